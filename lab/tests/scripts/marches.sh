#!/bin/bash
# masu conform --suite marches with the lab's programs: the marches plain, seed and checkerboard, baked with --variants,
# still have the errors of lab/suites/marches.json.
set -u
cd "$(dirname "$0")/../../.." || exit 1
bin=$(realpath "${BUILD:-build}/bin")
icd=$(tests/drivers.sh system) || exit 77
[ -z "$icd" ] || export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
export NODEVICE_SELECT=1
"$bin/masu" conform --suite marches
