#!/bin/bash
# Plain language: measures how often the documents, the public headers and the help texts use phrases of dialect.tsv, in
# hits per 1,000 words, and prints the worst files. Fails above 4 for all texts together, and for a file with more than
# 6 hits and above 8. A row of the table is a name, a Perl regular expression, an example and a replacement, by tabs.
#
# dialect.sh [FILE...]: measures only these Markdown or C files, and prints each hit.
#
# shellcheck disable=SC2016 # backquotes are text
set -u
export LC_ALL=C
table=$(dirname "$0")/dialect.tsv
bin=${BUILD:-build}/bin
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

fail() {
    echo "$1"
    failed=1
}

# Paragraphs of a Markdown file, one per line, without code.
markdown() {
    awk '
        function flush() { if (text != "") print text; text = "" }
        /^ *```/ { fenced = !fenced; flush(); next }
        fenced || /^    [^ -]/ && text == "" { next }
        { sub(/\r$/, ""); gsub(/`[^`]*`/, " ") }
        /^[ \t]*$/ || /^[|#]/ || /^ *([-*]|[0-9]+\.) / { flush() }
        { sub(/^[ \t]*([-*]|[0-9]+\.|#+)?[ \t]*/, ""); text = text (text == "" ? "" : " ") $0 }
        /^[|#]/ { flush() }
        END { flush() }' "$1" | sed 's/`[^`]*`/ /g; s/](\([^)]*\))/]/g'
}

# Comments and strings of a C file, one per line. A comment whose marks are on several lines is one line.
c_text() {
    awk '
        function flush() { if (text != "") print text; text = "" }
        {
            line = $0
            while (line != "") {
                if (inside) {
                    end = index(line, "*/")
                    part = end ? substr(line, 1, end - 1) : line
                    sub(/^[ \t]*\*? ?/, "", part)
                    if (part == "") flush()
                    else text = text (text == "" ? "" : " ") part
                    if (!end) break
                    inside = 0
                    flush()
                    line = substr(line, end + 2)
                    continue
                }
                if (!match(line, /"|\/\*|\/\//)) break
                mark = substr(line, RSTART, RLENGTH)
                line = substr(line, RSTART + RLENGTH)
                if (mark == "/*") inside = 1
                else if (mark == "//") { print line; break }
                else {
                    match(line, /^([^"\\]|\\.)*/)
                    string = substr(line, 1, RLENGTH)
                    line = substr(line, RLENGTH + 2)
                    if (string ~ / /) print string
                }
            }
        }' "$1"
}

# The help of each built program and of each command of masu and masu-lab; without programs the strings of their
# sources.
help_texts() {
    local file program command
    if [ ! -x "$bin/masu" ]; then
        for file in tools/masu/*.c tools/*/main.c lab/*/main.c; do [ ! -e "$file" ] || c_text "$file" | grep '^[^/]'; done
        return
    fi
    for program in "$bin"/masu "$bin"/masu-*; do
        [ -x "$program" ] || continue
        "$program" --help < /dev/null > "$folder/help" 2>&1
        cat "$folder/help"
        case $program in */masu | */masu-lab) ;; *) continue ;; esac
        awk '/^  [a-z][a-z-]+  / { print $1 }' "$folder/help" | while read -r command; do
            "$program" "$command" --help < /dev/null 2>&1
        done
    done | sed 's/^ *//'
}

# collect FILE...: writes the text of the files to $folder/text, and to $folder/names the file of each line
collect() {
    local file
    : > "$folder/text"
    : > "$folder/names"
    for file; do
        case $file in
            *.md) markdown "$file" ;;
            --help) help_texts ;;
            *) c_text "$file" ;;
        esac > "$folder/one"
        cat "$folder/one" >> "$folder/text"
        awk -v name="$file" '{ print name }' "$folder/one" >> "$folder/names"
    done
}

# hits: NAME<tab>LINE:TEXT for each hit in $folder/text
hits() {
    while IFS=$'\t' read -r name pattern _; do
        grep -noP -e "$pattern" "$folder/text" | sed "s/^/$name	/"
    done < "$table"
}

# measure: "INDEX HITS WORDS FILE" by falling index, and the sum as the last line
measure() {
    hits | awk -F '\t' '{ split($2, part, ":"); print part[1] }' > "$folder/lines"
    awk -v lines="$folder/lines" -v names="$folder/names" '
        BEGIN { while ((getline line < lines) > 0) hit[line]++; while ((getline line < names) > 0) file[++n] = line }
        { count = gsub(/[A-Za-z\047]+/, "")
          words[file[FNR]] += count; found[file[FNR]] += hit[FNR]; all += count; sum += hit[FNR] }
        END { for (f in words) if (words[f]) printf "%.1f %d %d %s\n", 1000 * found[f] / words[f], found[f], words[f], f
              printf "%.1f %d %d all\n", all ? 1000 * sum / all : 0, sum, all }' "$folder/text" | sort -rn |
        awk '$4 == "all" { last = $0; next } { print } END { print last }'
}

# ---- Self-test: every pattern finds its example, and code is not text ------------------------------

number=0
while IFS=$'\t' read -r name pattern example plain; do
    number=$((number + 1))
    [ "$plain" ] || fail "self-test: row $number of dialect.tsv does not have four columns"
    grep -qP -e "$pattern" <<< "$example" || fail "self-test: $name does not find '$example'"
done < "$table"
printf 'Of what lies\nbeside it nothing is told.\n\n`the picture` is plain\n\n```\nthe picture\n```\n' > "$folder/bad.md"
printf '/* A picture that\n * moves. */\nint picture;\nconst char *s = "what is shown";\n' > "$folder/bad.h"
echo 'The pass reads depth and writes the tile list.' > "$folder/good.md"
collect "$folder/bad.md" "$folder/bad.h" "$folder/good.md"
found=$(measure | awk '{ sub(/.*\//, "", $4); printf "%s=%s ", $4, $2 }')
for expected in bad.md=5 bad.h=3 good.md=0 all=8; do
    [[ $found == *$expected\ * ]] || fail "self-test: found $found, expected $expected"
done

# ---- The texts -----------------------------------------------------------------------------------

if [ $# -gt 0 ]; then
    collect "$@"
    hits | while IFS=$'\t' read -r name hit; do
        line=${hit%%:*}
        echo "$(sed -n "${line}p" "$folder/names"): $name: ${hit#*:}: $(sed -n "${line}p" "$folder/text" | cut -c 1-160)"
    done
    measure
    exit $failed
fi
# shellcheck disable=SC2046 # no names with spaces
collect README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md tests/expect/README.md $(find docs lab -name '*.md' 2> /dev/null | sort) \
    include/*.h --help
measure > "$folder/result"
tail -n 1 "$folder/result" | awk '{ printf "%s hits per 1,000 words (%d hits, %d words); the worst files:\n", $1, $2, $3 }'
head -n 10 "$folder/result" | awk '$2 { printf "  %6s %5d hits  %s\n", $1, $2, $4 }'
grep -v ' all$' "$folder/result" | awk '$2 > 6 && $1 > 8 { print "too much dialect: " $4 ": tests/scripts/dialect.sh " $4 }' > "$folder/bad"
[ ! -s "$folder/bad" ] || fail "$(cat "$folder/bad")"
tail -n 1 "$folder/result" | awk '{ exit !($1 > 4) }' && fail "all texts together are above 4 hits per 1,000 words"
exit $failed
