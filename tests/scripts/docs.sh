#!/bin/bash
# Documents tell the truth about what is there: links and paths lead somewhere, commands, options and
# make targets that they name exist, the README's example is examples/minimal.c to the letter, and
# README, CONTRIBUTING and ARCHITECTURE stay short. Each rule is first shown something that breaks it.
#
# shellcheck disable=SC2016,SC2317 # backquotes are text; rules are called through expect and expect_none
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
bin=${BUILD:-build}/bin

# The documents below a folder, as paths relative to it.
documents() {
    (cd "$1" && find . -name '*.md' ! -path './build/*' ! -path './.git/*' | sed 's|^\./||' | sort)
}

# "FILE<tab>CODE" for each code span, each line of a fenced shell block, and each indented command of
# the documents below a folder. A span may go on in the next line; what follows a # is a comment.
code() {
    documents "$1" | while read -r file; do
        awk -v file="$file" '
            /^```/ { fenced = !fenced; shell = /^```sh/; text = text "\n"; next }
            fenced { if (shell) { sub(/ +#.*/, ""); print file "\t" $0 } next }
            /^    (masu|make|build)/ { sub(/ +#.*/, ""); sub(/^ +/, ""); print file "\t" $0; next }
            { text = text ($0 == "" ? "\n\n" : " " $0) }
            END {
                count = split(text, paragraphs, "\n")
                for (p = 1; p <= count; p++) {
                    spans = split(paragraphs[p], parts, "`")
                    for (s = 2; s < spans; s += 2) print file "\t" parts[s]
                }
            }' "$1/$file"
    done
}

# ---- Rules: each prints what breaks it -----------------------------------------------------------

broken_links() {
    documents "$1" | while read -r file; do
        awk '/^```/ { fenced = !fenced; next } !fenced { gsub(/`[^`]*`/, ""); print }' "$1/$file" |
            grep -o '](\([^)]*\))' | sed 's/](\(.*\))/\1/; s/#.*//' |
            while read -r link; do
                case $link in http://* | https://* | "") continue ;; esac
                [ -e "$1/$(dirname "$file")/$link" ] || echo "$file links to $link"
            done
    done
}

# Paths in code spans, but patterns and placeholders. A changelog names what has gone, too.
missing_paths() {
    code "$1" | grep -v '^CHANGELOG.md' |
        grep -E '	(src|include|shaders|tools|tests|platform|suites|scenes|docs|examples|lab|package)/[A-Za-z0-9_./-]*$' |
        grep -vE 'NAME|SCENE' | sort -u | while IFS='	' read -r file path; do
        [ -e "$1/$path" ] || echo "$file names $path"
    done
}

# Documents that are named in code.
missing_documents() {
    (cd "$1" && grep -rnoE '\bdocs/[A-Za-z0-9_/.-]+\.md' --include='*.[chs]' --include='*.comp' --include='*.glsl' \
        --include='*.vert' --include='*.frag' --include='*.inc' --include='*.mk' --include='*.sh' --include=Makefile . |
        grep -vE '^\./(build/|tests/scripts/docs\.sh)') |
        while IFS=: read -r file line path; do
            [ -e "$1/$path" ] || echo "$file:$line names $path"
        done
}

# unknown_targets FOLDER TARGETS: `make TARGET` of which a file of names knows nothing
unknown_targets() {
    code "$1" | sed "s/='[^']*'//g; s/=\"[^\"]*\"//g; s/ *[&|;]\+ */\n&/g" | awk -F '\t' '
        NF == 2 { file = $1 }
        { line = NF == 2 ? $2 : $0; sub(/^ *[&|;]* */, "", line)
          count = split(line, word, " ")
          if (word[1] == "make") for (i = 2; i <= count; i++)
              if (word[i] ~ /^[a-z][a-z-]*$/) print file "\t" word[i] }' | sort -u |
        while IFS='	' read -r file target; do
            grep -qxF -e "$target" "$2" || echo "$file names make $target"
        done
}

# unknown_commands FOLDER HELP: `masu COMMAND`, `masu-lab COMMAND` and `masu-lab study NAME` that the program does not
# have, and options that the command does not have, except in the pages that list what was removed. HELP is called with
# the words of a command and prints its help. masu-lab is tested if LAB_PROGRAM names it (lab/tests/scripts/docs.sh).
unknown_commands() {
    code "$1" | grep -vE '^(CHANGELOG|lab/notes/removed)\.md' | sed 's/\$([^)]*)//g; s/ *[&|;]\+ */\n&/g' | awk -F '\t' '
        NF == 2 { file = $1 }
        { line = NF == 2 ? $2 : $0; sub(/^ *[&|;]* */, "", line)
          if (line ~ /^(build\/bin\/)?masu(-[a-z]+)? /) { sub(/^build\/bin\//, "", line); print file "\t" line } }' |
        sort -u | while IFS='	' read -r file line; do
        read -ra words <<< "$line"
        program=("${words[0]}")
        [ "${words[0]}" != masu-lab ] || [ "${LAB_PROGRAM:-}" ] || continue
        if [ "${words[0]}" = masu ] || [ "${words[0]}" = masu-lab ]; then
            [[ ${words[1]:-} =~ ^[a-z-]+$ ]] || continue
            "$2" "${program[@]}" | grep -qE "^  ${words[1]} " || { echo "$file names ${words[*]:0:2}" && continue; }
            program+=("${words[1]}")
            if [ "${words[*]:0:2}" = 'masu-lab study' ] && [[ ${words[2]:-} =~ ^[a-z] ]]; then
                for name in ${words[2]//|/ }; do
                    "$2" masu-lab study | grep -qE "^  $name " || echo "$file names masu-lab study $name"
                done
                program+=("${words[2]%%|*}")
            fi
        fi
        for word in "${words[@]}"; do
            [[ $word == -* || $word == [[]-* ]] || continue
            option=$(grep -oE '^-(-[a-z-]+|[a-z]$)' <<< "${word#[}") || continue
            "$2" "${program[@]}" | grep -qE -e "(^|[ ,|[])$option([ =[,]|$)" ||
                echo "$file: ${program[*]} has no $option"
        done
    done
}

help_of() {
    local key="$folder/help-$*"
    local program=$bin/$1
    [ "$1" != masu-lab ] || program=$LAB_PROGRAM
    [ -e "$key" ] || "$program" "${@:2}" --help > "$key" 2>&1
    cat "$key"
}

# Passes of docs/passes.md that the table does not have.
unknown_passes() {
    sed -n 's/^PASS([A-Z0-9_]*, *\([a-z0-9_]*\),.*/\1/p' "$1/src/plan/passes.inc" > "$folder/passes"
    awk -F '|' '/^\| `/ { print $2 }' "$1/docs/passes.md" | grep -o '`[a-z0-9_]*`' | tr -d '`' |
        grep -vxF -f "$folder/passes" | sed 's/^/docs\/passes.md names the pass /'
}

# Chapters that the index of docs/design does not name.
unlisted_chapters() {
    for file in "$1"/docs/design/*.md; do
        name=$(basename "$file")
        [ "$name" = README.md ] || grep -qF "]($name)" "$1/docs/design/README.md" ||
            echo "docs/design/README.md does not name $name"
    done
}

# too_long FILE LINES
too_long() {
    local lines
    lines=$(wc -l < "$1")
    [ "$lines" -le "$2" ] || echo "$1 has $lines lines, at most $2 are allowed"
}

# The first block of C in a README against a file.
other_example() {
    awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$1" | diff - "$2"
}

# expect_none NAME COMMAND...: the command prints nothing
expect_none() {
    local found
    found=$("${@:2}" 2>&1)
    [ "$found" ] || return 0
    echo "$1:"
    printf '%s\n' "$found" | sed 's/^/  /'
    failed=1
}

# expect COUNT COMMAND...: the command prints as many lines; else the rule cannot see
expect() {
    local count
    count=$("${@:2}" | wc -l)
    [ "$count" = "$1" ] && return
    echo "self-test: ${*:2} finds $count, not $1"
    failed=1
}

# ---- The rules see what breaks them --------------------------------------------------------------

bad=$folder/bad
mkdir -p "$bad/docs/design" "$bad/src/plan"
cat > "$bad/docs/a.md" << 'END'
[here](a.md#part), [there](b.md), [out](https://example.org/x), `[code](c.md)`
`src/plan`, `src/none.c`, `src/NAME.c`, `tools/*/x`, `make all
nothing TESTS="x y" DRIVERS=z`, `make` makes nonsense, `masu render`, `masu paint`, `masu-lab study march`,
`masu-lab study dance`, `masu-bake --old`

```sh
apt-get install make && make none V=1   # make comment
build/bin/masu render a.masu -o b.png --size 1x1 --gone=3 | masu COMMAND --help
```

    masu paint --x
END
echo 'as docs/a.md and docs/z.md have it' > "$bad/src/plan/x.c"
printf 'PASS(A, light, "x",\n' > "$bad/src/plan/passes.inc"
printf '| pass |\n|---|\n| `light`, `dark` | `other` |\n' > "$bad/docs/passes.md"
echo '[1](01-a.md)' > "$bad/docs/design/README.md"
touch "$bad/docs/design/01-a.md" "$bad/docs/design/02-b.md"
printf 'all\nhelp\n' > "$bad/targets"
bad_help() {
    case $* in
        masu) echo '  render  x' ;;
        masu-lab) echo '  study  x' ;;
        'masu-lab study') echo '  march  x' ;;
        'masu render') echo '  -o, --output FILE'; echo '      --size WxH' ;;
        masu-bake) echo '      --older' ;;
    esac
}
expect 1 broken_links "$bad"
expect 1 missing_paths "$bad"
expect 1 missing_documents "$bad"
expect 2 unknown_targets "$bad" "$bad/targets"
LAB_PROGRAM=x expect 5 unknown_commands "$bad" bad_help
LAB_PROGRAM= expect 4 unknown_commands "$bad" bad_help
expect 1 unknown_passes "$bad"
expect 1 unlisted_chapters "$bad"
expect 1 too_long "$bad/docs/a.md" 10
expect 0 too_long "$bad/docs/a.md" 11
printf '```c\nint a;\n```\n' > "$bad/readme"
echo 'int b;' > "$bad/b.c"
expect 4 other_example "$bad/readme" "$bad/b.c"

# ---- The rules -----------------------------------------------------------------------------------

make --no-print-directory help | awk '/^  / { print $1 }' > "$folder/targets"
expect_none 'links lead nowhere' broken_links .
expect_none 'paths are not there' missing_paths .
expect_none 'code names documents that are not there' missing_documents .
expect_none 'make has no such target' unknown_targets . "$folder/targets"
expect_none 'there is no such command or option' unknown_commands . help_of
expect_none 'src/plan/passes.inc has no such pass' unknown_passes .
expect_none 'chapters are not in the index' unlisted_chapters .
expect_none 'the README is too long' too_long README.md 150
expect_none 'CONTRIBUTING.md is too long' too_long CONTRIBUTING.md 150
expect_none 'ARCHITECTURE.md is too long' too_long ARCHITECTURE.md 120
expect_none "the README's example is not examples/minimal.c" other_example README.md examples/minimal.c
expect_none 'the example is too long' too_long examples/minimal.c 60
exit $failed
