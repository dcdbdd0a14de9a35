#!/bin/bash
# threads.sh: what runs in threads, under the thread sanitizer (make threads): four renderers on each of $DRIVERS,
# masu-bake with probes and textures, the double-precision field of masu bench. Drivers and libraries are not
# instrumented: tests/tsan.supp lists the libraries that are not checked. Exit 1: a report, or another failure.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
build=$(realpath "${BUILD:-build/thread}")
made=$(realpath "${MADE:-build}")
drivers=${DRIVERS:-system}
# SwiftShader, all in C++ and with schedulers of its own, is left out.
[ "$drivers" != all ] || drivers="system lavapipe-25"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp print_suppressions=0 exitcode=66 history_size=4 ${TSAN_OPTIONS:-}"
failed=0

# try NAME COMMAND...
try() {
    local name=$1 start=$SECONDS rc
    shift
    "$@" > "$folder/log" 2>&1 < /dev/null
    rc=$?
    printf '%-28s %4d s  exit %d, %d reports\n' "$name" $((SECONDS - start)) $rc \
        "$(grep -c 'WARNING: ThreadSanitizer' "$folder/log")"
    [ $rc = 0 ] || { head -n 60 "$folder/log" && failed=1; }
}

for driver in $drivers; do
    (
        icd=$(tests/drivers.sh "$driver") || exit 1
        export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd NODEVICE_SELECT=1 LP_NUM_THREADS=2
        # shellcheck disable=SC1090
        [ ! -e "build/drivers/$driver/env" ] || . "build/drivers/$driver/env"
        export MESA_SHADER_CACHE_DIR=$made/cache/$driver${LP_NATIVE_VECTOR_WIDTH:+-$LP_NATIVE_VECTOR_WIDTH}
        try "renderers, $driver" "$build/tests/threads" "$made/scenes/test_reserve.masu" "${FRAMES:-20}"
        [ $failed = 0 ]
    ) || failed=1
done

# Fewer rays than the scene has: each is followed by the same code.
sed 's/"rays": [0-9]*/"rays": 64/' tests/scenes/probe_room.json > "$folder/probes.json"
try "masu-bake, probes" "$build/bin/masu-bake" "$folder/probes.json" -o "$folder/probes.masu" --quiet
try "masu-bake, textures" "$build/bin/masu-bake" scenes/textures.json -o "$folder/textures.masu" --quiet \
    --texture-path "$made/textures"
icd=$(tests/drivers.sh system) || exit 1
export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd NODEVICE_SELECT=1 MESA_SHADER_CACHE_DIR=$made/cache/system
try "masu bench, field" "$build/bin/masu" bench "$made/stiff/blend.masu" --out "$folder/blend" --quick --quiet
exit $failed
