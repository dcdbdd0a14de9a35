#!/bin/bash
# Groups of a scene, from the file to the tree in the blob. That the tree is one, holds each instance
# once and has boxes that hold them is checked by masu_scene_bind, which masu-bake asks itself.
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

# model EXTRA: a member of "models"
model() { printf '{"mesh": {"box": {}}%s}' "$1"; }

# bakes MODELS: groups and items in $groups and $items
bakes() {
    printf '{"models": [%s]}' "$1" > "$folder/s.json"
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" --stats "$folder/s.stats" --quiet \
        2> "$folder/err" || fail "$1: is refused: $(cat "$folder/err")"
    groups=$(sed -n '/"groups"/,/}/s/.*"count": \([0-9]*\).*/\1/p' "$folder/s.stats")
    items=$(sed -n '/"group_items"/,/}/s/.*"count": \([0-9]*\).*/\1/p' "$folder/s.stats")
}

# has GROUPS ITEMS MODELS
has() {
    bakes "$3"
    [ "$groups $items" = "$1 $2" ] || fail "$3: $groups groups, $items items; not $1, $2"
}

# refuses PATTERN MODELS
refuses() {
    printf '{"models": [%s]}' "$2" > "$folder/s.json"
    if "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" 2> "$folder/err"; then
        fail "$2: is accepted"
    fi
    grep -q -e "$1" "$folder/err" || fail "\"$1\" is not in: $(cat "$folder/err")"
}

has 1 1 "$(model '')"
has 1 2 "$(model ''), $(model '')"
has 0 0 "$(model ', "moving": true')"
has 1 1 "$(model ', "moving": true'), $(model '')"
has 2 1 "$(model ', "group": "a"')"
has 2 2 "$(model ', "group": "a"'), $(model ', "group": "a"')"
has 3 2 "$(model ', "group": "a"'), $(model ', "group": "b"')"
has 4 3 "$(model ', "group": "a/b/c"'), $(model ', "group": "a/b"'), $(model '')"
has 9 1 "$(model ', "group": "1/2/3/4/5/6/7/8"')"
has 1 1 "$(model ''), $(model ', "moving": true, "name": "x"')"

many=$(model '')
for ((i = 0; i < 99; i++)); do many="$many, $(model ", \"translate\": [$((i * i % 37)), 0, $i]")"; done
bakes "$many"
[ "$items" = 100 ] || fail "a hundred boxes: $items items"
[ "$groups" -ge 13 ] && [ "$groups" -le 40 ] || fail "a hundred boxes: $groups groups"
# All in one place: no split is better than another.
many=$(model '')
for ((i = 0; i < 99; i++)); do many="$many, $(model '')"; done
bakes "$many"
[ "$items" = 100 ] || fail "a hundred times the same box: $items items"
# In a named group, and beside it.
bakes "$(sed 's/{}}/{}}, "group": "g"/g' <<< "$many"), $(model '')"
[ "$items" = 101 ] || fail "a hundred boxes in a group: $items items"

refuses 'group: expected 1 to 8 names' "$(model ', "group": ""')"
refuses 'group: expected 1 to 8 names' "$(model ', "group": "/a"')"
refuses 'group: expected 1 to 8 names' "$(model ', "group": "a/"')"
refuses 'group: expected 1 to 8 names' "$(model ', "group": "a//b"')"
refuses 'group: expected 1 to 8 names' "$(model ', "group": "1/2/3/4/5/6/7/8/9"')"
refuses 'a "moving" model cannot have a "group"' "$(model ', "group": "a", "moving": true')"
refuses 'models\[0\].moving' "$(model ', "moving": 1')"
refuses 'models\[0\].group' "$(model ', "group": 3')"

# occluders COUNT MODELS
occluders() {
    bakes "$2"
    count=$(sed -n '/"occluders"/,/}/s/.*"count": \([0-9]*\).*/\1/p' "$folder/s.stats")
    [ "$count" = "$1" ] || fail "$2: $count occluders, not $1"
}
occluders 0 "$(model '')"
occluders 0 "$(model ', "occluder": false')"
occluders 1 "$(model ', "occluder": true')"
occluders 1 "$(model ', "occluder": [[-9, 0, -9], [9, 0.25, 9]]')" # cut to the mesh
occluders 0 "$(model ', "occluder": [[2, 0, 0], [3, 1, 1]]')" # nothing is left
occluders 1 "$(model ', "occluder": true'), $(model ', "occluder": true')" # one mesh
occluders 2 "$(model ', "occluder": true'), {\"mesh\": {\"box\": {\"size\": [2, 1, 1]}}, \"occluder\": true}"
block='{"file": "'$PWD'/scenes/block.obj", "occluder": [[-0.5, 0, -0.5], [0.5, 1, 0.5]]}'
occluders 1 "$block, $block" # one mesh
# What one can look through hides nothing, and a warning says so, once for each mesh.
leaf='"base_color_map": "'$(realpath "${MADE:-build}")'/textures/leaf.tga"'
seen_through() { # COUNT MODELS: so many warnings, no occluders
    occluders 0 "$2"
    [ "$(grep -c 'warning: the mesh .* is alpha-tested, transparent or inside out: it cannot be an occluder' "$folder/err")" = "$1" ] ||
        fail "$2: not $1 warnings: $(cat "$folder/err")"
}
seen_through 1 "$(model ", \"occluder\": true, \"material\": {$leaf}")"
seen_through 1 "$(model ", \"occluder\": true, \"material\": {$leaf, \"alpha\": \"blend\"}")"
seen_through 1 "${block%\}}, \"material\": {$leaf}}"
occluders 1 "$(model ", \"occluder\": true, \"material\": {$leaf, \"alpha\": \"opaque\"}")"
refuses 'occluder: the mesh ".*" is not a box: give two corners' \
    '{"mesh": {"sphere": {}}, "occluder": true}'
refuses 'occluder: the mesh ".*" is not a box' '{"mesh": {"plane": {}}, "occluder": true}'
refuses 'occluder: the mesh ".*" is not a box' "${block//\[\[*\]\]/true}"
refuses 'occluder: expected true or two corners' "$(model ', "occluder": [[0, 0, 0], [1, 0, 1]]')"
refuses 'occluder' "$(model ', "occluder": 7')"
refuses 'occluder' "$(model ', "occluder": [[0, 0, 0]]')"

[ $failures = 0 ] && echo "groups: all as expected"
[ $failures = 0 ]
