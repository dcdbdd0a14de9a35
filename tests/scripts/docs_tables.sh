#!/bin/sh
# docs/knobs.md is what the tables of knobs and limits say today, and the help shows the same rows.
set -e
masu=${BUILD:-build}/bin/masu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$masu" plan --knobs=md > "$folder/knobs.md"
diff -u docs/knobs.md "$folder/knobs.md" || {
    echo "docs/knobs.md is not what include/masu.h says: make docs-tables"
    exit 1
}
"$masu" plan --knobs > "$folder/plan"
"$masu" render --setting help > "$folder/setting"
cmp "$folder/plan" "$folder/setting"
rows=$(grep -c '^  [a-z]' "$folder/plan")
[ "$rows" = "$(sed -n '/^## Knobs/,/^## Words/p; /^## Limits/,$p' docs/knobs.md | grep -c '^| `')" ]
[ "$rows" -ge 40 ]
