#!/bin/bash
# Checks the names of commands and options of masu-lab in the documents: tests/scripts/docs.sh with the lab's program.
set -u
cd "$(dirname "$0")/../../.." || exit 1
LAB_PROGRAM=$(realpath "${BUILD:-build}/bin/masu-lab")
BUILD=${MADE:-build}
export LAB_PROGRAM BUILD
exec tests/scripts/docs.sh
