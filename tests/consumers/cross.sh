#!/bin/bash
# cross.sh BUNDLE FOLDER SCENES: builds the bundle for other machines and links minimal.c with it; where the result can
# run (64-bit Arm by qemu, 32-bit x86 by itself), minimal.c and cross.c have to say what they say here.
set -eu
bundle=$1 folder=$2 scenes=$3
mkdir -p "$folder/vulkan-headers"
for part in vulkan vk_video; do
    [ ! -d /usr/include/$part ] || ln -sfn /usr/include/$part "$folder/vulkan-headers/$part"
done

# build NAME COMPILER FLAGS...: the library and both programs
build() {
    local to=$folder/$1 cc=$2
    shift 2
    rm -rf "$to" && cp -r "$bundle" "$to"
    make -C "$to" -j"$(nproc)" CC="$cc" CFLAGS="-O2 -Wall -Wextra -Wpedantic -Werror $* -I$(realpath "$folder")/vulkan-headers" \
        > "$to/said" 2>&1 || { cat "$to/said" && return 1; }
    for program in minimal cross; do
        $cc -std=c11 -O2 -Wall -Wextra -Wpedantic -Werror "$@" -I"$folder/vulkan-headers" -I"$to/include" -I"$to/src" -I"$to/shaders" -I"$to/gen" \
            tests/consumers/$program.c "$to/libmasu.a" -lm -static -o "$to/$program"
    done
}

# same NAME RUNNER...: what the programs say is what they say here
same() {
    local name=$1
    shift
    for program in minimal cross; do
        "$@" "$folder/$name/$program" $([ $program = minimal ] || echo "$scenes"/*.masu) > "$folder/$name/$program.txt"
        diff "$folder/here/$program.txt" "$folder/$name/$program.txt" || { echo "$name: $program differs"; exit 1; }
    done
    echo "$name: $(wc -l < "$folder/$name/cross.txt") lines alike"
}

build here gcc
same_here() { "$folder/here/$1" "${@:2}" > "$folder/here/$1.txt"; }
same_here minimal
same_here cross "$scenes"/*.masu
build i386 i686-linux-gnu-gcc -mfpmath=sse -msse2
same i386 env
build aarch64 aarch64-linux-gnu-gcc
same aarch64 qemu-aarch64
build mingw x86_64-w64-mingw32-gcc
echo "mingw: $(file -b "$folder/mingw/minimal.exe" 2> /dev/null || echo linked), not run"
