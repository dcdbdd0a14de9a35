#!/bin/bash
# Light probes from a scene's text to the blob: what is refused, and in which words; that threads and
# runs change no byte; the table of errors. Of the light itself test_probes.c knows.
set -u
cd "$(dirname "$0")/../.." || exit 1
bin=${BUILD:-build}/bin
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# scene PROBES
scene() {
    printf '{"models": [{"mesh": {"box": {"size": [4, 0.2, 4]}}}, {"mesh": {"box": {}}, "translate": [0, 1, 0]}], "probes": %s}' \
        "$1" > "$folder/s.json"
}

# refuses PATTERN PROBES
refuses() {
    scene "$2"
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/s.masu" 2> "$folder/err" && fail "$2: is accepted"
    grep -q -e "$1" "$folder/err" || fail "\"$1\" is not in: $(cat "$folder/err")"
    [ "$(wc -l < "$folder/err")" = 1 ] || fail "$2: not one line: $(cat "$folder/err")"
}

refuses 'probes: expected an object' 3
refuses 'probes.ray: unknown key' '{"ray": 3}'
refuses 'probes.rays: expected a number from 16 to 65536, found 15' '{"rays": 15}'
refuses 'probes.rays: expected a whole number' '{"rays": 16.5}'
refuses 'probes.bounces: expected a number from 1 to 32' '{"bounces": 0}'
refuses 'probes.sky_bands: expected a number from 1 to 3' '{"sky_bands": 4}'
refuses 'probes.visibility: expected a number from 0 to 16' '{"visibility": 17}'
refuses 'probes.bias: expected a number from 0 to 1' '{"bias": -1}'
refuses 'expected either "spacing" or "counts", found both' '{"spacing": [1, 1, 1], "counts": [2, 2, 2]}'
refuses 'probes.counts: expected whole numbers' '{"counts": [2, 2.5, 2]}'
refuses 'probes.spacing' '{"spacing": [1, 0, 1]}'
refuses 'probes.bounds: expected two corners' '{"bounds": [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}'
refuses 'the first corner must be the lower one' '{"bounds": [[0, 0, 0], [1, 0, 1]]}'
refuses '1000 x 1000 x 1000 are 1000000000 probes, at most 262144' '{"counts": [1000, 1000, 1000]}'
refuses 'bytes, at most 67108864' '{"counts": [512, 1, 512]}'
refuses 'probes.suns\[1\]: less than a degree from suns\[0\]' '{"suns": [{"azimuth": 3}, {"azimuth": 3.5}]}'
refuses 'probes.suns: 17 suns, at most 16' "{\"suns\": [$(printf '{"azimuth": %d},' {1..16}){\"azimuth\": 90}]}"

small='{"counts": [3, 2, 3], "rays": 64, "suns": [{"azimuth": 0}, {"azimuth": 90}]}'
scene "$small"
for run in 1 2 3; do
    "$bin/masu-bake" "$folder/s.json" --bare -o "$folder/$run.masu" --threads "$run" --stats "$folder/stats" --quiet ||
        fail "run $run"
done
cmp "$folder/1.masu" "$folder/2.masu" && cmp "$folder/1.masu" "$folder/3.masu" || fail "threads change the blob"
# 9 sets of the sky and 2 of suns of 14 words each, and a map of 10 x 10 words, of 18 probes
count=$(sed -n '/"probe_data"/,/}/s/.*"count": \([0-9]*\).*/\1/p' "$folder/stats")
[ "$count" = $((18 * (11 * 14 + 100))) ] || fail "$count words of probe data"

# Without a word about probes there are none, but the option makes them.
printf '{"models": [{"mesh": {"box": {}}}]}' > "$folder/s.json"
"$bin/masu-bake" "$folder/s.json" --bare -o "$folder/none.masu" --stats "$folder/stats" --quiet || fail "no probes"
[ "$(sed -n '/"probes"/,/}/s/.*"count": \([0-9]*\).*/\1/p' "$folder/stats")" = 0 ] || fail "probes unasked"

scene "$small"
"$bin/masu-bake" "$folder/s.json" --probe-report > "$folder/report" || fail "no report"
grep -q 'sky .*probes, as baked .*%' "$folder/report" || fail "no line of the sky: $(cat "$folder/report")"
grep -q 'sun, in between .*probes, as baked' "$folder/report" || fail "no line between suns"
"$bin/masu-bake" "$folder/s.json" 2> "$folder/err"
[ $? = 2 ] && grep -q 'no output given' "$folder/err" || fail "an output is not asked for"

[ "$failures" = 0 ]
