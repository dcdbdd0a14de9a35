#!/bin/sh
# table.sh GPU[,GPU...]: prints lab/notes/isa.csv: statistics of the GPUs' compilers for every pipeline of these
# scenes at 1280x720 (masu-lab isa). Reads baked scenes of $MADE, the program of $BUILD.
set -eu
build=${BUILD:-build} made=${MADE:-build}
line='scene,gpu,pipeline,stage,lanes,registers,waves,instructions,cycles,latency,sends,spills,fills,scalar_spills,scratch,lds'
echo "$line"
# rows NAME SCENE PIPELINES OPTIONS...: of a scene, under NAME, the pipelines that match an expression of grep
rows() {
    name=$1 scene=$2 which=$3
    shift 3
    table=$("$build/bin/masu-lab" isa "$made/scenes/$scene.masu" --gpu "$gpus" --size 1280x720 --csv - "$@")
    first=$(printf '%s\n' "$table" | sed -n 1p)
    [ "scene,$first" = "$line" ] || { echo "table.sh: the columns are now $first" >&2; exit 1; }
    printf '%s\n' "$table" | sed "1d; s/\"//g; s/, /; /g; s/^/$name,/" | grep -E "^$name,[^,]*,($which)"
}
gpus=$1
for scene in engine wet_city mirrors city textures glass night alley room; do
    rows "$scene" "$scene" ''
done
rows skins test_skin 'skin|gbuffer'
# Pipelines that no rung has by itself: a ladder of two sizes, with a knob.
ladder=$(mktemp)
trap 'rm -f "$ladder"' EXIT
# sized SCALE KNOB: 1 and that scale
sized() {
    rung='"wall_ms": 1, "gpu_ms": 1, "flip": 0, "rmse": 0'
    cat > "$ladder" << END
{"date": "2026-11-26", "scene": "engine.masu", "hash": "0", "driver": "none", "width": 64, "height": 64, "time": 1,
 "clock": "wall", "error": "flip", "rungs": [
  {"setting": "full", "ratio": 1, $rung, "knobs": {"scale": 1, "$2": "on"}},
  {"setting": "less", "ratio": 0.5, $rung, "knobs": {"scale": $1, "$2": "on"}}]}
END
}
sized 0.75 silhouettes
for scene in engine city; do
    rows "$scene with silhouettes" "$scene" 'silhouettes|tonemap' --ladder "$ladder"
done
sized 0.75 temporal
rows "engine with temporal" engine 'temporal|tonemap' --ladder "$ladder"
rows "mirrors with temporal" mirrors specular_composite --ladder "$ladder"
sized 0.5 ao # which is on anyway
rows 'engine at half size' engine easu_twice --ladder "$ladder"
sized 0.5 temporal
rows 'engine at half size' engine temporal_twice --ladder "$ladder"
rows 'engine with particles' engine 'particles|decals|lines' --particles 1 --decals 1 --lines 1
rows 'shadows with particles' test_shadows particles --particles 1
rows 'mirrors with extras' mirrors 'mesh|texture|bloom|focus|particles|decals|tonemap|gbuffer' --extras
