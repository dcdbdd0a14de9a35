#!/bin/bash
# masu-lab reference -o X.png: exposure, filmic curve and sRGB of a sky of one colour.
set -u
cd "$(dirname "$0")/../../.." || exit 1
lab=$(realpath "${BUILD:-build}/bin/masu-lab")
bin=$(realpath "${MADE:-build}/bin")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# Radiance .18, .36 and .09 with exposure 2: the curve gives .5036, .7250 and .2669, and sRGB 188, 221 and 141.
cat > "$folder/sky.json" << 'END'
{
  "models": [{"mesh": {"sphere": {"radius": 1}}, "translate": [0, -50, 0]}],
  "camera": {"fov_y": 40, "near": 0.1, "keys": [{"time": 0, "position": [0, 0, 0], "target": [0, 1, -1]}]},
  "sky": {"zenith": [0.18, 0.36, 0.09], "horizon": [0.18, 0.36, 0.09]},
  "sun": {"intensity": 0},
  "exposure": 2
}
END
"$bin/masu-bake" "$folder/sky.json" -o "$folder/sky.masu" --bare --quiet || fail "masu-bake"
"$lab" reference "$folder/sky.masu" -o "$folder/sky.png" --paths 1 --size 16x16 --quiet || fail "masu-lab reference"
colour=$(convert "$folder/sky.png" -depth 8 rgb:- | od -An -v -tu1 -w3 | sort -u | xargs)
[ "$colour" = "188 221 141" ] || fail "the sky is $colour"

# The name determines the format; in linear light the sky has the scene's values.
said=$("$lab" reference "$folder/sky.masu" -o "$folder/sky.jpg" --paths 1 --size 16x16 --quiet 2>&1)
[ $? = 2 ] && [[ $said == *sky.jpg* ]] && [ ! -e "$folder/sky.jpg" ] || fail "sky.jpg: $said"
for end in pfm exr; do
    "$lab" reference "$folder/sky.masu" -o "$folder/sky.$end" --paths 1 --size 16x16 --quiet || fail "sky.$end"
done
"$bin/masu" compare "$folder/sky.exr" "$folder/sky.pfm" > "$folder/compared" 2>&1 || fail "$(cat "$folder/compared")"

# An analytic sky is not traced.
sed 's/"sky": {.*}/"sky": {"turbidity": 3}/; s/"sun": .*/"sun": {"direction": [0, 1, 0]},/' "$folder/sky.json" > "$folder/haze.json"
if "$bin/masu-bake" "$folder/haze.json" -o "$folder/haze.masu" --bare --quiet; then
    said=$("$lab" reference "$folder/haze.masu" -o "$folder/haze.png" --paths 1 --size 16x16 --quiet 2>&1)
    [ $? = 1 ] && [[ $said == *"analytic sky (turbidity 3)"*"--sky"* ]] && [ ! -e "$folder/haze.png" ] ||
        fail "analytic sky: $said"
else
    fail "masu-bake, haze"
fi
[ $failures = 0 ]
