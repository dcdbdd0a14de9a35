#!/bin/bash
# The GPU tests of what has to do with optional features, once more on the driver that offers most, as on a device
# that offers none: MASU_DENY=all (platform/session.h). All pass, and no other tests are skipped than those named
# here, which are about a feature itself.
set -u
cd "$(dirname "$0")/../.." || exit 1
build=${BUILD:-build}
skips='a_frame_that_has_not_ended_has_no_times
an_apu_gets_one_block_of_the_type_that_is_both
one_type_for_everything_is_one_allocation_without_copies
timestamps_change_nothing_and_name_the_passes_that_ran
what_is_offered_and_not_enabled_is_told'
# Compressed blocks and anisotropy; ray queries; 16-bit floats; memory by role; timestamps.
tests='textures texture_order ray_query specular_textures upscale frame memory_kinds fixed_memory'

icd=$(tests/drivers.sh lavapipe-25) || exit 77
export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd NODEVICE_SELECT=1 MASU_TEST_DRIVER=lavapipe-25
# shellcheck disable=SC1091
[ ! -e build/drivers/lavapipe-25/env ] || . build/drivers/lavapipe-25/env
export MESA_SHADER_CACHE_DIR=$PWD/$build/cache/lavapipe-25${LP_NATIVE_VECTOR_WIDTH:+-$LP_NATIVE_VECTOR_WIDTH} CMOCKA_MESSAGE_OUTPUT=stdout MASU_DENY=all
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failures=0 passed=0 skipped=
for name in $tests; do
    program=$build/tests/gpu/test_$name
    [ -x "$program" ] || { echo "skipped: $program is not built" && exit 77; }
    timeout 600 "$program" > "$log" 2>&1
    code=$?
    here=$(sed -n 's/^\[  SKIPPED \] \([a-z_]*\)$/\1/p' "$log" | sort -u)
    passed=$((passed + $(grep -c '^\[       OK \]' "$log")))
    skipped+=$here${here:+$'\n'}
    [ $code = 0 ] || { failures=$((failures + 1)) && echo "FAILED: test_$name, $code:" && tail -n 20 "$log"; }
done
if [ "$(sort <<< "${skipped%$'\n'}")" != "$skips" ]; then
    failures=$((failures + 1))
    echo "FAILED: other tests than expected are skipped:"
    diff <(echo "$skips") <(sort <<< "${skipped%$'\n'}")
fi
echo "with every optional feature denied: $passed tests of $(wc -w <<< "$tests") programs pass; skipped:" $skipped
[ $failures = 0 ] && [ "$passed" -gt 40 ]
