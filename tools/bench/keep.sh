#!/bin/sh
# keep.sh FROM TO: copies the committed results of a `masu bench` folder: ladder.json, costs.csv, and results.csv with
# the times of steady.csv, the second and longer measurement of the rungs. `masu bench --rungs-of TO` and `--against`
# read these files.
set -eu
from=$1 to=$2
mkdir -p "$to"
cp "$from/ladder.json" "$to/ladder.json"
[ ! -f "$from/costs.csv" ] || cp "$from/costs.csv" "$to/costs.csv"
[ -f "$from/steady.csv" ] || { cp "$from/results.csv" "$to/results.csv"; exit; }
awk -F, 'NR == FNR { again[$1] = $0; next } FNR > 1 && $1 in again { print again[$1]; next } { print }' \
    "$from/steady.csv" "$from/results.csv" > "$to/results.csv.new"
mv "$to/results.csv.new" "$to/results.csv"
