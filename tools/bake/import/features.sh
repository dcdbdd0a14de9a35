#!/bin/sh
# features.sh: prints the table of what is read of glTF files, for docs/scene.md.
#   features.sh --into FILE   prints FILE with the table between its two markers replaced
set -eu
rows=$(dirname "$0")/gltf_features.inc

table() {
    printf '| glTF | read | not read, approximated or clamped |\n|---|---|---|\n'
    sed -n 's/^[A-Z]*("\(.*\)", "\(.*\)", "\(.*\)")$/| \1 | \2 | \3 |/p' "$rows" | sed 's/|  |/| |/g'
    printf '| other extensions | | all; a required one is an error |\n'
}

[ "${1:-}" = --into ] || { table; exit; }
sed '/^<!-- gltf features -->$/q' "$2"
echo
table
echo
sed -n '/^<!-- end of gltf features -->$/,$p' "$2"
