#!/bin/bash
# Rules that are kept by looking: images are stored and undefined functions called in one place
# each; the library calls nothing but memory, text and mathematics, and keeps nothing between calls.
# Each rule is first shown something that breaks it.
#
# shellcheck disable=SC2317 # most functions are called through expect and expect_none
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

# FILE:LINE: text, without comments
code() {
    awk '{
        line = $0; out = ""
        while (line != "") {
            open = index(line, "/*"); rest = index(line, "//"); close_ = index(line, "*/")
            if (inside) {
                if (!close_) break
                line = substr(line, close_ + 2); inside = 0
            } else if (rest && (!open || rest < open)) {
                out = out substr(line, 1, rest - 1); break
            } else if (open) {
                out = out substr(line, 1, open - 1) " "; line = substr(line, open + 2); inside = 1
            } else {
                out = out line; break
            }
        }
        print FILENAME ":" FNR ": " out
    }' "$1"
}

# The shaders of a folder that FILE is not among.
shaders_but() {
    find "$1" -type f \( -name '*.glsl' -o -name '*.comp' -o -name '*.vert' -o -name '*.frag' -o \
        -name '*.h' \) ! -path "*/shared/$2" | sort
}

# uses FOLDER FILE REGEX: lines of the shaders outside shared/FILE that call one of the functions
uses() {
    shaders_but "$1" "$2" | while read -r file; do
        code "$file" | grep -E "(^|[^A-Za-z0-9_])($3)[ ]*\("
    done
}

stores() { uses "$1" store.glsl 'imageStore|imageAtomic[A-Za-z]*'; }
raw_functions() {
    uses "$1" guard.glsl 'normalize|inversesqrt|pow|log2?|exp2?|acos|asin|atan|isnan|isinf'
}

# Functions that an archive needs from elsewhere and may not have. In debug builds and with
# CFLAGS=-fstack-protector or -D_FORTIFY_SOURCE the compiler adds some of its own.
forbidden_functions() {
    nm "$1" | awk '$1 == "U" { print $2 }' | sort -u > "$folder/needed"
    nm "$1" | awk 'NF == 3 && $2 ~ /[A-TV-Z]/ { print $3 }' | sort -u > "$folder/has"
    comm -23 "$folder/needed" "$folder/has" | grep -vxE \
        -e '(__)?(mem(cpy|move|set|cmp|chr)|v?snprintf)(_chk)?|bcmp|str(len|cmp|ncmp|chr)' \
        -e '(a?(sin|cos|tan)|sincos|hypot|atan2|exp2?|log2|pow|f?abs|floor|ceil|round|trunc|f(min|max|mod))f?' \
        -e '(sqrt|ldexp|frexp|nearbyint|l?lrint)f?|__(isfinite|isinf|isnan)f?' \
        -e '_GLOBAL_OFFSET_TABLE_|__stack_chk_fail'
}

# Objects of an archive that can change. Tables of pointers are in .data.rel.ro: they are set when
# the program is loaded and read-only from then on.
variables() {
    nm -f sysv "$1" | awk -F '|' '
        $7 ~ /^\.(data|bss|tdata|tbss|sdata|sbss)|COM/ && $7 !~ /^\.data\.rel\.ro/ { print $1, $7 }'
}

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

# ---- The rules see what breaks them --------------------------------------------------------------

mkdir -p "$folder/bad/shared"
cat > "$folder/bad/bad.comp" << 'END'
/* normalize(v) and imageStore(i, p, v) in a comment
   pow(x, y) */
a = masu_normalize(v, w); b = masu_pow(x, y); // exp(x)
c = normalize (v); d = /* here */ pow(x, y);
e = isnan(f) ? 0.0 : log(f) + exp2(f);
imageStore(i, p, v);
imageAtomicAdd(i, p, 1);
END
cp "$folder/bad/bad.comp" "$folder/bad/shared/guard.glsl"
cp "$folder/bad/bad.comp" "$folder/bad/shared/store.glsl"
expect 4 raw_functions "$folder/bad"
expect 4 stores "$folder/bad"

cat > "$folder/bad.c" << 'END'
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
extern const char *const names[];
const char *const names[] = {"constant"};
int kept, set = 7;
static int count;
void *bad(const char *t) {
    kept += set + ++count;
    puts(t);
    return strlen(t) ? malloc(9) : getenv(t);
}
END
${CC:-gcc} -std=c11 -O1 -fPIC -c "$folder/bad.c" -o "$folder/bad.o"
ar rc "$folder/bad.a" "$folder/bad.o"
expect 3 forbidden_functions "$folder/bad.a"
expect 3 variables "$folder/bad.a"

# ---- The rules -----------------------------------------------------------------------------------

# What declares 16-bit floats needs 450, and ray queries need 460.
newer_versions() {
    find "$1" -name '*.comp' -o -name '*.frag' | xargs grep -LE "arithmetic_types|GL_EXT_ray_query" | xargs grep -Hn '^#version' | grep -v ' 440$'
}
mkdir "$folder/version"
printf '#version 450\n' > "$folder/version/a.comp"
printf '#version 440\n' > "$folder/version/b.frag"
expect 1 newer_versions "$folder/version"
expect_none 'compute and fragment shaders are of version 440 (shaders/shaders.mk)' newer_versions shaders

# Rows of tables may be longer: *.inc, and ladder_devices.h, which is generated.
wide_lines() {
    find "$@" -type f \( -name '*.[ch]' -o -name '*.glsl' -o -name '*.comp' -o -name '*.vert' -o -name '*.frag' \) \
        ! -name ladder_devices.h -exec awk 'length > 100 { print FILENAME ":" FNR ": " length " columns" }' {} +
}
mkdir "$folder/wide"
printf '%100s\n%101s\n' a b > "$folder/wide/a.c"
expect 1 wide_lines "$folder/wide"
expect_none 'lines have at most 100 columns' wide_lines include src shaders platform examples

expect_none 'images are stored through the macros of shaders/shared/store.glsl alone' stores shaders
expect_none 'these are called through shaders/shared/guard.glsl alone' raw_functions shaders

# Instrumented objects need and have what the sanitizer adds: look at plain ones.
library=${BUILD:-build}/lib/libmasu.a
case ${config:-release} in
    release | debug) ;;
    *)
        library=$folder/libmasu.a
        for source in src/*.c src/*/*.c; do
            ${CC:-gcc} -std=c11 -O2 -fPIC -Iinclude -Isrc -Ishaders -I"${MADE:-${BUILD:-build}}/gen" \
                -c "$source" -o "$folder/$(basename "${source//\//_}" .c).o" || failed=1
        done
        rm "$folder/bad.o"
        ar rc "$library" "$folder"/*.o
        ;;
esac
expect_none "$library needs these functions" forbidden_functions "$library"
expect_none "$library has these variables" variables "$library"
[ -s "$library" ] || { echo "there is no $library" && failed=1; }
exit $failed
