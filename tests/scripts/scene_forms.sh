#!/bin/bash
# A new element of a scene has come with all that belongs to it: a new version of the blob, its section in docs/blob.md,
# its member in docs/scene.md, and a seed from which the fuzzer of scenes reaches its check. CONTRIBUTING.md lists the
# steps.
set -e
build=${BUILD:-build}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
problems=0
problem() {
    echo "$*"
    problems=1
}

# layout FILE: a checksum of the kinds of sections and of the structs of their elements, whatever their comments and
# their order of lines.
layout() {
    tr '\n' ' ' < "$1" | sed 's|/\*|\n/*|g; s|\*/|*/\n|g' | sed '/^\/\*/d' | tr -d '\n' | tr -s ' ' |
        grep -oE '(enum masu_blob_kind|typedef struct masu_blob_[a-z_]*) \{[^}]*\}' | cksum | cut -d' ' -f1
}

# version_problem FILE: what is wrong where the layout has changed and the version has not. Prints nothing if all is
# well.
version_problem() {
    local version sum
    version=$(sed -n 's/^#define MASU_BLOB_VERSION \([0-9]*\)u.*/\1/p' "$1")
    sum=$(layout "$1")
    grep -q "layout of version $version: $sum " "$1" && return
    if grep -q "layout of version $version: " "$1"; then
        echo "$1: sections or elements have changed: raise MASU_BLOB_VERSION to $((version + 1)), unless this change" \
            "has raised it to $version already, and write 'layout of version N: $sum' with its number behind it"
    else
        echo "$1: write 'layout of version $version: $sum' behind MASU_BLOB_VERSION"
    fi
}

# kinds FILE: the numbers of all kinds of sections.
kinds() { sed -n 's/^ *MASU_BLOB_[A-Z0-9_]* = \([0-9]*\),.*/\1/p' "$1"; }

# rows FILE: the kinds in the first column of the table of sections in docs/blob.md.
rows() { sed -n '/^| kind | name /,/^$/s/^| \([0-9, ]*\) |.*/\1/p' "$1" | tr ', ' '\n\n' | sed '/^$/d'; }

# members FILES: the members of JSON objects that masu-bake reads.
members() {
    cat "$@" | tr '\n' ' ' | grep -oE 'members\[\] = \{[^}]*\}' | grep -oE '"[^"]*"' | tr -d '"' | sort -u
}

# undocumented DOC: of the names on stdin those that DOC does not name as code.
undocumented() {
    while read -r name; do
        grep -qE "\`([a-z_]+\.)*$name\`|\"$name\"" "$1" || echo "$name"
    done
}

# strides DOC: of the table of sections in DOC, a line `kind stride` for each kind.
strides() {
    sed -n '/^| kind | name /,/^$/s/^| \([0-9, ]*\) | [^|]* | \([0-9]*\) |.*/\1|\2/p' "$1" |
        awk -F '|' '{ n = split($1, kinds, ", "); for (i = 1; i <= n; i++) print kinds[i], $2 }'
}

# seeded_strides DIRECTORY: the same of the blobs there.
seeded_strides() {
    for blob in "$1"/*.masu; do
        count=$(od -An -tu4 -j24 -N4 "$blob" | tr -d ' ')
        od -An -v -tu4 -w24 -j64 -N$((count * 24)) "$blob" | awk '{ print $1, $2 }'
    done | sort -nu
}

# seeded DIRECTORY: the kinds of sections in the blobs there.
seeded() {
    for blob in "$1"/*.masu; do
        count=$(od -An -tu4 -j24 -N4 "$blob" | tr -d ' ')
        od -An -v -tu4 -w24 -j64 -N$((count * 24)) "$blob" | awk '{ print $1 }'
    done | sort -nu
}

# missing A B: lines of A that are not in B.
missing() { grep -vxFf "$2" "$1" || true; }

# ---- What the tree says --------------------------------------------------------------------------

text=$(version_problem src/scene/blob.h)
[ -z "$text" ] || problem "$text"
version=$(sed -n 's/^#define MASU_BLOB_VERSION \([0-9]*\)u.*/\1/p' src/scene/blob.h)
grep "\`version\`" docs/blob.md | grep -qw "$version" || problem "docs/blob.md: the version is not $version"

kinds src/scene/blob.h > "$folder/kinds"
rows docs/blob.md > "$folder/rows"
for kind in $(missing "$folder/kinds" "$folder/rows"); do
    problem "docs/blob.md: no row for sections of kind $kind, $(sed -n "s/^ *\(MASU_BLOB_[A-Z0-9_]*\) = $kind,.*/\1/p" src/scene/blob.h)"
done

members tools/bake/description/*.c > "$folder/members"
for name in $(undocumented docs/scene.md < "$folder/members"); do
    problem "docs/scene.md: does not describe the member \"$name\", which masu-bake reads"
done

# The marches of the lab build are in no blob of the product.
mkdir "$folder/seeds"
sed -n '/seed_scene$/{n;s/.*\$@ \([0-9]*\)$/\1/p}' tests/tests.mk > "$folder/parts"
while read -r parts; do
    "$build/tests/fuzz/seed_scene" "$folder/seeds/$parts.masu" "$parts"
done < "$folder/parts"
seeded "$folder/seeds" > "$folder/seeded"
grep -vxE '17|18|19' "$folder/kinds" > "$folder/needed"
for kind in $(missing "$folder/needed" "$folder/seeded"); do
    problem "tests/fuzz/seed_scene.c: no seed of tests/tests.mk has sections of kind $kind," \
        "$(sed -n "s/^ *\(MASU_BLOB_[A-Z0-9_]*\) = $kind,.*/\1/p" src/scene/blob.h)"
done

seeded_strides "$folder/seeds" > "$folder/strides"
strides docs/blob.md > "$folder/written"
while read -r kind stride; do
    problem "docs/blob.md: elements of sections of kind $kind have $stride bytes, which the table of sections does not say"
done < <(missing "$folder/strides" "$folder/written")
[ "$problems" = 0 ] || exit 1

# ---- That it would be found ----------------------------------------------------------------------

# finds WHAT EXPECTED FOUND
finds() { [ "$2" = "$3" ] || problem "a planted fault is not found: $1: '$3' instead of '$2'"; }

[ "$(wc -l < "$folder/kinds")" -ge 50 ] || problem "kinds of sections are not found in src/scene/blob.h"
[ "$(wc -l < "$folder/members")" -ge 100 ] || problem "members are not found in tools/bake/description"
sed 's/^\(    MASU_BLOB_KIND_COUNT = \).*/    MASU_BLOB_GHOSTS = 99,\n\1100/' src/scene/blob.h > "$folder/section.h"
sed 's/^typedef struct masu_blob_shadow {/&\n    float extra;/' src/scene/blob.h > "$folder/element.h"
sed 's|^typedef struct masu_blob_shadow {|/* another comment */\n&|' src/scene/blob.h > "$folder/comment.h"
finds "a new section" 1 "$(version_problem "$folder/section.h" | grep -c "raise MASU_BLOB_VERSION to $((version + 1))")"
finds "a longer element" 1 "$(version_problem "$folder/element.h" | grep -c 'have changed')"
finds "a comment" '' "$(version_problem "$folder/comment.h")"
kinds "$folder/section.h" > "$folder/more"
finds "a section without a row" 99 "$(missing "$folder/more" "$folder/kinds")"
echo 'static const char *const members[] = {"source", "ghost", NULL};' > "$folder/read.c"
finds "a member without words" ghost "$(members "$folder/read.c" | undocumented docs/scene.md)"
sed 's/^| 35 | lights | [0-9]* /| 35 | lights | 1 /' docs/blob.md > "$folder/short.md"
strides "$folder/short.md" > "$folder/other"
finds "another stride" 35 "$(missing "$folder/strides" "$folder/other" | cut -d' ' -f1)"
rm "$folder"/seeds/17921.masu # skins
seeded "$folder/seeds" > "$folder/fewer"
finds "a kind without a seed" 49 "$(missing "$folder/seeded" "$folder/fewer" | head -n 1)"

exit "$problems"
