#!/bin/sh
# The example in the README is examples/minimal.c to the letter, is at most 60 lines, and every file that the README links
# to is there.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' README.md > "$folder/block.c"
diff "$folder/block.c" examples/minimal.c
[ "$(wc -l < examples/minimal.c)" -le 60 ]
grep -o '](\([^)]*\))' README.md | sed 's/](\(.*\))/\1/' | grep -v '^http' | while read -r file; do
    [ -e "$file" ] || { echo "README.md links to $file, which is not there"; exit 1; }
done
