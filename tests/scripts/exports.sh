#!/bin/bash
# The shared library exports what masu.h declares as MASU_API and nothing else, under its soname, and needs nothing but
# libc and libm; tests/consumers/exports.txt is the list, so that a function that comes or goes is seen.
set -u
build=${BUILD:-build}
list=tests/consumers/exports.txt
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
[ "${config:-release}" = release ] || { echo "of config=release alone" && exit 77; }

fail() {
    echo "$1"
    failed=1
}

# declared HEADER: the functions that it declares as MASU_API
declared() {
    sed 's/MASU_MUST_USE//g' "$1" | tr '\n' ' ' | grep -oE 'MASU_API[^;(]*[ *](masu_[a-z0-9_]+)\(' |
        sed 's/($//; s/.*[ *]//' | sort
}

# exported LIBRARY
exported() { nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | sort; }

# The rules see what breaks them.
printf 'MASU_API int masu_a(int x);\nMASU_API MASU_MUST_USE masu_result masu_b(\n    void);\nMASU_API const char *masu_c(void);\nint masu_d(void);\n' \
    > "$folder/h.h"
[ "$(declared "$folder/h.h" | paste -sd' ')" = 'masu_a masu_b masu_c' ] || fail 'self-test: not all that is declared is seen'
printf 'int masu_a(void) { return 1; }\n__attribute__((visibility("hidden"))) int masu_h(void) { return 2; }\nint open_one;\n' \
    > "$folder/x.c"
${CC:-gcc} -shared -fPIC "$folder/x.c" -o "$folder/x.so" || fail 'self-test: does not compile'
[ "$(exported "$folder/x.so" | paste -sd' ')" = 'masu_a open_one' ] || fail 'self-test: not all that is exported is seen'

version=$(sed -n 's/^.define MASU_VERSION_[A-Z]* //p' include/masu.h | paste -sd.)
library=$build/lib/libmasu.so.$version
soname=$(objdump -p "$library" | awk '$1 == "SONAME" { print $2 }')
[ "$soname" = "libmasu.so.${version%.*}" ] || fail "the soname is $soname"
[ "$(readlink -f "$build/lib/libmasu.so")" = "$(readlink -f "$library")" ] || fail 'libmasu.so is not that'
others=$(objdump -p "$library" | awk '$1 == "NEEDED" && $2 !~ /^lib[cm]\.so/ { print $2 }')
[ -z "$others" ] || fail "it needs $others"

cat include/*.h > "$folder/all.h"
declared "$folder/all.h" > "$folder/declared"
exported "$library" > "$folder/exported"
[ "$(wc -l < "$folder/declared")" -gt 30 ] || fail 'masu.h declares hardly anything'
diff "$folder/declared" "$folder/exported" || fail 'masu.h (<) and the library (>) differ'
diff "$list" "$folder/exported" || fail "$list (<) and the library (>) differ; if that is meant, put it there"
echo "$(wc -l < "$folder/exported") functions are exported"
exit $failed
