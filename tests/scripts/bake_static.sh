#!/bin/bash
# masu-bake: which SDFs are static, and the check of "static" in a scene. A static SDF has no code for its velocity.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
export MASU_SPIRV_QUICK=1 # nothing is drawn here

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# field NAME DISTANCE COLOR: hand-written
field() {
    printf 'float masu_sdf(vec3 p) { return %s; }\n' "$2" > "$folder/$1"
    printf 'void masu_sdf_surface(vec3 p, inout masu_surface s) { s.albedo = vec3(%s); }\n' "$3" >> "$folder/$1"
}

# run NAME DECLARED MORE: bakes the scene
run() {
    printf '{"sdf": {"source": "%s", "static": %s, "bounds": [[-2,-2,-2],[2,2,2]]%s}}' "$1" "$2" "$3" \
        > "$folder/scene.json"
    "$bake" --quiet --bare --stats "$folder/stats" "$folder/scene.json" -o "$folder/out.masu" 2> "$folder/said"
}

# words: of the velocity's code
words() { grep -A1 '"velocity_spirv"' "$folder/stats" | sed -n 's/.*"count": \([0-9]*\).*/\1/p'; }

# still NAME [MORE]: static, declared or not
still() {
    for declared in false true; do
        run "$1" $declared "${2-}" || fail "$1, $declared: $(cat "$folder/said")"
        [ "$(words)" = 0 ] || fail "$1, $declared: has code for a velocity"
    done
}

# moves NAME REASON [MORE]: may change; an error in one line if declared static
moves() {
    run "$1" false "${3-}" || fail "$1: $(cat "$folder/said")"
    [ "$(words)" -gt 0 ] || fail "$1: has no code for its velocity"
    rm "$folder/out.masu"
    run "$1" true "${3-}" && fail "$1: accepted as static"
    [ -e "$folder/out.masu" ] && fail "$1: leaves a blob"
    [ "$(grep -vc warning "$folder/said")" = 1 ] || fail "$1: not one line: $(cat "$folder/said")"
    grep -qxF "masu-bake: $folder/$1: declared \"static\", but $2" "$folder/said" ||
        fail "$1: $(cat "$folder/said")"
}

radius='[{"name": "small", "value": 1, "min": 0.5, "max": 1.5}]'
fixed='[{"name": "small", "value": 1, "min": 1, "max": 1}]'
color='material grey { albedo 0.6; roughness 0.5 }'
field sphere.glsl 'length(p) - 1.0' 0.5
field lamp.glsl 'length(p) - 1.0' 'masu_time()'
field unused.glsl 'length(p) - 1.0 + 0.0 * float(0 * int(p.x))' 0.5
field pulse.glsl 'length(p) - 1.0 - 0.1 * sin(masu_time())' 0.5
field small.glsl 'length(p) - masu_param(MASU_PARAM_SMALL)' 0.5
echo "$color part ball : grey = sphere(1);" > "$folder/sphere.sdf"
echo "material red { albedo 0.5 + 0.4 * sin(time); roughness 0.5 } part ball : red = sphere(1);" > "$folder/red.sdf"
echo "param r = 1 [0.5, 1.5]; $color part ball : grey = sphere(r);" > "$folder/param.sdf"
echo "$color part ball : grey = sphere(1 + 0.1 * sin(time));" > "$folder/time.sdf"
block='bounds (-2,-2,-2), (2,2,2) lipschitz 1;'
echo "$color part ball : grey = glsl { return length(p) - 1.0; } $block" > "$folder/block.sdf"
echo "$color part ball : grey = glsl { return length(p) - 1.0 - 0.1 * sin(masu_time()); } $block" \
    > "$folder/timed_block.sdf"

still sphere.glsl
still lamp.glsl
still unused.glsl
still small.glsl ", \"params\": $fixed"
still sphere.sdf
still red.sdf
still block.sdf
moves pulse.glsl 'the field reads masu_time()'
moves small.glsl 'the field reads the parameter "small" or another that may change (min < max)' ", \"params\": $radius"
moves param.sdf 'part ball depends on time or on a parameter'
moves time.sdf 'part ball depends on time or on a parameter'
moves timed_block.sdf 'the field reads masu_time()'
[ "$failures" = 0 ] || exit 1
