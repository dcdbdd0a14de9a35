#!/bin/bash
# drive_long.sh [OPTIONS]: the game on the world forza, a whole lap and more by its autopilot, under the validation
# layer: two other window sizes, a pause, dusk and day again. Called by make drive-long: on a CPU it takes
# a quarter of an hour. Prints the line of counts; exit 1 where there is no lap or the layer has something to say.
# The pictures and strip.png, all of them, lie in $BUILD/drive-long.
set -u
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
folder=$build/drive-long
# shellcheck source=tests/xvfb.sh
. tests/xvfb.sh
trap stop_screen EXIT
rm -rf "$folder" && mkdir -p "$folder"
start_screen "$folder" || exit 1

# Ten frames a second: a CPU draws no more. Of 1,800 frames six are paused.
{
    echo "frame 0 step 0.1"
    echo "frame 0 key o"
    for ((frame = 1; frame < 1800; frame++)); do
        case $frame in
            100) echo "frame $frame resize 160x90" ;;
            160) echo "frame $frame key p" ;;
            165) echo "frame $frame screenshot $folder/0165.bmp" && echo "frame 166 key p" ;;
            200) echo "frame $frame resize 240x136" ;;
            450 | 700) echo "frame $frame key n" ;;
            *00 | 60 | 130 | 550) echo "frame $frame screenshot $folder/$(printf '%04d' $frame).bmp" ;;
        esac
    done
    echo "frame 1800 quit"
} > "$folder/script.txt"
"$build/examples/drive" -s 192x108 -t 250 -v "$@" -f "$folder/script.txt" "$build/worlds/forza.masu" \
    "$build/worlds/forza.track" > "$folder/out.txt" 2> "$folder/err.txt"
code=$?
cat "$folder/out.txt" "$folder/err.txt"
montage "$folder"/*.bmp -geometry 240x136+2+2 -tile 5x "$folder/strip.png"
echo "The strip is $PWD/$folder/strip.png"
[ $code = 0 ] && grep -q 'laps 1' "$folder/out.txt"
