#!/bin/bash
# stability.sh: writes docs/stability.md: what `masu conform --suite extreme` measures on each driver of
# $DRIVERS (system, lavapipe-25 and swiftshader). Results stay in $BUILD/stability; with KEEP=1 those that are there
# are not measured again. Exit 1: a case fails on a driver, or a driver is not to be had; the file is written all the
# same, and says which.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
out=$build/stability
drivers=${DRIVERS:-system lavapipe-25 swiftshader}
[ "$drivers" != all ] || drivers="system lavapipe-25 swiftshader"
failed=0
mkdir -p "$out"

measure() { # in a shell of its own: what a driver sets, the next does not see
    local icd
    icd=$(tests/drivers.sh "$1") || return 1
    [ -z "$icd" ] || export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
    export NODEVICE_SELECT=1 MASU_TEST_DRIVER=$1
    # shellcheck disable=SC1090
    [ ! -e "build/drivers/$1/env" ] || . "build/drivers/$1/env"
    "$build/tests/driver_info" > "$out/$1.driver" 2> /dev/null || echo "$1" > "$out/$1.driver"
    "$build/bin/masu" conform --suite extreme --scenes "${MADE:-$build}/scenes" --table "$out/$1.md" > "$out/$1.log"
}

for d in $drivers; do
    [ "${KEEP:-}" = 1 ] && [ -s "$out/$d.md" ] && continue
    echo "  STABILITY  $d"
    (measure "$d") || { echo "masu: stability: driver $d" >&2; failed=1; }
done
for d in $drivers; do
    [ -s "$out/$d.md" ] || failed=1
    ! grep -qE '^\| (fail|resource error) ' "$out/$d.md" || failed=1
done

# One row a case: what was measured on the first, the second, the third.
merged() {
    (cd "$out" && awk -F ' [|] ' -v drivers="$drivers" '
        FNR == 1 { files++ }
        { sub(/^[|] /, "", $1); sub(/ [|]$/, "", $5) }
        files == 1 { order[++n] = $2; row[$2] = "| " $2 " | " $3 " | " $4 " |" }
        $2 in row { row[$2] = row[$2] " " ($1 == "pass" ? "" : "**" $1 "** ") $5 " |" }
        END { for (i = 1; i <= n; i++) print row[order[i]] }' $(printf '%s.md ' $drivers))
}

{
    cat << 'END'
# Stability

Written by `make stability`: the suite of extreme cases (`masu conform --suite extreme`, [conform.md](conform.md)) on
each driver of the tests. A case passes where what must hold does; limits are a quarter above the worst of what was
measured on the three, so that what gets worse is seen. Bad numbers stand here as they are: a limit of 30 % is no
promise of quality, it says how bad the input is for the march.

`non_finite`: numbers in depth, radiance and velocity of all frames that are not finite, or depths outside of 0..1.
`replaced`: values that the guards at stores had to replace. `hitmiss_pct`: pixels in which the picture has something and
the field in double precision has nothing, or the other way round; `lost_pct`: the latter. `depth_p50`, `depth_p99`:
distance along the ray against the field's, relative. `steps`: the largest difference of a channel, of 255.

What is worst here: under 0.01 degrees a slab that is not met in closed form is lost in 28 % of the pixels, whose rays
use up their 2,048 steps; of a Lipschitz constant of 1,000, waves of a thousandth of the picture, 24 % of the pixels
hit where there is nothing. A field of view goes to 3.1 radians, 177.6 degrees; more is refused by name. The rungs that
change with each frame leave reflections that have gathered for 16 frames where those at rest have for 32: 48 of 255.

What else is extreme, and which test has it:

| input | what must hold | test |
|---|---|---|
| a scene of an SDF at 1e6 and 1e7 units: coverage, depth, material, velocity | as at the origin | `test_far` |
| parameters of an SDF of 1e30, 1e-40, NaN | finite pictures; what is not finite is refused by name | `test_stiff` |
| deep zooms to 1e-6, cameras in and on solids, sizes of zero, equal surfaces | the table of [the march](design/11-march-measured.md), `make stiff` | `test_stiff` |
| fields of NaN and infinity | a miss, and nothing beside it | `test_extremes` |
| roughness, all of it, against double precision | a bound on the lobe's error | `test_brdf`, `test_vndf` |
| each input image and buffer of each pass full of NaN, infinities, denormals, huge, negative | finite pictures; none keeps it. SwiftShader, which looks at no bounds, runs all but the reflections' inputs: of those one still ends the process | `test_poison` |
| images of more columns or rows than a frame draws, what lies beyond NaN in one component alone; down to 1x1 | the picture of a renderer of that size | `test_resize` |
| a mirror of textures at rest, 64 frames | the same to the bit; rougher surfaces take new rays in each frame | `test_specular_textures` |
| the n-th Vulkan call fails, in init, load, resize; a device that is lost; a block one byte short | a named error, nothing left behind | `test_failures`, `test_faults` |
| each limit of the description, and one over | refused by name, with the limit | `test_desc` |
| rungs, cameras, scenes, sizes at random, 20,000 frames | memory flat, pictures finite | `make soak` |

Memory that a driver takes: on Mesa 22.3.6 the process grows by 0.9 MB with each frame of `test_sky`, and by nothing in
`test_live` and `test_velocity`. It is the driver: frames recorded once and submitted again and again, with no call of
the library in between, grow by 930 KB each; the soak, a third of whose frames are of that scene, by 312 KB. All of it
belongs to one dispatch, that of `light` with an analytic sky: alone it takes 0.81 MB a frame, any other pass alone
nothing. What piles up are blocks of 32 KB that the driver's queue thread takes and keeps until the device is gone.
What it is in the shader has not been found. The newer lavapipe does not grow (0.02 KB a frame). SwiftShader takes
memory by leaps, of which too short a soak fails: over 900 frames 75 KB a frame, the bare loop 93 KB.

## Cases
END
    echo
    for d in $drivers; do echo "- \`$d\`: $(head -n 1 "$out/$d.driver")"; done
    echo
    printf '| case | input | what must hold |'
    printf ' %s |' $drivers
    printf '\n|---|---|---|'
    for d in $drivers; do printf '%s' '---|'; done
    echo
    merged
} > "$out/stability.md"
mv "$out/stability.md" docs/stability.md
for d in $drivers; do tail -n 1 "$out/$d.log"; done
exit $failed
