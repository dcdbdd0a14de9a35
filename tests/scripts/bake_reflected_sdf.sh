#!/bin/bash
# Reflections of an SDF from a scene's text to the plan: the code is in the blob where it is asked for; the least
# roughness of what its materials say decides whether anything is traced.
set -u
cd "$(dirname "$0")/../.." || exit 1
bin=${BUILD:-build}/bin
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
export MASU_SPIRV_QUICK=1 # nothing is drawn here

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# bake MATERIAL [MEMBERS]: a ball of that material
bake() {
    printf 'param p = 0.9 [0, 1];\nmaterial unused { roughness 0 }\nmaterial m { %s }\npart a : m = sphere(1);\n' "$1" > "$folder/s.sdf"
    printf '{"sdf": {"source": "s.sdf", "bounds": [[-1,-1,-1],[1,1,1]]}%s}' "${2-, \"reflections\": {\}}" > "$folder/s.json"
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" --stats "$folder/stats" --quiet 2> "$folder/err" ||
        fail "$1: $(cat "$folder/err")"
    [ ! -s "$folder/err" ] || fail "$1: $(cat "$folder/err")"
}

# glossiest VALUE MATERIAL: what the blob says
glossiest() {
    bake "$2"
    # The section: cutoff, distance, then the least roughness (src/scene/blob.h). 0.5 and 10000 as floats begin it.
    found=$(od -An -v -tx1 "$folder/s.masu" | tr -d ' \n' | sed -n 's/.*0000003f00401c46\(........\).*/\1/p')
    [ "$found" = "$1" ] || fail "$2: the least roughness is $found, not $1"
}

# Which materials count how: test_sdfc.c.
glossiest 00000000 'roughness p'
glossiest cdcc4c3e 'roughness 0.2'
grep -A1 '"specular_trace_sdf_spirv"' "$folder/stats" | grep -q '"count": [1-9]' || fail "no code"
bake 'roughness 0.2' ''
grep -A1 '"specular_trace_sdf_spirv"' "$folder/stats" | grep -q '"count": [1-9]' && fail "code that nobody asked for"

# A model beside it of which none is traced is worth a word.
printf '{"models": [{"mesh": {"box": {}}, "traced": false}], "sdf": {"source": "s.sdf", "bounds": [[-1,-1,-1],[1,1,1]]}, "reflections": {}}' > "$folder/s.json"
"$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" --quiet 2> "$folder/err" || fail "a box beside it"
grep -q 'no instance is traced' "$folder/err" || fail "no word about the box"

[ "$failures" = 0 ] || exit 1
