#!/bin/bash
# masu-sdfc from outside: exit codes, messages, the three outputs; every .sdf of scenes/ compiles, and
# masu-bake takes a .sdf where it takes GLSL.
set -u
cd "$(dirname "$0")/../.." || exit 1
sdfc=$(realpath "${BUILD:-build}/bin/masu-sdfc")
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
export MASU_SPIRV_QUICK=1 # nothing is drawn here

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# run COMMAND...: its exit code in $code, its streams in stdout and stderr
run() {
    "$@" > "$folder/stdout" 2> "$folder/stderr"
    code=$?
}

# expect CODE PATTERN COMMAND...: that exit code, and the pattern on stderr
expect() {
    local wanted=$1 pattern=$2
    shift 2
    run "$@"
    [ $code = "$wanted" ] || fail "$*: exit code $code, not $wanted: $(cat "$folder/stderr")"
    grep -q -e "$pattern" "$folder/stderr" || fail "$*: \"$pattern\" is not in: $(cat "$folder/stderr")"
}

good=$folder/good.sdf
printf 'param r = 1 [0.5, 2];\npart a = sphere(r);\n' > "$good"
printf 'part a = sphere(1);\npart b = shpere(1);\n' > "$folder/bad.sdf"

expect 2 'no IN.sdf given' "$sdfc"
expect 2 'more than one input' "$sdfc" a b
expect 1 'none.sdf: cannot open: No such file' "$sdfc" "$folder/none.sdf"
expect 1 'bad.sdf:2:10: expected a shape, found "shpere"' "$sdfc" "$folder/bad.sdf"
[ "$(sed -n 2,3p "$folder/stderr")" = "masu-sdfc: part b = shpere(1);
masu-sdfc:          ^" ] || fail "the line and its caret: $(cat "$folder/stderr")"
expect 1 'cannot write' "$sdfc" "$good" --glsl "$folder/none/x"
run "$sdfc" "$good" --glsl "$folder/x.glsl" --c "$folder/x.c" --table "$folder/x.json"
[ $code = 0 ] || fail "good.sdf: $(cat "$folder/stderr")"
grep -q 'float masu_sdf_part(uint part, vec3 p)' "$folder/x.glsl" || fail "no masu_sdf_part"
grep -q 'double masu_truth_distance(' "$folder/x.c" || fail "no masu_truth_distance"
grep -q '"name": "a", "shape": 0, "slot": 16, "slots": 1, "material": 0, "lipschitz": 1,' \
    "$folder/x.json" || fail "table: $(cat "$folder/x.json")"
[ "$(cat "$folder/stdout")" = \
    "$good: 1 parts of 1 forms, 23 slots (some change), $(wc -c < "$folder/x.glsl") bytes of GLSL" ] ||
    fail "summary: $(cat "$folder/stdout")"

for scene in scenes/*.sdf; do
    run "$sdfc" "$scene"
    [ $code = 0 ] || fail "$scene: $(cat "$folder/stderr")"
done

# With anchors the fields are the same ones, around the origin; a literal place becomes a slot.
run "$sdfc" tests/unit/features.sdf --anchored
[ $code = 0 ] || fail "features.sdf, anchored: $(cat "$folder/stderr")"
printf 'part a = translate((1000000.3, 0, 0), sphere(1));\n' > "$folder/far.sdf"
run "$sdfc" "$folder/far.sdf" --glsl "$folder/near.glsl"
run "$sdfc" "$folder/far.sdf" --anchored --glsl "$folder/far.glsl" --c "$folder/far.c"
grep -q 'masu_anchor' "$folder/near.glsl" && fail "anchors that nobody asked for"
grep -q '#define MASU_SDF_PLACES 6' "$folder/far.glsl" || fail "the places are not data"
grep -q '1000000.3125, (-0.01249999' "$folder/far.c" ||
    fail "the place is not kept in two floats: $(grep 1000000 "$folder/far.c")"
printf 'part a = translate((1000000.3 + sin(time), 0, 0), sphere(1));\n' > "$folder/moves.sdf"
run "$sdfc" "$folder/moves.sdf" --anchored --glsl "$folder/moves.glsl"
grep -q 'masu_wide_add(vec2(1000000.31, (-0.0125)), vec2(e[0-9]*, 0.0))' "$folder/moves.glsl" ||
    fail "1000000.3 + sin(time) is not a sum of two floats: $(grep wide "$folder/moves.glsl")"
grep -q 'MASU_SDF_DYNAMIC 0' "$folder/far.glsl" || fail "an anchor is no time"
grep -q 'masu_anchor' "$folder/far.c" && fail "the truth needs no anchor"

# json SOURCE MORE: the scene's JSON
json() {
    echo "{\"sdf\": {\"source\": \"$1\", \"bounds\": [[-2, -2, -2], [2, 2, 2]] $2}}" > "$folder/s.json"
}
json good.sdf ''
run "$bake" "$folder/s.json" --bare -o "$folder/s.masu" --stats "$folder/stats.json"
[ $code = 0 ] || fail "baking good.sdf: $(cat "$folder/stderr")"
tr -d ' \n' < "$folder/stats.json" | grep -q '"sdf_params":{"count":1' || fail "no parameter in the blob"
json bad.sdf ''
expect 1 '^masu-bake: .*bad.sdf:2:10: expected a shape' "$bake" "$folder/s.json" -o "$folder/t.masu"
[ ! -e "$folder/t.masu" ] || fail "bad.sdf was baked"
json good.sdf ', "anchored": 1'
expect 1 'anchored: expected true or false' "$bake" "$folder/s.json" -o "$folder/t.masu"
printf 'float masu_sdf(vec3 p) { return length(p) - 1.0; }\nvoid masu_sdf_surface(vec3 p, inout masu_surface s) {}\n' > "$folder/hand.glsl"
json hand.glsl ', "anchored": true'
expect 1 'only a .sdf file can be "anchored"' "$bake" "$folder/s.json" -o "$folder/t.masu"
json good.sdf ', "params": [{"name": "r", "value": 1}]'
expect 1 'a .sdf file declares its own parameters' "$bake" "$folder/s.json" -o "$folder/t.masu"

# ---- what comes from data is no index until it is clamped ------------------------------------------------

# unclamped FILE: places where a slot becomes an index as it is. In the names base and first it may stand, of which
# every use is clamped, and in the forms, which are compared.
unclamped() {
    grep -n 'uint(masu_slot(' "$1" | grep -v -e 'min(uint(masu_slot(' -e '^[0-9]*:    uint \(base\|first\|form\) = ' \
        -e 'switch (uint(masu_slot('
    grep -n -e '\(case .*\|return \)masu_shape_[0-9]*(.*z, base,' -e '= first' "$1" # but for what follows a clamp of its own
}
printf 'a\n    uint material = uint(masu_slot(part * 8u + 7u));\n' > "$folder/bare.glsl"
[ "$(unclamped "$folder/bare.glsl" | wc -l)" = 1 ] || fail "an index that is not clamped is not found"
for file in scenes/*.sdf tests/scenes/*.sdf "$folder/far.sdf"; do
    "$sdfc" "$file" --glsl "$folder/x.glsl" --quiet 2> /dev/null || continue
    found=$(unclamped "$folder/x.glsl")
    [ -z "$found" ] || fail "$file: $found"
    grep -q 'min(uint(masu_slot(' "$folder/x.glsl" || fail "$file: nothing is clamped"
done

[ $failures = 0 ]
