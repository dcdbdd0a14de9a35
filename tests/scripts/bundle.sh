#!/bin/bash
# What `make bundle` writes builds without a shader compiler or anything else of this tree: by its Makefile and, as part
# of a project, by CMake; the program works. And each source compiles by itself, with the flags that docs/embedding.md names.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build=${BUILD:-build}

make --no-print-directory bundle > "$folder/said" || { cat "$folder/said" && exit 1; }
mv "$build/bundle" "$folder/bundle"
bundle=$folder/bundle
version=$(sed -n 's/^.define MASU_VERSION_[A-Z]* //p' include/masu.h | paste -sd.)
for f in LICENSE Makefile CMakeLists.txt include/masu.h gen/packed.h src/api.c; do
    [ -f "$bundle/$f" ] || { echo "the bundle has no $f"; exit 1; }
done
[ "$(find "$bundle/src" -name '*.c' | wc -l)" = "$(find src -name '*.c' | wc -l)" ]
if grep -rl "$PWD" "$bundle"; then echo 'names this folder'; exit 1; fi

# A PATH that has a C compiler and no shader compiler.
mkdir "$folder/bin"
for tool in sh bash make cmake ar ranlib ld as nm objcopy objdump strip rm mkdir cat cp uname "${CC:-gcc}" cc1 collect2; do
    path=$(command -v "$tool") && ln -s "$path" "$folder/bin/$(basename "$tool")"
done
alone() { env -i PATH="$folder/bin" HOME="$folder" "$@"; }
if alone sh -c 'command -v glslangValidator || command -v spirv-opt'; then echo 'has a shader compiler'; exit 1; fi

alone make -C "$bundle" -j2 CC="$(basename "${CC:-gcc}")" CFLAGS='-O0 -Wall -Wextra -Werror' > "$folder/said" 2>&1 || { cat "$folder/said"; exit 1; }
${CC:-gcc} -std=c11 tests/consumers/minimal.c -I"$bundle/include" "$bundle/libmasu.a" -lm -o "$folder/minimal"
[ "$("$folder/minimal")" = "masu $version: success" ]

# CMake's build checks each source with its own flags, and links the objects above.
cat > "$folder/bin/check" << 'END'
#!/bin/sh
for source; do :; done
case $source in
    */bundle/src/*.c) "$@" -fsyntax-only && while [ "$1" != -o ]; do shift; done && cp "${source%.c}.o" "$2" ;;
    *) exec "$@" ;;
esac
END
chmod +x "$folder/bin/check"
{ alone cmake -S tests/consumers/vendored -B "$folder/vendored" -DBUNDLE="$bundle" -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_C_COMPILER_LAUNCHER="$folder/bin/check" -DCMAKE_C_COMPILER="$folder/bin/$(basename "${CC:-gcc}")" &&
    alone cmake --build "$folder/vendored" -j2; } > "$folder/said" 2>&1 ||
    { cat "$folder/said"; exit 1; }
[ "$("$folder/vendored/consumer")" = "masu $version: success" ]
