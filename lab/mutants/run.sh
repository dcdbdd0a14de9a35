#!/bin/bash
# run.sh [RESULTS]: tries the mutants of drawn.tsv (draw.awk) in turn, each in a copy of the tree below
# $MUTANTS_DIR, and appends `number verdict by seconds` to RESULTS; those that it lists already are not tried again.
#
# Verdicts: caught (by the first test that failed, or by the bake of a scene), survived, no-compile (the next one of
# the list is tried instead). First run the unit tests and scripts of the mutant's subject, then its GPU tests, then
# all other unit tests. Needs a tree that is built, with its tests; changes nothing in it. After a change of the tree
# remove $MUTANTS_DIR.
#
# WANTED=60        as many with a verdict other than no-compile
# ONLY='3 17'      these numbers
# DRIVERS=system   drivers of the GPU tests, as of `make gpu`; none: only the unit tests and scripts of the subject
# MINUTES=0        starts none after as many minutes; 0: no end
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
tree=$PWD
folder=${MUTANTS_DIR:-/tmp/masu-mutants}
results=$(realpath -m "${1:-build/mutants.tsv}")
drawn=$tree/lab/mutants/drawn.tsv
work=$folder/work
export MASU_TEST_TIMEOUT=${MASU_TEST_TIMEOUT:-240}
mkdir -p "$folder" "$(dirname "$results")"
touch "$results"
[ -d "$folder/base" ] || { cp -a "$tree" "$folder/base.part" && mv "$folder/base.part" "$folder/base"; } || exit 1

# tests_of FILE: sets unit and gpu to the tests of its subject.
tests_of() {
    local stem=${1##*/}
    stem=${stem%.*}
    case $1 in
        src/scene/material.h) unit="first_look shared_layout" gpu="frame textures reserve transparents" ;;
        src/scene/check_* | src/scene/reader.* | src/scene/scene.*)
            unit="scene_rules scene scene_textures code trace" gpu=load ;;
        src/scene/*) unit="cull code lights trace trace_textures models animation surface scene_query scene_textures" gpu="culling lods trace skin" ;;
        src/plan/*) unit="plan plan_specular desc needs split" gpu="frame output resize reserve" ;;
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
        tools/bake/mesh/*) unit="bake_detail creases trace surface masks bake_rays bake_blocks" gpu=lods ;;
        tools/bake/scene/*) unit="models placement bake_groups bake_merge bake_placement bake_limits bake" gpu=live ;;
        tools/bake/shader/*) unit="code whole_vectors first_look sdfc bake bake_limits" gpu=frame ;;
        tools/bake/*) unit="first_look bake bake_lights bake_limits programs" gpu=frame ;;
        tools/sdfc/*) unit="sdfc sdf_shapes reflected_sdf" gpu="sdf_looks stiff" ;;
        tools/conform/*) unit=conform gpu=conform ;;
    esac
}

# keep KIND PREFIX WORD...: the words that name tests of that kind.
existing() {
    local kind=$1 name
    shift
    for name; do
        [ -e "tests/$kind/test_$name.c" ] && echo "$name" && continue
        [ "$kind" = unit ] && [ -e "tests/scripts/$name.sh" ] && echo "$name"
    done | sort -u | tr '\n' ' '
}

# attempt TARGET TESTS [DRIVERS]: sets by to what failed; exit 1 if something did.
attempt() {
    [ "$2" ] || return 0
    timeout 900 make -C "$work" WERROR=1 "$1" TESTS="$2" DRIVERS="${3:-system}" &> "$work.log" && return 0
    by=$(sed -n '/^  FAIL/{s/^  FAIL  *\([^ ]*\).*/\1/;p;n;s/^ *\(failed\|died in it\|timed out\|skipped\)[^:]*: */: /;p;q;}' "$work.log" |
        tr -d '\n')
    by=${by:-$(grep -m 1 -q '^  BAKE' "$work.log" && echo 'bake of a scene' || echo "make $1")}
    return 1
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
    local file=$1 others
    by=-
    timeout 600 make -C "$work" WERROR=1 tools &> "$work.log" || { verdict=no-compile && return; }
    tests_of "$file"
    unit=$(passing unit $(existing unit $unit))
    [ "${DRIVERS:-system}" = none ] || gpu=$(passing gpu $(existing gpu $gpu))
    verdict=caught
    attempt unit "$unit" || return
    [ "${DRIVERS:-system}" = none ] && verdict=survived && return
    attempt gpu "$gpu" "${DRIVERS:-system}" || return
    case $file in
        shaders/*) others="shader_gates" ;; # the others do not read shaders
        *) others=$(cd "$work/tests/unit" && ls test_*.c | sed 's/^test_//; s/\.c$//' | grep -vxF -f <(tr ' ' '\n' <<< "$unit")) ;;
    esac
    attempt unit "$(passing unit $others)" || return
    verdict=survived
}

# passing KIND TEST...: those that pass without a mutant; each is tried once.
passing() {
    local kind=$1 name
    shift
    for name; do
        grep -q "^$kind $name " "$folder/control" 2> /dev/null || {
            timeout 900 make -C "$folder/base" WERROR=1 "$kind" TESTS="$name" DRIVERS="${DRIVERS:-system}" &> "$folder/control.log"
            echo "$kind $name $?" >> "$folder/control"
        }
        grep -q "^$kind $name 0" "$folder/control" && echo "$name"
    done | tr "\n" " "
}

end=$((SECONDS + ${MINUTES:-0} * 60))
while IFS=$'\t' read -r number _ file line before after; do
    [ -z "${ONLY:-}" ] || [[ " $ONLY " == *" $number "* ]] || continue
    [ "$(grep -vc 'no-compile' "$results")" -lt "${WANTED:-60}" ] || break
    [ "${MINUTES:-0}" = 0 ] || [ $SECONDS -lt $end ] || break
    grep -q "^$number	" "$results" && continue
    began=$SECONDS
    rm -rf "$work"
    cp -a "$folder/base" "$work" || exit 1
    for f in "$work"/build/drivers/*/{icd.json,env}; do [ ! -e "$f" ] || sed -i "s|$tree/|$work/|g" "$f"; done
    apply "$line" "$before" "$after" "$work/$file" || { echo "$number: no such line in $file" >&2 && continue; }
    judge "$file"
    printf '%s\t%s\t%s\t%s\n' "$number" "$verdict" "$by" $((SECONDS - began)) | tee -a "$results"
    cp "$work.log" "$folder/$number.log"
done < "$drawn"
cut -f 2 "$results" | sort | uniq -c
