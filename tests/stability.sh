#!/bin/bash
# stability.sh: writes docs/stability.md from `masu conform --suite extreme`, run on each driver of $DRIVERS
# (system, lavapipe-25 and swiftshader). Results are kept in $BUILD/stability; KEEP=1 reuses existing ones.
# Exit 1: a case fails on a driver, or a driver is not available. The file is written anyway and marks failed cases.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
out=$build/stability
drivers=${DRIVERS:-system lavapipe-25 swiftshader}
[ "$drivers" != all ] || drivers="system lavapipe-25 swiftshader"
failed=0
mkdir -p "$out"

measure() { # runs in a subshell, so that one driver's environment does not affect the next
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

# One row per case, with the results of all drivers.
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

This page lists extreme inputs, the conditions that must hold for them, and the values measured on each driver of the
tests. `make stability` generates it from the suite of extreme cases (`masu conform --suite extreme`,
[conform.md](conform.md)). A case passes if its conditions hold. Limits are a quarter above the worst value measured on
the three drivers, so that a regression is detected. A limit of 30 % is therefore no promise of quality; it shows how
difficult the input is for sphere tracing.

| metric | meaning |
|---|---|
| `non_finite` | number of values in depth, radiance and velocity of all frames that are not finite, or depths outside of 0..1 |
| `replaced` | number of values that the guards at image stores had to replace |
| `hitmiss_pct` | percentage of pixels in which the image has a surface and the double-precision field has none, or vice versa |
| `lost_pct` | percentage of pixels in which only the double-precision field has a surface |
| `depth_p50`, `depth_p99` | percentiles of the relative error of the distance along the ray |
| `steps` | largest difference of a colour channel, of 255 |

The worst results:

- At a grazing angle of 0.01 degrees, a slab without a closed-form intersection is lost in 28 % of the pixels: their
  rays use all of their 2,048 steps.
- With a Lipschitz constant of 1,000 (waves of a thousandth of the image), 24 % of the pixels hit a surface where none
  is.
- With a different rung in each frame, reflections have accumulated over 16 frames instead of 32, and differ by up to 48
  of 255.

The largest field of view is 3.1 radians (177.6 degrees); a larger one is an error with a message that names it.

Other extreme inputs have their own tests:

| input | condition | test |
|---|---|---|
| an SDF scene at 1e6 and 1e7 units: coverage, depth, material, velocity | same as at the origin | `test_far` |
| SDF parameters of 1e30, 1e-40, NaN | finite images; an error names values that are not finite | `test_stiff` |
| deep zooms to 1e-6, cameras in and on solids, sizes of zero, equal surfaces | the table of [sphere tracing](design/05-sphere-tracing.md), `make stiff` | `test_stiff` |
| fields of NaN and infinity | a miss, without effect on other pixels | `test_extremes` |
| the whole range of roughness, against double precision | bounded error of the lobe | `test_brdf`, `test_vndf` |
| each input image and buffer of each pass filled with NaN, infinities, denormals, huge and negative values | finite images, and no pass keeps the values. On SwiftShader, which does not check bounds, all but the inputs of reflections are tested: one of these still crashes the process | `test_poison` |
| images with more columns or rows than a frame draws, down to 1x1; the rest is NaN in one component | same as the image of a renderer of that size | `test_resize` |
| a static view of textured mirrors, 64 frames | bit-identical; rougher surfaces use new rays in each frame | `test_specular_textures` |
| failure of the n-th Vulkan call in init, load and resize; device loss; a memory block that is one byte too small | an error with a name, and no leaks | `test_failures`, `test_faults` |
| each limit of `masu_desc`, and one above it | an error that names the limit | `test_desc` |
| random rungs, cameras, scenes and sizes, 20,000 frames | constant memory, finite images | `make soak` |
| scenes with random bytes changed and the hash made to fit, 3,000 on lavapipe 25 | one line of refusal, or finite images and a silent validation layer | `test_mutated`: `LONG=1`, `MUTATED=500` |
| broken models, drawn on any driver | one line of refusal, or an image | `make hostile RENDER=1 DRIVERS=lavapipe-25` |
| four renderers in four threads, the threads of the programs | no report of the thread sanitizer; the same pixels as alone | `make threads` |

**Driver memory.** On Mesa 22.3.6 the process grows by 0.9 MB per frame of `test_sky`, and not at all in `test_live` and
`test_velocity`. The driver causes this: frames that are recorded once and submitted repeatedly, without calls of the
library, grow by 930 KB each. The soak test, in which a third of the frames use that scene, grows by 312 KB. A single
dispatch is responsible: `light` with an analytic sky. By itself it grows by 0.81 MB per frame; every other pass by
itself does not grow. The driver's queue thread allocates blocks of 32 KB and keeps them until the device is destroyed.
The cause in the shader is unknown. The newer lavapipe does not grow (0.02 KB per frame). SwiftShader allocates memory
in large steps, which fails a soak test that is too short: over 900 frames it grows by 75 KB per frame, and the
submission loop by 93 KB.

## Cases
END
    echo
    for d in $drivers; do echo "- \`$d\`: $(head -n 1 "$out/$d.driver")"; done
    echo
    printf '| case | input | condition |'
    printf ' %s |' $drivers
    printf '\n|---|---|---|'
    for d in $drivers; do printf '%s' '---|'; done
    echo
    merged
} > "$out/stability.md"
mv "$out/stability.md" docs/stability.md
for d in $drivers; do tail -n 1 "$out/$d.log"; done
exit $failed
