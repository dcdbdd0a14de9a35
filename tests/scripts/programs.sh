#!/bin/bash
# What all programs do alike with files, without a driver: a FIFO is refused instead of waited for, outputs are checked
# before the work, names of other formats are refused, files of another program get a hint, closed standard streams and
# a full or limited disk harm no file, a clock that stands still is reported. masu-bake bakes a .sdf without a scene.
set -u
bin=$(realpath "${BUILD:-build}/bin")
tree=$PWD
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0
export VK_ICD_FILENAMES=/nonexistent.json # what is refused before a device is opened does not mention one

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# refuses CODE PATTERN PROGRAM ARGUMENTS...: within 10 s, by one line of stderr
refuses() {
    local code=$1 pattern=$2
    shift 2
    timeout 10 "$bin/$1" "${@:2}" > stdout 2> stderr
    local got=$?
    [ $got = "$code" ] || fail "$*: exit code $got, expected $code: $(cat stderr)"
    grep -q -e "$pattern" stderr || fail "$*: no \"$pattern\" in: $(cat stderr)"
    [ "${config:-}" = sanitize ] || [ "$(wc -l < stderr)" = 1 ] || fail "$*: not one line: $(cat stderr)"
}
left() { find . -name '*.part'; }

cat > field.sdf << 'END'
material red { albedo (0.8, 0.2, 0.1) }
material grey { albedo (0.4, 0.4, 0.4) }
part ball : red = translate((1, 2, 3), sphere(0.5));
part ground : grey = plane((0, 1, 0), 0);
END
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n' > tri.obj
echo '{"models": [{"file": "tri.obj"}]}' > scene.json
echo '{"format": 1, "cases": [{"name": "a", "scene": "s", "size": [8, 8]}]}' > suite.json
echo '{"rungs": [{"setting": "base"}]}' > ladder.json
"$bin/masu-bake" tri.obj --bare -o tri.masu --quiet || fail "tri.obj is not baked"
printf '\211PNG\r\n\032\n' > image.png
mkfifo fifo fifo.json fifo.png

# ---- FIFOs ---------------------------------------------------------------------------------------

file='regular file'
refuses 1 "$file" masu render fifo -o x.png
refuses 1 "$file" masu plan fifo
refuses 1 "$file" masu compare fifo fifo
refuses 1 "$file" masu upscale fifo x.png --size 8x8
refuses 1 "$file" masu bench --ladder fifo
refuses 1 "$file" masu conform --suite ./fifo --scenes .
refuses 1 "$file" masu render tri.masu -o x.png --ladder fifo
refuses 1 "$file" masu-bake fifo -o x.masu
refuses 1 "$file" masu-bake fifo.json -o x.masu
refuses 1 "$file" masu-sdfc fifo
refuses 1 "$file" masu-meso fifo -o x
refuses 1 "$file" masu-meso fifo.png --height 1 -o x
refuses 1 'no program reads from this FIFO' masu render tri.masu -o fifo
refuses 1 'no program reads from this FIFO' masu-bake tri.obj -o fifo
refuses 1 'no program reads from this FIFO' masu-sdfc field.sdf --glsl fifo
printf 'newmtl m\nmap_Kd fifo.png\n' > fifo.mtl
printf 'mtllib fifo.mtl\nusemtl m\nvt 0 0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1 2/1 3/1\n' > textured.obj
timeout 10 "$bin/masu-bake" textured.obj --bare -o x.masu --quiet 2> stderr || fail "a FIFO as a texture: $(cat stderr)"
grep -q 'fifo.png.*regular file' stderr || fail "a FIFO as a texture: $(cat stderr)"

# ---- Outputs -------------------------------------------------------------------------------------

for name in x.jpg x.hdr x.masu; do
    refuses 2 'ends in .*, expected one that ends in .png, .pfm or .exr, the only formats' masu render tri.masu -o $name
    refuses 2 'expected one that ends in .png' masu upscale image.png $name --size 8x8
    refuses 2 'expected one that ends in .png' masu compare image.png image.png --map $name
done
refuses 2 'expected one that ends in .masu' masu-bake tri.obj -o x.glb
refuses 2 'expected one that ends in .masu' masu-bake scene.json -o scene.json
[ ! -f "$bin/masu-view" ] || refuses 2 'expected one that ends in .png' masu-view tri.masu --frames 1 --screenshot x.bmp
echo 'frame 1 screenshot x.jpg' > shot.script
[ ! -f "$bin/masu-view" ] || refuses 1 'expected a name that ends in .png' masu-view tri.masu --script shot.script
for option in "-o no/x.png" "-o x.png --stats no/x.json" "-o x.png --times no/x.csv"; do
    # shellcheck disable=SC2086
    refuses 1 '^masu render: no/x.*: cannot write: No such file' masu render tri.masu $option
done
refuses 1 '^masu upscale: no/x.png: cannot write: No such file' masu upscale image.png no/x.png --size 8x8
refuses 1 '^masu bench: no/x.png: cannot write: No such file' masu bench tri.masu --out b --truth no/x.png
refuses 1 '^masu-bake: no/x.masu: cannot write: No such file' masu-bake tri.obj -o no/x.masu
refuses 1 '^masu-bake: no/x.json: cannot write: No such file' masu-bake tri.obj -o x.masu --stats no/x.json
refuses 1 '^masu-sdfc: no/x.c: cannot write: No such file' masu-sdfc field.sdf --glsl x.glsl --c no/x.c
[ ! -e x.glsl ] || fail "masu-sdfc has written one of two files"
refuses 1 '^masu-meso: no/x_color.png: cannot write: No such file' masu-meso --make grass -o no/x
mkdir read && touch read/x.png && chmod 444 read/x.png
[ -w read/x.png ] || refuses 1 'Permission denied' masu render tri.masu -o read/x.png

# ---- Files of other programs ---------------------------------------------------------------------

refuses 1 'a scene description: .masu-bake' masu render scene.json -o x.png
refuses 1 'an SDF: .masu-bake' masu plan field.sdf
refuses 1 'a model: .masu-bake' masu bench tri.obj --out b
refuses 1 'a suite, for .masu conform' masu render suite.json -o x.png
refuses 1 'an image, for .masu compare' masu render image.png -o x.png
refuses 1 'a baked scene, for .masu render' masu compare tri.masu tri.masu
refuses 1 'a baked scene, for .masu render' masu upscale tri.masu x.png --size 8x8
refuses 1 'a suite, for .masu conform' masu render tri.masu -o x.png --ladder suite.json
refuses 1 'a scene description' masu conform --suite scene.json --scenes .
refuses 1 'a quality ladder, for --ladder' masu conform --suite ladder.json --scenes .
refuses 1 'a baked scene, for .masu render' masu-bake tri.masu -o x.masu
refuses 1 'an image' masu-bake image.png -o x.masu
refuses 1 'a suite, for .masu conform' masu-bake suite.json -o x.masu
refuses 1 'a scene description: .masu-bake' masu-sdfc scene.json
refuses 1 'a model: .masu-bake' masu-sdfc tri.obj
refuses 1 'a baked scene, for .masu render' masu-sdfc tri.masu
refuses 1 'a scene description: .masu-bake' masu-meso scene.json -o x
refuses 1 'a baked scene, for .masu render' masu-meso tri.masu -o x

# ---- A .sdf without a scene ----------------------------------------------------------------------

"$bin/masu-bake" field.sdf --bare -o field.masu --quiet 2> stderr || fail "field.sdf: $(cat stderr)"
[ "$(head -c 4 field.masu)" = MASU ] || fail "field.sdf gives no blob"
echo 'part broken = sphere(' > broken.sdf
timeout 10 "$bin/masu-bake" broken.sdf -o x.masu > stdout 2> stderr && fail "broken.sdf is accepted"
[ "$(grep -c '^masu-bake: broken.sdf:2:1: ' stderr)" = 1 ] || fail "broken.sdf: $(cat stderr)"

# ---- Closed streams, limits, signals -------------------------------------------------------------

"$bin/masu-bake" tri.obj --bare -o closed.masu --quiet <&- >&- || fail "masu-bake fails without standard streams"
cmp tri.masu closed.masu || fail "masu-bake writes another file without standard streams"
"$bin/masu-bake" tri.obj --bare -o closed.masu <&- >&- 2>&-
cmp tri.masu closed.masu || fail "masu-bake writes another file without standard streams"
"$bin/masu-sdfc" field.sdf --c open.c --quiet && "$bin/masu-sdfc" field.sdf --c closed.c <&- >&- 2>&-
cmp open.c closed.c || fail "masu-sdfc writes another file without standard streams"
"$bin/masu-sdfc" --help >&- 2> stderr && fail "a closed standard output is not noticed"

if [ "${config:-}" != sanitize ]; then
    { for i in $(seq 300); do echo "v $i 0 0"; done; for i in $(seq 298); do echo "v $i 1 0"; echo "f $i $((i + 1)) -1"; done; } > large.obj
    (ulimit -f 2; exec "$bin/masu-bake" large.obj --bare -o limited.masu --quiet) 2> stderr && fail "a limit of 2 KiB is not noticed"
    grep -q 'limited.masu: File too large' stderr || fail "limit of file size: $(cat stderr)"
    (ulimit -f 2; exec "$bin/masu-sdfc" field.sdf --glsl limited.glsl --quiet) 2> stderr && fail "a limit of 2 KiB is not noticed"
    grep -q 'limited.glsl: cannot write: File too large' stderr || fail "limit of file size: $(cat stderr)"
    text=$(ulimit -f 0; exec "$bin/masu-bake" field.sdf --bare -o limited.masu --quiet 2>&1) && fail "a limit of 0 bytes is not noticed"
    [[ $text = *': File too large' ]] || fail "limit of file size, a short text: $text"
fi
[ -z "$(left)" ] || fail "left: $(left)"

# ---- A clock that stands still -------------------------------------------------------------------

cat > still.c << 'END'
#include <time.h>
int clock_gettime(clockid_t clock, struct timespec *t) { (void)clock; *t = (struct timespec){1000, 0}; return 0; }
END
if [ "${config:-}" != sanitize ] && ${CC:-gcc} -shared -fPIC still.c -o still.so 2> /dev/null; then
    still='the clock .* does not advance'
    LD_PRELOAD=$folder/still.so refuses 1 "$still" masu render tri.masu --times -
    LD_PRELOAD=$folder/still.so refuses 1 "$still" masu render tri.masu --target-ms 10
    LD_PRELOAD=$folder/still.so refuses 1 "$still" masu bench tri.masu --out b
    LD_PRELOAD=$folder/still.so timeout 60 "$bin/masu-bake" tri.obj --bare -o x.masu --quiet 2> stderr ||
        fail "masu-bake without a clock: $(cat stderr)"
fi

# ---- Reports of masu conform without a device ----------------------------------------------------

mkdir scenes && cp tri.masu scenes/s.masu
refuses 1 'masu conform: ' masu conform --suite suite.json --scenes scenes --junit r.xml --csv r.csv --table r.md --images i/j
[ -d i/j ] || fail "--images does not create its folder"
grep -q 'tests="1" failures="0" errors="1"' r.xml || fail "r.xml: $(cat r.xml)"
grep -q '<error message="[^"]*Vulkan' r.xml || fail "r.xml does not say why: $(cat r.xml)"
grep -q '^"a","s",8,8,not run,' r.csv || fail "r.csv: $(cat r.csv)"
grep -q '^| not run | a 8x8 ' r.md || fail "r.md: $(cat r.md)"
python3 -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' r.xml 2> /dev/null || ! command -v python3 > /dev/null ||
    fail "r.xml is no XML"
# A driver that crashes when it is opened; test_conform.c has an end during a case.
echo 'void abort(void); void *vk_icdGetInstanceProcAddr(void *i, const char *name) { (void)i; (void)name; abort(); return 0; }' > crash.c
if [ "${config:-}" != sanitize ] && ${CC:-gcc} -shared -fPIC crash.c -o crash.so 2> /dev/null; then
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s/crash.so", "api_version": "1.1.0"}}' "$folder" > crash.json
    rm r.xml r.csv r.md
    (VK_ICD_FILENAMES=$folder/crash.json VK_DRIVER_FILES=$folder/crash.json exec "$bin/masu" conform --suite suite.json \
        --scenes scenes --junit r.xml --csv r.csv --table r.md > stdout 2>&1) 2> /dev/null && fail "the driver does not crash"
    grep -q 'type="not run"' r.xml && grep -q '</testsuites>' r.xml && grep -q ',not run,' r.csv && grep -q '^| not run ' r.md ||
        fail "after a crash of the driver: $(cat r.xml r.csv r.md)"
fi
refuses 1 '1 of 1 scenes are not baked in i (s): .make scenes' masu conform --suite suite.json --scenes i --junit r.xml
grep -q '<error message="1 of 1 scenes' r.xml || fail "r.xml does not say why: $(cat r.xml)"
refuses 1 'tri.obj/x: cannot create the folder' masu conform --suite suite.json --scenes scenes --images tri.obj/x

# The programs find the suites that the build has put beside them, also if masu alone was built.
make -C "$tree" -n "BUILD=$folder/other" "$folder/other/bin/masu" > plan 2> /dev/null
grep -q 'cp suites/smoke.json' plan || fail "masu is built without its suites"

[ $failures = 0 ] && echo "programs: all as expected"
[ $failures = 0 ]
