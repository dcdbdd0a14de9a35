#!/bin/sh
# table.sh GPU[,GPU...]: prints docs/report/isa.csv: what the GPUs' compilers make of every pipeline of these
# scenes at 1280x720 (masu plan --isa). Reads baked scenes of $MADE, the program of $BUILD.
set -eu
build=${BUILD:-build} made=${MADE:-build}
line='scene,gpu,pipeline,stage,lanes,registers,waves,instructions,cycles,latency,sends,spills,fills,scalar_spills,scratch,lds'
echo "$line"
# rows NAME SCENE PIPELINES OPTIONS...: of a scene, as NAME, the pipelines that an expression of grep matches
rows() {
    name=$1 scene=$2 which=$3
    shift 3
    table=$("$build/bin/masu" plan "$made/scenes/$scene.masu" --isa "$gpus" --size 1280x720 --csv - "$@")
    first=$(printf '%s\n' "$table" | sed -n 1p)
    [ "scene,$first" = "$line" ] || { echo "table.sh: the columns are now $first" >&2; exit 1; }
    printf '%s\n' "$table" | sed "1d; s/\"//g; s/, /; /g; s/^/$name,/" | grep -E "^$name,[^,]*,($which)"
}
gpus=$1
for scene in engine wet_city mirrors city textures glass night; do
    rows "$scene" "$scene" ''
done
rows skins test_skin 'skin|gbuffer'
# What no rung has by itself.
ladder=$(mktemp)
trap 'rm -f "$ladder"' EXIT
sed 's/"aa": "auto"/"aa": "auto", "silhouettes": "on"/' docs/report/engine/ladder.json > "$ladder"
for scene in engine city; do
    rows "$scene with silhouettes" "$scene" 'silhouettes|tonemap' --ladder "$ladder"
done
sed 's/"aa": "auto"/"aa": "auto", "temporal": "on"/' docs/report/engine/ladder.json > "$ladder"
rows "engine with temporal" engine 'temporal|tonemap' --ladder "$ladder"
sed '0,/"scale": 1,/s//"scale": 0.5,/' docs/report/engine/ladder.json > "$ladder"
rows 'engine at half size' engine easu_twice --ladder "$ladder"
rows 'engine with particles' engine 'particles|decals|lines' --particles 1 --decals 1 --lines 1
rows 'shadows with particles' test_shadows particles --particles 1
