#!/bin/bash
# Facts that several pages repeat are the same everywhere, and equal what the sources define: library size, limits,
# number of drivers, tested GPUs, the exception of masu_resize. Each check is first shown a copy of the tree that breaks
# it.
#
# shellcheck disable=SC2016,SC2046,SC2086 # dollars belong to sed and awk; lists of files
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
PAGES='README.md CHANGELOG.md ARCHITECTURE.md docs include'

# value ROOT FILE NAME: the number that a header defines
value() { sed -n "s/^#define $3 *(*\([0-9]*\)u*.*/\1/p" "$1/$2"; }

# pages ROOT: "FILE<tab>TEXT" for each paragraph, list item and table row of the pages
pages() {
    (cd "$1" && find $PAGES -name '*.md' -o -name 'masu*.h' | sort | while read -r file; do
        awk -v file="$file" 'BEGIN { RS = "" } {
            gsub(/\n *(- |\|)/, "\001&"); count = split($0, item, "\001")
            for (i = 1; i <= count; i++) { gsub(/[\n\t ]+\**/, " ", item[i]); print file "\t" item[i] } }' "$file"
    done)
}

# requires ROOT FILE TEXT: complains if the page does not have the text
requires() { tr -s '\n ' '  ' < "$1/$2" | grep -qF -e "$3" || echo "$2 should have '$3'"; }

# facts ROOT: prints each contradiction
facts() {
    local root=$1 size limit rungs lights number=(none one two three four five)
    size=$(awk -F, '$1 == "all" { printf "%.1f", $2 / 1e6 }' "$root/package/sizes.csv")
    for page in README.md CHANGELOG.md docs/embedding.md; do
        requires "$root" $page "$size MB <!-- facts.sh: package/sizes.csv, all -->"
    done
    limit=$(sed -n 's/.*\$1 == "all" ? \([0-9]*\)00000 : \([0-9]*\)00000.*/\1 \2/p' "$root/tests/scripts/sizes.sh")
    requires "$root" docs/promises.md "$(awk '{ printf "%.1f MB for one class of scenes, %.1f MB", $2 / 10, $1 / 10 }' <<< "$limit")"
    rungs=$(value "$root" include/masu.h MASU_MAX_RUNGS)
    lights=$(value "$root" src/scene/blob.h MASU_BLOB_LIGHTS_MAX)
    requires "$root" README.md "Limits: $rungs quality levels"
    requires "$root" README.md "$lights punctual lights"
    requires "$root" docs/devices.md "| punctual lights | $lights,"
    requires "$root" docs/devices.md "$rungs, $(value "$root" include/masu.h MASU_MAX_TARGETS), $(value "$root" include/masu.h MASU_MAX_FLIGHT) |"
    limit=$(sed -n 's/.*VkExtent2D output;.*pixels,* *1\.\.\([0-9]*\).*/\1/p' "$root/include/masu.h")
    requires "$root" README.md "${limit:-?} pixels per side"
    requires "$root" docs/devices.md "1x1 to ${limit:-?}x${limit:-?}"
    limit=$(sed -n 's/.*"\$drivers" != all \].*drivers="\(.*\)"/\1/p' "$root/tests/run.sh" | wc -w)
    requires "$root" README.md "on ${number[$limit]} drivers"
    [ "$(grep -cE '^\| (lavapipe|SwiftShader)' "$root/docs/devices.md")" = "$limit" ] || echo "docs/devices.md does not list $limit drivers"
    pages "$root" | while IFS=$'\t' read -r file text; do
        [[ ! ${text,,} =~ real\ gpus[^.]*\ not\ (been\ )?(yet\ )?(measured|tested)|no\ (real\ )?gpu\ (has\ been|was)\ (measured|tested) ]] ||
            ! grep -q NVIDIA "$root/docs/devices.md" || echo "$file has no measured GPU, docs/devices.md has one: ${text:0:80}"
        [[ $text != *vkBegin/EndCommandBuffer* || $text == *masu_resize* ]] ||
            echo "$file: vkBegin/EndCommandBuffer without the exception masu_resize: ${text:0:80}"
    done
}

# breaks WORD FILE SED: with that edit of a copy of the tree, a check complains and names WORD
breaks() {
    rm -rf "$folder/tree" && mkdir "$folder/tree"
    cp --parents $(find $PAGES -name '*.md' -o -name 'masu*.h') package/sizes.csv tests/run.sh tests/scripts/sizes.sh \
        src/scene/blob.h "$folder/tree"
    sed -i -e "$3" "$folder/tree/$2"
    facts "$folder/tree" | grep -qF -e "$1" || { echo "self-test: '$3' of $2 is not found"; failed=1; }
}
breaks 'README.md should have' package/sizes.csv 's/^all,[0-9]*/all,9990000/'
breaks 'docs/promises.md' tests/scripts/sizes.sh 's/2500000/2600000/'
breaks 'quality levels' include/masu.h 's/^#define MASU_MAX_RUNGS .*/#define MASU_MAX_RUNGS 9u/'
breaks 'punctual lights' src/scene/blob.h 's/^#define MASU_BLOB_LIGHTS_MAX .*/#define MASU_BLOB_LIGHTS_MAX 2048u/'
breaks 'pixels per side' README.md 's/16384 pixels/8192 pixels/'
breaks 'drivers' tests/run.sh 's/drivers="system /drivers="/'
breaks 'no measured GPU' docs/memory.md '$a\\nReal GPUs are not measured yet.'
breaks 'masu_resize' docs/promises.md '$a\\nNo vkBegin/EndCommandBuffer after masu_init.'

facts . > "$folder/found"
[ ! -s "$folder/found" ] || { cat "$folder/found"; failed=1; }
exit $failed
