#!/bin/bash
# masu-bake with many models in one scene: equal meshes are shared, groups are named in the blob, and errors in "lods",
# "occluders", "merge" and "group" are one line.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
count_of() { sed -n "/\"$2\": {/,/}/s/.*\"count\": \([0-9]*\).*/\1/p" "$1" | head -1; }

# refuses CODE PATTERN COMMAND...: one line on stderr
refuses() {
    local wanted=$1 pattern=$2 code
    shift 2
    "$@" > /dev/null 2> "$folder/stderr"
    code=$?
    [ $code = "$wanted" ] || fail "$*: exit code $code: $(cat "$folder/stderr")"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "$*: not one line: $(cat "$folder/stderr")"
    grep -q -e "$pattern" "$folder/stderr" || fail "\"$pattern\" is not in: $(cat "$folder/stderr")"
}

scene() {
    printf '%s\n' "$1" > "$folder/s.json"
    refuses 1 "$2" "$bake" "$folder/s.json" -o "$folder/x.masu"
}
ball='{"mesh": {"sphere": {"subdivisions": 3}}'
scene "{\"models\": [$ball}], \"lods\": 4}" ': lods: expected a number from 0 to 3'
scene "{\"models\": [$ball}], \"lods\": 1.5}" 'lods must be a whole number'
scene "{\"models\": [$ball}], \"occluders\": -1}" ': occluders: expected a number from 0'
scene "{\"models\": [$ball, \"merge\": 10}]}" '"merge" needs "file"'
scene "{\"models\": [$ball, \"group\": 3}]}" ': models\[0\].group: expected a string'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' > "$folder/t.obj"
scene '{"models": [{"file": "t.obj", "merge": 0}]}' ': models\[0\].merge: expected a number'
scene '{"models": [{"file": "t.obj", "merge": 1, "occluder": true}]}' '"merge" and "occluder" cannot be combined'

# One placed twice with each of two colours, and a shape twice: three meshes in all.
cat > "$folder/s.json" << 'END'
{"models": [{"file": "t.obj", "group": "a/b"}, {"file": "t.obj", "material": {"roughness": 0.1}},
            {"file": "t.obj", "translate": [2, 0, 0], "group": "a/c"},
            {"file": "t.obj", "translate": [4, 0, 0], "material": {"roughness": 0.1}},
            {"mesh": {"box": {}}}, {"mesh": {"box": {}}, "translate": [0, 4, 0]}]}
END
"$bake" "$folder/s.json" --bare -o "$folder/x.masu" --stats "$folder/x.stats" --quiet || fail "shared meshes"
[ "$(count_of "$folder/x.stats" meshes)" = 3 ] || fail "meshes are not shared: $(cat "$folder/x.stats")"
[ "$(count_of "$folder/x.stats" instances)" = 6 ] || fail "instances"
[ "$(count_of "$folder/x.stats" indices)" = 60 ] || fail "indices are not shared"
grep -aq 'a/c' "$folder/x.masu" || fail "the group's name is not in the blob"

[ $failures = 0 ]
