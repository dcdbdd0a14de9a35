#!/bin/bash
# Trees for rays, from the file to the blob: what is traced and what is not. That a tree is one is checked by
# masu_scene_bind, which masu-bake asks itself.
set -u
cd "$(dirname "$0")/../.." || exit 1
bin=${BUILD:-build}/bin
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# bakes TEXT: meshes, instances, triangles in $meshes, $instances, $triangles
bakes() {
    printf '%s' "$1" > "$folder/s.json"
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" --stats "$folder/s.stats" --quiet \
        2> "$folder/err" || fail "$1: is refused: $(cat "$folder/err")"
    for name in meshes instances triangles nodes depth; do
        value=$(sed -n '/"reflections"/,/}/s/.*"'$name'": \([0-9]*\).*/\1/p' "$folder/s.stats")
        printf -v "$name" '%s' "$value"
    done
}

# has MESHES INSTANCES TRIANGLES MODELS REFLECTIONS
has() {
    bakes "{\"models\": [$4]$5}"
    [ "$meshes $instances $triangles" = "$1 $2 $3" ] ||
        fail "$4 $5: $meshes meshes, $instances instances, $triangles triangles; not $1 $2 $3"
}

# refuses PATTERN TEXT
refuses() {
    printf '%s' "$2" > "$folder/s.json"
    if "$bin/masu-bake" "$folder/s.json" -o "$folder/s.masu" 2> "$folder/err"; then
        fail "$2: is accepted"
    fi
    grep -q -e "$1" "$folder/err" || fail "\"$1\" is not in: $(cat "$folder/err")"
}

box='"mesh": {"box": {}}'
ball='"mesh": {"sphere": {"subdivisions": 3}}'
has '' '' '' "{$box}" ''
has 1 1 12 "{$box}" ', "reflections": {}'
has 1 3 12 "{$box}, {$box, \"scale\": 2}, {$box, \"scale\": [1, -1, 1]}" ', "reflections": {}'
has 2 2 1292 "{$box}, {$ball}" ', "reflections": {}'
has 1 1 1280 "{$box, \"traced\": false}, {$ball}" ', "reflections": {}'
has 1 1 12 "{$box}, {$ball, \"scale\": 0.001}" ', "reflections": {"smallest": 0.1}'
has 2 2 1292 "{$box}, {$ball, \"scale\": 0.001, \"traced\": true}" ', "reflections": {"smallest": 0.1}'
has 2 2 1292 "{$box}, {$ball, \"scale\": 1e-4}" ', "reflections": {"smallest": 0}'
has 1 1 12 "{$box}, {$ball, \"scale\": 1e-4}" ', "reflections": {}'
has 1 1 12 "{$box}, {$ball, \"material\": {\"alpha\": \"blend\", \"opacity\": 0.5}}" ', "reflections": {}'
# Sorted by mesh, tags go along: the second ball is left out, and no other.
has 2 3 1292 "{$ball}, {$box}, {$ball, \"traced\": false}, {$box}" ', "reflections": {}'

bakes "{\"models\": [{$ball}], \"reflections\": {}}"
[ "$nodes" -ge 320 ] && [ "$nodes" -le 480 ] || fail "1280 triangles: $nodes nodes"
[ "$depth" -ge 5 ] && [ "$depth" -le 9 ] || fail "1280 triangles: depth $depth"
cp "$folder/s.masu" "$folder/t.masu"
bakes "{\"models\": [{$ball}], \"reflections\": {}}"
cmp -s "$folder/s.masu" "$folder/t.masu" || fail "the same scene gives other bytes"

bakes "{\"models\": [{$box, \"traced\": false}], \"reflections\": {}}"
grep -q "no instance is traced" "$folder/err" || fail "nothing is said of a scene without rays"
# Without --bare a scene has reflections, unless it says otherwise; and shadows and ambient occlusion.
for told in '' ', "reflections": true' ', "reflections": false'; do
    printf '{"models": [{%s}]%s}' "$box" "$told" > "$folder/s.json"
    "$bin/masu-bake" "$folder/s.json" -o "$folder/s.masu" --stats "$folder/s.stats" --quiet || fail "$told: is refused"
    grep -q '"triangles": 12' <(sed -n '/"reflections"/,/}/p' "$folder/s.stats")
    case $?$told in 0*false | 1 | 1*true) fail "reflections of a scene that says '$told'" ;; esac
done

refuses 'smalest: unknown key' "{\"models\": [{$box}], \"reflections\": {\"smalest\": 1}}"
refuses 'smallest' "{\"models\": [{$box}], \"reflections\": {\"smallest\": -1}}"
refuses 'reflections' "{\"models\": [{$box}], \"reflections\": 1}"
refuses 'traced' "{\"models\": [{$box, \"traced\": 1}], \"reflections\": {}}"

[ "$failures" = 0 ] || exit 1
