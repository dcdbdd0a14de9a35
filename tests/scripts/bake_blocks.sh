#!/bin/bash
# GLSL blocks in .sdf scenes, and sources of GLSL: masu-bake runs them on the CPU and refuses one that is steeper than
# its author says, with the two points. blocks.sdf has each instruction that such code may hold.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
export MASU_SPIRV_QUICK=1 # nothing is drawn here

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

echo '{"sdf": {"source": "s.sdf", "bounds": [[-2, -2, -2], [2, 2, 2]]}}' > "$folder/s.json"

# bake TEXT: bakes that .sdf; exit code in $code
bake() {
    printf '%s\n' "$1" > "$folder/s.sdf"
    rm -f "$folder/s.masu"
    "$bake" --bare "$folder/s.json" -o "$folder/s.masu" --quiet > "$folder/stdout" 2> "$folder/stderr"
    code=$?
}

# accepts WHAT TEXT
accepts() {
    bake "$2"
    [ $code = 0 ] && [ ! -s "$folder/stderr" ] && [ -s "$folder/s.masu" ] ||
        fail "$1: exit code $code: $(cat "$folder/stderr")"
}

# refuses WHAT TEXT: in one line that holds two points whose values are too far apart
number='(-?[0-9.]+(e[-+]?[0-9]+)?)'
refuses() {
    bake "$2"
    [ $code = 1 ] || fail "$1: exit code $code"
    [ ! -e "$folder/s.masu" ] || fail "$1: wrote its output"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "$1: not one line: $(cat "$folder/stderr")"
    local steep="part a: its glsl is steeper than its lipschitz constant $number: "
    steep+="f\($number, $number, $number\) = $number, f\($number, $number, $number\) = $number, "
    steep+="$number apart, at time $number$"
    sed -nE "s/.*$steep/\1 \3 \5 \7 \9/p" "$folder/stderr" > "$folder/first"
    grep -qE "$steep" "$folder/stderr" || fail "$1: no pair in $(cat "$folder/stderr")"
    # L, then the values and the distance, by their words
    sed -E 's/[=,()]/ /g; s/.*constant //' "$folder/stderr" | awk '
        { l = $1 + 0; n = 0; for (i = 1; i <= NF; i++) if ($i == "f") at[n++] = i
          d = $(at[0] + 4) - $(at[1] + 4); for (i = 1; i <= NF; i++) if ($i == "apart") r = $(i - 1)
          if (d < 0) d = -d; exit !(r > 0 && d > l * r) }' ||
        fail "$1: the pair is none: $(cat "$folder/stderr")"
}

# block L GLSL: a part with that block
block() {
    echo "param k = 1 [1, 2];"
    echo "part a = glsl { $2 } bounds (-1, -1, -1), (1, 1, 1) lipschitz $1 c { return 0; };"
}

all=$(< tests/unit/blocks.sdf)
accepts "every instruction" "$all"
for line in $(grep -n '    ok = ok' tests/unit/blocks.sdf | cut -d: -f1); do
    inverted=$(sed "${line}s/ok = ok && \(.*\);/ok = ok \&\& !(\1);/" tests/unit/blocks.sdf)
    [ "$inverted" != "$all" ] || fail "line $line is as before"
    bake "$inverted"
    [ $code = 1 ] && grep -q 'part all: its glsl is steeper' "$folder/stderr" ||
        fail "line $line of blocks.sdf says nothing: exit code $code"
done

accepts "a sphere" "$(block 1 'return length(p) - 1.0;')"
accepts "a steep sphere" "$(block 3 'return 3.0 * (length(p) - 1.0);')"
refuses "1.05" "$(block 1 'return 1.05 * (length(p) - 1.0);')"
refuses "a displacement not divided" "$(block 1 'return length(p) - 1.0 + 0.1 * sin(20.0 * p.x);')"
refuses "a jump" "$(block 2 'return length(p) - (p.x > 0.3 ? 1.0 : 0.99);')"
refuses "a parameter, not at its default" "$(block 1 'return masu_param(0) * (length(p) - 1.0);')"
refuses "time" "$(block 1 'return length(p) * (1.0 + 0.5 * abs(sin(masu_time()))) - 1.0;')"
refuses "within an operator" "part a = union(sphere(0.2), scale(2, $(
    block 1 'return 1.5 * (length(p) - 1.0);' | sed -n 's/part a = \(.*\);$/\1/p')));
param k = 1 [1, 2];"

refuses "4.123 as 4.1" "$(block 4.1 'return p.y - 2.0 * sin(2.0 * p.x) * sin(2.0 * p.z);')"
# Spikes in a millionth of the bounds: found where a decision of the code leads.
at='float d = length(p - vec3(0.5, 0.3, -0.2));'
refuses "a spike by max" "$(block 1 "$at return length(p) - 1.0 + max(0.0, 29.0 * (0.02 - d));")"
refuses "a spike by if" "$(block 1 "$at float f = p.y; if (d < 0.01) f += 29.0 * (0.01 - d); return f;")"
refuses "a spike by smoothstep" "$(block 1 "$at return p.y + 0.5 * (1.0 - smoothstep(0.0, 0.02, d));")"
refuses "a spike by exp" "$(block 1 "$at return p.y + exp(-4000.0 * d * d);")"

# Sources of GLSL are tested within their bounds in the same way.
surface='void masu_sdf_surface(vec3 p, inout masu_surface s) { s.albedo = vec3(0.5); }'

# source LIPSCHITZ GLSL: bakes it; exit code in $code
source_of() {
    local bounds='"bounds": [[-2, -2, -2], [2, 2, 2]]' params='"params": [{"name": "k", "value": 1, "min": 1, "max": 2}]'
    echo "{\"sdf\": {\"source\": \"f.glsl\", \"lipschitz\": $1, $bounds, $params}}" > "$folder/f.json"
    printf 'float masu_sdf(vec3 p) { %s }\n%s\n' "$2" "$surface" > "$folder/f.glsl"
    rm -f "$folder/f.masu"
    "$bake" --bare "$folder/f.json" -o "$folder/f.masu" > "$folder/stdout" 2> "$folder/stderr"
    code=$?
}

accepts_source() {
    source_of "$2" "$3"
    [ $code = 0 ] && [ ! -s "$folder/stderr" ] && [ -s "$folder/f.masu" ] ||
        fail "source, $1: exit code $code: $(cat "$folder/stderr")"
}

refuses_source() {
    source_of "$2" "$3"
    [ $code = 1 ] && [ ! -e "$folder/f.masu" ] && [ "$(wc -l < "$folder/stderr")" = 1 ] &&
        grep -q "f.glsl: the field is steeper than its lipschitz constant $2: f(.*) = .*, f(.*) = .* apart" "$folder/stderr" ||
        fail "source, $1: exit code $code: $(cat "$folder/stderr")"
}

waves='return p.y - 2.0 * sin(2.0 * p.x) * sin(2.0 * p.z);'
accepts_source "steep outside of the bounds" 1 'return length(p) - 1.0 + 9.0 * max(0.0, p.x - 2.01);'
refuses_source "waves" 1 "$waves"
refuses_source "a parameter, not at its default" 1 'return masu_param(MASU_PARAM_K) * (length(p) - 1.0);'
refuses_source "a spike" 1 "$at return length(p) - 1.0 + max(0.0, 29.0 * (0.02 - d));"

source_of '"auto"' "$waves"
found=$(sed -nE 's/.*lipschitz ([0-9.]+) \(steepest slope found: ([0-9.]+)\)$/\1 \2/p' "$folder/stdout")
[ $code = 0 ] && [ "$found" = "4.329 4.123" ] || fail "auto: exit code $code, $found: $(cat "$folder/stderr")"
source_of '"auto"' 'return mod(p.x, 1.0) - 0.5;'
[ $code = 1 ] && grep -q 'the field jumps by 1 at' "$folder/stderr" || fail "auto, a jump: $(cat "$folder/stderr")"
source_of '"automatic"' "$waves"
[ $code = 1 ] && grep -q 'must be a number or "auto"' "$folder/stderr" || fail "automatic: $(cat "$folder/stderr")"

bake "$(block 1 'float s = 0.0; for (int i = 0; i < 1000000; i++) s += p.x; return s;')"
[ $code = 0 ] || fail "a long loop: exit code $code: $(cat "$folder/stderr")"
grep -q 'warning: .*part a: its glsl was not tested, .*it does not end within' "$folder/stderr" ||
    fail "a long loop: $(cat "$folder/stderr")"

# Decisions of other parts do not take the place of a part's own: a spike in the last one.
bake "$(for i in $(seq 1 9); do
    sides=''
    for k in $(seq 1 9); do sides+=" e += max(p.x - $i.0 - 0.1 * $k.0, 0.0);"; done
    spike=0.0
    [ "$i" != 9 ] || spike='max(0.0, 29.0 * (0.02 - d))'
    echo "part p$i = translate(($((3 * i)), 0, 0), glsl { $at float e = 0.0;$sides" \
        "return max(length(p) - 1.0 + $spike, 0.1 * e - 50.0); } bounds (-1, -1, -1), (1, 1, 1) lipschitz 1" \
        "c { return 0; });"
done)"
[ $code = 1 ] && grep -q 'part p9: its glsl is steeper' "$folder/stderr" ||
    fail "a spike in the last of several parts: exit code $code: $(head -2 "$folder/stderr")"

# A camera inside of a block or of a source.
view='"camera": {"fov_y": 50, "keys": [{"position": [0, 0.5, 0.1], "target": [0, 0, -1]}]}'
echo "{\"sdf\": {\"source\": \"f.glsl\", \"bounds\": [[-2, -2, -2], [2, 2, 2]]}, $view}" > "$folder/v.json"
printf 'float masu_sdf(vec3 p) { return length(p) - 1.0; }\n%s\n' "$surface" > "$folder/f.glsl"
"$bake" "$folder/v.json" -o "$folder/v.masu" --quiet 2> "$folder/stderr"
grep -q 'f.glsl: the camera at (0, 0.5, 0.1), 0 s, is inside the field' "$folder/stderr" ||
    fail "a camera inside of a source: $(cat "$folder/stderr")"

[ $failures = 0 ]
