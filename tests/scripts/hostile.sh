#!/bin/bash
# Broken models by name: what masu-bake says about each, and that what it bakes is sane. A few are of
# Debian's assimp-testmodels; the others are written here, so that each kind of damage is met even
# where the library changes. tests/hostile.sh goes through the whole package.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
models=/usr/share/assimp/models
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# try FILE: bakes within 30 s and 2 GiB; the exit code in $code
try() {
    (
        [ "${config:-}" = sanitize ] || ulimit -v 2097152
        exec timeout 30 "$bake" "$1" --bare -o "$folder/x.masu" --stats "$folder/x.json" --quiet
    ) > "$folder/stdout" 2> "$folder/stderr"
    code=$?
}

# refuses FILE PATTERN: exit code 1 and one line that matches
refuses() {
    try "$1"
    [ $code = 1 ] || fail "$1: exit code $code: $(cat "$folder/stderr")"
    grep -q -e "^masu-bake: .*$2" "$folder/stderr" || fail "$1: no \"$2\": $(cat "$folder/stderr")"
    [ "${config:-}" = sanitize ] || [ "$(wc -l < "$folder/stderr")" = 1 ] ||
        fail "$1: not one line: $(cat "$folder/stderr")"
}

# warns FILE TRIANGLES PATTERN: a blob of so many triangles, and a warning that matches
warns() {
    try "$1"
    [ $code = 0 ] || fail "$1: exit code $code: $(cat "$folder/stderr")"
    grep -q -e "^masu-bake: warning: .*$3" "$folder/stderr" ||
        fail "$1: no \"$3\": $(cat "$folder/stderr")"
    grep -q "\"triangles\": $2," "$folder/x.json" ||
        fail "$1: not $2 triangles: $(grep triangles "$folder/x.json")"
}

# ---- made here -----------------------------------------------------------------------------------

square='v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n'
cd "$folder" || exit 1
printf "o part\n$square%s" 'v nan 0 0
f 1 2 3
f 1 3 5
' > nan.obj
warns nan.obj 1 '1 of 2 triangles skipped: a vertex is not finite (in 1 meshes: "part")'
printf "o part\n${square}v 1e30 0 0\nf 1 2 3\nf 1 3 5\n" > far.obj
warns far.obj 1 '1 of 2 triangles skipped: a vertex is not finite'
printf "o part\n${square}v 2 0 0\nf 1 2 3\nf 1 2 5\nf 1 1 2\n" > flat.obj
warns flat.obj 1 'triangles skipped: they have no area (in 1 meshes: "part")'
printf "o part\n${square}v 2 0 0\nf 1 2 5\n" > all_flat.obj
refuses all_flat.obj 'no triangles to draw; 1 of 1 triangles skipped: they have no area'
printf "${square}f 1 2 9\n" > index.obj
refuses index.obj 'cannot read index.obj: '
printf "${square}f 1 2 -9\n" > negative.obj
refuses negative.obj 'cannot read negative.obj: '
printf "${square}vn nan nan nan\nvn 0 0 0\nf 1//1 2//2 3//1\n" > normals.obj
warns normals.obj 1 'normals regenerated: they were invalid'
printf "mtllib gone.mtl\nusemtl gone\n${square}f 1 2 3\n" > no_material.obj
try no_material.obj
[ $code = 0 ] || fail "a missing material file: $(cat stderr)"
printf 'newmtl a\nKd nan inf -7\nKe 1e39 nan 0\nNs nan\nd nan\nillum 99\nmap_Kd no such.png\n' > a.mtl
printf "mtllib a.mtl\nusemtl a\n${square}f 1 2 3\n" > bad_material.obj
warns bad_material.obj 1 'no such.png'
# As exporters for Windows write them: keywords in capitals, names in another case or with folders of their own.
printf 'SOLID Part\r\n  FACET NORMAL 0.0E+00 0.0E+00 1.0E+00\r\n    OUTER LOOP\r\n      VERTEX 0.0E+00 0.0E+00 0.0E+00
      VERTEX 1.0E+00 0.0E+00 0.0E+00\r\n      VERTEX 0.0E+00 1.0E+00 0.0E+00\r\n    ENDLOOP\r\n  ENDFACET\r\nENDSOLID Part\r\n' > capitals.stl
try capitals.stl
[ $code = 0 ] || fail "an STL in capitals: $(cat stderr)"
grep -q '"triangles": 1,' x.json || fail "an STL in capitals: $(grep triangles x.json)"
printf 'newmtl red\nKd 1 0 0\nmap_Kd C:\\textures\\GONE.png\n' > Red.mtl
for name in RED.MTL '.\red.mtl' 'C:\models\Red.mtl'; do
    printf "mtllib %s\nusemtl red\n${square}f 1 2 3\n" "$name" > library.obj
    warns library.obj 1 'GONE.png'
done
: > empty.obj
refuses empty.obj 'cannot read empty.obj'
printf 'AC3Db\nOBJECT world\nkids 1\nOBJECT poly\nnumvert 1000000000\n0 0 0\n' > claims.ac
refuses claims.ac 'cannot read claims.ac'
printf 'OFF\n4000000000 4000000000 0\n0 0 0\n' > claims.off
refuses claims.off 'cannot read claims.off'

# gltf NAME NODES ACCESSOR_COUNT: a triangle whose parts can be told wrong things
gltf() {
    cat > "$1" << END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": $2,
 "meshes": [{"name": "tri", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": $3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]},
               {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                 {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
 "buffers": [{"byteLength": 42, "uri": "data:application/octet-stream;base64,$triangle"}]}
END
}
triangle=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA
gltf good.gltf '[{"mesh": 0}]' 3
try good.gltf
[ $code = 0 ] || fail "the good triangle: $(cat stderr)"
gltf count.gltf '[{"mesh": 0}]' 4000000000
try count.gltf
[ $code = 1 ] || fail "an accessor of 48 GB: exit code $code"
gltf self.gltf '[{"mesh": 0, "children": [0]}]' 3
refuses self.gltf 'cannot read self.gltf'
gltf ring.gltf '[{"mesh": 0, "children": [1]}, {"children": [2]}, {"children": [1]}]' 3
try ring.gltf
[ $code = 0 ] || [ $code = 1 ] || fail "a ring of nodes: exit code $code"
gltf mesh.gltf '[{"mesh": 7}]' 3
try mesh.gltf
[ $code = 1 ] || fail "a node of no mesh: exit code $code"
gltf flat.gltf '[{"mesh": 0, "scale": [0, 0, 0]}]' 3
try flat.gltf
[ $code = 0 ] || fail "a node that flattens: $(cat stderr)"
gltf huge.gltf '[{"mesh": 0, "scale": [1e30, 1e30, 1e30]}]' 3
refuses huge.gltf 'no node shows its meshes with a finite transform'

# ---- of the package ------------------------------------------------------------------------------

if [ -d $models/glTF2 ]; then
    cd $models/glTF2 || exit 1
    refuses BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb \
        '12 of 12 triangles skipped: a vertex is not finite'
    warns IndexOutOfRange/IndexOutOfRange.gltf 11 'an index is out of range'
    refuses IndexOutOfRange/AllIndicesOutOfRange.gltf '12 of 12 triangles skipped: an index is out of range'
    refuses RecursiveNodes/RecursiveNodes.gltf 'is twice in the scene'
    warns BoxBadNormals-glTF-Binary/BoxBadNormals.glb 12 'normals regenerated'
    if [ "${config:-}" != sanitize ]; then # there it takes a minute
        refuses ../invalid/OutOfMemory.off 'cannot read'
    fi
else
    echo "assimp-testmodels is not installed: only the models made here were tried"
fi

[ $failures = 0 ] && echo "hostile models: all as expected"
[ $failures = 0 ]
