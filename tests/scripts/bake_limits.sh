#!/bin/bash
# masu-bake when something goes wrong on a large scale: limits of memory and time, kill -9, what a model names outside
# of its folder.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/tmp" "$folder/slow" "$folder/out" "$folder/model" "$folder/other"
export TMPDIR=$folder/tmp
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# nothing_left WHEN: no file of masu-bake's own
nothing_left() {
    local left
    left=$(ls -A "$TMPDIR"; find "$folder/out" -name '*.part')
    [ -z "$left" ] || fail "$1: leaves $left"
}

# says PATTERN WHEN: one line of the latest run's
says() {
    grep -q -e "^masu-bake: .*$1" "$folder/stderr" || fail "$2: no \"$1\": $(head -c 500 "$folder/stderr")"
}

# gone PID: within ten seconds
gone() {
    for _ in $(seq 100); do
        kill -0 "$1" 2> /dev/null || return 0
        sleep 0.1
    done
    return 1
}

# A shader compiler that does not come back, and says which process it is.
cat > "$folder/slow/glslangValidator" << 'END'
#!/bin/sh
echo $$ > "$TMPDIR/../tool.$1.new" && mv "$TMPDIR/../tool.$1.new" "$TMPDIR/../tool"
exec sleep 600
END
chmod +x "$folder/slow/glslangValidator"
cat > "$folder/field.glsl" << 'END'
float masu_sdf(vec3 p) { return length(p) - 1.0; }
void masu_sdf_surface(vec3 p, inout masu_surface s) { s.albedo = vec3(0.5); }
END
cat > "$folder/scene.json" << 'END'
{"sdf": {"source": "field.glsl", "bounds": [[-1, -1, -1], [1, 1, 1]]}}
END

# begin_slow: in the background; waits until the compiler runs; $parent and $tool are the processes
begin_slow() {
    rm -f "$folder/tool"
    PATH=$folder/slow:$PATH "$bake" "$folder/scene.json" --bare -o "$folder/out/x.masu" "$@" 2> "$folder/stderr" &
    parent=$!
    for _ in $(seq 300); do
        [ -s "$folder/tool" ] && break
        kill -0 $parent 2> /dev/null || { fail "the slow bake has ended: $(cat "$folder/stderr")"; break; }
        sleep 0.1
    done
    tool=$(cat "$folder/tool")
}

# ---- limits --------------------------------------------------------------------------------------

begin_slow --time-limit 1
wait $parent
code=$?
[ $code = 1 ] || fail "time: exit code $code"
says 'scene.json: took more than 1 seconds (--time-limit)' time
gone "$tool" || fail "time: the compiler runs on"
nothing_left time

if [ "${config:-}" != sanitize ]; then # whose shadow is address space
    env -u GLIBC_TUNABLES MASU_SPIRV_CACHE= "$bake" "$folder/scene.json" --bare -o "$folder/out/x.masu" --memory-limit 16 2> "$folder/stderr"
    code=$?
    [ $code = 1 ] || fail "memory: exit code $code"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "memory: not one line: $(cat "$folder/stderr")"
    nothing_left memory
fi
[ ! -e "$folder/out/x.masu" ] || fail "limits: there is output"
"$bake" "$folder/scene.json" --bare -o "$folder/out/x.masu" --memory-limit 0 --time-limit 0 --quiet 2> "$folder/stderr" ||
    fail "no limits: $(cat "$folder/stderr")"

# ---- signals -------------------------------------------------------------------------------------

for signal in TERM INT; do
    begin_slow
    kill -s $signal $parent
    wait $parent
    code=$?
    [ $code -gt 128 ] || fail "$signal: exit code $code"
    gone "$tool" || fail "$signal: the compiler runs on"
    nothing_left $signal
done

# What is killed cannot clean up; the next one does, but not what another that runs is at.
begin_slow
dead=$(ls "$TMPDIR")
[ "$dead" ] || fail "kill -9: there was nothing to leave"
kill -9 $parent
wait $parent 2> /dev/null
gone "$tool" || fail "kill -9: the compiler runs on"
begin_slow
running=$(ls "$TMPDIR")
[ "$(wc -w <<< "$running")" = 1 ] && [ "$running" != "$dead" ] || fail "kill -9: beside the running one there is $running"
"$bake" "$folder/scene.json" --bare -o "$folder/out/x.masu" --quiet 2> "$folder/stderr" || fail "beside: $(cat "$folder/stderr")"
[ "$(ls "$TMPDIR")" = "$running" ] || fail "beside: $running is not what is left: $(ls "$TMPDIR")"
kill $parent
wait $parent
nothing_left "beside"

# ---- what a model names --------------------------------------------------------------------------

# bakes ARGUMENT...: the model
bakes() { "$bake" "$@" -o "$folder/out/x.masu" --bare --quiet > "$folder/stdout" 2> "$folder/stderr"; }

cd "$folder/model" || exit 1
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' > ../other/xyz.bin
cp ../other/xyz.bin here.bin
ln -s ../other/xyz.bin link.bin
# gltf URI NAME: a triangle whose buffer is there
gltf() {
    cat > "$2" << END
{"asset": {"version": "2.0"}, "buffers": [{"uri": "$1", "byteLength": 36}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}
END
}
gltf here.bin a.gltf
bakes a.gltf || fail "a buffer beside: $(cat "$folder/stderr")"
bakes "$folder/model/../model/a.gltf" || fail "by another way: $(cat "$folder/stderr")"
for uri in ../other/xyz.bin "$folder/other/xyz.bin" link.bin %2e%2e/other/xyz.bin; do
    gltf "$uri" a.gltf
    bakes a.gltf && fail "$uri: read"
    says "is outside of the model's folder" "$uri"
    bakes a.gltf --texture-path "$folder/slow:$folder/other" || fail "$uri, named: $(cat "$folder/stderr")"
done

printf 'newmtl red\nKd 1 0 0\n' > ../other/x.mtl
printf 'mtllib ../other/x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n' > a.obj
bakes a.obj || fail "a.obj: $(cat "$folder/stderr")"
says "x.mtl is outside of the model's folder: ignored" a.obj
mv "$folder/out/x.masu" "$folder/out/plain.masu"
bakes a.obj --texture-path "$folder/other" || fail "a.obj, named: $(cat "$folder/stderr")"
! cmp -s "$folder/out/x.masu" "$folder/out/plain.masu" || fail "a.obj: its colour is the same with its materials and without"

printf 'P6 1 1 255\nabc' > ../other/pic.ppm
cp ../other/pic.ppm pic.ppm
# obj PICTURE
obj() {
    printf 'newmtl red\nKd 1 1 1\nmap_Kd %s\n' "$1" > b.mtl
    printf 'mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n' > b.obj
}
obj pic.ppm
bakes b.obj || fail "b.obj: $(cat "$folder/stderr")"
[ ! -s "$folder/stderr" ] || fail "b.obj: $(cat "$folder/stderr")"
rm pic.ppm
obj ../other/pic.ppm
bakes b.obj || fail "b.obj: $(cat "$folder/stderr")"
says "pic.ppm: is outside of its model's folder" b.obj
bakes b.obj --texture-path "$folder/other" || fail "b.obj, named: $(cat "$folder/stderr")"
[ ! -s "$folder/stderr" ] || fail "b.obj, named: $(cat "$folder/stderr")"

# ---- names ---------------------------------------------------------------------------------------

gltf here.bin a.gltf
long=$(printf 'n%.0s' $(seq 300))
sed -i "s/{\"mesh\": 0}/{\"mesh\": 0, \"name\": \"$long\"}/" a.gltf
bakes a.gltf || fail "a long name: $(cat "$folder/stderr")"
says '1 names are longer than 255 bytes, and cut' 'a long name'
cut=$(grep -ao 'nnnn*' "$folder/out/x.masu" | head -1)
[ ${#cut} = 255 ] || fail "a long name has ${#cut} bytes left"

[ $failures = 0 ] && echo "masu-bake: limits, signals and folders as expected"
[ $failures = 0 ]
