#!/bin/bash
# masu-lab ladder: the ladders of docs/report give src/quality/ladder_tables.h byte for byte; settings that some scenes
# of a class or some devices do not support are rejected.
set -u
cd "$(dirname "$0")/../../.." || exit 1
lab=$(realpath "${BUILD:-build}/bin/masu-lab")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

fail() {
    echo "$1"
    failed=1
}

# refuses CODE TEXT ARGUMENTS...: checks the exit code, and that the output is one line with TEXT
refuses() {
    local out code
    out=$("$lab" ladder "${@:3}" 2>&1 > /dev/null)
    code=$?
    [ "$code" = "$1" ] && [[ $out == *"$2"* ]] && [ "$(wc -l <<< "$out")" = 1 ] || fail "ladder ${*:3}: exit code $code, $out"
}

# LADDERS of the Makefile
files=()
while IFS= read -r pair; do
    files+=("${pair%%=*}=docs/report/${pair#*=}/ladder.json")
done < <(sed -n '/^LADDERS ?=/,/[^\\]$/p' Makefile | grep -oE '[a-z-]+=[a-z_-]+')
[ ${#files[@]} -ge 5 ] || fail "the Makefile has ${#files[@]} ladders"
"$lab" ladder "${files[@]}" > "$folder/tables.h" || fail 'masu-lab ladder fails'
cmp "$folder/tables.h" src/quality/ladder_tables.h || fail 'other tables than src/quality/ladder_tables.h (make ladders)'

# ladder NAME RATIO KNOBS: a ladder.json of two rungs
ladder() {
    local first='"setting": "base", "ratio": 1, "wall_ms": 2, "gpu_ms": 2, "flip": 0.1, "rmse": 3'
    cat > "$folder/$1.json" << END
{"scene": "a.masu", "hash": "0", "driver": "D", "date": "2026-01-02", "width": 32, "height": 24, "time": 0.0,
 "clock": "wall", "error": "flip", "rungs": [{$first, "knobs": {"scale": 1, "aa": "smaa-low"}},
 {"setting": "scale=0.5", "ratio": $2, "wall_ms": 1, "gpu_ms": 1, "flip": 0.25, "rmse": 5,
  "knobs": {"scale": 0.5, "march_steps": 64, "shadow_refresh": [1, 2, 4, 8]$3}}]}
END
}
ladder good 0.5 ''
"$lab" ladder both="$folder/good.json" > "$folder/both.h" || fail 'a ladder of two rungs is rejected'
for text in '[MASU_SCENE_BOTH] =' '{.scale = 1.0f, .aa = MASU_AA_SMAA_LOW},' '.ratios = {1.0f, 0.5f},' \
    '{.scale = 0.5f, .march_steps = 64, .shadow_refresh = {1, 2, 4, 8}},' '.flips = {0.1f, 0.25f},'; do
    grep -qF -e "$text" "$folder/both.h" || fail "no $text"
done
for knob in '"march": "plain"' '"specular": "on"' '"occlusion": "on"' '"upscale": "off"' '"shadow_distance": 0.25' \
    '"specular_cutoff": 0.25'; do
    ladder refused 0.5 ", $knob"
    refuses 1 'rungs[1]: ' sdf="$folder/refused.json"
done
ladder near 0.99 ''
refuses 1 'expected at least 1.04 times less than the previous rung, 1, found 0.99' sdf="$folder/near.json"
refuses 2 'no ladder is given'
refuses 2 'expected CLASS=FILE' "$folder/good.json"
refuses 2 'expected CLASS=FILE' many="$folder/good.json"
refuses 2 'two ladders of one class' sdf="$folder/good.json" sdf="$folder/good.json"
refuses 2 '--devices cannot be combined with --costs' --devices --costs "a.masu=$folder"
refuses 2 'expected SCENE.masu=DIR' --costs a.masu
refuses 1 'no setting is measured' --costs "a.masu=$folder"
refuses 2 'expected CLASS=SCENE.masu=LADDER.json' --devices sdf="$folder/good.json"
exit $failed
