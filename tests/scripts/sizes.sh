#!/bin/bash
# The library is no larger than package/sizes.csv says, 3 % aside (make sizes-table writes it anew), and for one class
# of scenes at most 2.4 MB. Built for a class it takes every baked scene of that class, and of others at least
# refuses those that draw or trace what it cannot, by a line that says what to build.
set -u
build=${BUILD:-build} made=${MADE:-build}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
case ${config:-release}/${CC:-gcc} in release/gcc) ;; *) echo 'of gcc and config=release alone' && exit 77 ;; esac

fail() {
    echo "$1"
    failed=1
}

# grown TABLE NEW: a line for what NEW has more of than TABLE, or has not
grown() {
    awk -F, '
        FNR == 1 { next }
        NR == FNR { was[$1] = $2; next }
        { seen[$1] = 1 }
        !($1 in was) { print $1 ": not in the table"; next }
        $2 > was[$1] * 1.03 { print $1 ": " $2 " bytes, in the table " was[$1] }
        $2 > ($1 == "all" ? 2500000 : 2400000) { print $1 ": " $2 " bytes are more than is promised" }
        $2 < was[$1] * 0.9 { print $1 ": " $2 " bytes, in the table " was[$1] ": it can be written anew" }
        END { for (c in was) if (!(c in seen)) print c ": no size any more" }' "$1" "$2"
}

# ---- Sizes ---------------------------------------------------------------------------------------

make --no-print-directory sizes > "$folder/said" 2>&1 || { cat "$folder/said" && exit 1; }
sed -n '/^classes,/,$p' "$folder/said" > "$folder/new.csv"
[ "$(wc -l < "$folder/new.csv")" = 10 ] || fail 'make sizes does not end in a table of eight classes and all'
grown package/sizes.csv "$folder/new.csv" > "$folder/grown"
[ ! -s "$folder/grown" ] || fail "$(cat "$folder/grown")"
# Documents have the table's numbers.
package/sizes.sh package/sizes.csv | while read -r row; do
    grep -qxF "$row" docs/embedding.md || echo "docs/embedding.md has no row $row; make sizes-table writes it"
done > "$folder/rows"
[ ! -s "$folder/rows" ] || fail "$(cat "$folder/rows")"
awk -F, 'NR > 1 { $2 = int($2 * 1.04) } { print $1 "," $2 "," $3 }' "$folder/new.csv" > "$folder/more.csv"
[ "$(grown "$folder/new.csv" "$folder/more.csv" | grep -c 'in the table')" = 9 ] || fail 'self-test: 4 % more are not seen'
sed 's/^sdf,[0-9]*/sdf,2450000/' "$folder/new.csv" > "$folder/more.csv"
grown "$folder/more.csv" "$folder/more.csv" | grep -q 'sdf: .* promised' || fail 'self-test: more than is promised is not seen'

# ---- What a library of a class takes -------------------------------------------------------------

# of CLASS: links classes.c with the library of that class; $folder/CLASS is what it says of all scenes
of() {
    ${CC:-gcc} -std=c11 -O1 -Wall -Wextra -Werror -Iinclude -Isrc -Ishaders -I"$made/gen" tests/consumers/classes.c \
        "$build/classes/$1/shaders.o" "$build/lib/libmasu.a" -lm -o "$folder/classes" &&
        "$folder/classes" "$1" "$made"/scenes/*.masu > "$folder/$1" || fail "$1: classes.c fails"
    if ! grep -q "^$1 takes .*($1)\$" "$folder/$1"; then fail "$1: no scene of its class is there"; fi
    if grep "^$1 refuses .*($1):" "$folder/$1"; then fail "$1: refuses scenes of its class"; fi
}
# refuses CLASS SCENE PASS
refuses() {
    grep -q "^$1 refuses .*/$2.masu .* the pass $3: .* make CLASSES=" "$folder/$1" || fail "$1: does not refuse $2 for $3"
}
of polygons
refuses polygons wet_city specular_guide
of sdf
refuses sdf engine gbuffer
refuses sdf test_lods occluders
of both
refuses both mirrors specular_guide
of both-traced
if grep ' refuses ' "$folder/both-traced"; then fail 'both-traced: refuses scenes, and has every shader'; fi
exit $failed
