#!/bin/sh
# The structs of include/masu_knobs.h, docs/knobs.md, docs/passes.md and docs/sdf-shapes.md are up to date with the
# tables they are generated from, and the help shows the same knobs.
set -e
masu=${BUILD:-build}/bin/masu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
${CC:-gcc} -std=c11 -Wall -Wextra -Werror -DMASU_LAB -Iinclude tools/generate/make_structs.c -o "$folder/make_structs"
"$folder/make_structs" < include/masu_knobs.h | diff -u include/masu_knobs.h - || {
    echo "the structs of include/masu_knobs.h are not what its tables say: make docs-tables"
    exit 1
}
if grep -v 'written by make_structs.c: masu_rung' include/masu_knobs.h | "$folder/make_structs" > "$folder/knobs.h" 2>&1; then
    echo "make_structs accepts a header without its markers"
    exit 1
fi
"$masu" plan --knobs=md > "$folder/knobs.md"
diff -u docs/knobs.md "$folder/knobs.md" || {
    echo "docs/knobs.md is not what include/masu_knobs.h says: make docs-tables"
    exit 1
}
shaders/tables.sh passes > "$folder/passes.md"
diff -u docs/passes.md "$folder/passes.md" || {
    echo "docs/passes.md is out of date with src/plan/passes.inc: run make docs-tables"
    exit 1
}
"${BUILD:-build}/bin/masu-sdfc" --shapes > "$folder/shapes.md"
diff -u docs/sdf-shapes.md "$folder/shapes.md" || {
    echo "docs/sdf-shapes.md is not what tools/sdfc/kinds.inc says: make docs-tables"
    exit 1
}
tools/bake/import/features.sh --into docs/scene.md | diff -u docs/scene.md - || {
    echo "docs/scene.md is out of date with tools/bake/import/gltf_features.inc: run make docs-tables"
    exit 1
}
[ "$(tools/bake/import/features.sh | wc -l)" -ge 30 ]
"$masu" plan --knobs > "$folder/plan"
"$masu" render --setting help > "$folder/setting"
cmp "$folder/plan" "$folder/setting"
rows=$(grep -c '^  [a-z]' "$folder/plan")
[ "$rows" = "$(sed -n '/^## Knobs/,/^## Values/p; /^## Limits/,$p' docs/knobs.md | grep -c '^| `')" ]
[ "$rows" -ge 40 ]

# What rungs cost on classes of GPUs is of the ladders that are kept.
sed -n 's|.*/\* \([a-z_-]*\)\.masu, ladder\.json \([0-9]*\) \*/$|\1 \2|p' src/quality/ladder_devices.h > "$folder/ladders"
[ "$(wc -l < "$folder/ladders")" -ge 5 ]
while read -r name sum; do
    [ "$(cksum < "docs/report/$name/ladder.json" | cut -d' ' -f1)" = "$sum" ] || {
        echo "src/quality/ladder_devices.h is of another docs/report/$name/ladder.json: make ladder-devices"
        exit 1
    }
done < "$folder/ladders"
