#!/bin/bash
# The small examples beside minimal.c: loop in a window of a screen of its own, under the validation layer, with a
# smaller window (masu_resize), a larger one (masu_destroy, masu_init) and rungs of the governor; split_screen,
# whose halves show the scene from two places; sprites; cloth, a mesh that the host deforms; host_pass, with commands of
# its own in a frame. drive.sh has the game.
set -u
cd "$(dirname "$0")/../.." || exit 1
examples=${BUILD:-build}/examples
scenes=${MADE:-build}/scenes
folder=$(mktemp -d)
# shellcheck source=tests/xvfb.sh
. tests/xvfb.sh
trap 'rm -rf "$folder"; stop_screen' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
colors() { convert "$1" ${2:+-crop "$2"} -format '%k' info:; }

for example in minimal loop split_screen cloth; do
    lines=$(wc -l < examples/$example.c)
    [ "$lines" -le 150 ] || fail "$example.c has $lines lines: at most 150"
done

# ---- split_screen ----------------------------------------------------------------------------------

"$examples/split_screen" "$scenes/test_live.masu" "$folder/split.png" > "$folder/out" 2> "$folder/err" ||
    fail "split_screen: $(cat "$folder/out" "$folder/err")"
grep -q 'validation 0' "$folder/out" || fail "split_screen: $(cat "$folder/out")"
convert "$folder/split.png" -crop 320x360 +repage "$folder/half%d.png"
for half in 0 1; do
    [ "$(colors "$folder/half$half.png")" -gt 100 ] || fail "half $half of the split screen is hardly a picture"
done
# Of the same place twice it is 2,400 pixels: reflections have noise.
[ "$(compare -metric AE -fuzz 10% "$folder/half0.png" "$folder/half1.png" null: 2>&1)" -gt 20000 ] ||
    fail "both halves show the same"
"$examples/split_screen" 2> /dev/null
[ $? = 2 ] || fail "split_screen without arguments"
"$examples/split_screen" /dev/null "$folder/none.png" 2> /dev/null && fail "split_screen takes an empty scene"

# ---- cloth -----------------------------------------------------------------------------------------

"$examples/cloth" "$scenes/test_reserve.masu" ball "$folder/cloth.png" > "$folder/out" 2> "$folder/err" ||
    fail "cloth: $(cat "$folder/out" "$folder/err")"
grep -q '768 triangles.*validation 0$' "$folder/out" || fail "cloth: $(cat "$folder/out")"
# The middle of the flag is yellow.
[ "$(convert "$folder/cloth.png" -format '%[fx:int(255*(u.p{320,180}.r-u.p{320,180}.b))]' info:)" -gt 40 ] ||
    fail "the flag is not there"
"$examples/cloth" "$scenes/test_reserve.masu" none "$folder/none.png" 2> "$folder/err" &&
    fail "cloth takes an unknown material"
grep -q 'reserve.meshes\[0\].material' "$folder/err" || fail "cloth: $(cat "$folder/err")"
"$examples/cloth" 2> /dev/null
[ $? = 2 ] || fail "cloth without arguments"

# The time of the others goes by in a driver, drawing.
if [ "${NESTED:-}" ]; then
    [ $failures = 0 ]
    exit
fi

# ---- sprites ---------------------------------------------------------------------------------------

"$examples/sprites" "$scenes/test_texture_floor.masu" "$folder/sprites.png" > "$folder/out" 2> "$folder/err" ||
    fail "sprites: $(cat "$folder/out" "$folder/err")"
grep -q 'validation 0' "$folder/out" || fail "sprites: $(cat "$folder/out")"
[ "$(colors "$folder/sprites.png" 480x540+480+0)" -gt 300 ] || fail "the trail of sprites is not there"
"$examples/sprites" 2> /dev/null
[ $? = 2 ] || fail "sprites without arguments"

# ---- host_pass -------------------------------------------------------------------------------------

"$examples/host_pass" "$scenes/test_both.masu" "$folder/own.png" > "$folder/out" 2> "$folder/err" ||
    fail "host_pass: $(cat "$folder/out" "$folder/err")"
grep -q '^3 parts, .*validation 0$' "$folder/out" || fail "host_pass: $(cat "$folder/out")"
# Left of the box the sheet, bluer than the sky above it; the bar below.
blue() { convert "$folder/own.png" -format "%[fx:int(255*(u.p{$1}.b-u.p{$1}.r))]" info:; }
[ "$(blue 200,360)" -gt $(($(blue 200,160) + 10)) ] || fail "the sheet of host_pass is not there"
[ "$(blue 200,659)" -lt -100 ] || fail "the bar of host_pass is not there"
"$examples/host_pass" 2> /dev/null
[ $? = 2 ] || fail "host_pass without arguments"

# ---- loop ------------------------------------------------------------------------------------------

if [ ! -x "$examples/loop" ] || ! command -v Xvfb > /dev/null; then
    echo "skipped: no SDL2 or no Xvfb here (make deps-test)"
    [ $failures = 0 ] && exit 77
    exit 1
fi
start_screen "$folder" || exit 1
cat > "$folder/script" << END
# 640x360, then another
frame 9 screenshot $folder/first.bmp
frame 10 resize 320x180
frame 13 screenshot $folder/small.bmp
frame 14 resize 648x365
frame 17 screenshot $folder/large.bmp
frame 18 quit
END
timeout 300 "$examples/loop" "$scenes/test_live.masu" "$folder/script" > "$folder/out" 2> "$folder/err" ||
    fail "loop: $? $(cat "$folder/out" "$folder/err")"
grep -Eq 'frames 18 rungs 0x[0-9a-f]+ resizes 2 inits 2 format (37|44) validation 0' "$folder/out" || fail "loop: $(cat "$folder/out")"
[ "$(identify -format '%wx%h ' "$folder"/{first,small,large}.bmp)" = "640x360 320x180 648x365 " ] ||
    fail "sizes of the pictures"
for shot in first small large; do
    [ "$(colors "$folder/$shot.bmp")" -gt 100 ] || fail "$shot is hardly a picture"
done
# No rung keeps 16.7 ms on a CPU: it has left the first.
rungs=$(sed -n 's/.* rungs \([^ ]*\) .*/\1/p' "$folder/out")
[ $((rungs)) -gt 1 ] || fail "no rung but the first: $(cat "$folder/out")"
# A swapchain of an sRGB format shows the same bytes, also in another present mode.
sed -n '1,2p' "$folder/script" | sed 's/first/srgb/' > "$folder/srgb"
echo 'frame 10 quit' >> "$folder/srgb"
LOOP_SURFACE=srgb,unpaced timeout 300 "$examples/loop" "$scenes/test_live.masu" "$folder/srgb" > "$folder/out2" \
    2> "$folder/err" || fail "loop, sRGB: $? $(cat "$folder/out2" "$folder/err")"
grep -Eq 'format (43|50) validation 0' "$folder/out2" || fail "loop, sRGB: $(cat "$folder/out2")"
mean() { convert "$1" -format '%[fx:int(1000*mean)]' info:; }
off=$(($(mean "$folder/first.bmp") - $(mean "$folder/srgb.bmp")))
[ "${off#-}" -le 8 ] || fail "the sRGB window differs by $off thousandths"
echo 'frame 1 fly' > "$folder/script"
"$examples/loop" "$scenes/test_live.masu" "$folder/script" 2> "$folder/err" > /dev/null && fail "loop flies"
grep -q 'script: unknown command: fly' "$folder/err" || fail "loop: $(cat "$folder/err")"

[ $failures = 0 ] && echo "examples: all as expected: $(cat "$folder/out")"
[ $failures = 0 ]
