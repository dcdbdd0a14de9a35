#!/bin/bash
# analyse.sh [FILE...]: what three programs that read code without running it say of src/, or of those files; 1 if
# anything. They look for what must not be, not for taste: .clang-tidy lists what is asked of clang-tidy, known.txt
# beside this what the other two say and is not so.
set -u
cd "$(dirname "$0")/../.." || exit 1
known=tools/analyse/known.txt
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ $# != 0 ] || set -- src/*.c src/*/*.c
flags=(-std=c11 -DNDEBUG -ffp-contract=off -Iinclude -Isrc -Ishaders -I"${MADE:-build}/gen")

echo "  TIDY    $# files"
clang-tidy --quiet "$@" -- "${flags[@]}" > "$folder/tidy" 2> "$folder/counts" ||
    [ -s "$folder/tidy" ] || cp "$folder/counts" "$folder/tidy"

# Without the folder of generated headers, whose tables it would read for minutes.
echo "  CPPCHECK $# files"
awk '$1 == "cppcheck" { print $3 ":" $2 }' "$known" > "$folder/suppressed"
cppcheck -q --std=c11 -DNDEBUG --enable=warning,performance,portability --suppressions-list="$folder/suppressed" \
    -Iinclude -Isrc -Ishaders --error-exitcode=1 "$@" > "$folder/cppcheck" 2>&1 ||
    [ -s "$folder/cppcheck" ] || echo "cppcheck failed" > "$folder/cppcheck"

echo "  GCC     $# files"
for file; do
    not=()
    while read -r option; do not+=("${option/-W/-Wno-}"); done < <(
        awk -v f="$file" '$1 == "gcc" && $2 == f { print $3 }' "$known"
    )
    gcc "${flags[@]}" -O1 -fanalyzer "${not[@]}" -c "$file" -o /dev/null
done > "$folder/gcc" 2>&1

cat "$folder/tidy" "$folder/cppcheck" "$folder/gcc"
[ ! -s "$folder/tidy" ] && [ ! -s "$folder/cppcheck" ] && [ ! -s "$folder/gcc" ] && echo "nothing found"
