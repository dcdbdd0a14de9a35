#!/bin/bash
# masu-bake from outside: what it writes, what it says when it cannot, and what it leaves behind.
# Every failure is one line on stderr that names the thing, exit code 1 (2: wrong usage), no output,
# no temporary file. Hostile model files never crash it.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
models=/usr/share/assimp/models
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/tmp" "$folder/out"
export TMPDIR=$folder/tmp
failures=0
tools=$PATH # where masu-bake finds the shader tools

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# run ARGUMENT...: masu-bake with its exit code in $code, its streams in out/stdout and out/stderr
run() {
    PATH=$tools "$bake" "$@" > "$folder/stdout" 2> "$folder/stderr"
    code=$?
    left=$(ls -A "$TMPDIR")
    [ -z "$left" ] || fail "$*: leaves $left in TMPDIR" "$(rm -rf "${TMPDIR:?}"/*)"
    drafts=$(find "$folder" -name '*.part')
    [ -z "$drafts" ] || fail "$*: leaves $drafts"
}

# refuses CODE PATTERN ARGUMENT...: that exit code, one line that matches, and no output
refuses() {
    local wanted=$1 pattern=$2
    shift 2
    rm -f "$folder/out/x.masu"
    run "$@"
    [ $code = "$wanted" ] || fail "$*: exit code $code, not $wanted: $(cat "$folder/stderr")"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "$*: not one line: $(cat "$folder/stderr")"
    grep -q -e "^masu-bake: .*$pattern" "$folder/stderr" ||
        fail "$*: \"$pattern\" is not in: $(cat "$folder/stderr")"
    [ ! -e "$folder/out/x.masu" ] || fail "$*: wrote its output"
}

# accepts ARGUMENT...: exit code 0
accepts() {
    run "$@"
    [ $code = 0 ] || fail "$*: exit code $code: $(cat "$folder/stderr")"
}

# says FILE PATTERN: the stream or file matches
says() {
    grep -q -e "$2" "$folder/$1" || fail "\"$2\" is not in $1: $(head -c 600 "$folder/$1")"
}

# scene TEXT: writes scene.json
scene() { printf '%s\n' "$1" > "$folder/scene.json"; }

x=(-o "$folder/out/x.masu")
json=$folder/scene.json
glsl=$folder/field.glsl
cat > "$folder/good.glsl" << 'END'
float masu_sdf(vec3 p) { return length(p) - 1.0; }
void masu_sdf_surface(vec3 p, inout masu_surface s) { s.albedo = vec3(0.5); }
END

# ---- command line --------------------------------------------------------------------------------

accepts --help
says stdout '^Usage: masu-bake MODEL|SCENE.json|FIELD.sdf -o X.masu'
accepts -h
accepts --version
says stdout '^masu-bake [0-9]*\.[0-9]*\.[0-9]*$'
refuses 2 'no MODEL, SCENE.json or FIELD.sdf given'
refuses 2 'no output given' tests/scenes/test_both.json
refuses 2 'more than one input: b' a b "${x[@]}"
refuses 2 'unknown option --outptu' --outptu=x a
refuses 2 'unknown option -q' -q a
refuses 2 '\-o needs a value' a -o
refuses 2 '\-\-quiet takes no value' --quiet=yes a "${x[@]}"
accepts tests/scenes/test_both.json --output="$folder/out/a.masu" --quiet
[ ! -s "$folder/stdout" ] || fail "--quiet prints $(cat "$folder/stdout")"
accepts "-o$folder/out/b.masu" -- tests/scenes/test_both.json
says stdout 'b.masu: [0-9]* bytes, 24 vertices, 12 triangles'
cmp "$folder/out/a.masu" "$folder/out/b.masu" || fail "the same scene gives other bytes"
accepts tests/scenes/test_planted_fault.json -o "$folder/out/c.masu" --quiet

# ---- files ---------------------------------------------------------------------------------------

refuses 1 "cannot read $folder/none.glb: No such file" "$folder/none.glb" "${x[@]}"
refuses 1 "cannot read $folder/none.json: No such file" "$folder/none.json" "${x[@]}"
refuses 1 "cannot read $folder: Is a directory" "$folder" "${x[@]}"
refuses 1 'cannot read /dev/zero: not a regular file' /dev/zero "${x[@]}"
: > "$folder/empty.glb"
refuses 1 'cannot read .*empty.glb' "$folder/empty.glb" "${x[@]}"
: > "$folder/empty.json"
refuses 1 'empty.json:1:' "$folder/empty.json" "${x[@]}"
head -c 3000 /dev/urandom > "$folder/noise.glb"
refuses 1 'cannot read .*noise.glb' "$folder/noise.glb" "${x[@]}"
plain=$folder/plain.json # without an SDF, which takes two seconds to compile
echo '{"models": [{"mesh": {"sphere": {"subdivisions": 0}}}]}' > "$plain"
refuses 1 '/nowhere/x.masu: cannot write: No such file' $plain -o /nowhere/x.masu
refuses 1 "$folder/out: cannot write: it is a directory" $plain -o "$folder/out"
refuses 1 'cannot write /dev/full: No space' $plain -o /dev/full
accepts $plain -o /dev/null
[ -c /dev/null ] || fail "/dev/null was replaced"
"$bake" $plain "${x[@]}" > /dev/full 2> "$folder/stderr" &&
    fail "a full standard output is not noticed"
says stderr 'cannot write to standard output'

# A failed bake leaves the old blob; a link's target is replaced, not the link.
cp "$folder/out/a.masu" "$folder/out/old.masu"
scene '{"models": 1}'
run "$json" -o "$folder/out/old.masu"
cmp "$folder/out/a.masu" "$folder/out/old.masu" || fail "a failed bake changed its output"
ln -s old.masu "$folder/out/link.masu"
accepts $plain -o "$folder/out/link.masu"
[ -L "$folder/out/link.masu" ] || fail "a link was replaced"
[ "$(head -c 4 "$folder/out/old.masu")" = MASU ] || fail "no MASU at the start of a blob"
size=$(od -An -t u8 -j 8 -N 8 "$folder/out/old.masu" | tr -d ' ')
[ "$size" = "$(stat -c %s "$folder/out/old.masu")" ] || fail "the header says $size bytes"

# ---- scenes: mistakes ----------------------------------------------------------------------------

# wrong PATTERN TEXT: a scene with one mistake
wrong() {
    scene "$2"
    refuses 1 "scene.json$1" "$json" "${x[@]}"
}

sphere='{"mesh": {"sphere": {"subdivisions": 0}}'
wrong ':2:' '{"models": [],
  oops}'
wrong ':1:.*duplicate' '{"exposure": 1, "exposure": 2}'
wrong ': expected an object' '[]'
wrong ': empty scene' '{}'
wrong ': modles: unknown key' '{"modles": []}'
wrong ': models: expected an array' '{"models": {}}'
wrong ': models\[0\].scael: unknown key' '{"models": [{"file": "a.obj", "scael": 2}]}'
wrong ': models\[0\]: needs either "file" or "mesh"' '{"models": [{"name": "x"}]}'
wrong ': models\[0\].file: expected a string' '{"models": [{"file": 1}]}'
wrong ': models\[1\].scale: must not be zero' "{\"models\": [$sphere}, $sphere, \"scale\": 0}]}"
wrong ': models\[0\].scale\[2\]: expected a number, found a string' \
    "{\"models\": [$sphere, \"scale\": [1, 1, \"a\"]}]}"
wrong ': models\[0\].translate: expected three numbers, found 2' \
    "{\"models\": [$sphere, \"translate\": [1, 1]}]}"
wrong ': models\[0\]: expected either "rotate" or "rotate_y", found both' \
    "{\"models\": [$sphere, \"rotate\": [1, 2, 3], \"rotate_y\": 1}]}"
wrong ': models\[0\].fit: expected either' \
    "{\"models\": [$sphere, \"fit\": {\"center\": [0,0,0], \"base\": [0,0,0]}}]}"
wrong ': models\[0\].material.depth_bias: expected a number from -0.01 to 0.01, found 0.02' \
    '{"models": [{"mesh": {"sphere": {}}, "material": {"depth_bias": 0.02}}]}'
wrong ': models\[0\].material: "emissive": an unlit material' \
    '{"models": [{"mesh": {"sphere": {}}, "material": {"unlit": true, "emissive": [1, 1, 1]}}]}'
wrong ': models\[0\].material.roughness: expected a number from 0 to 1, found 2' \
    "{\"models\": [$sphere, \"material\": {\"roughness\": 2}}]}"
wrong ': models\[0\].mesh: needs one of' '{"models": [{"mesh": {}}]}'
wrong ': models\[0\].mesh.sphere.subdivisions: expected a number from 0 to 8' \
    '{"models": [{"mesh": {"sphere": {"subdivisions": 30}}}]}'
wrong ': models\[0\]: gives a transform' \
    "{\"models\": [$sphere, \"translate\": [1e15, 0, 0], \"scale\": 1e9,
      \"fit\": {\"size\": 1e9, \"center\": [1e15, 0, 0]}}]}"
wrong ': camera.fov_y: expected a number from 0.1 to 170, found 180' \
    "{\"models\": [$sphere}], \"camera\": {\"fov_y\": 180}}"
wrong ': camera.keys: expected at least 1' "{\"models\": [$sphere}], \"camera\": {\"keys\": []}}"
wrong ': camera.keys\[0\]: position and target are the same' "{\"models\": [$sphere}],
    \"camera\": {\"keys\": [{\"position\": [1,1,1], \"target\": [1,1,1]}]}}"
wrong ': camera.keys\[1\]: time must be later' "{\"models\": [$sphere}],
    \"camera\": {\"keys\": [{\"time\": 1, \"position\": [1,1,1], \"target\": [0,1,1]},
                            {\"time\": 1, \"position\": [1,1,1], \"target\": [0,1,1]}]}}"
wrong ': sun.direction: expected a vector that is not zero' "{\"models\": [$sphere}], \"sun\": {\"direction\": [0,0,0]}}"
wrong ': sun: expected either' \
    "{\"models\": [$sphere}], \"sun\": {\"direction\": [0,1,0], \"azimuth\": 3}}"
for bad in '"cascades": 0' '"cascades": 5' '"cascades": -1' '"resolution": 0' '"resolution": 15' \
    '"resolution": 8193' '"resolution": -64' '"distance": 0' '"distance": -3' '"distance": 1e10' \
    '"lambda": -0.1' '"lambda": 1.1'; do
    name=${bad%%:*} name=${name//\"/}
    wrong ": sun.shadows.$name: expected a number from" \
        "{\"models\": [$sphere}], \"sun\": {\"shadows\": {$bad}}}"
done
wrong ': sun.shadows.cascades: expected a whole number' \
    "{\"models\": [$sphere}], \"sun\": {\"shadows\": {\"cascades\": 1.5}}}"
wrong ':1:.*NaN' "{\"models\": [$sphere}], \"sun\": {\"shadows\": {\"distance\": NaN}}}"
wrong ': sun.shadows.size: unknown key' \
    "{\"models\": [$sphere}], \"sun\": {\"shadows\": {\"size\": 3}}}"
wrong ': sun.shadows: expected an object, true or false, found a number' \
    "{\"models\": [$sphere}], \"sun\": {\"shadows\": 1}}"
wrong ': exposure: expected a number' "{\"models\": [$sphere}], \"exposure\": 0}"
wrong ': exposure.darken: expected a number' "{\"models\": [$sphere}], \"exposure\": {\"darken\": -1}}"
wrong ': exposure.speed: unknown key' "{\"models\": [$sphere}], \"exposure\": {\"speed\": 1}}"
wrong ': sdf: needs "bounds"' '{"sdf": {"source": "good.glsl"}}'
wrong ': sdf.bounds: the first corner must be the lower' \
    '{"sdf": {"source": "good.glsl", "bounds": [[0,0,0],[1,0,1]]}}'
wrong ': sdf: needs "source"' '{"sdf": {"bounds": [[0,0,0],[1,1,1]]}}'
bounds='"bounds": [[-1,-1,-1],[1,1,1]]'
wrong ': sdf.lipschitz: expected a number from 0.001' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"lipschitz\": 0}}"
wrong ': sdf.params\[0\].name: expected at most' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds,
      \"params\": [{\"name\": \"a b\", \"value\": 0}]}}"
wrong ': sdf.params\[0\]: value 3 is not between min 0 and max 1' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds,
      \"params\": [{\"name\": \"a\", \"value\": 3, \"min\": 0, \"max\": 1}]}}"
wrong ': sdf.params\[1\]: another parameter has the same constant MASU_PARAM_AB' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds,
      \"params\": [{\"name\": \"ab\", \"value\": 0}, {\"name\": \"AB\", \"value\": 0}]}}"
wrong ': sdf.shadows: expected an object, true or false, found a string' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"shadows\": \"soft\"}}"
wrong ': sdf.shadows.radius: unknown key' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"shadows\": {\"radius\": 1}}}"
wrong ': sdf.shadows.sun_radius: expected a number from 0 to 20, found 21' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"shadows\": {\"sun_radius\": 21}}}"
wrong ': sdf.shadows.distance: expected a number from 0.001' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"shadows\": {\"distance\": 1e16}}}"
wrong ':1:.*NaN' "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"shadows\": {\"distance\": NaN}}}"
wrong ': sdf.ambient_occlusion.radius: expected a number from 0.001' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"ambient_occlusion\": {\"radius\": 0}}}"
wrong ': sdf.ambient_occlusion.strength: expected a number from 0 to 1, found 2' \
    "{\"sdf\": {\"source\": \"good.glsl\", $bounds, \"ambient_occlusion\": {\"strength\": 2}}}"
scene "{\"sdf\": {\"source\": \"none.glsl\", $bounds}}"
refuses 1 "cannot read $folder/none.glsl: No such file" "$json" "${x[@]}"
scene '{"models": [{"file": "none.obj"}]}'
refuses 1 "cannot read $folder/none.obj: No such file" "$json" "${x[@]}"
scene '{"models": [{"file": "@assimp/none.obj"}]}'
refuses 1 "cannot read /over/there/none.obj: No such file" "$json" "${x[@]}" --models /over/there

# ---- the scene's GLSL ----------------------------------------------------------------------------

scene "{\"sdf\": {\"source\": \"field.glsl\", $bounds}}"
{ cat "$folder/good.glsl" && echo 'float a = vec3(1.0);'; } > "$glsl"
refuses 1 'field.glsl:3: ' "$json" "${x[@]}"
sed 's/masu_sdf(/my_sdf(/' "$folder/good.glsl" > "$glsl"
run "$json" "${x[@]}"
[ $code = 1 ] || fail "GLSL without masu_sdf: exit code $code"
says stderr "masu-bake: the scene's GLSL must define float masu_sdf(vec3)"
printf '#include "part.glsl"\n' > "$glsl"
cp "$folder/good.glsl" "$folder/part.glsl"
accepts "$json" "${x[@]}"
printf '\x00\xff\x13' > "$glsl"
run "$json" "${x[@]}"
[ $code = 1 ] || fail "binary GLSL: exit code $code"
cp "$folder/good.glsl" "$glsl"

# Tools that are missing, die, or do not end.
mkdir "$folder/bin"
tools=$folder/bin
refuses 1 'cannot run glslangValidator; is it installed? (package glslang-tools)' \
    "$json" "${x[@]}"
tools=$folder/bin:$PATH
for tool in glslangValidator spirv-val spirv-opt; do
    printf '#!/bin/sh\nkill -SEGV $$\n' > "$folder/bin/$tool"
    chmod +x "$folder/bin/$tool"
    refuses 1 "field.glsl: $tool was ended by signal 11 (SIGSEGV)" "$json" "${x[@]}"
    printf '#!/bin/sh\necho it is full\nexit 3\n' > "$folder/bin/$tool"
    refuses 1 "$tool failed (exit code 3): it is full" "$json" "${x[@]}"
    printf '#!/bin/sh\nexit 0\n' > "$folder/bin/$tool"
    [ $tool = spirv-val ] || refuses 1 '' "$json" "${x[@]}"
    rm "$folder/bin/$tool"
done
printf '#!/bin/sh\necho started > %s\nexec sleep 60\n' "$folder/started" \
    > "$folder/bin/glslangValidator"
chmod +x "$folder/bin/glslangValidator"
PATH=$tools "$bake" "$json" "${x[@]}" > "$folder/stdout" 2> "$folder/stderr" &
for _ in $(seq 100); do
    [ -e "$folder/started" ] && break
    sleep 0.1
done
kill -TERM $!
wait $!
[ $? = 143 ] || fail "TERM: exit code is not 143"
says stderr 'interrupted by signal 15'
[ -z "$(ls -A "$TMPDIR")" ] || fail "TERM: leaves $(ls -A "$TMPDIR")"
tools=$PATH

# ---- what a model becomes ------------------------------------------------------------------------

# One triangle (0,0,0) (1,0,0) (0,1,0), shown by three nodes: one in another, one mirrored.
positions=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA
cat > "$folder/nodes.gltf" << END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
 "nodes": [{"mesh": 0, "name": "outer", "translation": [10, 0, 0], "children": [1]},
           {"mesh": 0, "name": "inner", "translation": [0, 5, 0], "scale": [2, 2, 2]},
           {"mesh": 0, "name": "mirrored", "scale": [-1, 1, 1]}],
 "meshes": [{"name": "triangle", "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
 "materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0, 1]}}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,$positions"}]}
END
accepts "$folder/nodes.gltf" "${x[@]}" --bare --stats "$folder/stats.json"
says stdout ' 3 vertices, 1 triangles (3 drawn), 1 meshes, 3 instances, 1 materials'
bounds_found=$(tr -d ' \n' < "$folder/stats.json" | sed 's/.*"bounds":\(\[\[.*\]\]\).*/\1/')
[ "$bounds_found" = '[[-1.0,0.0,0.0],[12.0,7.0,0.0]]' ] || fail "nodes: bounds $bounds_found"
for name in outer inner mirrored triangle paint; do
    grep -q -a "$name" "$folder/out/x.masu" || fail "the name $name is not in the blob"
done

# An animated file alone plays: its clip is kept, without "moving". One without clips has no model.
sed -e "s|\"count\": 3|&|; s|^ \"bufferViews\": \[| \"animations\": [{\"name\": \"lift\", \"samplers\": [{\"input\": 1, \"output\": 2}],\\
    \"channels\": [{\"sampler\": 0, \"target\": {\"node\": 1, \"path\": \"translation\"}}]}],\\
&{\"buffer\": 1, \"byteLength\": 8}, {\"buffer\": 1, \"byteOffset\": 8, \"byteLength\": 24}, |" \
    -e 's|"bufferView": 0, "componentType"|"bufferView": 2, "componentType"|' \
    -e 's|"max": \[1, 1, 0\]}|&,\
    {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"},\
    {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"}|' \
    -e "s|\"buffers\": \[.*\"}\]|\"buffers\": [{\"byteLength\": 36, \"uri\": \"data:application/octet-stream;base64,$positions\"},\\
    {\"byteLength\": 32, \"uri\": \"data:application/octet-stream;base64,AAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAAAACgQAAAAAA=\"}]|" "$folder/nodes.gltf" > "$folder/lift.gltf"
accepts "$folder/lift.gltf" "${x[@]}"
grep -q -a lift "$folder/out/x.masu" || fail "lift.gltf: its clip is not kept"
"$bake" "$folder/lift.gltf" --describe | grep -q '"moving": true' || fail "lift.gltf: does not play"
! "$bake" "$folder/nodes.gltf" --describe | grep -q moving || fail "nodes.gltf: a model without clips is movable"

# What --describe writes is baked to the same bytes: a model with a ground, a flat one, a clip, a field.
echo 'f 1 2 3 4' | cat <(printf 'v %s 0 %s\n' 0 0 0 9 9 9 9 0) - > "$folder/flat.obj"
echo 'part ball = sphere(0.7);' > "$folder/ball.sdf"
mkdir -p "$folder/out"
for input in nodes.gltf flat.obj lift.gltf ball.sdf; do
    accepts "$folder/$input" "${x[@]}"
    cp "$folder/out/x.masu" "$folder/out/alone.masu"
    accepts "$folder/$input" --describe -o "$folder/out/told.json"
    accepts "$folder/out/told.json" "${x[@]}"
    cmp -s "$folder/out/x.masu" "$folder/out/alone.masu" || fail "$input: its description gives another blob"
    (cd "$folder" && "$bake" "$input" --describe) | grep -q "\"$input\"" || fail "$input: is not named in its description"
done
grep -q '"sdf"' "$folder/out/told.json" || fail "no SDF in: $(cat "$folder/out/told.json")"
refuses 1 'told.json: is a scene description already' "$folder/out/told.json" --describe
refuses 2 'found a name that ends in .masu, expected one that ends in .json' "$folder/nodes.gltf" --describe "${x[@]}"
refuses 2 'bakes nothing: remove --stats' "$folder/nodes.gltf" --describe --stats "$folder/stats.json"
rm -f "$folder/out/told.json" "$folder/out/alone.masu"

# A model that is kilometres long may be in centimetres.
printf 'v %s 0 %s\n' 0 0 0 9 1500000 9 1500000 0 | cat - <(echo 'f 1 2 3 4') > "$folder/wide.obj"
accepts "$folder/wide.obj" "${x[@]}"
says stdout 'wide.obj: is 1.5e+06 m long; if its file is in centimetres'

# The same with NaN in a corner of one of two triangles, then in both.
nan=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAwH8AAAAA
two=$(printf '%s%s' "$positions" "$nan")
sed -e 's/"count": 3/"count": 6/; s/"byteLength": 36/"byteLength": 72/g' \
    -e "s|base64,.*\"}|base64,$two\"}|" "$folder/nodes.gltf" > "$folder/half.gltf"
accepts "$folder/half.gltf" "${x[@]}" --bare
says stderr 'half.gltf: 1 of 2 triangles skipped: a vertex is not finite (in 1 meshes: "triangle")'
says stdout ' 3 vertices, 1 triangles'
sed "s|base64,.*\"}|base64,$nan\"}|" "$folder/nodes.gltf" > "$folder/nan.gltf"
refuses 1 'nan.gltf: no triangles to draw; 1 of 1' "$folder/nan.gltf" "${x[@]}"

# Nodes that show the same set of meshes share one masu mesh; another set with one of them does not.
geometry() {
    printf '<geometry id="%s"><mesh><source id="p%s">
        <float_array id="f%s" count="9">%s</float_array>
        <technique_common><accessor source="#f%s" count="3" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/>
        <param name="Z" type="float"/></accessor></technique_common></source>
        <vertices id="v%s"><input semantic="POSITION" source="#p%s"/></vertices>
        <triangles count="1"><input semantic="VERTEX" source="#v%s" offset="0"/><p>0 1 2</p>
        </triangles></mesh></geometry>' "$1" "$1" "$1" "$2" "$1" "$1" "$1" "$1"
}
cat > "$folder/sets.dae" << END
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries>$(geometry a '0 0 0 1 0 0 0 1 0')$(geometry b '0 0 1 1 0 1 0 1 1')
</library_geometries><library_visual_scenes><visual_scene id="s">
<node><instance_geometry url="#a"/><instance_geometry url="#b"/></node>
<node><translate>5 0 0</translate><instance_geometry url="#a"/></node>
<node><translate>9 0 0</translate><instance_geometry url="#a"/><instance_geometry url="#b"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
END
accepts "$folder/sets.dae" "${x[@]}" --bare
says stdout ' 6 vertices, 3 triangles (5 drawn), 2 meshes, 3 instances'

# A model placed twice is stored once; an override makes new materials, not new geometry.
scene '{"models": [{"file": "nodes.gltf"}, {"file": "nodes.gltf", "name": "b", "rotate_y": 90},
    {"file": "nodes.gltf", "material": {"roughness": 0.5}}]}'
accepts "$json" "${x[@]}"
says stdout ' 3 vertices, 2 triangles (9 drawn), 2 meshes, 9 instances, 2 materials'
# Those that a pattern names alone; the last word counts.
scene '{"models": [{"file": "nodes.gltf", "material": {"coat": 1},
    "materials": [{"match": "no such *", "coat": 0.5}]}, {"file": "nodes.gltf", "material": {"coat": 1}},
    {"file": "nodes.gltf", "materials": [{"match": "pa?nt", "coat": 0.25}, {"match": "*", "coat": 1}]}]}'
accepts "$json" "${x[@]}"
says stdout ' 3 vertices, 3 triangles (9 drawn), 3 meshes, 9 instances, 1 materials'
wrong ': models\[0\].materials\[0\]: needs "match"' \
    "{\"models\": [{\"file\": \"nodes.gltf\", \"materials\": [{\"coat\": 1}]}]}"
wrong ': models\[0\].material.detail: expected a number from 0.001 to 10000, or two' \
    "{\"models\": [{\"file\": \"nodes.gltf\", \"material\": {\"detail\": [1, 2, 3]}}]}"
wrong ': models\[0\].materials: expected an array' \
    "{\"models\": [{\"file\": \"nodes.gltf\", \"materials\": {}}]}"
scene '{"models": [{"file": "nodes.gltf", "rotate": [0, 0, 90],
    "fit": {"size": 26, "base": [1, 2, 3]}, "translate": [0, 0, 1]}]}'
accepts "$json" "${x[@]}" --stats "$folder/stats.json"
bounds_found=$(tr -d ' \n' < "$folder/stats.json" | sed 's/.*"bounds":\(\[\[.*\]\]\).*/\1/')
[ "$bounds_found" = '[[-6.0,2.0,4.0],[8.0,28.0,4.0]]' ] || fail "fit: bounds $bounds_found"

# ---- scenes of the tree, as make has baked them: of every way to bake one; with the sanitizers one ---------

again=(scenes/{glass,mirrors,night,surfaces,textures}.json)
[ "${NESTED:-}" = '' ] || again=(scenes/textures.json)
for file in "${again[@]}"; do
    accepts "$file" -o "$folder/out/again.masu" --texture-path "${MADE:-build}/textures"
    cmp "$folder/out/again.masu" "${MADE:-build}/scenes/$(basename "$file" .json).masu" ||
        fail "$file: not the same bytes twice"
done

# ---- hostile models ------------------------------------------------------------------------------

[ -d $models/invalid ] || fail "$models is missing (package assimp-testmodels)"
. tests/outcome.sh
tried=0 least=150
[ "${NESTED:-}" = '' ] || least=15
: > "$folder/outcomes"
while read -r file; do
    rm -f "$folder/out/x.masu"
    run "$file" "${x[@]}" --quiet
    tried=$((tried + 1))
    ! is_model "$file" || outcome $code "$folder/stderr" >> "$folder/outcomes"
    [ $code = 0 ] || [ $code = 1 ] || fail "$file: exit code $code"
    if [ $code = 1 ] && [ "${config:-}" != sanitize ]; then # there Assimp's own stderr is shown
        [ "$(grep -vc '^masu-bake: warning: ' "$folder/stderr")" = 1 ] ||
            fail "$file: not one line: $(cat "$folder/stderr")"
    fi
    [ $code = 1 ] || [ -s "$folder/out/x.masu" ] || fail "$file: no output"
    ! grep -q -e 'Sanitizer' -e 'runtime error' "$folder/stderr" || fail "$(cat "$folder/stderr")"
    # The address sanitizer takes a minute to refuse what OutOfMemory.off asks for.
done < <(find $models/{glTF2,glTF,OBJ,AC,invalid,PLY,STL,OFF} -type f ! -size +2M |
    if [ "${config:-}" = sanitize ]; then grep -v OutOfMemory.off; else cat; fi | sort |
    if [ "${NESTED:-}" ]; then sed -n '1~12p'; else cat; fi)
[ $tried -gt $least ] || fail "only $tried models were tried"
# How many of those that are models bake, and why the others do not. Where this is better than it was, tests/expect/models.txt is to
# be written anew from what is printed here.
if [ "${config:-}" != sanitize ] && [ "${NESTED:-}" = '' ]; then
    sort "$folder/outcomes" | uniq -c | sed 's/^ *//' > "$folder/counts"
    diff tests/expect/models.txt "$folder/counts" ||
        fail "other counts (>) than tests/expect/models.txt (<)"
fi

# ---- What the command line changes ---------------------------------------------------------------

cat > "$folder/paint.gltf" << 'END'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"extensionsUsed":["KHR_materials_variants"],
"extensions":{"KHR_materials_variants":{"variants":[{"name":"crimson"},{"name":"azure"}]}},
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.1,1]}},
{"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.9,1]}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0,
"extensions":{"KHR_materials_variants":{"mappings":[{"material":0,"variants":[0]},{"material":1,
"variants":[1]}]}}}]}],"buffers":[{"byteLength":66,
"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAIC/AAABAAIAAQADAAIAAwAAAAIA"}],
"bufferViews":[{"buffer":0,"byteLength":48,"byteOffset":0},{"buffer":0,"byteLength":18,"byteOffset":48}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,0,-1],"max":[1,2,0]},
{"bufferView":1,"componentType":5123,"count":9,"type":"SCALAR"}]}
END
for paint in crimson azure; do
    accepts "$folder/paint.gltf" -o "$folder/$paint.masu" --variant $paint --quiet
done
accepts "$folder/paint.gltf" -o "$folder/plain.masu" --quiet
cmp -s "$folder/plain.masu" "$folder/crimson.masu" || fail "--variant crimson is not the file's own material"
cmp -s "$folder/plain.masu" "$folder/azure.masu" && fail "--variant azure changes nothing"
refuses 1 'green.*"crimson", "azure"' "$folder/paint.gltf" "${x[@]}" --variant green
scene '{"models": [{"file": "paint.gltf"}]}'
refuses 1 'scene.json: --variant needs a model' "$json" "${x[@]}" --variant azure

# Half of the panorama is brighter (32 x 16 texels of Radiance's format, not compressed).
{
    printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n'
    for ((i = 0; i < 16; i++)); do
        for ((j = 0; j < 32; j++)); do printf "\\x$((j < 16 ? 70 : 20))\\x40\\x40\\x80"; done
    done
} > "$folder/sky.hdr"
scene '{"environment": {"file": "sky.hdr", "rotate": 30}, "models": [{"file": "paint.gltf"}]}'
accepts "$json" -o "$folder/more.masu" --turn 20 --quiet
if [ "${NESTED:-}" = '' ]; then # with the sanitizers, one such bake goes through the same code
    accepts "$json" -o "$folder/turned.masu" --quiet
    scene '{"environment": {"file": "sky.hdr", "rotate": 10}, "models": [{"file": "paint.gltf"}]}'
    accepts "$json" -o "$folder/less.masu" --turn 20 --quiet
    cmp -s "$folder/turned.masu" "$folder/less.masu" || fail "--turn 20 is not added to the 10 degrees of the scene"
    cmp -s "$folder/turned.masu" "$folder/more.masu" && fail "--turn changes nothing"
fi
refuses 2 'turn.*400' "$json" "${x[@]}" --turn 400

[ $failures = 0 ] && echo "masu-bake: all as expected, $tried models tried"
[ $failures = 0 ]
