#!/bin/bash
# run.sh [RESULTS]: tries the mutants of $DRAWN (draw.awk) in turn, in a copy of the tree below $MUTANTS_DIR, and
# appends `number operator verdict by seconds` to RESULTS; those that it lists already are not tried again.
#
# Verdicts: caught (by the first test that failed, or that could not be built), survived, no-compile (the next one of
# its operator is tried instead). The unit tests and scripts of the mutant's subject run first, then its GPU tests, each
# alone and stopped at its first failure; only they are linked anew, and scenes are baked again only for a mutant of a
# shader that they hold. After a mutant what it changed is copied back. Needs a tree that is built; changes nothing in
# it. After a change of the tree remove $MUTANTS_DIR.
#
# DRAWN=lab/mutants/drawn.tsv: the list
# WANTED=12        of each operator, with a verdict other than no-compile
# ONLY='3 17'      these numbers
# DRIVERS=system   drivers of the GPU tests, as of `make gpu`; none: only the unit tests and scripts of the subject
# OTHERS=1         a survivor is tried against all other unit tests
# MINUTES=0        starts none after as many minutes; 0: no end
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
tree=$PWD
folder=${MUTANTS_DIR:-/tmp/masu-mutants}
results=$(realpath -m "${1:-build/mutants.tsv}")
drawn=$(realpath "${DRAWN:-lab/mutants/drawn.tsv}")
work=$folder/work
export MASU_TEST_TIMEOUT=${MASU_TEST_TIMEOUT:-240} MASU_TEST_JOBS=1
export MASU_SPIRV_CACHE=$folder/spirv
mkdir -p "$folder" "$(dirname "$results")"
touch "$results"
[ -d "$folder/base" ] || { cp -a "$tree" "$folder/base.part" && mv "$folder/base.part" "$folder/base"; } || exit 1

# The copy as it was: what is newer than the last mutant's start comes from the base again, or goes.
restore() {
    if [ -d "$work" ]; then
        (cd "$work" && find . -type f -newer "$folder/start") | while read -r f; do
            if [ -e "$folder/base/$f" ]; then cp -p "$folder/base/$f" "$work/$f"; else rm -f "$work/$f"; fi
        done
    else
        cp -a "$folder/base" "$work"
    fi
    touch "$folder/start"
    sleep 0.02
}

# tests_of FILE: sets unit and gpu to the tests of its subject.
tests_of() {
    local stem=${1##*/}
    stem=${stem%.*}
    case $1 in
        src/scene/material.h) unit="first_look shared_layout" gpu="frame textures reserve transparents" ;;
        src/scene/check_* | src/scene/reader.* | src/scene/scene.*)
            unit="scene_rules scene_limits scene scene_textures animation code trace" gpu=load ;;
        src/scene/punctual_light*) unit=lights gpu="small_lamps area_lights lights" ;;
        src/scene/*) unit="cull code lights trace trace_textures models animation surface scene_query scene_textures" gpu="culling lods trace skin" ;;
        src/plan/*) unit="plan plan_specular desc needs split" gpu="frame output resize reserve shadow_frames" ;;
        src/quality/*) unit="governor ladder desc device_class pacing governor_loads bench_rungs" gpu="governor ladder" ;;
        src/device/*) unit="unpack code plan upload" gpu="frame load resize pool memory_kinds live_textures" ;;
        src/frame/sky* | src/frame/sun_sky*) unit="sky environment" gpu="sky picture_sky" ;;
        src/frame/*) unit="$stem" gpu="$stem frame reserve" ;;
        src/api*) unit="null desc" gpu="frame reserve resize viewports host_pass" ;;
        src/*) unit="arena detail null" gpu="frame" ;;
        shaders/trace/*) unit="trace trace_textures" gpu="trace specular_truth bounce" ;;
        shaders/bounce*) unit=bounce gpu=bounce ;;
        shaders/upscale/* | shaders/temporal* | shaders/easu* | shaders/rcas*)
            unit="fsr1_fast fsr1_reference" gpu="upscale temporal" ;;
        shaders/specular*) unit="" gpu="specular_truth specular_filters specular_textures specular_sdf" ;;
        shaders/cone* | shaders/march* | shaders/classify* | shaders/sdf* | shaders/silhouettes* | shaders/update*)
            unit=sdf_shapes gpu="sdf_looks stiff frame specular_sdf velocity" ;;
        shaders/post/* | shaders/bloom* | shaders/focus* | shaders/expose* | shaders/meter*) unit="" gpu="post tone" ;;
        shaders/light* | shaders/local_shadow*)
            unit="lights local_shadows" gpu="lights area_lights brdf local_shadows small_lamps terms" ;;
        shaders/brdf/*) unit="brdf vndf" gpu="brdf vndf meso terms" ;;
        shaders/decals* | shaders/particles* | shaders/transparents*) unit="" gpu="sprites transparents instance_looks trails" ;;
        shaders/shared/*) unit="normal_packing brdf shared_layout" gpu="brdf frame terms agreement" ;;
        shaders/gbuffer*) unit="" gpu="frame textures brdf terms agreement" ;;
        shaders/cascade* | shaders/shadow*) unit=shadow_map gpu="shadow shadow_frames" ;;
        shaders/*) unit="" gpu="$stem frame agreement" ;;
        tools/bake/light/*) unit="probes environment emission picture_path sky bake_probes bake_lights" gpu="probes picture_sky" ;;
        tools/bake/texture/*) unit="image texels masks bump trace_textures scene_textures bake_textures meso" gpu=textures ;;
        tools/bake/import/*) unit="gltf picture_path bake hostile" gpu=gltf_pictures ;;
        tools/bake/mesh/*) unit="bake_detail gltf creases trace surface masks bake_rays bake_blocks" gpu=lods ;;
        tools/bake/scene/*) unit="gltf models placement bake_groups bake_merge bake_placement bake_limits bake" gpu=live ;;
        tools/bake/shader/*) unit="code whole_vectors first_look sdfc bake bake_limits" gpu=frame ;;
        tools/bake/*) unit="first_look bake bake_lights bake_limits programs" gpu=frame ;;
        tools/sdfc/*) unit="sdfc sdf_shapes reflected_sdf" gpu="sdf_looks stiff" ;;
        tools/conform/*) unit=conform gpu=conform ;;
    esac
}

# existing KIND WORD...: the words that name tests of that kind; NAME.sh for a script.
existing() {
    local kind=$1 name
    shift
    for name; do
        [ ! -e "tests/$kind/test_$name.c" ] || echo "$name"
        [ "$kind" != unit ] || [ ! -e "tests/scripts/$name.sh" ] || echo "$name.sh"
    done | tr '\n' ' '
}

# built TREE TARGET...: makes only these. A shader that no scene holds needs no optimiser and bakes nothing.
built() {
    local in=$1 path=$PATH quick='' keep='-o build/bin/masu-bake.code -o build/textures/made'
    shift
    case $file in
        shaders/cone* | shaders/march* | shaders/classify* | shaders/update* | shaders/silhouettes* | shaders/sdf*) keep='' ;;
        shaders/*) path=$in/tests/cached:$PATH quick=1 ;;
    esac
    # shellcheck disable=SC2086
    PATH=$path MASU_SPIRV_QUICK=$quick timeout 900 make -C "$in" WERROR=1 $keep "$@" &> "$in.log"
}

# run_test TREE KIND NAME: one test; stopped when it has failed.
run_test() {
    local in=$1 kind=$2 name=$3 program log pid failed=
    program=build/tests/$kind/test_$name
    log=$in/build/test-results
    if [[ $name == *.sh ]]; then
        kind=script program=tests/scripts/$name
        built "$in" build/bin/masu build/bin/masu-bake build/bin/masu-sdfc || return 1
    else
        built "$in" "$program" build/tests/driver_info || return 1
    fi
    rm -rf "$log"
    (cd "$in" && BUILD=build MADE=build CC=gcc CXX=g++ WERROR=1 exec setsid tests/run.sh --"$kind" "$program") &> "$in.log" &
    pid=$!
    while kill -0 $pid 2> /dev/null; do
        sleep 0.5
        grep -qs '  FAILED  \]' "$log"/*/*.log && failed=1 && kill -- -$pid 2> /dev/null
    done
    wait $pid && [ ! "$failed" ]
}

# attempt KIND TEST...: sets by to the first that fails; exit 1 if one does.
attempt() {
    local kind=$1 name
    shift
    for name; do
        run_test "$work" "$kind" "$name" && continue
        run_test "$folder/base" "$kind" "$name" || continue # fails without the mutant
        by=$name
        return 1
    done
}

# apply LINE BEFORE AFTER FILE: to the line nearest to LINE that has the text BEFORE.
apply() {
    awk -v at="$1" 'NR == FNR { texts[NR] = $0; next }
        { lines[FNR] = $0; d = FNR > at ? FNR - at : at - FNR
          if ($0 == texts[1] && (!found || d < off)) { found = FNR; off = d } }
        END { if (!found) exit 1
              lines[found] = texts[2]; for (i = 1; i <= FNR; i++) print lines[i] }' \
        <(printf '%s\n%s\n' "$2" "$3") "$4" > "$4.mutant" && mv "$4.mutant" "$4"
}

judge() {
    local object=build/obj/${file%.c}.o
    by=-
    case $file in
        *.c) built "$work" "$object" ;;
        shaders/*) built "$work" build/lib/libmasu.a ;;
        *) built "$work" build/bin/masu ;;
    esac || { verdict=no-compile && return; }
    tests_of "$file"
    verdict=caught
    # shellcheck disable=SC2046,SC2086
    attempt unit $(existing unit $unit) || return
    verdict=survived
    [ "${DRIVERS:-system}" != none ] || return
    verdict=caught
    # shellcheck disable=SC2046,SC2086
    attempt gpu $(existing gpu $gpu) || return
    # shellcheck disable=SC2046
    [ ! "${OTHERS:-}" ] || attempt unit $(find "$work/tests/unit" -name 'test_*.c' | sed 's/.*test_//; s/\.c$//') || return
    verdict=survived
}

end=$((SECONDS + ${MINUTES:-0} * 60))
while IFS=$'\t' read -r number operator file line before after; do
    [ -z "${ONLY:-}" ] || [[ " $ONLY " == *" $number "* ]] || continue
    [ "$(awk -v o="$operator" '$2 == o && $3 != "no-compile"' "$results" | wc -l)" -lt "${WANTED:-12}" ] || continue
    [ "${MINUTES:-0}" = 0 ] || [ $SECONDS -lt $end ] || break
    grep -q "^$number	" "$results" && continue
    began=$SECONDS
    restore
    apply "$line" "$before" "$after" "$work/$file" || { echo "$number: no such line in $file" >&2 && continue; }
    judge
    printf '%s\t%s\t%s\t%s\t%s\n' "$number" "$operator" "$verdict" "$by" $((SECONDS - began)) | tee -a "$results"
    cp "$work.log" "$folder/$number.log"
done < "$drawn"
cut -f 3 "$results" | sort | uniq -c
