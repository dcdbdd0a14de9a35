#!/bin/sh
# bundle.sh TO OBJECTS GENERATED SOURCE...: the library's sources, every header that they include (as the compiler
# has found them, in OBJECTS) and what those need to be built without a shader compiler, to the folder TO, which is
# replaced.
set -eu
to=$1 objects=$2 generated=$3
shift 3

rm -rf "$to.new"
mkdir -p "$to.new"
for source; do
    echo "$source"
    tr -s ' \\' '\n\n' < "$objects/${source%.c}.d" | grep '\.\(h\|inc\)$'
done | sort -u | while read -r file; do
    place=$file
    case $file in "$generated"/*) place=gen/${file#"$generated"/} ;; esac
    mkdir -p "$to.new/$(dirname "$place")"
    cp "$file" "$to.new/$place"
done
cp LICENSE package/CMakeLists.txt "$to.new"
cp include/masu.hpp "$to.new/include"
cp package/bundle-Makefile "$to.new/Makefile"
rm -rf "$to"
mv "$to.new" "$to"
