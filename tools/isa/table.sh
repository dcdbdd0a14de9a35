#!/bin/sh
# table.sh GPU[,GPU...]: prints docs/report/isa.csv: what the GPUs' compilers make of every pipeline of these
# scenes at 1280x720 (masu plan --isa). Reads baked scenes of $MADE, the program of $BUILD.
set -eu
build=${BUILD:-build} made=${MADE:-build}
line='scene,gpu,pipeline,stage,lanes,registers,waves,instructions,cycles,latency,sends,spills,fills,scalar_spills,scratch,lds'
echo "$line"
for scene in engine wet_city mirrors city textures glass night; do
    table=$("$build/bin/masu" plan "$made/scenes/$scene.masu" --isa "$1" --size 1280x720 --csv -)
    first=$(printf '%s\n' "$table" | sed -n 1p)
    [ "scene,$first" = "$line" ] || { echo "table.sh: the columns are now $first" >&2; exit 1; }
    printf '%s\n' "$table" | sed "1d; s/\"//g; s/, /; /g; s/^/$scene,/"
done
