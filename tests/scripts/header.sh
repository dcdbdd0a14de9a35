#!/bin/sh
# The public header stands alone, with its two parts: it compiles as C11 pedantic and as C++17, with nothing before it,
# and includes nothing but the Vulkan headers and the C library's freestanding ones.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

printf '#include "masu.h"\n#include "masu.h"\nint main(void) { return 0; }\n' > "$folder/header.c"
cp "$folder/header.c" "$folder/header.cpp"
strict="-pedantic-errors -Wall -Wextra -Werror -Iinclude"
# shellcheck disable=SC2086
${CC:-gcc} -std=c11 $strict -c "$folder/header.c" -o "$folder/c.o"
# shellcheck disable=SC2086
${CXX:-g++} -std=c++17 $strict -c "$folder/header.cpp" -o "$folder/cpp.o"

printf '#include "masu.hpp"\n#include "masu.hpp"\nint main() { return 0; }\n' > "$folder/wrapper.cpp"
# shellcheck disable=SC2086
${CXX:-g++} -std=c++17 $strict -c "$folder/wrapper.cpp" -o "$folder/wrapper.o"

others=$(sed -n 's/^ *# *include *//p' include/*.h |
    grep -vxE '<(stddef|stdint|stdbool)\.h>|<vulkan/vulkan_core\.h>|"masu_(knobs|study)\.h"' || true)
[ -z "$others" ] || { echo "masu.h includes $others"; exit 1; }
