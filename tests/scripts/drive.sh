#!/bin/bash
# The game examples/drive on a screen of its own: a drive by script with keys, pause, dusk, another window
# size; the same script twice; what it may include; skid marks, smoke, brake lights, bloom and rain in
# images; that its heap is closed once it runs; what it refuses.
# Without SDL2 there is no game to look at.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/xvfb.sh
. tests/xvfb.sh
game=${BUILD:-build}/examples/drive
scene=${MADE:-build}/scenes/test_drive.masu
track=tests/scenes/test_drive.track
folder=$(mktemp -d)
trap 'rm -rf "$folder"; stop_screen' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

if [ ! -x "$game" ] || ! command -v Xvfb > /dev/null; then
    echo "skipped: no SDL2 or no Xvfb here (make deps-test)"
    exit 77
fi

start_screen "$folder" || exit 1

# drive NAME ARGUMENTS...: leaves NAME.out, NAME.err; the script is NAME.txt
drive() {
    local name=$1
    shift
    timeout 300 "$game" -s 192x108 "$@" -f "$folder/$name.txt" "$scene" "$track" > "$folder/$name.out" 2> "$folder/$name.err"
}
count() { sed -n "s/.* \?$2 \([^ ]*\).*/\1/p" "$folder/$1.out"; }
is() { [ "$(count "$1" "$2")" = "$3" ] || fail "$1: $2 is not $3: $(cat "$folder/$1.out")"; }
size() { identify -format '%wx%h' "$1"; }
colors() { identify -format '%k' "$1"; }

# ---- what it is made of ----------------------------------------------------------------------------

# The public header and the examples' window alone: with no other folder to look in, it compiles.
for source in examples/drive/*.c examples/shared/*.c; do
    # shellcheck disable=SC2046
    "${CC:-gcc}" -std=c11 -D_POSIX_C_SOURCE=200809L -Iinclude -Iexamples/shared $(pkg-config --cflags sdl2) -fsyntax-only "$source" ||
        fail "$source needs more than masu.h, examples/shared, SDL2 and Vulkan"
done
grep -hE '#include "\.\.|#include <(bake|cli|platform)' examples/drive/* examples/shared/* &&
    fail "it looks into other folders"
lines=$(cat examples/drive/*.[ch] | wc -l)
[ "$lines" -le 1200 ] || fail "the game has $lines lines: it is to be read, at most 1200"

# ---- a drive: at one rung, twice, once under the validation layer ----------------------------------

script() {
    cat << END
# forward, a bend, a pause, dusk, another size
frame 0 key up down
frame 2 screenshot $folder/$1-start.bmp
frame 24 key left down
frame 32 key left up
frame 40 screenshot $folder/$1-driven.bmp
frame 41 key p
frame 44 screenshot $folder/$1-paused.bmp
frame 46 key p
frame 48 key n
frame 50 screenshot $folder/$1-dusk.bmp
frame 52 resize 240x136
frame 54 screenshot $folder/$1-large.bmp
frame 56 resize 120x90
frame 58 screenshot $folder/$1-small.bmp
frame 60 quit
END
}
for run in a b; do
    script $run > "$folder/$run.txt"
    # shellcheck disable=SC2046
    drive $run -r 0 $([ $run = b ] || echo -v) || fail "$run: exit code $?: $(cat "$folder/$run.err")"
    [ ! -s "$folder/$run.err" ] || fail "$run says $(cat "$folder/$run.err")"
    is $run frames 60
    is $run rungs 0x01
    is $run resizes 2
done
cmp -s "$folder/a.out" "$folder/b.out" || sed 's/over [0-9]*//; s/bars.*//' "$folder/a.out" "$folder/b.out" | uniq | wc -l |
    grep -qx 1 || fail "the same script drives otherwise: $(cat "$folder/a.out" "$folder/b.out")"
for shot in start driven paused dusk large small; do
    cmp -s "$folder/a-$shot.bmp" "$folder/b-$shot.bmp" || fail "the same script shows another $shot"
    [ "$(colors "$folder/a-$shot.bmp")" -gt 100 ] || fail "$shot is hardly a picture"
    [ "$shot" = start ] || ! cmp -s "$folder/a-$shot.bmp" "$folder/a-start.bmp" || fail "$shot looks like the start"
done
[ "$(size "$folder/a-start.bmp") $(size "$folder/a-large.bmp") $(size "$folder/a-small.bmp")" = \
    "192x108 240x136 120x90" ] || fail "sizes of the pictures"
awk '{ for (i = 1; i < NF; i++) if ($i == "distance") exit !($(i + 1) > 3 && $(i + 1) < 20) }' "$folder/a.out" ||
    fail "distance: $(cat "$folder/a.out")"
# ---- effects ---------------------------------------------------------------------------------------

# A skid; dusk; the brakes; the same frame without bloom, without head lights; by day, dry and in rain. In a pause
# nothing moves.
skid() {
    cat << END
frame 0 step 0.1
frame 0 key up down
frame 12 key up up
frame 12 key left down
frame 12 key Space down
frame 17 screenshot $folder/$1-skid.bmp
$2
END
}
skid effects "frame 18 key n
frame 18 key Space up
frame 18 key left up
frame 25 screenshot $folder/tail.bmp
frame 26 step 0.01
frame 26 key down down
frame 27 key p
frame 27 screenshot $folder/brake.bmp
frame 28 key b
frame 28 screenshot $folder/sharp.bmp
frame 29 key l
frame 29 screenshot $folder/unlit.bmp
frame 30 key n
frame 30 screenshot $folder/dry.bmp
frame 31 key r
frame 31 screenshot $folder/rain.bmp
frame 32 quit" > "$folder/effects.txt"
drive effects -r 0 -v || fail "effects: $(cat "$folder/effects.err")"
# The same skid in a scene without the material of the marks, and by a car without wheels: no smoke.
sed 's/"name": "skid", "base_color"/"base_color"/' tests/scenes/test_drive.json > "$folder/bare.json"
"${BUILD:-build}/bin/masu-bake" "$folder/bare.json" -o "$folder/bare.masu" --quiet || fail "baking without marks"
sed '/^wheel/d' "$track" > "$folder/clean.track"
skid bare "frame 18 quit" > "$folder/bare.txt"
skid clean "frame 18 quit" > "$folder/clean.txt"
scene=$folder/bare.masu drive bare -r 0 || fail "bare: $(cat "$folder/bare.err")"
track=$folder/clean.track drive clean -r 0 || fail "clean: $(cat "$folder/clean.err")"

# gray IMAGE REGION: its mean, 0 to 1000. brighter WHAT FACTOR REGION IMAGE OTHER: by at least that factor.
gray() { convert "$1" -crop "$2" +repage -colorspace Gray -format '%[fx:1000*mean]' info:; }
brighter() {
    awk "BEGIN { exit !($(gray "$folder/$4.bmp" "$3") > $2 * $(gray "$folder/$5.bmp" "$3")) }" ||
        fail "$1: $(gray "$folder/$4.bmp" "$3") in $4, $(gray "$folder/$5.bmp" "$3") in $5"
}
brighter smoke 1.05 60x16+8+78 bare-skid clean-skid
brighter "skid marks" 1.008 40x14+68+94 bare-skid effects-skid
brighter "brake lights" 1.3 12x4+76+67 brake tail
brighter bloom 1.02 60x6+66+62 brake sharp
brighter "head lights" 1.02 40x5+76+50 sharp unlit
# The largest difference between the sky and the blurred sky: drops.
drops() {
    convert "$folder/$1.bmp" -crop 192x14+0+16 +repage -colorspace Gray \( +clone -blur 0x2 \) \
        -compose difference -composite -format '%[fx:1000*maxima]' info:
}
awk "BEGIN { exit !($(drops rain) > 2.5 * $(drops dry)) }" || fail "rain: $(drops rain) with, $(drops dry) without"
# Most of the pipelines were created behind the loading bar, the other rungs in frames.
[ "$(count effects bars)" -ge 1 ] && [ "$(count effects late)" -ge 1 ] || fail "no loading bar: $(cat "$folder/effects.out")"

# ---- the governor: a target that no rung keeps, one that the first does ----------------------------

printf 'frame 30 quit\n' > "$folder/slow.txt"
printf 'frame 20 quit\n' > "$folder/fast.txt"
drive slow -t 1 || fail "slow: $(cat "$folder/slow.err")"
is slow frames 30
[ "$(($(count slow rungs)))" -gt 1 ] || fail "no rung but the first: $(cat "$folder/slow.out")"
drive fast -t 1000 || fail "fast: $(cat "$folder/fast.err")"
is fast frames 20

# ---- the heap is closed ----------------------------------------------------------------------------

printf 'frame 3 allocate\nframe 4 quit\n' > "$folder/heap.txt"
(drive heap -r 0) 2> /dev/null && fail "an allocation in a frame is let through"
grep -q 'the heap is closed' "$folder/heap.err" || fail "heap: $(cat "$folder/heap.err")"

# ---- what it refuses, each in one line -------------------------------------------------------------

# refuses NAME PATTERN ARGUMENTS...
refuses() {
    local name=$1 pattern=$2
    shift 2
    drive "$name" "$@" && fail "$name: is taken"
    [ "$(wc -l < "$folder/$name.err")" = 1 ] || fail "$name: not one line: $(cat "$folder/$name.err")"
    grep -q -e "$pattern" "$folder/$name.err" || fail "$name: \"$pattern\" is not in $(cat "$folder/$name.err")"
}
echo 'frame 3 key nosuch' > "$folder/key.txt"
refuses key 'script: unknown command: key nosuch'
echo 'fly away' > "$folder/word.txt"
refuses word 'script: unknown command: fly away'
printf 'frame 1 quit\n' | tee "$folder/track.txt" "$folder/blob.txt" "$folder/big.txt" > /dev/null
echo 'masu-track 1 points 2' > "$folder/bad.track"
track=$folder/bad.track refuses track 'bad.track: expected a track of version 1'
scene=tests/scenes/test_drive.track refuses blob 'scene blob'
"$game" > /dev/null 2> "$folder/err"
[ $? = 2 ] && grep -q '^usage' "$folder/err" || fail "no usage without a scene"

[ $failures = 0 ] && echo "drive: all as expected: $(cat "$folder/a.out")"
[ $failures = 0 ]
