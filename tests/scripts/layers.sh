#!/bin/bash
# The layers of the sources: a file of src/ includes and calls only what is in its own folder or below, there are no
# cycles of files in src/ and of folders in tools/, no file is too long, tools/ has no files of its own, and nothing
# outside lab/ includes or links anything of lab/, and lab/reference includes nothing of shaders/ and src/frame. Each
# rule is first shown something that breaks it.
#
# A node is a module, x.c with x.h. Includes are read from the text, calls from the object files.
#
# shellcheck disable=SC2317 # most functions are called through expect and expect_none
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
LAYERS="base scene quality plan device frame"
LONG=700

# includes SRC: "module module" for each include of a file of SRC by another
includes() {
    (cd "$1" && find . -name '*.[ch]' -o -name '*.inc' | sed 's|^\./||' | sort > "$folder/files" &&
        xargs -r awk '
            function module(file) { sub(/\.[^.\/]*$/, "", file); return file }
            FILENAME == list { is[$0]; next }
            /^[[:space:]]*#[[:space:]]*include "/ {
                split($0, part, "\"")
                if (part[2] in is && module(FILENAME) != module(part[2]))
                    print module(FILENAME), module(part[2])
            }' list="$folder/files" "$folder/files" < "$folder/files") | sort -u
}

# calls SRC OBJECTS: the same for each function or table that an object needs of another. Objects of
# sources that are no more do not count.
calls() {
    (cd "$1" && find . -name '*.c' | sed 's|^\./||;s|\.c$|.o|' | sort) > "$folder/objects"
    (cd "$2" && xargs -r nm -A < "$folder/objects") | sed 's/\.o:/ /' | awk '
        NF == 3 && $2 == "U" { print "needs", $3, $1 }
        NF == 4 && $3 ~ /[TDBRVW]/ { print "has", $4, $1 }' | awk '
        $1 == "has" { owner[$2] = $3 }
        $1 == "needs" { needs[++n] = $2; by[n] = $3 }
        END {
            for (i = 1; i <= n; i++)
                if (needs[i] in owner && owner[needs[i]] != by[i]) print by[i], owner[needs[i]]
        }' | sort -u
}

# upward: of edges "module module" those from a lower layer to a higher one. What lies in no folder is
# the door, above all.
upward() {
    awk -v layers="$LAYERS" '
        BEGIN { count = split(layers, name, " "); for (i = 1; i <= count; i++) rank[name[i]] = i }
        function layer(module, part) {
            if (split(module, part, "/") < 2) return count + 1
            return part[1] in rank ? rank[part[1]] : 0
        }
        layer($1) == 0 || layer($2) == 0 { print $1, "->", $2, "(a folder that is no layer)"; next }
        layer($2) > layer($1) { print $1, "->", $2 }'
}

# circles: the modules of edges that lie on one
circles() { tsort 2>&1 > /dev/null | sed -n 's/^tsort: \([^ ]*\/\{0,1\}[^ ]*\)$/\1/p' | sort -u; }

# long_files FOLDER...: those over the limit that do not say why at their head
long_files() {
    find "$@" -type f \( -name '*.[ch]' -o -name '*.inc' -o -name '*.glsl' -o -name '*.comp' \
        -o -name '*.vert' -o -name '*.frag' \) | sort | xargs -r wc -l | awk -v most="$LONG" '
        $2 != "total" && $1 > most { print $1, $2 }' | while read -r lines file; do
        head -n 12 "$file" | grep -qE 'Over 700 lines: |not to be edited' || echo "$file: $lines lines"
    done
}

# folders TOOLS: "folder folder" for each include of a file of a folder of TOOLS by another folder
folders() {
    (cd "$1" && grep -rHE '^[[:space:]]*#[[:space:]]*include "' --include='*.[ch]' --include='*.cpp' . | sed 's|^\./||' |
        awk -F '"' '{ from = $1; sub(/\/.*/, "", from); to = $2
            if (to ~ /\// && sub(/\/.*/, "", to) && from != to) print from, to }' | sort -u) |
        while read -r from to; do [ ! -d "$1/$to" ] || echo "$from $to"; done
}
folder_circles() { folders "$1" | tsort 2>&1 > /dev/null | sed -n 's/^tsort: \([^ ]*\)$/\1/p' | grep -v '^-:' | sort -u; }

# lab_users ROOT: files outside of lab/ that include something of lab/, and makefiles that link its archive or objects
lab_users() {
    (cd "$1" || exit
        grep -rlE '^[[:space:]]*#[[:space:]]*include "([^"]*/)?lab/' --exclude-dir=build --exclude-dir=.git \
            --include='*.[chS]' --include='*.cpp' --include='*.inc' --include='*.glsl' --include='*.comp' \
            --include='*.vert' --include='*.frag' .
        grep -rlE 'libmasu-lab|obj/lab/|LAB_(SOURCES|ARCHIVE|LINKED)' --exclude-dir=build --exclude-dir=.git \
            --include='*.mk' --include=Makefile .) |
        sed 's|^\./||' | grep -vE '^(lab|build)/' | sort
}

# shared_code ROOT: includes of lab/reference beyond its own files, the blob's layout and validation, the SDF compiler
# and file helpers: the path tracer that judges the renderer shares no shading, no light and no camera with it
shared_code() {
    (cd "$1" && grep -rnE '^[[:space:]]*#[[:space:]]*include "' --include='*.[ch]' lab/reference) |
        grep -vE '"(lab/reference/[a-z_]+\.h|scene/blob\.h|masu\.h|image\.h|file_kind\.h|sdfc/sdfc\.h|bake/base/process\.h)"'
}

# loose FOLDER: sources directly in it
loose() { find "$1" -maxdepth 1 -name '*.[ch]' | sort; }

# expect_none NAME COMMAND...: the command prints nothing
expect_none() {
    local found
    found=$("${@:2}")
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

# of SRC OBJECTS COMMAND: the command over includes and calls together
of() { { includes "$1" && calls "$1" "$2"; } | sort -u | "$3"; }

# ---- The rules see what breaks them --------------------------------------------------------------

bad=$folder/src
mkdir -p "$bad/base" "$bad/scene" "$bad/frame" "$folder/tools/one"
# Upwards a call (base/low) and an include (scene/up); circles of calls upwards (base/low, frame/high), of
# includes (scene/one, two), and of an include and a call (scene/three, four).
echo 'int masu_low(void);' > "$bad/base/low.h"
printf '#include "base/low.h"\nint masu_high(void);\nint masu_low(void) { return masu_high(); }\n' \
    > "$bad/base/low.c"
echo 'int masu_high(void);' > "$bad/frame/high.h"
printf '#include "frame/high.h"\n#include "base/low.h"\nint masu_high(void) { return 1; }\n' \
    > "$bad/frame/high.c"
printf '#include "frame/high.h"\n' > "$bad/scene/up.h"
printf '#include "scene/two.h"\n' > "$bad/scene/one.h"
printf '#include "scene/one.h"\n' > "$bad/scene/two.h"
printf '#include "scene/four.h"\nint masu_three(void) { return 3; }\n' > "$bad/scene/three.c"
printf 'int masu_three(void);\nint masu_four(void) { return masu_three(); }\n' > "$bad/scene/four.c"
touch "$bad/scene/four.h"
printf '#include "base/low.h"\nint masu_low(void);\nint main(void) { return masu_low(); }\n' \
    > "$bad/api.c"
for source in base/low frame/high scene/three scene/four api; do
    mkdir -p "$folder/obj/$(dirname $source)"
    ${CC:-gcc} -std=c11 -I"$bad" -c "$bad/$source.c" -o "$folder/obj/$source.o" || failed=1
done
expect 6 includes "$bad"
expect 3 calls "$bad" "$folder/obj"
expect 2 of "$bad" "$folder/obj" upward
expect 6 of "$bad" "$folder/obj" circles # low and high, one and two, three and four
mkdir "$bad/other" && printf '#include "base/low.h"\n' > "$bad/other/lost.h"
expect 3 of "$bad" "$folder/obj" upward

yes '/* a line */' | head -n 701 > "$folder/tools/one/long.c"
{ echo '/* Over 700 lines: one table */' && cat "$folder/tools/one/long.c"; } > "$folder/tools/one/why.c"
{ echo '/* written by a tool: not to be edited */' && cat "$folder/tools/one/long.c"; } \
    > "$folder/tools/one/made.h"
head -n 700 "$folder/tools/one/long.c" > "$folder/tools/one/short.comp"
cp "$folder/tools/one/long.c" "$folder/tools/one/long.comp"
expect 2 long_files "$folder/tools"
touch "$folder/tools/drawer.c" "$folder/tools/one/kept.c"
expect 1 loose "$folder/tools"

mkdir -p "$folder/rooms/a" "$folder/rooms/b" "$folder/rooms/c"
printf '#include "b/x.h"\n#include <a/y.h>\n' > "$folder/rooms/a/x.c"
printf '#include "c/x.h"\n#include "none/x.h"\n' > "$folder/rooms/b/x.h"
expect 2 folders "$folder/rooms"
expect 0 folder_circles "$folder/rooms"
printf '#include "a/y.h"\n' > "$folder/rooms/c/x.h"
expect 3 folder_circles "$folder/rooms"

mkdir -p "$folder/tree/tools/one" "$folder/tree/lab/study" "$folder/tree/tests"
printf '#include "lab/study/x.h"\n' | tee "$folder/tree/tools/one/x.c" > "$folder/tree/lab/study/x.c"
printf '  #  include "../../lab/study/x.h"\n' > "$folder/tree/tests/x.h"
printf '#include "slab/x.h"\n// "lab/x.h"\n' > "$folder/tree/tests/y.h"
printf 'x: $(BUILD)/lib/libmasu-lab.a\n' | tee "$folder/tree/tools/tools.mk" > "$folder/tree/lab/lab.mk"
expect 3 lab_users "$folder/tree"
rm "$folder/tree/tools/one/x.c" "$folder/tree/tests/x.h" # what links is found without what includes
expect 1 lab_users "$folder/tree"

mkdir -p "$folder/tree/lab/reference"
printf '#include "brdf/bsdf.glsl"\n#include "shared/masu_shared.h"\n#include "frame/camera.h"\n#include <math.h>\n' \
    > "$folder/tree/lab/reference/x.c"
printf '#include "lab/reference/x.h"\n#include "scene/blob.h"\n#include "lab/study/x.h"\n' > "$folder/tree/lab/reference/y.h"
expect 4 shared_code "$folder/tree"

# ---- The rules -----------------------------------------------------------------------------------

objects=${BUILD:-build}/obj/src
[ -f "$objects/api.o" ] || { echo "there are no objects in $objects" && failed=1; }
expect_none "upwards (layers: $LAYERS)" of src "$objects" upward
expect_none 'modules on a circle of includes and calls' of src "$objects" circles
expect_none "over $LONG lines without a reason ('Over 700 lines: why') at the head" \
    long_files src shaders tools lab
expect_none 'folders of tools/ on a circle of includes' folder_circles tools
expect_none 'these include or link something of lab/' lab_users .
expect_none 'lab/reference includes what the renderer is made of, or what no rule allows' shared_code .
[ ! -e "${BUILD:-build}/obj/lab" ] || { echo "the product's build has objects of lab/" && failed=1; }
expect_none 'sources directly in tools/' loose tools
exit $failed
