#!/bin/bash
# masu-bake: what a scene takes from where its models are (their cameras, and the ground that they fall on), and that
# what is left out is said.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/out"
failures=0
x=(-o "$folder/out/x.masu")
json=$folder/scene.json
sphere='{"mesh": {"sphere": {"subdivisions": 0}}'

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# run ARGUMENT...: masu-bake with its exit code in $code, its streams in stdout and stderr
run() {
    "$bake" "$@" > "$folder/stdout" 2> "$folder/stderr"
    code=$?
}
accepts() {
    run "$@"
    [ $code = 0 ] || fail "$*: exit code $code: $(cat "$folder/stderr")"
}
# says FILE PATTERN: the stream or file matches
says() { grep -q -e "$2" "$folder/$1" || fail "\"$2\" is not in $1: $(head -c 600 "$folder/$1")"; }
scene() { printf '%s\n' "$1" > "$json"; }
# wrong PATTERN TEXT: a scene with one mistake
wrong() {
    scene "$2"
    run "$json" "${x[@]}"
    [ $code = 1 ] || fail "$2: exit code $code"
    says stderr "scene.json$1"
}

# ---- cameras -------------------------------------------------------------------------------------

# One triangle (0,0,0) (1,0,0) (0,1,0), and two cameras.
positions=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA
cat > "$folder/camera.gltf" << END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0, "name": "outer", "translation": [10, 0, 0], "children": [1], "camera": 0},
           {"mesh": 0, "name": "inner", "translation": [0, 5, 0], "camera": 1}],
 "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
             {"type": "orthographic", "orthographic": {}}],
 "meshes": [{"name": "triangle", "primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,$positions"}]}
END

# A camera of a model's file: by its own name or with the model's before it; moved with the model.
for from in outer b/outer; do
    scene '{"models": [{"file": "camera.gltf", "name": "b", "translate": [1, 2, 3]}], "camera": {"from": "'$from'"}}'
    accepts "$json" "${x[@]}" --stats "$folder/stats.json"
    says stderr 'camera.gltf: 1 cameras without perspective or size, which are not supported (first: inner)'
    says stats.json '"b/outer"'
    cp "$folder/out/x.masu" "$folder/out/$(basename $from).$(dirname $from | tr . x).masu"
done
cmp "$folder/out/outer.x.masu" "$folder/out/outer.b.masu" || fail "two names of a camera are two cameras"
scene '{"models": [{"file": "camera.gltf", "name": "b", "translate": [1, 2, 3]}],
    "camera": {"keys": [{"position": [11, 2, 3], "target": [11, 2, 2], "fov_y": 28.64788975654116}]}}'
accepts "$json" "${x[@]}"
cmp "$folder/out/outer.x.masu" "$folder/out/x.masu" || fail "a camera is not where its file has it"
# An orthographic one: as one of a scene that is as high, exact in the middle of the model.
sed 's/"orthographic": {}/"orthographic": {"xmag": 6, "ymag": 3, "znear": 0.1, "zfar": 100}/; s/5, 0\], "camera"/5, 7], "camera"/' \
    "$folder/camera.gltf" > "$folder/flat.gltf"
scene '{"models": [{"file": "flat.gltf"}], "camera": {"from": "inner"}}'
accepts "$json" "${x[@]}" --strict
cp "$folder/out/x.masu" "$folder/out/flat.masu"
scene '{"models": [{"file": "flat.gltf"}], "camera": {"height": 6, "keys": [{"position": [10, 5, 7], "target": [10, 5, 3.5]}]}}'
accepts "$json" "${x[@]}"
cmp "$folder/out/flat.masu" "$folder/out/x.masu" || fail "an orthographic camera is not where its file has it"
wrong ': camera: expected either "fov_y" or "height", found both' "{\"models\": [$sphere}],
    \"camera\": {\"fov_y\": 40, \"height\": 2}}"

scene '{"models": [{"file": "camera.gltf"}], "camera": {"from": "inner"}}'
run "$json" "${x[@]}"
[ $code = 1 ] || fail "a camera that there is not: exit code $code"
says stderr ': camera.from: no model has a camera "inner"; available: "outer"'
wrong ': camera: expected either "keys" or "from", found both' "{\"models\": [$sphere}],
    \"camera\": {\"from\": \"a\", \"keys\": [{\"position\": [0,0,0], \"target\": [1,1,1]}]}}"

# ---- drop ----------------------------------------------------------------------------------------

# What is dropped rests on what stands there already, or on the ground: a box of 2 on one of 1, which stands at 5.
rests() {
    scene "{\"models\": [{\"mesh\": {\"box\": {}}, \"translate\": [0, 5, 0]},
        {\"mesh\": {\"box\": {\"size\": [2, 2, 2]}}, \"translate\": [$1, 9, 0.3], \"rotate_y\": 30, \"drop\": $2}]}"
    accepts "$json" "${x[@]}" --stats "$folder/stats.json"
    found=$(tr -d ' \n' < "$folder/stats.json" | sed 's/.*"bounds":\[\[[^,]*,\([^,]*\),.*\],\[[^,]*,\([^,]*\),.*/\1 \2/')
    [ "${found%% *}" = "$3" ] && [ "${found#* }" = "$4" ] || fail "dropped at $1: from $found, not $3 to $4"
}
rests 0.2 true 4.5 7.5
rests 1.4 true 4.5 7.5 # by a corner, where no vertex of either is above the other
rests 4 true 0.0 5.5
rests 4 -1.5 -1.5 5.5
rests 4 false 4.5 10.0
wrong ': models\[0\].drop: expected' "{\"models\": [$sphere, \"drop\": \"down\"}]}"

# ---- what is left out is said ----------------------------------------------------------------------

# Points and lines, of glTF by our reader, of other formats by Assimp; a pattern that no material has.
sed 's/"primitives": \[/"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}, "mode": 1}, /' \
    "$folder/camera.gltf" > "$folder/points.gltf"
accepts "$folder/points.gltf" "${x[@]}"
says stderr 'points.gltf: 1 primitives are points: skipped (first: triangle)'
says stderr 'points.gltf: 1 primitives are lines: skipped (first: triangle)'
printf 'o thing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nl 2 3\n' > "$folder/lines.obj"
accepts "$folder/lines.obj" "${x[@]}"
says stderr 'lines.obj: 2 points and lines skipped (in 1 meshes: "thing")'
scene '{"models": [{"file": "lines.obj", "materials": [{"match": "pai?t", "coat": 1}]}]}'
accepts "$json" "${x[@]}"
says stderr 'models\[0\]: no material matches "pai?t"'
run "$json" "${x[@]}" --strict
[ $code = 1 ] || fail "--strict takes warnings: exit code $code"
says stderr '2 warnings are errors with --strict'

# Many files of Collada say that nothing is to be seen of what is all there: it is taken for opaque, and not blended.
cat > "$folder/unseen.dae" << END
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><diffuse><color>0.5 0.5 0.5 1</color></diffuse>
<transparent opaque="A_ONE"><color>1 1 1 1</color></transparent><transparency><float>0</float></transparency>
</phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="f" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#f" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
END
accepts "$folder/unseen.dae" "${x[@]}" --stats "$folder/stats.json"
says stderr 'unseen.dae: 1 materials have an opacity of 0: treated as opaque'
# Rays meet the ground's two triangles and its one: they pass by what is blended.
found=$(tr -d ' \n' < "$folder/stats.json" | sed 's/.*"reflections":{\([^}]*\)}.*/\1/')
case $found in *'"triangles":3,'*) ;; *) fail "unseen.dae is blended: $found" ;; esac

# ---- rest poses ----------------------------------------------------------------------------------

# A mesh that follows a joint stands where the joint rests, in the formats of Assimp too: 5 above where it is bound.
cat > "$folder/bent.x" << END
xof 0303txt 0032
template XSkinMeshHeader { <3cf169ce-ff7c-44ab-93c0-f78f62d172e2> WORD nMaxSkinWeightsPerVertex; WORD nMaxSkinWeightsPerFace; WORD nBones; }
template SkinWeights { <6f0d123b-bad2-4167-a0d0-80224f25fabb> STRING transformNodeName; DWORD nWeights;
 array DWORD vertexIndices[nWeights]; array float weights[nWeights]; Matrix4x4 matrixOffset; }
Frame root {
 FrameTransformMatrix { 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; }
 Frame joint { FrameTransformMatrix { 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,5.0,0.0,1.0;; } }
 Frame bent { FrameTransformMatrix { 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,40.0,0.0,1.0;; }
  Mesh skin { 3; 0.0;0.0;0.0;, 1.0;0.0;0.0;, 0.0;1.0;0.0;; 1; 3;0,1,2;;
   XSkinMeshHeader { 1; 1; 1; }
   SkinWeights { "joint"; 3; 0, 1, 2; 1.0, 1.0, 1.0; 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; }
  }
 }
}
END
accepts "$folder/bent.x" "${x[@]}" --stats "$folder/stats.json" --bare
found=$(tr -d ' \n' < "$folder/stats.json" | sed 's/.*"bounds":\[\[[^,]*,\([^,]*\),.*\],\[[^,]*,\([^,]*\),.*/\1 \2/')
case $found in 5.0*\ 6.0*) ;; *) fail "a skin rests from $found, not 5 to 6" ;; esac

[ $failures = 0 ] && echo "masu-bake: cameras, drops and warnings as expected"
[ $failures = 0 ]
