#!/bin/bash
# masu-view on a screen of Xvfb, with the system's lavapipe under the validation layer: scripts press its
# keys, resize, minimise and lose things, change files; the pictures that it writes are compared with
# each other. Pictures are of one moment (paused); dither moves by one step from frame to frame, so that
# equal means within two steps. Skipped without masu-view, Xvfb, lavapipe or ImageMagick, which with
# MASU_REQUIRE_DRIVERS must be there.
set -u
cd "$(dirname "$0")/../.." || exit 1
view=$(realpath "${BUILD:-build}")/bin/masu-view
bake=$(realpath "${BUILD:-build}")/bin/masu-bake
scenes=$(realpath "${MADE:-build}")/scenes
folder=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; [ -n "${KEEP:-}" ] || rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
skip() {
    echo "$1"
    [ -n "${MASU_REQUIRE_DRIVERS:-}" ] && exit 1
    exit 77
}

[ -x "$view" ] || skip "there is no $view: it takes SDL2 and Dear ImGui"
command -v Xvfb > /dev/null || skip "there is no Xvfb"
command -v compare > /dev/null || skip "there is no ImageMagick"
icd=$(tests/drivers.sh system 2> /dev/null) || skip "there is no lavapipe"
export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd NODEVICE_SELECT=1 SDL_AUDIODRIVER=dummy
cd "$folder" || exit 1

# refuses CODE PATTERN ARGUMENTS...: one line on stderr
refuses() {
    local wanted=$1 pattern=$2 code
    shift 2
    timeout 120 "$view" "$@" > /dev/null 2> stderr
    code=$?
    [ $code = "$wanted" ] || fail "$*: exit code $code: $(cat stderr)"
    [ "$(wc -l < stderr)" = 1 ] || fail "$*: not one line: $(cat stderr)"
    grep -q -e "$pattern" stderr || fail "$*: $(cat stderr), not $pattern"
}

# ---- without a screen ----------------------------------------------------------------------------

both=$scenes/test_both.masu
"$view" --help | grep -q 'F12' || fail "--help does not list the keys"
refuses 2 'unknown option --gone' --gone "$both"
refuses 2 'expected one file' "$both" "$both"
refuses 2 '--quit needs --frames' "$both" --quit
refuses 2 '--setting' "$both" --setting scale=7
refuses 1 'none.masu: no such file' none.masu
refuses 1 '--rung: expected 0 to 2, found 7' "$both" --rung 7 --ladder off
printf 'frame 3 quit\nframe 2 quit\n' > falling
refuses 1 'falling:2: expected frame numbers in rising order' "$both" --script falling
printf '\n# nothing\nframe 3 key Nokey\n' > nokey
refuses 1 'nokey:3: ' "$both" --script nokey
printf 'frame 3 dance\n' > dance
refuses 1 'dance:1: unknown action' "$both" --script dance
printf 'frame 3 click 5\n' > half
refuses 1 'half:1: wrong or missing argument' "$both" --script half
SDL_VIDEODRIVER=x11 DISPLAY='' refuses 1 'masu-view: no window: ' "$both"
head -c 1000 "$both" > short.masu
SDL_VIDEODRIVER=x11 DISPLAY='' refuses 1 'short.masu: ' short.masu

# ---- a screen ------------------------------------------------------------------------------------

mkfifo display
Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp 3> display > /dev/null 2>&1 &
server=$!
read -r -t 60 number < display || { fail "Xvfb does not start"; exit 1; }
export DISPLAY=:$number SDL_VIDEODRIVER=x11

# play NAME ARGUMENTS...: the script on stdin, in a folder of that name; exit code 0, no message
play() {
    local name=$1 code
    shift
    mkdir -p "$name"
    cat > "$name/script"
    (cd "$name" && timeout 500 "$view" "$@" --script script --validate > stdout 2> stderr)
    code=$?
    [ $code = 0 ] || fail "$name: exit code $code: $(cat "$name/stderr")"
    ! grep -q 'validation' "$name/stderr" || fail "$name: $(grep validation "$name/stderr" | head -3)"
}

# shows PICTURE SIZE: it is there, as large, and not of one colour
shows() {
    local is
    is=$(identify -format '%wx%h %k' "$1" 2>&1)
    [ "${is% *}" = "$2" ] && [ "${is#* }" -gt 8 ] || fail "$1 is $is, not $2 and colourful"
}

# unlike A B [PART]: how many pixels differ by more than two steps of 255
unlike() {
    local part=()
    [ -z "${3:-}" ] || part=(-crop "$3" +repage)
    convert "$1" "${part[@]}" one.miff && convert "$2" "${part[@]}" two.miff || echo missing
    compare -fuzz 0.9% -metric AE one.miff two.miff null: 2>&1
}
same() { [ "$(unlike "$@")" = 0 ] || fail "$* differ in $(unlike "$@") pixels"; }
differ() {
    local n
    n=$(unlike "$@")
    [[ $n =~ ^[0-9.e+]+$ ]] && [ "$n" != 0 ] || fail "$* do not differ ($n)"
}
# Above the lines at the bottom, right of the overlay: the picture alone.
upper=320x100+0+0

# ---- a scene that is being worked on -------------------------------------------------------------

cat > ball.sdf << 'END'
material red { albedo (0.8, 0.2, 0.1); roughness 0.5 }
material grey { albedo 0.5; roughness 0.8 }
part ball : red = translate((0, 1, 0), sphere(1));
part ground : grey = plane((0, 1, 0), 0);
END
cat > ball.json << 'END'
{
  "camera": {"fov_y": 50, "near": 0.1, "keys": [
    {"time": 0, "position": [0, 1.5, 5], "target": [0, 1, 0]},
    {"time": 2, "position": [3, 1.5, 4], "target": [0, 1, 0]}]},
  "sun": {"azimuth": 40, "elevation": 40},
  "sdf": {"source": "ball.sdf", "bounds": [[-50, -1, -50], [50, 3, 50]], "max_distance": 100}
}
END
sed 's/0.8, 0.2, 0.1/0.1, 0.7, 0.2/' ball.sdf > green.sdf
sed 's/sphere(1)/sphere(/' ball.sdf > broken.sdf
cp ball.sdf red.sdf
# No side of an image is a power of two: the driver compiles for such sides again.
# Three sizes without a past, which would show each frame something else: as measured ones, which have no AUTO.
cat > sizes.json << 'END'
{"scene": "ball", "driver": "any", "clock": "wall", "width": 320, "height": 180, "error": "flip", "rungs": [
  {"setting": "none", "ratio": 1, "flip": 0.1, "knobs": {"scale": 1}},
  {"setting": "scale=0.75", "ratio": 0.56, "flip": 0.1, "knobs": {"scale": 0.75}},
  {"setting": "scale=0.375", "ratio": 0.14, "flip": 0.1, "knobs": {"scale": 0.375}}]}
END

play ball --json ../ball.json --size 320x180 --ladder ../sizes.json --rung 0 << 'END'
frame 0 key F1          # full
frame 0 key F1          # off
frame 0 key Space
frame 3 screenshot rung0.png
frame 3 key PageDown
frame 3 key PageDown
frame 5 screenshot rung2.png
frame 5 key F2
frame 7 screenshot split.png
frame 7 key Shift+]
frame 9 screenshot split_right.png
frame 9 button left down
frame 9 mouse 80 90
frame 9 button left up
frame 11 screenshot split_left.png
frame 11 key F3
frame 14 screenshot map.png
frame 14 key 2
frame 14 key PageUp
frame 18 screenshot map_none.png
frame 18 key F3
frame 26 key F1
frame 28 screenshot hud_short.png
frame 28 key F1
frame 32 screenshot hud_full.png
frame 32 key F1
frame 33 run cp ../green.sdf ../ball.sdf
frame 35 screenshot green.png
frame 36 run cp ../broken.sdf ../ball.sdf
frame 38 screenshot broken.png
frame 39 run cp ../red.sdf ../ball.sdf
frame 41 screenshot red.png
frame 42 resize 200x150
frame 45 screenshot small.png
frame 46 resize 400x300
frame 49 screenshot large.png
frame 50 resize 320x180
frame 53 screenshot again.png
frame 54 minimise
frame 74 restore
frame 77 lose
frame 81 screenshot found.png
frame 82 quit
END
cd ball || exit 1
for p in rung0 rung2 split map hud_short hud_full green broken red again found; do
    shows $p.png 320x180
done
shows small.png 200x150
shows large.png 400x300
differ rung0.png rung2.png
same split.png rung2.png 150x60+0+0
same split.png rung0.png 150x60+170+0
same split_right.png rung2.png 214x60+0+0
differ split_right.png split.png 40x60+170+0
same split_left.png rung0.png 230x60+90+0
differ map.png rung2.png $upper
differ map.png map_none.png $upper
[ "$(convert map_none.png -crop 200x40+0+0 -format '%[fx:maxima<0.1]' info:)" = 1 ] ||
    fail "the difference of a rung from itself is not black"
differ hud_short.png rung0.png
differ hud_full.png hud_short.png
differ green.png rung0.png $upper
same broken.png green.png $upper
differ broken.png green.png 320x80+0+100 # the line of the error
same red.png rung0.png $upper
same again.png rung0.png $upper
same found.png rung0.png $upper
[ "$(grep -c 'device was lost' stderr)" = 1 ] || fail "one line about the lost device: $(cat stderr)"
read -r frames turns < <(sed -n 's/.*: \([0-9]*\) frames in \([0-9]*\) loop iterations.*/\1 \2/p' stderr)
[ -n "${turns:-}" ] && [ $((turns - frames)) -ge 20 ] && [ $((turns - frames)) -le 40 ] ||
    fail "while it was minimised $((turns - frames)) turns drew nothing, not 20 and a few"
cd ..

# Files that are named by named files: an include, a material of an OBJ.
printf 'include "colour.sdf";\n%s\n' "$(grep -v red red.sdf)
part ball : red = translate((0, 1, 0), sphere(1));" > including.sdf
grep red red.sdf | head -1 > colour.sdf
sed 's/ball.sdf/including.sdf/' ball.json > including.json
printf 'mtllib quad.mtl\nv -1 0 0\nv 1 0 0\nv 0 2 0\nusemtl m\nf 1 2 3\nf 3 2 1\n' > quad.obj
printf 'newmtl m\nKd 0.8 0.1 0.1\n' > quad.mtl
for file in including.json quad.obj; do
    edit="sed -i 's/0.8, 0.2, 0.1/0.1, 0.2, 0.8/' ../colour.sdf"
    [ $file != quad.obj ] || edit="sed -i 's/Kd .*/Kd 0.1 0.1 0.8/' ../quad.mtl"
    play "$file.d" ../$file --size 160x90 --rung 0 << END
frame 0 key F1
frame 0 key F1
frame 0 key Space
frame 3 screenshot before.png
frame 4 run $edit
frame 7 screenshot after.png
frame 8 quit
END
    differ "$file.d/before.png" "$file.d/after.png" 160x45+0+0
done

# A signal during a bake ends it as closing the window does. The folder of the bake is looked for at the end.
printf '#!/bin/sh\ntouch %s/started\nexec sleep 100\n' "$folder" > sleeper
chmod +x sleeper
"$view" red.sdf --bake ./sleeper --size 60x45 > out 2>&1 &
child=$!
for ((i = 0; i < 600; i++)); do [ -e started ] && break || sleep 0.1; done
kill "$child"
wait "$child" || fail "a signal: exit code $?: $(cat out)"
[ -e started ] || fail "the bake has not begun"

# Every frame depends on the script alone. (A rung without a past: what was flown is not to be seen in what follows.)
for run in 1 2; do
    play fly$run "$both" --size 160x90 --ladder ../sizes.json --rung 0 << 'END'
frame 0 key F1
frame 0 key F1
frame 2 screenshot start.png
frame 2 down W
frame 8 wheel 1
frame 12 up W
frame 12 button right down
frame 13 mouse 40 10
frame 14 button right up
frame 16 screenshot flown.png
frame 17 key P
frame 19 screenshot path.png
frame 20 quit
END
done
shows fly1/start.png 160x90
differ fly1/start.png fly1/flown.png
same fly1/start.png fly1/path.png 160x40+0+0 # below is a note
for p in start flown path; do
    cmp -s fly1/$p.png fly2/$p.png || fail "$p.png is another one the second time"
done

# What a click is on: what moves, what does not, the sky; in split screen it takes the line instead.
play pick $scenes/test_live.masu --size 320x180 --rung 0 << 'END'
frame 0 key F1
frame 0 key F1
frame 0 key Space
frame 2 screenshot before.png
frame 2 click 120 75
frame 5 screenshot truck.png
frame 5 click 40 160
frame 8 click 160 2
frame 11 key F2
frame 12 click 250 150
frame 15 key F2
frame 16 resize 160x90
frame 16 click 319 179
frame 20 quit
END
truck="120 75: node [0-9]* of model 'truck', instance 'truck/.*', depth [5-7]\.[0-9]* m, at -1\.[0-9]* 1\.[0-9]* [01]\.[0-9]*"
grep -qx "$truck" pick/stdout || fail "a click on the truck: $(cat pick/stdout)"
grep -q "^40 160: instance 'floor', depth " pick/stdout || fail "a click on the floor: $(cat pick/stdout)"
grep -qx '160 2: the sky' pick/stdout || fail "a click on the sky: $(cat pick/stdout)"
[ "$(wc -l < pick/stdout)" -le 4 ] || fail "a click in split screen: $(cat pick/stdout)"
! grep -q '^250 150' pick/stdout || fail "a click in split screen is one on the picture"
differ pick/before.png pick/truck.png 320x40+0+40
play sdf $scenes/test_sphere_sdf.masu --size 160x90 --rung 0 << 'END'
frame 0 key Space
frame 2 click 80 45
frame 6 quit
END
grep -q '^80 45: the SDF, depth ' sdf/stdout || fail "a click on the SDF: $(cat sdf/stdout)"

# Panels: each opens and shows something else; a slider by mouse and a box by keys change something; the video has its
# frames; a recorded path becomes a description. Files are dropped, and what cannot be opened is one line.
sed 's/sphere(1)/sphere(radius)/; 1i param radius = 1 [0.4, 1.6];' red.sdf > field.sdf
sed 's/ball.sdf/field.sdf/' ball.json > field.json
cat > slow << END
#!/bin/sh
printf '\\r\\033[Ktracing 2 of 5' >&2
until [ -e $folder/go ]; do sleep 0.05; done
exec '$bake' "\$@"
END
chmod +x slow
touch go
# At the coarsest rung: the panels are as large, what is behind them costs a seventh.
play panels ../field.json --bake ../slow --size 480x270 --ladder ../sizes.json --rung 2 << 'END'
frame 0 key F1
frame 0 key F1
frame 0 key Space
frame 4 screenshot plain.png
frame 4 key F5
frame 7 screenshot scene.png
frame 7 click 460 65        # radius, at its largest
frame 11 screenshot slid.png
frame 11 key F6
frame 14 screenshot light.png
frame 14 click 325 48       # the sun's elevation, nearly at its lowest
frame 18 screenshot dusk.png
frame 18 key F7
frame 21 screenshot quality.png
frame 21 key F10
frame 24 screenshot capture.png
frame 24 key Down           # the keyboard is at the first item: without panels and text
frame 27 key Space
frame 30 key F9
frame 33 key F9
frame 34 key F8
frame 37 screenshot camera.png
frame 37 click 190 170      # record
frame 60 click 190 170
frame 64 screenshot recorded.png
frame 64 click 262 170      # save
frame 66 key Escape
frame 68 screenshot closed.png
frame 69 run rm ../go
frame 70 drop ../ball.sdf
frame 74 screenshot progress.png
frame 75 run touch ../go
frame 75 wait
frame 78 screenshot dropped.png
frame 79 drop ../none.glb
frame 81 screenshot none.png
frame 82 quit
END
cd panels || exit 1
differ plain.png scene.png 300x200+180+0
differ scene.png light.png 300x200+180+0
differ light.png quality.png 300x200+180+0
differ quality.png capture.png 300x200+180+0
differ capture.png camera.png 300x200+180+0
same plain.png scene.png 170x200+0+0
differ scene.png slid.png 170x200+0+0 # a larger ball
differ slid.png dusk.png 170x200+0+0
same closed.png dusk.png 170x200+0+0
[ "$(head -1 masu-*.y4m)" = 'YUV4MPEG2 W480 H270 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED' ] ||
    fail "video: $(head -c 80 masu-*.y4m | head -1)"
[ "$(stat -c %s masu-*.y4m)" = $(($(head -1 masu-*.y4m | wc -c) + 3 * (6 + 3 * 480 * 270))) ] ||
    fail "a video of $(stat -c %s masu-*.y4m) bytes, not 3 frames"
grep -q '"target"' ../field-path.json && grep -q 'field.sdf' ../field-path.json || fail "no path was saved"
"$bake" ../field-path.json -o path.masu --quiet || fail "the saved path does not bake"
differ closed.png progress.png 170x100+0+170
differ progress.png dropped.png
differ none.png dropped.png 480x70+0+200 # the line of the error
same none.png dropped.png 480x150+0+0
cd ..

# The start page makes pictures of the scenes of a folder, and opens one.
mkdir scenes && cp ball.json ball.sdf scenes/
play start --gallery ../scenes --cache ../pictures --size 320x180 << 'END'
frame 2 screenshot empty.png
frame 2 run until [ -e ../pictures/ball.png ]; do sleep 0.1; done; sleep 0.3
frame 6 screenshot page.png
frame 6 key F1
frame 6 key F1
frame 6 click 60 80
frame 8 wait
frame 12 screenshot opened.png
frame 13 quit
END
shows pictures/ball.png 192x108
differ start/empty.png start/page.png
differ start/page.png start/opened.png

# A baked scene that is exchanged, and one that is cut off.
cp "$both" scene.masu
play blob ../scene.masu --size 160x90 --ladder ../sizes.json --rung 0 << END
frame 0 key F1
frame 0 key F1
frame 2 screenshot before.png
frame 3 run cp $scenes/test_sphere_sdf.masu ../scene.masu
frame 6 screenshot after.png
frame 7 run cp ../short.masu ../scene.masu
frame 9 screenshot kept.png
frame 10 run cp $both ../scene.masu
frame 12 screenshot back.png
frame 13 quit
END
differ blob/before.png blob/after.png
same blob/kept.png blob/after.png 160x20+0+0
differ blob/kept.png blob/after.png
same blob/back.png blob/before.png 160x20+0+0

# One picture, as a command; the governor; then a device that is lost for good.
mkdir once
(cd once && timeout 120 "$view" "$both" --size 60x45 --frames 5 --screenshot one.png --quit --quiet > out 2>&1) ||
    fail "--screenshot: $(cat once/out)"
[ ! -s once/out ] || fail "--quiet says $(cat once/out)"
shows once/one.png 60x45
printf 'frame 3 lose\nframe 4 lose\nframe 9 quit\n' > twice
timeout 120 "$view" "$both" --size 60x45 --script twice > out 2>&1
code=$?
[ $code = 1 ] && grep -q 'masu-view: the Vulkan device was lost twice in a row' out ||
    fail "lost twice: exit code $code: $(cat out)"
: > nothing.json
refuses 1 'nothing.json' nothing.json --size 60x45 --frames 1 --quit
left=$(find "${TMPDIR:-/tmp}" -maxdepth 1 -name 'masu-view-*' -newer display)
[ -z "$left" ] || fail "left behind: $left"

[ $failures = 0 ] && echo "masu-view does as it should" || echo "$failures failures"
exit $((failures != 0))
