#!/bin/bash
# gallery.sh: an HTML page of third-party models as masu-bake shows them: for each an image, its name, triangles, bytes,
# CPU seconds, and masu-bake's messages. It is made to be looked at; tests/scripts/bake.sh counts the outcomes.
#
#   gallery.sh OUT FOLDER...     OUT: a new or empty folder for index.html, the images, counts.txt (outcomes),
#                               kinds.txt (warnings and errors by kind: the number of files with each)
#
# SIZE (480x270) of the images, MATCH a pattern (find -path) of the models, JOBS (all processors) in parallel.
# Clips are shown at TIME (0.5) seconds. NO_PICTURES=1 only bakes. With PATHS=N, above 0, each row has the reference
# with N paths per pixel, the converged image of a still camera, and one raw frame.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
masu=$(realpath "${BUILD:-build}/bin/masu")
lab=$(realpath -m "${BUILD:-build}/lab/bin/masu-lab")
paths=${PATHS:-0}
size=${SIZE:-480x270}
time=${TIME:-0.5}

. tests/outcome.sh

html() { sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g'; }

# kinds FILE: the kinds of the warnings and of an error on stdin, without names of files and numbers
kinds() {
    sed -n "s/^masu-bake: //; s|${1//[|.*&[]/.}|FILE|g; s/.*warning: /warning: /; s/^cannot read FILE: /refused: /
        s/^warning: texture .*: \([^:]*; ignored\)/warning: texture: \1/; s/^warning: unsupported textures.*/warning: unsupported textures/
        s/^warning: [^:\"]*\.[A-Za-z0-9]*: /warning: /; s/ (\(in [0-9]* meshes\|first\).*//; s/material \"[^\"]*\"/a material/
        s/'[^']*'/'...'/g; s/_[0-9]\+/_n/g; s/\b[0-9][0-9.e+-]*/N/g
        /^\(warning\|refused\): /p" | cut -c 1-120
}

# beside NUMBER FILE: the other two images of the row, or the reason why there is no reference
beside() {
    local at=$out/$1 sdf=()
    case $2 in
    *.sdf) sdf=(--sdf "$2") ;;
    *.json) mapfile -t sdf < <(sed -n 's|.*"source": *"\([^"]*\.sdf\)".*|--sdf\n'"${2%/*}"'/\1|p' "$2") ;;
    esac
    "$lab" reference "$at.masu" -o "$at.ref.png" --paths "$paths" --size "$size" --time "$time" --quiet "${sdf[@]}" 2>> "$at.err" &&
        echo "<img src=\"$1.ref.png\" loading=\"lazy\" alt=\"reference\">"
    "$masu" render "$at.masu" -o "$at.raw.png" --frame --size "$size" --time "$time" --quiet 2>> "$at.err" &&
        echo "<img src=\"$1.raw.png\" loading=\"lazy\" alt=\"raw frame\">"
}

# one NUMBER FILE NAME: a row of the page in OUT/NUMBER.row, its outcome in OUT/NUMBER.outcome
one() {
    local number=$1 file=$2 name=$3 at=$out/$1 took code
    local TIMEFORMAT='%3U %3S'
    { time timeout 600 "$bake" "$file" -o "$at.masu" --stats "$at.json" --quiet > /dev/null 2> "$at.err" < /dev/null; } 2> "$at.cpu"
    code=$?
    took=$(awk '{ printf "%d", 1000 * ($1 + $2) }' "$at.cpu")
    outcome $code "$at.err" > "$at.outcome"
    kinds "$file" < "$at.err" | sort -u > "$at.kinds"
    {
        echo "<figure>"
        if [ $code = 0 ] && [ ! "${NO_PICTURES:-}" ]; then
            if timeout 300 "$masu" render "$at.masu" -o "$at.png" --size "$size" --time "$time" --quiet > /dev/null 2>> "$at.err"; then
                [ "$paths" = 0 ] || beside "$number" "$file" > "$at.beside"
                grep -s ref.png "$at.beside"
                echo "<img src=\"$number.png\" loading=\"lazy\" alt=\"\">"
                grep -s raw.png "$at.beside"
            else
                echo "WRONG: does not render" > "$at.outcome"
            fi
        fi
        printf '<figcaption><b>%s</b><br>' "$(html <<< "$name")"
        if [ $code = 0 ]; then
            printf '%s triangles, %s bytes, ' "$(sed -n 's/^  "drawn_triangles": \([0-9]*\).*/\1/p' "$at.json")" \
                "$(stat -c %s "$at.masu")"
        fi
        printf '%d.%03d s<br>%s' $((took / 1000)) $((took % 1000)) "$(cat "$at.outcome")"
        sed "s|^masu-bake: ||; s|$file: ||; s|${file%/*}/||g" "$at.err" | cut -c 1-300 | html | sed 's/^/<br><small>/; s/$/<\/small>/'
        printf '</figcaption></figure>\n'
    } > "$at.row"
    echo "$took $name" > "$at.took"
    sed -n 's/^  "peak_bytes": \([0-9]*\).*/\1/p' "$at.json" > "$at.peak" 2> /dev/null
    rm -f "$at.masu" "$at.json"
}

if [ "${1:-}" = --one ]; then
    out=$2
    one "$3" "$4" "$5"
    exit
fi

out=$1
shift
mkdir -p "$out" || exit 1
out=$(realpath "$out")
rm -f "$out"/[0-9]*.{png,row,outcome,took,peak,err,cpu,kinds} "$out"/index.html "$out"/counts.txt
number=0
for folder in "$@"; do
    [ -d "$folder" ] || continue
    while read -r file; do
        is_model "$file" || continue
        case $folder in */tracks | */tracks/) [[ $file == *.acc ]] || continue ;; esac # beside descriptions in XML
        number=$((number + 1))
        printf '%s\0%s\0%s\0%s\0%s\0' --one "$out" "$(printf %04d $number)" "$file" "${file#"${folder%/}"/}"
    done < <(find "$folder" -type f ! -size +64M -path "${MATCH:-*}" | LC_ALL=C sort)
done > "$out/list"
xargs -0 -n 5 -P "${JOBS:-$(nproc)}" -r "$0" < "$out/list"
rm -f "$out/list"
cat "$out"/[0-9]*.outcome 2> /dev/null | sort | uniq -c | sort -rn > "$out/counts.txt"
{
    echo '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Models of strangers</title>'
    echo '<style>body{font:14px sans-serif;background:#ddd}figure{display:inline-block;vertical-align:top;margin:6px;'
    echo "width:$((paths ? 1440 : 480))px;"
    echo 'background:#fff;overflow-wrap:anywhere}img{width:480px;float:left}figcaption{clear:both;padding:6px}small{color:#a30}</style>'
    echo '<h1>Models of strangers</h1><pre>'
    html < "$out/counts.txt"
    cut -d ' ' -f 1 "$out"/[0-9]*.took 2> /dev/null | sort -n | awk '{ t[NR] = $1 } END { if (NR)
        printf "processor seconds to bake: median %.2f, most %.2f\n", t[int((NR + 1) / 2)] / 1000, t[NR] / 1000 }' | tee -a "$out/counts.txt"
    cat "$out"/[0-9]*.peak 2> /dev/null | sort -n | awk '{ p[NR] = $1 } END { if (NR)
        printf "memory to bake, MB: median %.1f, most %.1f\n", p[int((NR + 1) / 2)] / 1e6, p[NR] / 1e6 }' | tee -a "$out/counts.txt"
    cat "$out"/[0-9]*.kinds 2> /dev/null | sort | uniq -c | sort -rn | tee "$out/kinds.txt" | html
    sort -rn "$out"/[0-9]*.took 2> /dev/null | head -5 | awk '{ $1 = $1 / 1000 " s "; print }' | html
    echo '</pre>'
    cat "$out"/[0-9]*.row 2> /dev/null
    echo '</html>'
} > "$out/index.html"
rm -f "$out"/[0-9]*.{row,outcome,took,peak,err,cpu,kinds,beside}
cat "$out/counts.txt"
echo "The page is $out/index.html"
! grep -q WRONG "$out/counts.txt"
