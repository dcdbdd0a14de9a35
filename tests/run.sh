#!/bin/bash
# run.sh --unit PROGRAM... --script FILE... --fuzz PROGRAM... --gpu PROGRAM...: runs tests, counts
# them, says what failed.
#
# Unit and GPU programs are cmocka groups: each of their tests counts. A script or a fuzzer counts
# as one. A program that dies, times out, ends before its last test or fails after it is a failure
# of its own. GPU programs run once for each driver of $DRIVERS (see drivers.sh; "all" is the three
# that CI uses).
#
# The last line is `N passed, N failed`; exit 0 only if none failed and some passed. Skips and known
# faults of drivers (tests/expect/README.md) are counted on the line before. Logs and JUnit XML go
# to $BUILD/test-results/.
#
# MASU_REQUIRE_DRIVERS=1   a driver that is not there, and a test that is skipped, is a failure
# MASU_TEST_TIMEOUT=600    seconds for each program; three times as many for tests/full, which builds the
#                          tree anew
# LONG=1                   tests that try many of a kind try all, and tests of programs run on all drivers;
#                          CI does not
# NESTED=1                 the tests are those of the tree built anew: what takes long does a part
# MASU_TEST_JOBS=N         programs at a time; default: processors + 1, because a program mostly runs one thread and
#                          is idle for a tenth of its time
#
# No side of a frame, of its half or quarter should be a power of two (good: 160x90, 96x66, 66x48):
# lavapipe compiles a shader once for images of such sides and once for others, and all tests share
# what is compiled.
#
# A test runs in the root of the tree and sees BUILD, MADE, MASU_EXPECT_DIR and, with a driver,
# MASU_TEST_DRIVER, MASU_DRIVER_INFO (one line: name and version), VK_DRIVER_FILES.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C

build=${BUILD:-build}
results=$build/test-results
timeout=${MASU_TEST_TIMEOUT:-600}
require=${MASU_REQUIRE_DRIVERS:-}
[ "$require" != 0 ] || require=
drivers=${DRIVERS:-system}
[ "$drivers" != all ] || drivers="system lavapipe-25 swiftshader"
jobs=${MASU_TEST_JOBS:-$(($(nproc) + 1))}
# Tests of programs, of what a validation layer says of shaders, and of the host alone hardly depend on the driver: the
# first driver that is there runs them.
once=" test_bench test_cli test_gpu_av test_mutated test_reference test_soak "
# Of all three drivers the first runs every test. The others leave out what stands here, which LONG=1 runs too.
# lavapipe 25: decisions of the host; means over many rays and filters; what tests/full/denied.sh runs on it (frame,
# fixed_memory, upscale); what SwiftShader runs as well (area_lights, far, output, picture_sky, poison, smaa,
# stiff, tone, trace, velocity).
not_lavapipe_25=" test_ao test_area_lights test_bounce test_calls test_devices test_failures test_far test_faults test_fixed_memory "
not_lavapipe_25+="test_frame test_gltf_pictures test_governor test_governor_host test_host_pass test_ladder test_live "
not_lavapipe_25+="test_live_environment test_load test_local_shadows test_meshes test_occlusion test_output test_pick "
not_lavapipe_25+="test_picture_sky test_poison test_reserve test_resize test_sdf_casters test_shadow test_shadow_frames "
not_lavapipe_25+="test_small_lamps test_smaa test_specular_filters test_specular_sdf test_specular_truth test_stiff "
not_lavapipe_25+="test_temporal test_terms test_tone test_trace test_truth test_upscale test_velocity test_window "
# SwiftShader takes four times as long to draw. It leaves out decisions of the host and comparisons of many frames:
# test_conform draws every pass there, test_poison gives each pass hostile bits, test_stiff marches.
not_swiftshader=" test_ao test_bounce test_calls test_culling test_devices test_failures test_faults test_fixed_memory "
not_swiftshader+="test_frame test_gltf_pictures test_governor test_governor_host test_host_pass test_instance_looks test_ladder "
not_swiftshader+="test_lights test_live test_live_environment test_live_textures test_load test_local_shadows test_lods "
not_swiftshader+="test_memory_kinds test_meshes "
not_swiftshader+="test_occluders test_occlusion test_pick test_pool test_post test_reinit test_reserve test_resize "
not_swiftshader+="test_sdf_casters test_shadow test_shadow_frames test_skin test_small_lamps "
not_swiftshader+="test_specular_filters test_specular_sdf test_specular_textures test_specular_truth "
not_swiftshader+="test_sprites test_temporal test_terms test_texture_order test_transparents test_truth "
not_swiftshader+="test_viewports test_window "

# These programs spend more time on compiling shaders than on drawing. On the system driver their shaders are compiled
# for vectors of 128 bits and without LLVM's optimiser, as lavapipe 25 compiles those of all tests (tests/drivers.sh).
compiled=" test_cli test_devices test_gltf_pictures test_gpu_av test_upscale "

# A rasteriser's own threads are in the way of the programs beside it: a tenth of the time.
export LP_NUM_THREADS=${LP_NUM_THREADS-0}
export LONG=${LONG:-} BUILD=$build MADE=${MADE:-$build} MASU_EXPECT_DIR=tests/expect
export CMOCKA_MESSAGE_OUTPUT=stdout
export PATH=$PWD/tests/cached:$PATH
# Scripts that call make again start from a clean slate, not inside the make that runs this.
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES

declare -A programs=([unit]="" [script]="" [fuzz]="" [gpu]="")
kind=
for argument; do
    case $argument in
        --unit | --script | --fuzz | --gpu) kind=${argument#--} ;;
        *) programs[${kind:?}]+=" $argument" ;;
    esac
done

# Reads the log of a cmocka program; prints `pass|fail|skip|crash NAME` per test, then `end` if the
# group came to its end. The marks may stand anywhere in a line: what a test prints without a
# newline stands before them.
# shellcheck disable=SC2016
read_cmocka='
/\[ RUN      \] / { sub(/.*\[ RUN      \] /, ""); running = $0; next }
/\[       OK \] / { print "pass", running; running = ""; next }
/\[  SKIPPED \] / { if (running != "") print "skip", running; running = ""; next }
/\[  FAILED  \] / { print "fail", running != "" ? running : "(group)"; running = ""; next }
/\[  ERROR   \] / && $NF == running { print "fail", running; running = ""; next }
/\[==========\] [0-9]+ test\(s\) run/ { print "end"; exit }
END { if (running != "") print "crash", running }'

# The part of the log that belongs to one test.
# shellcheck disable=SC2016
cut_cmocka='
index($0, "[ RUN      ] ") { on = substr($0, index($0, "] ") + 2) == name }
/^\[==========\] [0-9]+ test\(s\) run/ { exit }
on'

indented() {
    tail -n 60 | cut -c 1-400 | sed 's/^/      | /'
}

# known_fault DRIVER PROGRAM TEST: whether tests/expect/DRIVER-fails.txt lists it for this version
known_fault() {
    local file=tests/expect/$1-fails.txt version test
    [ -e "$file" ] || return 1
    while IFS=$'\t' read -r version test _; do
        [[ -z $version || $version == '#'* ]] && continue
        [[ ${MASU_DRIVER_INFO:-} == *"$version"* && $2/$3 == "$test" ]] && return 0
    done < "$file"
    return 1
}

escaped() {
    sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g; s/"/\&quot;/g' | tr -d '\000-\010\013\014\016-\037'
}

# testcase CLASS TEST FAULT: one element of JUnit XML
testcase() {
    printf '<testcase classname="%s" name="%s">' "$1" "$(escaped <<< "$2")"
    [ -z "$3" ] || printf '<failure message="%s"/>' "$(escaped <<< "$3")"
    printf '</testcase>\n'
}

# run KIND DRIVER PROGRAM: runs it, prints its line and what went wrong, leaves its counts in
# $results/DRIVER/NAME.counts
run() {
    local kind=$1 driver=$2 program=$3
    local name log rc seconds user system cpu word test verdict=ok trouble='' ended='' died='' fault
    local p=0 f=0 s=0 k=0 tests=() notes=() arguments=()
    # shellcheck disable=SC1090
    [ "$kind" != gpu ] || . "$results/$driver.env"
    name=$(basename "$program" .sh)
    if [[ $kind$driver == gpusystem && $compiled == *" $name "* ]]; then
        export LP_NATIVE_VECTOR_WIDTH=128 GALLIVM_PERF=nopt MESA_SHADER_CACHE_DIR=$cache/system-128
        mkdir -p "$MESA_SHADER_CACHE_DIR"
    fi
    log=$results/$driver/$name.log
    mkdir -p "$results/$driver"
    local seeds=SEEDS_$name
    # shellcheck disable=SC2206
    [ "$kind" != fuzz ] || arguments=(${!seeds:-})
    local limit=$timeout
    [[ $program != */full/* ]] || limit=$((3 * timeout))

    # Of the three times the last line is taken: what bash says of a program that dies stands before
    # them, and is said better below.
    read -r rc seconds user system < <(
        TIMEFORMAT='%2R %2U %2S'
        { time timeout -k 10 "$limit" "$program" "${arguments[@]}" &> "$log" < /dev/null; } \
            2> "$results/$driver/$name.times"
        echo "$? $(tail -n 1 "$results/$driver/$name.times")"
    )
    cpu=$(awk "BEGIN { printf \"%.2f\", $user + $system }")
    echo "$cpu $seconds $name $driver" > "$results/$driver/$name.times"

    if [ "$kind" = unit ] || [ "$kind" = gpu ]; then
        mapfile -t tests < <(awk "$read_cmocka" "$log")
    elif [ $rc = 0 ]; then
        tests=("pass $name" end)
    elif [ $rc = 77 ]; then
        tests=("skip $name" end)
    else
        tests=("fail $name" end)
    fi

    for test in "${tests[@]}"; do
        word=${test%% *}
        test=${test#* }
        [ "$word" != end ] || { ended=1 && continue; }
        [ "$word" != crash ] || died=1
        fault=
        if [ "$word" = pass ]; then
            p=$((p + 1))
            if [ "$kind" = gpu ] && known_fault "$driver" "$name" "$test"; then
                p=$((p - 1)) fault="passed, though $driver-fails.txt lists it"
            fi
        elif [ "$word" = skip ]; then
            fault=skipped
            [ "$require" ] || { s=$((s + 1)) && fault='' && notes+=("skipped: $test"); }
        elif [ "$kind$word" = gpufail ] && known_fault "$driver" "$name" "$test"; then
            k=$((k + 1)) && notes+=("known fault of this driver: $test")
        else
            fault=failed
            [ "$word" != crash ] || fault="died in it"
        fi
        [ -z "$fault" ] || { f=$((f + 1)) && notes+=("$fault: $test"); }
        testcase "$driver.$name" "$test" "$fault"
    done > "$results/$driver/$name.cases"

    # Programs fail in more ways than their tests do.
    if [ $rc = 124 ] || [ $rc = 137 ]; then
        trouble="timed out after $limit s"
    elif [ -z "$ended" ]; then
        trouble="ended early with exit code $rc"
    elif [ ${#tests[@]} = 1 ]; then
        trouble="ran no test"
    elif [ $rc != 0 ] && [ $((f + k + s)) = 0 ]; then
        trouble="every test passed, but the exit code is $rc"
    fi
    if [ "$trouble" ]; then
        [ "$died" ] || f=$((f + 1))
        testcase "$driver.$name" program "$trouble" >> "$results/$driver/$name.cases"
    fi

    [ $p != 0 ] || verdict=skip
    [ $f = 0 ] || verdict=FAIL
    printf '  %-4s  %-28s %-12s %4d passed, %d failed  %8s s %8s s CPU\n' \
        "$verdict" "$name" "$driver" $p $f "$seconds" "$cpu"
    for test in "${notes[@]}"; do
        echo "    $test"
        [ "$kind" = script ] || [ "$kind" = fuzz ] ||
            awk -v name="${test#*: }" "$cut_cmocka" "$log" | indented
    done
    [ -z "$trouble" ] || echo "    $trouble"
    case $trouble$kind in
        unit | gpu) ;;
        script | fuzz) [ $((f + s)) = 0 ] || indented < "$log" ;;
        *) indented < "$log" ;;
    esac
    {
        printf '<testsuite name="%s.%s" time="%s" ' "$driver" "$name" "$seconds"
        printf 'tests="%d" failures="%d" skipped="%d">\n' $((p + f + s + k)) $f $((s + k))
        cat "$results/$driver/$name.cases"
        printf '<system-out>%s</system-out>\n</testsuite>\n' "$(tail -n 200 "$log" | escaped)"
    } > "$results/$driver/$name.xml"
    rm "$results/$driver/$name.cases"
    echo "$p $f $s $k" > "$results/$driver/$name.counts"
}

# start KIND DRIVER PROGRAM: run, beside at most $jobs - 1 others; what it prints comes in one piece
start() {
    while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n; done
    {
        text=$(run "$@")
        printf '%s\n' "$text"
    } &
}

# use DRIVER: sets the environment for it. 1: it is not there, and $reason says why. A name that is
# no driver's is a mistake, not a missing driver.
use() {
    local icd
    icd=$(tests/drivers.sh "$1" 2> "$results/$1.fetch") || {
        [ $? != 2 ] || require=1
        reason=$(tail -n 1 "$results/$1.fetch")
        return 1
    }
    [ -z "$icd" ] || export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
    # One driver is visible: there is nothing to select, and Mesa's layer for that opens displays.
    export MASU_TEST_DRIVER=$1 NODEVICE_SELECT=1
    # shellcheck disable=SC1090
    [ ! -e "build/drivers/$1/env" ] || . "build/drivers/$1/env"
    # Compiled shaders stay with the build, not in the home of the user. Those for another width of vectors are not
    # told apart in the driver's cache, and crash.
    export MESA_SHADER_CACHE_DIR=$cache/$1${LP_NATIVE_VECTOR_WIDTH:+-$LP_NATIVE_VECTOR_WIDTH}
    mkdir -p "$MESA_SHADER_CACHE_DIR"
    if ! MASU_DRIVER_INFO=$("$build/tests/driver_info" 2>&1); then
        reason="it does not start: $MASU_DRIVER_INFO"
        return 1
    fi
    [ ! -e "build/drivers/$1/version" ] || MASU_DRIVER_INFO+=", $(< "build/drivers/$1/version")"
    export MASU_DRIVER_INFO
}

rm -rf "$results"
mkdir -p "$results/baked"
# Scenes that tests bake themselves are baked for the first driver, and kept for the next.
export MASU_BAKED=$PWD/$results/baked

# Scripts draw on the system's driver. The programs with the sanitizers and those of lab/ have the shaders of $MADE, and
# take what was compiled of them.
cache=$(realpath -m "$MADE")/cache
export MESA_SHADER_CACHE_DIR=$cache/system
mkdir -p "$MESA_SHADER_CACHE_DIR"

# The check that builds the tree anew and runs this again takes half of the processors. It goes on beside the GPU
# tests, which build nothing, and not beside scripts that do.
# The short ones come last: then no processor waits for a long one.
for kind in script fuzz unit; do
    for program in ${programs[$kind]}; do
        [[ $program == */full/sanitize.sh ]] || start $kind $kind "$program"
    done
done
wait
for program in ${programs[script]}; do
    [[ $program != */full/sanitize.sh ]] || start script script "$program"
done

# The environment of each driver is found once, in a shell of its own: what one sets, the next does not
# see. Then nothing waits for the last program of a driver.
if [ "${programs[gpu]}" ]; then
    first=
    for driver in $drivers; do
        (
            if use "$driver"; then
                echo "  driver $driver: $MASU_DRIVER_INFO"
                export -p > "$results/$driver.env"
            elif [ "$require" ]; then
                echo "  FAIL  driver $driver: $reason"
                mkdir -p "$results/$driver" && echo 0 1 0 0 > "$results/$driver/missing.counts"
            else
                echo "  skip  driver $driver: $reason"
                mkdir -p "$results/$driver" &&
                    echo 0 0 "$(wc -w <<< "${programs[gpu]}")" 0 > "$results/$driver/missing.counts"
            fi
        )
        [ -e "$results/$driver.env" ] || continue
        first=${first:-$driver}
        for program in ${programs[gpu]}; do
            [[ -z $LONG && $driver != "$first" && $once == *" ${program##*/} "* ]] && continue
            if [[ -z $LONG && $drivers == "system lavapipe-25 swiftshader" && $first == system ]]; then
                [[ $driver == lavapipe-25 && $not_lavapipe_25 == *" ${program##*/} "* ]] && continue
                [[ $driver == swiftshader && $not_swiftshader == *" ${program##*/} "* ]] && continue
            fi
            start gpu "$driver" "$program"
        done
    done
fi
wait
read -r passed failed skipped known < <(cat "$results"/*/*.counts 2> /dev/null |
    awk '{ p += $1; f += $2; s += $3; k += $4 } END { print p + 0, f + 0, s + 0, k + 0 }')

# One file for readers of JUnit, too.
{
    printf '<?xml version="1.0" encoding="UTF-8"?>\n<testsuites>\n'
    cat "$results"/*/*.xml 2> /dev/null
    echo '</testsuites>'
} > "$results/junit.xml"

# Of the processor, too: what a program waits for on a busy machine says little of itself.
slowest=$(cat "$results"/*/*.times 2> /dev/null | sort -rn | head -n 10)
if [ "$(wc -l <<< "$slowest")" -gt 1 ]; then
    echo "  the slowest, by seconds of the processor:"
    while read -r cpu seconds name driver; do
        printf '        %-28s %-12s %37s s %8s s CPU\n' "$name" "$driver" "$seconds" "$cpu"
    done <<< "$slowest"
fi

[ $((skipped + known)) = 0 ] || echo "$skipped skipped, $known known faults of drivers"
[ $((passed + failed + skipped + known)) -gt 0 ] ||
    echo "no test of that name is of this kind: 'make unit' runs tests without a driver, 'make gpu' those with one"
echo "$passed passed, $failed failed" | tee "$results/summary"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
