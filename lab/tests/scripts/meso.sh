#!/bin/bash
# masu-lab meso: the table, the CSV, and the plots if gnuplot is installed.
set -u
cd "$(dirname "$0")/../../.." || exit 1
lab=$(realpath "${BUILD:-build}/bin/masu-lab")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

fail() {
    echo "$1"
    failed=1
}

small=(--make grass --detail 1 --size 32 --rays 8 --sky-rays 2)
"$lab" meso "${small[@]}" -o "$folder/g r" --no-plots > "$folder/stdout" || fail 'masu-lab meso fails'
grep -q '^   *88 ' "$folder/stdout" || fail "no table: $(cat "$folder/stdout")"
grep -q '^angle,plain,plain_and_ao,curves' "$folder/g r.csv" || fail 'no rows of errors in the CSV'
"$lab" meso "${small[@]}" -o "$folder/q" --no-plots --quiet > "$folder/stdout" || fail 'with --quiet it fails'
[ ! -s "$folder/stdout" ] || fail '--quiet prints'
cmp "$folder/q.csv" "$folder/g r.csv" || fail 'two runs give two results'

# Without gnuplot there is only a warning.
mkdir "$folder/bin"
ln -s "$(command -v sh)" "$folder/bin/sh"
PATH="$folder/bin" "$lab" meso "${small[@]}" -o "$folder/p" > /dev/null 2> "$folder/stderr" || fail 'without gnuplot it fails'
grep -q 'no plots: there is no gnuplot' "$folder/stderr" || fail "no warning: $(cat "$folder/stderr")"
if command -v gnuplot > /dev/null; then
    "$lab" meso "${small[@]}" -o "$folder/it's" > /dev/null || fail 'with gnuplot it fails'
    for plot in tilt rough ao shadow error; do
        grep -q '</svg>' "$folder/it's_$plot.svg" || fail "no plot $plot"
    done
fi
"$lab" meso -o "$folder/x" 2>&1 | grep -q 'no relief given' || fail 'no relief is not reported'
exit $failed
