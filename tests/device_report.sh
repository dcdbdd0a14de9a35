#!/bin/bash
# device_report.sh DRIVER: what a GPU makes of Masu, in one folder to send in: docs/devices/NAME. DRIVER as in drivers.sh;
# `any` is whatever the Vulkan loader finds. $NAME: the folder's (that of the device); $MINUTES: for all of it (20), of
# which each step has a share; one that does not end in time is told so, and what it has written until then stays.
# $TESTS: programs of tests/gpu. Writes nothing else but below $BUILD. Exit 1: there is no such driver.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
driver=${1:-any}
icd=$(tests/drivers.sh "$driver") || exit 1
[ -z "$icd" ] || export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
export NODEVICE_SELECT=1 MASU_TEST_DRIVER=$driver
# shellcheck disable=SC1090
[ ! -e "build/drivers/$driver/env" ] || . "build/drivers/$driver/env"
info=$("$build/tests/driver_info") || { echo "masu: device-report: $info" >&2; exit 1; }
info+=${MASU_DENY:+, limits of MASU_DENY=$MASU_DENY}
name=${NAME:-$(tr -cs 'A-Za-z0-9.\n' '-' <<< "${info%%, Vulkan*}" | sed 's/^-*//; s/-*$//' | cut -c 1-60)}
case $name in '' | */* | .*) echo "masu: device-report: NAME is a folder's name, given is '$name'" >&2; exit 1 ;; esac
out=docs/devices/$name
start=$SECONDS budget=$((60 * ${MINUTES:-20}))
rm -rf "$out"
mkdir -p "$out/tests"

# step NAME PERCENT COMMAND...: at most that share of the time, its output to NAME.txt, a row for the sum
step() {
    local step=$1 share=$(($2 * budget / 100)) rc begun=$SECONDS
    shift 2
    local left=$((budget - SECONDS + start))
    [ "$share" -le "$left" ] || share=$left
    if [ "$share" -lt 2 ]; then
        echo "| $step | not begun: no time was left | 0 |" >> "$out/rows"
        return
    fi
    echo "  DEVICE  $step (up to $share s)"
    timeout -k 5 "$share" "$@" > "$out/$step.txt" 2>&1
    rc=$?
    case $rc in 0) rc=good ;; 124 | 137) rc="did not end in $share s" ;; *) rc="exit code $rc" ;; esac
    echo "| $step | $rc: $(tail -n 1 "$out/$step.txt" | tr '|' '/' | cut -c 1-120) | $((SECONDS - begun)) |" >> "$out/rows"
}

# As `make gpu` runs them: as many at a time as there are processors, for they measure nothing.
tests() {
    # shellcheck disable=SC2086
    DRIVERS=$driver MASU_TEST_TIMEOUT=120 tests/run.sh --gpu $TESTS
}

# The log of each program that has not ended well, or not at all.
keep_logs() {
    local log failed
    for log in "$build/test-results/$driver"/*.log; do
        [ -e "$log" ] || continue
        failed=1
        [ ! -s "${log%.log}.counts" ] || read -r _ failed _ < "${log%.log}.counts"
        [ "$failed" = 0 ] || cp "$log" "$out/tests/$(basename "$log" .log).txt"
    done
}

machine() {
    echo "$info"
    uname -srm
    grep -m 1 'model name' /proc/cpuinfo
    grep MemTotal /proc/meminfo
    git describe --always --dirty 2> /dev/null
    if command -v vulkaninfo > /dev/null; then vulkaninfo --summary 2> /dev/null; fi
    echo "$info"
}

export -f tests machine
export TESTS info out build driver
export BUILD=$build MADE=${MADE:-$build} MASU_EXPECT_DIR=tests/expect CC=${CC:-gcc} LONG=
export MASU_BAKED=$build/device-report
mkdir -p "$MASU_BAKED"
scenes=${MADE:-$build}/scenes
step machine 2 bash -c machine
step conform-smoke 15 "$build/bin/masu" conform --suite smoke --scenes "$scenes" --csv "$out/smoke.csv" --junit "$out/smoke.xml"
step conform-extreme 20 "$build/bin/masu" conform --suite extreme --scenes "$scenes" --csv "$out/extreme.csv" --table "$out/extreme.md"
step conform-full 15 "$build/bin/masu" conform --suite full --scenes "$scenes" --csv "$out/full.csv"
step ladder 3 "$build/bin/masu" plan "$scenes/engine.masu" --size 1920x1080 --ladder auto
step stats 5 "$build/bin/masu" render "$scenes/engine.masu" -o "$out/engine.png" --size 1920x1080 --time 0.8 --stats "$out/stats.json"
# What is measured until the time is up stays, and is gone on with.
step bench 15 "$build/bin/masu" bench "$scenes/engine.masu" --size 320x180 --positions 16 --reference 64 --frames 16 --runs 5 \
    --steady 0 --out "$out/bench"
rm -rf "${build:?}/test-results/$driver"
step tests 60 bash -c tests
keep_logs
{
    echo "# $name"
    echo
    echo "$info. Written by \`make device-report\` in $((SECONDS - start)) s."
    echo
    echo "| step | how it ended, and its last line | s |"
    echo "|---|---|---|"
    cat "$out/rows"
} > "$out/README.md"
rm -f "$out/rows"
echo "  $out: $(find "$out" -type f | wc -l) files, $(du -sk "$out" | cut -f 1) KB, $((SECONDS - start)) s"
