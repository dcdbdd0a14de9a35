#!/bin/bash
# masu-meso from outside: exit codes, messages, what it writes, and that masu-bake takes it.
set -u
cd "$(dirname "$0")/../.." || exit 1
meso=$(realpath "${BUILD:-build}/bin/masu-meso")
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# expect CODE PATTERN COMMAND...: that exit code, and the pattern on stderr
expect() {
    local wanted=$1 pattern=$2
    shift 2
    "$@" > "$folder/stdout" 2> "$folder/stderr"
    code=$?
    [ $code = "$wanted" ] || fail "$*: exit code $code, not $wanted: $(cat "$folder/stderr")"
    [ -z "$pattern" ] || grep -q -e "$pattern" "$folder/stderr" || fail "$*: \"$pattern\" is not in: $(cat "$folder/stderr")"
}

small="--size 32 --rays 8 --sky-rays 2"

# ---- Wrong command lines and bad files ----

expect 2 'no relief given' "$meso" -o "$folder/x"
expect 2 'no output given' "$meso" --make grass
expect 2 'not both' "$meso" a.obj --make grass -o "$folder/x"
expect 2 'more than one input' "$meso" a.obj b.obj -o "$folder/x"
expect 2 '"sand"' "$meso" --make sand -o "$folder/x"
expect 2 'needs --height' "$meso" a.png -o "$folder/x"
expect 2 'power of two, found 48' "$meso" --make grass --size 48 -o "$folder/x"
expect 1 'cannot open: No such file' "$meso" "$folder/none.png" --height 0.1 -o "$folder/x"
expect 1 'cannot read .*none.obj: No such file' "$meso" "$folder/none.obj" -o "$folder/x"
printf 'no picture' > "$folder/bad.png"
expect 1 'bad.png: is not a PNG file' "$meso" "$folder/bad.png" --height 0.1 -o "$folder/x"
printf '\x89PNG\r\n\x1a\n' > "$folder/cut.png"
expect 1 'cut.png: the PNG file is truncated' "$meso" "$folder/cut.png" --height 0.1 -o "$folder/x"
# What a decoder would trip over does not reach it: a byte that the checksum does not know, a part of a file, a size
# that is told by the header alone.
picture=tests/fuzz/corpus/png/one_bit.png
{ head -c 45 "$picture"; printf 'x'; tail -c +47 "$picture"; } > "$folder/changed.png"
expect 1 'changed.png: the PNG file is damaged' "$meso" "$folder/changed.png" --height 0.1 -o "$folder/x"
head -c 60 "$picture" > "$folder/part.png"
expect 1 'part.png: the PNG file is truncated' "$meso" "$folder/part.png" --height 0.1 -o "$folder/x"
printf '\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xff\xff\0\0\xff\xff\x08\0\0\0\0\x93\x6e\x86\x8c' > "$folder/large.png"
expect 1 'large.png: 65535x65535 is larger than 16384' "$meso" "$folder/large.png" --height 0.1 -o "$folder/x"
printf 'v 0 0 0\n' > "$folder/empty.obj"
expect 1 'empty.obj' "$meso" "$folder/empty.obj" -o "$folder/x"
printf 'v 0 0 0\nv 1 9 0\nv 0 0 1\nf 1 2 3\n' > "$folder/high.obj"
expect 1 'at most 2 periods high' "$meso" "$folder/high.obj" -o "$folder/x"
# A tower of a period that nothing closes below: no crash, no endless loop.
printf 'v 0.2 1 0.2\nv 1.2 1 0.2\nv 0.2 1.5 1.2\nf 1 2 3\n' > "$folder/holes.obj"
# shellcheck disable=SC2086
expect 0 '' "$meso" "$folder/holes.obj" -o "$folder/holes" $small
# shellcheck disable=SC2086
expect 1 'none/x' "$meso" --make grass -o "$folder/none/x" $small

# ---- What it writes ----

# shellcheck disable=SC2086
expect 0 '' "$meso" --make grass --detail 1 -o "$folder/g r" $small
grep -q 'error of the fit' "$folder/stdout" || fail "no error: $(cat "$folder/stdout")"
for file in .json _color.png _normal.png _rough.png _ao.png; do
    [ -s "$folder/g r$file" ] || fail "no file g r$file"
done
cp "$folder/g r.json" "$folder/first.json"
# shellcheck disable=SC2086
expect 0 '' "$meso" --make grass --detail 1 -o "$folder/g r" $small --quiet
cmp -s "$folder/g r.json" "$folder/first.json" || fail "two runs give two results"
[ -s "$folder/stdout" ] && fail "--quiet prints"

# Heights: the map that was just made will do as well as any.
# shellcheck disable=SC2086
expect 0 '' "$meso" "$folder/g r_ao.png" --height 0.05 --albedo 0.3 --roughness 0.6 -o "$folder/h" $small
grep -q '"facet_roughness": 0.6' "$folder/h.json" || fail "roughness: $(cat "$folder/h.json")"

# ---- masu-bake takes the curves, in place and as a file, and says what is wrong with others ----

scene() {
    printf '{"models": [{"mesh": {"plane": {"size_x": 4, "size_z": 4, "tile": 1}}, "material": {%s}}]}' "$1" \
        > "$folder/scene.json"
}
maps='"base_color_map": "g r_color.png", "normal_map": "g r_normal.png", "roughness_map": "g r_rough.png", "occlusion_map": "g r_ao.png"'
scene "$maps, \"meso\": \"g r.json\""
expect 0 '' "$bake" "$folder/scene.json" --bare -o "$folder/a.masu" --quiet
scene "$maps, \"meso\": $(cat "$folder/g r.json")"
expect 0 '' "$bake" "$folder/scene.json" --bare -o "$folder/b.masu" --quiet
cmp -s "$folder/a.masu" "$folder/b.masu" || fail "a file and its text give two scenes"
scene "$maps"
expect 0 '' "$bake" "$folder/scene.json" --bare -o "$folder/c.masu" --quiet
cmp -s "$folder/a.masu" "$folder/c.masu" && fail "the curves are not in the scene"
scene '"meso": "none.json"'
expect 1 'none.json' "$bake" "$folder/scene.json" --bare -o "$folder/d.masu"
scene '"meso": {"tilt": [0, 0, 0]}'
expect 1 'needs "rough"' "$bake" "$folder/scene.json" --bare -o "$folder/d.masu"
scene "\"meso\": $(sed 's/"alpha": [^,]*/"alpha": 9/' "$folder/g r.json")"
expect 1 'alpha' "$bake" "$folder/scene.json" --bare -o "$folder/d.masu"

[ $failures = 0 ] || exit 1
