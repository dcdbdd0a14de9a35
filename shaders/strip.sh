#!/bin/sh
# strip.sh DIR FILE...: copies each shader source to DIR without comments and blank lines. A copy whose content would
# not change keeps its time: an edited comment compiles no shader. shaders/NAME is copied to DIR/NAME, any other path to
# DIR/PATH. Removes copies of files that are not listed.
set -eu
dir=$1
shift
mkdir -p "$dir"
printf '%s\n' "$@" | sed 's|^shaders/||' | sort > "$dir.listed"
sed -n 's|/[^/]*$||p' "$dir.listed" | sort -u | while read -r folder; do mkdir -p "$dir/$folder"; done
awk -v dir="$dir" '
function finish(    path, old, line) {
    path = source
    sub(/^shaders\//, "", path)
    path = dir "/" path
    old = ""
    while ((getline line < path) > 0) old = old line "\n"
    close(path)
    if (old == text) return
    printf "%s", text > path
    close(path)
}
FNR == 1 { if (source != "") finish(); source = FILENAME; text = ""; comment = 0 }
{
    line = $0
    out = ""
    while (line != "") {
        if (comment) {
            end = index(line, "*/")
            if (!end) break
            line = substr(line, end + 2)
            comment = 0
            out = out " "
        } else if (match(line, /\/[*\/]/)) {
            out = out substr(line, 1, RSTART - 1)
            if (substr(line, RSTART, 2) == "//") break
            line = substr(line, RSTART + 2)
            comment = 1
        } else {
            out = out line
            break
        }
    }
    sub(/[ \t]+$/, "", out)
    if (out ~ /[^ \t]/) text = text out "\n"
}
END { if (source != "") finish() }' "$@"
(cd "$dir" && find . -type f | sed 's|^\./||' | sort) | comm -23 - "$dir.listed" | while read -r old; do
    rm -f "$dir/$old"
done
rm -f "$dir.listed"
