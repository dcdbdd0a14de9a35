#!/bin/bash
# Lights of a scene, from the file to the blob's section: of the scene's own text and of a glTF model.
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

# bakes MODELS LIGHTS [MEMBERS]
bakes() {
    printf '{"models": [%s], "lights": [%s]%s}' "$1" "$2" "${3:-}" > "$folder/s.json"
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" --stats "$folder/s.stats" --quiet \
        2> "$folder/err" || fail "$2: is refused: $(cat "$folder/err")"
}

# word OFFSET BYTES FORMAT: one number of the blob
word() { od -An -v -j "$1" -N "$2" -t "$3" "$folder/s.masu" | tr -s ' \n' ' '; }

# section KIND: its first byte and the bytes of an element, in $section and $stride
section() {
    local row count at=64
    count=$(word 24 4 u4)
    section=0
    for ((row = 0; row < count; row++, at += 24)); do
        [ "$(word $at 4 u4)" = " $1 " ] && section=$(word $((at + 8)) 8 u8) && stride=$(word $((at + 4)) 4 u4)
    done
}

# sun_is NUMBERS: direction and colour of the environment
sun_is() {
    local found
    section 8
    found=$({ od -An -v -w4 -j $((section)) -N 12 -t f4 "$folder/s.masu"
        od -An -v -w4 -j $((section + 16)) -N 12 -t f4 "$folder/s.masu"; } | awk '{ printf "%s%.4g", n++ ? " " : "", ($1 * $1 < 1e-12 ? 0 : $1) }')
    [ "$found" = "$1" ] || fail "the sun is $found, not $1"
}

# The numbers of light N: 3 position, range, 3 colour, radius, 3 direction; type; inner, outer; parent
light() {
    local at
    section 35
    [ "$section" != 0 ] || { echo none; return; }
    at=$((section + stride * $1))
    floats=$(od -An -v -w4 -j $at -N 44 -t f4 "$folder/s.masu" | awk '{ printf "%.4g ", $1 }')
    echo "$floats|$(word $((at + 44)) 4 u4)|$(od -An -v -w4 -j $((at + 48)) -N 8 -t f4 "$folder/s.masu" |
        awk '{ printf "%.4g ", $1 }')|$(word $((at + 56)) 4 d4)"
}

# is N NUMBERS
is() {
    local found
    found=$(light "$1")
    [ "$found" = "$2" ] || fail "light $1 is $found, not $2"
}

# refuses PATTERN LIGHT
refuses() {
    printf '{"models": [%s], "lights": [%s]}' "$box" "$2" > "$folder/s.json"
    rm -f "$folder/s.masu"
    if "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" 2> "$folder/err"; then
        fail "$2: is accepted"
    fi
    [ "$(wc -l < "$folder/err")" = 1 ] || fail "$2: not one line: $(cat "$folder/err")"
    grep -q -e "$1" "$folder/err" || fail "\"$1\" is not in: $(cat "$folder/err")"
    [ ! -e "$folder/s.masu" ] || fail "$2: wrote its output"
}

box='{"mesh": {"box": {}}, "name": "car"}'
point='"type": "point", "position": [1, 2, 3]'

bakes "$box" ''
is 0 none
bakes "$box" "{$point}"
is 0 '1 2 3 10 1 1 1 0.01 0 0 0 | 0 |0 0 | -1 '
bakes "$box" "{$point, \"color\": [1, 0.5, 0], \"intensity\": 4, \"radius\": 0.2, \"range\": 7}"
is 0 '1 2 3 7 4 2 0 0.2 0 0 0 | 0 |0 0 | -1 '
bakes "$box" "{$point, \"intensity\": 4}, {\"type\": \"spot\", \"position\": [0, 0, 1],
    \"direction\": [0, 3, -4], \"outer\": 90, \"inner\": 45, \"instance\": \"car\", \"name\": \"lamp\"}"
is 0 '1 2 3 20 4 4 4 0.01 0 0 0 | 0 |0 0 | -1 '
is 1 '0 0 1 10 1 1 1 0.01 0 0.6 -0.8 | 1 |0.7854 1.571 | 0 '
grep -q -a lamp "$folder/s.masu" || fail "the name lamp is not in the blob"
# Instances are sorted by mesh: the light goes with its own.
bakes "{\"mesh\": {\"sphere\": {}}, \"name\": \"a\"}, $box, {\"mesh\": {\"sphere\": {}}, \"name\": \"b\"}" \
    "{$point, \"instance\": \"b\"}, {$point, \"instance\": \"car\"}"
is 0 '1 2 3 10 1 1 1 0.01 0 0 0 | 0 |0 0 | 1 '
is 1 '1 2 3 10 1 1 1 0.01 0 0 0 | 0 |0 0 | 2 '
bakes "$box" "{\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [0, 0, 1], \"outer\": 0, \"range\": 0}"
is 0 '0 0 0 0 1 1 1 0.01 0 0 1 | 1 |0 0 | -1 '

refuses 'lights\[0\]: expected "type": "point", "spot"' '{"position": [1, 2, 3]}'
refuses 'lights\[0\].type: expected "point", "spot", "sphere"' '{"type": "sun", "position": [1, 2, 3]}'
refuses 'lights\[1\]: needs "position"' "{$point}, {\"type\": \"point\"}"
refuses 'lights\[0\].colour: unknown key' "{$point, \"colour\": [1, 1, 1]}"
refuses 'color' "{$point, \"color\": [1, -1, 1]}"
refuses 'range: expected a number from 0' "{$point, \"range\": -1}"
refuses 'radius: expected a number from' "{$point, \"radius\": 0}"
refuses 'at most 1e+09' "{$point, \"color\": [1, 1, 1e6], \"intensity\": 1e6}"
refuses '"outer" is only allowed for spot lights' "{$point, \"outer\": 10}"
refuses 'a spot light needs a "direction"' '{"type": "spot", "position": [1, 2, 3]}'
refuses 'outer: expected a number from 0 to 180' \
    '{"type": "spot", "position": [1, 2, 3], "direction": [0, 1, 0], "outer": 181}'
refuses 'inner: expected a number from 0 to 30' \
    '{"type": "spot", "position": [1, 2, 3], "direction": [0, 1, 0], "outer": 30, "inner": 31}'
refuses 'instance: no instance is named "bus"' "{$point, \"instance\": \"bus\"}"
many="{$point}"
for ((i = 0; i < 12; i++)); do many="$many, $many"; done
bakes "$box" "$many"
refuses '4097 lights' "$many, {$point}"

# ---- Area lights ---------------------------------------------------------------------------------

rectangle='"type": "rectangle", "position": [1, 2, 3], "half_u": [0.6, 0, 0], "half_v": [0, 0.8, 0]'
bakes "$box" "{\"type\": \"sphere\", \"position\": [1, 2, 3], \"radius\": 0.5, \"intensity\": 4},
    {\"type\": \"capsule\", \"position\": [0, 0, 0], \"half_u\": [0, 2, 0], \"radius\": 0.1, \"range\": 20},
    {$rectangle}, {$rectangle, \"two_sided\": true, \"instance\": \"car\"}"
is 0 '1 2 3 60 4 4 4 0.5 0 0 0 | 2 |0 0 | -1 '
is 1 '0 0 0 20 1 1 1 0.1 0 2 0 | 3 |0 0 | -1 '
is 2 '1 2 3 46.91 1 1 1 0.01 0.6 0 0 | 4 |0 0 | -1 '
is 3 '1 2 3 46.91 1 1 1 0.01 0.6 0 0 | 516 |0 0 | 0 '
half_v() { section 35; od -An -v -w4 -j $((section + stride * $1 + 64)) -N 12 -t f4 "$folder/s.masu" | awk '{ printf "%.4g ", $1 }'; }
[ "$(half_v 2)" = '0 0.8 0 ' ] || fail "the rectangle's half_v is $(half_v 2)"
refuses '"range" is 5 m; expected at least 6 times' "{$rectangle, \"range\": 5}"
refuses '"radius" is only allowed for other lights than rectangles' "{$rectangle, \"radius\": 1}"
refuses '"half_u" is only allowed for capsules' "{$point, \"half_u\": [1, 0, 0]}"
refuses '"half_v" is only allowed for rectangles' '{"type": "capsule", "position": [0, 0, 0], "half_v": [1, 0, 0]}'
refuses '"two_sided" is only allowed for rectangles' "{$point, \"two_sided\": true}"
refuses 'needs "radius"' '{"type": "sphere", "position": [0, 0, 0]}'
refuses 'a half axis is not 1e-6 to 1e9 m long: 0' '{"type": "capsule", "position": [0, 0, 0], "radius": 1}'
refuses 'the sine of the angle between the half axes' \
    '{"type": "rectangle", "position": [0, 0, 0], "half_u": [1, 0, 0], "half_v": [2, 0, 0]}'

# ---- Emissive models -----------------------------------------------------------------------------

# glows MESH [MEMBERS]
glows() { echo "{\"mesh\": $1, \"material\": {\"base_color\": [0, 0, 0], \"emissive\": [4, 2, 1]}${2:-}}"; }

# Sheets shine both ways. The box has 2.1 m2 in all, which 2 m2 of the rectangle stand for; the post 0.82 m2, the
# capsule 4 pi r (r + half). Radiance keeps the flux.
bakes "$(glows '{"plane": {"size_x": 2, "size_z": 1}}' ', "translate": [5, 6, 7]')" ''
light 0 | grep -qE '^\S+ \S+ \S+ 95.75 4 2 1 1e-06 -?1 0 0 \| 1540 .*\| 0 $' || fail "a sheet is $(light 0)"
bakes "$(glows '{"box": {"size": [2, 0.02, 0.5]}}' ', "scale": 2')" ''
light 0 | awk '{ exit !($5 " " $6 " " $7 " " $8 == "4.2 2.1 1.05 0.01" && $9 * $9 == 1 && $10 * $10 + $11 * $11 < 1e-12 && $13 == 1540) }' ||
    fail "a flat box is $(light 0)"
bakes "$(glows '{"box": {"size": [0.1, 2, 0.1]}}')" ''
light 0 | awk '{ r = $8; h = $10 < 0 ? -$10 : $10; flux = $5 * 12.5664 * r * (r + h); exit !(flux > 3.26 && flux < 3.30 && r > 0.06 && r < 0.078 && h > 0.9 && $13 == 1027) }' ||
    fail "a post is $(light 0)"
# Turned in any way they have the same half axes in the space of their instance.
turned=('[0, 0, 0]' '[20, 35, 0]' '[20, 0, 50]' '[0, 35, 50]' '[20, 35, 50]' '[10, 10, 10]' '[80, 20, 33]' '[-45, 45, 45]')
boxes='' posts=''
for angles in "${turned[@]}"; do
    boxes+=${boxes:+, }$(glows '{"box": {"size": [2, 0.02, 0.5]}}' ", \"rotate\": $angles")
    posts+=${posts:+, }$(glows '{"box": {"size": [0.1, 2, 0.1]}}' ", \"rotate\": $angles")
done
bakes "$boxes" ''
for i in "${!turned[@]}"; do
    echo "$(light "$i") $(half_v "$i")" | awk '{ exit !($8 > 0.0099 && $8 < 0.0101 && $9 * $9 > 0.998 && $9 * $9 < 1.002 &&
        $10 * $10 + $11 * $11 < 1e-6 && $18 * $18 + $19 * $19 < 1e-6 && $20 * $20 > 0.0624 && $20 * $20 < 0.0626) }' ||
        fail "a flat box turned by ${turned[i]} is $(light "$i") $(half_v "$i")"
done
# A flat ellipsoid: half axes 1, 0.4 and 0.1. It has more edges than are tried, and none is along an axis.
awk -v n=24 -v m=12 'BEGIN {
    for (i = 0; i <= m; i++) for (k = 0; k < n; k++) { t = i * 3.14159265 / m; p = k * 6.2831853 / n
        printf "v %.6f %.6f %.6f\n", sin(t) * cos(p), 0.1 * cos(t), 0.4 * sin(t) * sin(p) }
    for (i = 0; i < m; i++) for (k = 1; k <= n; k++) { a = i * n + k; b = i * n + k % n + 1
        if (i > 0) print "f", a, b, a + n
        if (i < m - 1) print "f", b, b + n, a + n } }' > "$folder/pebble.obj"
pebbles=''
for angles in "${turned[@]}"; do
    pebbles+="${pebbles:+, }{\"file\": \"pebble.obj\", \"material\": {\"base_color\": [0, 0, 0], \"emissive\": [4, 2, 1]}, \"rotate\": $angles}"
done
bakes "$pebbles" ''
for i in "${!turned[@]}"; do
    echo "$(light "$i") $(half_v "$i")" | awk '{ exit !($13 == 1540 && $8 > 0.099 && $8 < 0.101 &&
        $9 * $9 > 0.98 && $9 * $9 < 1.02 && $20 * $20 > 0.156 && $20 * $20 < 0.164) }' ||
        fail "an ellipsoid turned by ${turned[i]} is $(light "$i") $(half_v "$i")"
done
bakes "$posts" ''
for i in "${!turned[@]}"; do
    light "$i" | awk '{ exit !($8 > 0.06 && $8 < 0.078 && $10 * $10 > 0.81 && $9 * $9 + $11 * $11 < 1e-6) }' ||
        fail "a post turned by ${turned[i]} is $(light "$i")"
done
bakes "$(glows '{"sphere": {"radius": 0.1, "subdivisions": 3}}')" ''
light 0 | awk '{ exit !($5 > 3.8 && $5 < 4 && $8 > 0.0999 && $8 < 0.1001 && $13 == 1026) }' || fail "a ball is $(light 0)"
bakes "$(glows '{"sphere": {"radius": 0.1}}' ', "area_light": false')" ''
is 0 none
bakes "$(glows '{"sphere": {"radius": 0.001}}')" '' # too small, unless it is asked for
is 0 none
bakes "$(glows '{"sphere": {"radius": 0.001}}' ', "area_light": true')" ''
[ "$(light 0)" != none ] || fail "a small ball that shall be a light is none"

# ---- glTF ----------------------------------------------------------------------------------------

positions=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA
cat > "$folder/lamps.gltf" << END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3, 4]}],
 "extensionsUsed": ["KHR_lights_punctual"],
 "extensions": {"KHR_lights_punctual": {"lights": [
    {"type": "point", "color": [1, 0.5, 0], "intensity": 31.415926535, "range": 5},
    {"type": "spot", "intensity": 3.1415926535, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
    {"type": "directional", "intensity": 3, "color": [0.5, 1, 0]}]}},
 "nodes": [{"mesh": 0, "name": "body", "translation": [10, 0, 0], "children": [1]},
           {"name": "mount", "translation": [0, 0, 2], "children": [2]},
           {"name": "beam", "rotation": [0, 1, 0, 0], "translation": [1, 0, 0],
            "extensions": {"KHR_lights_punctual": {"light": 1}}},
           {"name": "bulb", "translation": [0, 3, 0],
            "extensions": {"KHR_lights_punctual": {"light": 0}}},
           {"name": "sky", "rotation": [-0.70710678, 0, 0, 0.70710678], "extensions": {"KHR_lights_punctual": {"light": 2}}}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,$positions"}]}
END
# The beam is of the body, in its space; a half turn about y points it along +z.
bakes '{"file": "lamps.gltf"}' ''
[ ! -s "$folder/err" ] || fail "lamps.gltf: $(cat "$folder/err")"
# Its directional light, turned by its node, is the sun: 3 lux, half of it red. A scene's own sun stays, and of two
# one is enough; both are said.
sun_is '0 1 0 0.4775 0.9549 0'
bakes '{"file": "lamps.gltf", "rotate": [0, 0, -90], "lights": 2}' ''
sun_is '1 0 0 0.9549 1.91 0'
bakes '{"file": "lamps.gltf"}' '' ', "sun": {"direction": [0, 0, 1], "color": [1, 1, 1], "intensity": 2}'
sun_is '0 0 1 2 2 2'
grep -q 'directional light "sky": ignored, since the scene has a sun' "$folder/err" || fail "no word of the sun"
bakes '{"file": "lamps.gltf"}' '' ', "sun": {"shadows": {}}'
sun_is '0 1 0 0.4775 0.9549 0'
bakes '{"file": "lamps.gltf"}, {"file": "lamps.gltf"}' ''
sun_is '0 1 0 0.4775 0.9549 0'
grep -q 'directional light "sky": ignored, since the scene has another one' "$folder/err" || fail "no word of the second sun"
"$bin/masu-bake" "$folder/lamps.gltf" -o "$folder/s.masu" --strict --quiet || fail "lamps.gltf alone"
sun_is '0 1 0 0.4775 0.9549 0'
bakes '{"file": "lamps.gltf"}' ''
is 1 '0 3 0 5 10 5 0 0.01 0 0 0 | 0 |0 0 | -1 '
is 0 '1 0 2 10 1 1 1 0.01 0 0 1 | 1 |0.2 0.4 | 0 '
# Placed: what stands alone moves, what is carried stays in its instance's space.
bakes "$box, {\"file\": \"lamps.gltf\", \"name\": \"b\", \"scale\": 2, \"translate\": [0, 1, 0], \"lights\": 0.5}" ''
is 1 '0 7 0 5 5 2.5 0 0.01 0 0 0 | 0 |0 0 | -1 '
is 0 '1 0 2 7.071 0.5 0.5 0.5 0.01 0 0 1 | 1 |0.2 0.4 | 1 '
grep -q -a b/beam "$folder/s.masu" || fail "the name b/beam is not in the blob"
bakes '{"file": "lamps.gltf", "lights": 0}' ''
is 0 none
# Merged, nothing is left that could carry it.
bakes '{"file": "lamps.gltf", "merge": 100}' ''
is 0 '11 0 2 10 1 1 1 0.01 0 0 1 | 1 |0.2 0.4 | -1 '

[ $failures = 0 ]
