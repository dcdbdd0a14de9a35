#!/bin/sh
# strip.sh DIR FILE...: copies each shader source to DIR without comments and blank lines. A copy whose content would
# not change keeps its time: an edited comment compiles no shader. shaders/NAME is copied to DIR/NAME, any other path to
# DIR/PATH. Removes copies of files that are not listed. Lines that continue another (\) are kept, even blank ones.
set -eu
dir=$1
shift
mkdir -p "$dir"
printf '%s\n' "$@" | sed 's|^shaders/||' | sort > "$dir.listed"
sed -n 's|/[^/]*$||p' "$dir.listed" | sort -u | while read -r folder; do mkdir -p "$dir/$folder"; done
awk -v dir="$dir" '
function finish(    path, old, line, exists) {
    path = source
    sub(/^shaders\//, "", path)
    path = dir "/" path
    old = ""
    exists = (getline line < path) >= 0
    close(path)
    while ((getline line < path) > 0) old = old line "\n"
    close(path)
    if (exists && old == text) return
    printf "%s", text > path
    close(path)
}
FNR == 1 { if (source != "") finish(); source = FILENAME; text = ""; comment = rest = continued = 0 }
{
    sub(/\r$/, "")
    line = (rest ? "//" : "") $0 # rest: of a comment that the line above continues
    out = ""
    rest = 0
    while (line != "") {
        if (comment) {
            end = index(line, "*/")
            if (!end) break
            line = substr(line, end + 2)
            comment = 0
            out = out " "
        } else if (match(line, /\/[*\/]/)) {
            out = out substr(line, 1, RSTART - 1)
            if (substr(line, RSTART, 2) == "//") {
                rest = line ~ /\\$/
                break
            }
            line = substr(line, RSTART + 2)
            comment = 1
        } else {
            out = out line
            break
        }
    }
    sub(/[ \t]+$/, "", out)
    if (continued || out ~ /[^ \t]/) text = text out "\n"
    continued = out ~ /\\$/
}
END { if (source != "") finish() }' "$@"
(cd "$dir" && find . -type f | sed 's|^\./||' | sort) | comm -23 - "$dir.listed" | while read -r old; do
    rm -f "$dir/$old"
done
rm -f "$dir.listed"
