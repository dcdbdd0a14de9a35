#!/bin/bash
# isa.sh: checks the output of RADV's compiler for the pipelines against lab/notes/isa.csv: no spill to memory, no more
# scalar registers kept in vector registers, no scratch memory, at most 5 % more instructions, the same pipelines
# (make isa-table rewrites it). Then the errors of masu-lab isa.
set -u
build=${BUILD:-build} made=${MADE:-build}
lab=$build/bin/masu-lab
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

fail() {
    echo "$1"
    failed=1
}

# refuses CODE TEXT ARGUMENTS...: checks the exit code, and that a line contains TEXT
refuses() {
    local out code
    out=$("$lab" "${@:3}" 2>&1 > /dev/null)
    code=$?
    [ "$code" = "$1" ] && [[ $out == *"$2"* ]] || fail "masu-lab ${*:3}: exit code $code, $out"
}

# worse TABLE NEW: a line for each number that is higher in NEW
worse() {
    awk -F, '
        FNR == 1 { next }
        { key = $1 "," $2 "," $3 "," $4 }
        NR == FNR { if ($2 == "vangogh" || $2 == "raven") was[key] = $8; scalars[key] = $14; next }
        { seen[key] = 1 }
        !(key in was) { print key ": no row in the table"; next }
        $8 > was[key] * 1.05 { print key ": instructions " $8 ", in the table " was[key] }
        $12 > 0 || $14 > scalars[key] + 0 || $15 > 0 { print key ": spills " $12 ", of scalars " $14 ", scratch " $15 }
        END { for (key in was) if (!(key in seen)) print key ": no pipeline any more" }' "$1" "$2"
}

# The child's compiler does not need the tests' driver.
BUILD=$build MADE=$made lab/isa/table.sh vangogh,raven > "$folder/new.csv" || fail 'table.sh fails'
worse lab/notes/isa.csv "$folder/new.csv" > "$folder/worse"
[ ! -s "$folder/worse" ] || fail "$(cat "$folder/worse")
make isa-table rewrites lab/notes/isa.csv, if that is intended"

# The comparison finds more instructions and spills.
sed 's/^\(engine,raven,easu,[^,]*,[^,]*,[^,]*,[^,]*\),[0-9]*,/\1,9999,/' "$folder/new.csv" > "$folder/more.csv"
worse "$folder/new.csv" "$folder/more.csv" | grep -q '^engine,raven,easu,.*9999' || fail 'more instructions are not seen'
sed 's/^\(engine,raven,rcas\(,[^,]*\)\{8\}\),0,/\1,3,/' "$folder/new.csv" > "$folder/spill.csv"
worse "$folder/new.csv" "$folder/spill.csv" | grep -q '^engine,raven,rcas,.*spills 3' || fail 'a spill is not seen'

scene=$made/scenes/engine.masu
"$lab" isa --gpu=help | grep -q 'vangogh.*RADV' || fail 'no list of GPUs'
"$lab" isa "$scene" --gpu vangogh,raven --json > "$folder/json" || fail 'no JSON'
grep -q '"raven": \[' "$folder/json" && grep -q '"pipeline": "march"' "$folder/json" || fail 'JSON without rows'
refuses 2 'no GPU is given' isa "$scene"
refuses 2 "there is no GPU 'gtx'" isa "$scene" --gpu gtx
refuses 2 'unknown option --drawn' isa "$scene" --gpu vangogh --drawn 64x48
refuses 1 'cannot' isa "$folder/none.masu" --gpu vangogh
MASU_ISA_DRIVERS='' refuses 1 'MASU_ISA_DRIVERS is to name the folder' isa "$scene" --gpu tgl
MASU_ISA_DRIVERS=$folder refuses 1 "has no $folder/libvulkan_intel.so" isa "$scene" --gpu kbl
# If a driver ends the child, the error is only the driver's message.
printf '#include <stdio.h>\n#include <stdlib.h>\nint vk_icdNegotiateLoaderICDInterfaceVersion(unsigned *v) {
    (void)v; fputs("driver: this chip is not known\\n", stderr); exit(7); }\n' > "$folder/driver.c"
mkdir "$folder/drivers"
: > "$folder/shim.c"
if gcc -shared -fPIC "$folder/driver.c" -o "$folder/drivers/libvulkan_intel.so" 2> /dev/null; then
    gcc -shared -fPIC "$folder/shim.c" -o "$folder/drivers/libintel_noop_drm_shim.so"
    MASU_ISA_DRIVERS=$folder/drivers refuses 1 'kbl: exit code 7: driver: this chip is not known' isa "$scene" --gpu kbl
fi
exit $failed
