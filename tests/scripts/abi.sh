#!/bin/bash
# The binary interface of masu.h is the one of tests/consumers/abi.txt: functions with their types, values of enums,
# offset, size and type of each public member. A difference is one line that says what changed and what to do.
# `abi.sh --write` (make abi) writes the file, unless the change breaks an ABI that has been released.
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ "$(getconf LONG_BIT)" = 64 ] || { echo 'offsets are those of 64-bit machines' && exit 77; }
list=tests/consumers/abi.txt

# compare OLD NEW RELEASED: the line, or nothing if both are the same; 1 if the new one must not be written. RELEASED:
# a changelog.
compare() {
    local old new changed more first
    if cmp -s "$1" "$2"; then return 0; fi
    old=$(sed -n '1s/^abi //p' "$1") new=$(sed -n '1s/^abi //p' "$2")
    changed=$(diff <(sed 1d "$1") <(sed 1d "$2") | grep -c '^<')
    more=$(diff <(sed 1d "$1") <(sed 1d "$2") | grep -c '^[<>]')
    first=$(diff <(sed 1d "$1") <(sed 1d "$2") | sed -n 's/^< /was: /p; s/^> /new: /p' | head -n 1)
    if [ "$changed" = 0 ]; then
        echo "ABI $new grows (${first:-only its number}, $more lines): run make abi, and commit $list"
    elif [ "$old" = "$new" ] && grep -q "^## $new\.[0-9]" "$3"; then
        echo "ABI $new is released, and this breaks it ($first, $changed lines): raise MASU_VERSION_MINOR in" \
            "include/masu.h, then run make abi"
        return 1
    else
        echo "ABI $old -> $new changes ($first, $changed lines): run make abi, and commit $list"
    fi
}

# ---- The rules see what breaks them --------------------------------------------------------------

failed=0
# sees TEXT STATUS NEW CHANGELOG
sees() {
    local line status
    printf 'abi 0.1\nmember a.b at 0, 4 bytes, int\n' > "$folder/old"
    printf '%b' "$3" > "$folder/new"
    printf '%b' "$4" > "$folder/log"
    line=$(compare "$folder/old" "$folder/new" "$folder/log")
    status=$?
    case $line in "$1"*) ;; *) false ;; esac && [ $status = "$2" ] && [ "$(wc -l <<< "$line")" = 1 ] ||
        { echo "self-test: '$line' ($status) for $3" && failed=1; }
}
sees '' 0 'abi 0.1\nmember a.b at 0, 4 bytes, int\n' '## 0.1.0\n'
sees 'ABI 0.1 grows (new: member a.c' 0 'abi 0.1\nmember a.b at 0, 4 bytes, int\nmember a.c at 4, 4 bytes, int\n' '## 0.1.0\n'
sees 'ABI 0.1 is released, and this breaks it (was: member a.b' 1 'abi 0.1\nmember a.b at 8, 4 bytes, int\n' '## 0.1.2 (x)\n'
sees 'ABI 0.1 -> 0.1 changes (was: member a.b' 0 'abi 0.1\nmember a.b at 8, 4 bytes, int\n' '## Unreleased\n'
sees 'ABI 0.1 -> 0.2 changes' 0 'abi 0.2\nmember a.b at 8, 4 bytes, int\n' '## 0.1.0\n'
# A header with a member more, and another type, is not the same.
mkdir "$folder/include"
cp include/masu*.h "$folder/include"
sed -i 's/^    uint32_t x, y, width, height;/    uint32_t x, y, width, height, more;/' "$folder/include/masu.h"
package/abi.sh "$folder/include" > "$folder/more"
grep -q '^member masu_viewport.more at 16, 4 bytes, uint32_t$' "$folder/more" || { echo 'self-test: a new member' && failed=1; }
[ "$(grep -c '^function ' "$folder/more")" = "$(wc -l < tests/consumers/exports.txt)" ] ||
    { echo 'self-test: not all exported functions are seen' && failed=1; }

# ---- The ABI -------------------------------------------------------------------------------------

package/abi.sh > "$folder/abi.txt" || exit 1
[ "$(grep -c '^member ' "$folder/abi.txt")" -gt 500 ] || { echo 'hardly any members' && exit 1; }
line=$(compare "$list" "$folder/abi.txt" CHANGELOG.md)
good=$?
if [ "${1:-}" = --write ]; then
    [ -z "$line" ] || echo "${line%%: run make abi*}"
    [ $good = 0 ] && [ $failed = 0 ] && cp "$folder/abi.txt" "$list"
    exit
fi
[ -z "$line" ] || { echo "$line" && exit 1; }
echo "ABI $(sed -n '1s/^abi //p' "$list"): $(wc -l < "$list") lines"
exit $failed
