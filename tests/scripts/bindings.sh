#!/bin/bash
# Other languages on the interface of masu.h: include/masu.hpp with examples/raii.cpp in C++, which renders, and the
# generated declarations (package/cdef.sh) with examples/inspect.lua in LuaJIT, whose layouts are those of the ABI.
set -u
build=${BUILD:-build} made=${MADE:-build}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ "${config:-release}" = release ] || { echo "of config=release alone" && exit 77; }
failed=0

fail() {
    echo "$1"
    failed=1
}

# ---- C++ -----------------------------------------------------------------------------------------

lines=$(wc -l < include/masu.hpp)
[ "$lines" -le 300 ] || fail "masu.hpp has $lines lines: at most 300"
${CXX:-g++} -std=c++17 -Wall -Wextra -Wpedantic -Werror -Iinclude -Iplatform examples/raii.cpp \
    "$build/lib/libmasu-platform.a" "$build/lib/libmasu.a" -lvulkan -lm -o "$folder/raii" || fail 'raii.cpp does not compile'
"$folder/raii" "$made/scenes/test_live.masu" "$folder/raii.png" > "$folder/out" 2> "$folder/err" ||
    fail "raii: $(cat "$folder/out" "$folder/err")"
grep -q 'masu_desc.bytes is .*, this library .* needs ' "$folder/out" || fail "raii: $(cat "$folder/out")"
grep -q 'instances, validation 0$' "$folder/out" || fail "raii: $(cat "$folder/out")"
[ "$(convert "$folder/raii.png" -format %k info:)" -gt 100 ] || fail 'raii.png is hardly a picture'
"$folder/raii" /dev/null "$folder/none.png" 2> "$folder/err" && fail 'raii takes an empty scene'
grep -q '^raii: .' "$folder/err" || fail "raii, of an empty scene: $(cat "$folder/err")"

# ---- LuaJIT --------------------------------------------------------------------------------------

if ! command -v luajit > /dev/null; then
    echo 'no LuaJIT here (make deps-test)'
    [ $failed = 0 ] && exit 77
    exit 1
fi
package/cdef.sh > "$folder/masu.cdef"
inspect() { luajit examples/inspect.lua "$build/lib/libmasu.so" "$folder/masu.cdef" "$made/scenes/test_live.masu" "$1"; }
inspect tests/consumers/abi.txt > "$folder/lua" 2>&1 || fail "inspect.lua: $(tail -n 3 "$folder/lua")"
version=$(sed -n 's/^.define MASU_VERSION_[A-Z]* //p' include/masu.h | paste -sd.)
grep -qx "masu $version" "$folder/lua" || fail "inspect.lua: $(head -n 1 "$folder/lua")"
class=$("$build/bin/masu" plan "$made/scenes/test_live.masu" --size 64x64 | sed -n 's/^class: \([a-z-]*\).*/\1/p')
grep -qx "class $class" "$folder/lua" || fail "inspect.lua: not of the class $class"
grep -q '^masu_desc_resolve: masu_desc.bytes is ' "$folder/lua" || fail 'inspect.lua: no error of a wrong size'
alike=$(sed -n 's/^layouts: \([0-9]*\) alike, 0 differ$/\1/p' "$folder/lua")
[ "${alike:-0}" -gt 500 ] || fail "inspect.lua: $(tail -n 1 "$folder/lua")"
# A member at another place is seen.
sed 's/^member masu_viewport.y at 4,/member masu_viewport.y at 8,/' tests/consumers/abi.txt > "$folder/other"
inspect "$folder/other" > "$folder/lua" && fail 'self-test: another layout is not seen'
grep -q '^member masu_viewport.y at 8,.* 4 in LuaJIT$' "$folder/lua" || fail 'self-test: another layout is not named'
[ $failed = 0 ] && echo "C++ and LuaJIT: all as expected, $alike layouts alike"
exit $failed
