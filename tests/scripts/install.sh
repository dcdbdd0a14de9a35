#!/bin/sh
# What `make install` leaves is what a port needs: with PREFIX and DESTDIR apart, exactly the files
# that it should, paths in masu.pc that know nothing of DESTDIR, and a library with which
# tests/consumers/ build by pkg-config as C and as C++, and run. `make uninstall` then leaves none.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
stage=$folder/stage
prefix=/opt/masu

make --no-print-directory install DESTDIR="$stage" PREFIX=$prefix
(cd "$stage" && find . -type f | sort) > "$folder/files"
sort > "$folder/expected" << END
.$prefix/bin/masu
.$prefix/bin/masu-bake
.$prefix/bin/masu-meso
.$prefix/bin/masu-sdfc
.$prefix/include/masu.h
.$prefix/lib/libmasu.a
.$prefix/lib/pkgconfig/masu.pc
END
diff "$folder/expected" "$folder/files"
if grep "$stage" "$stage$prefix/lib/pkgconfig/masu.pc"; then exit 1; fi

# To build against a staged tree, pkg-config is told where / is.
export PKG_CONFIG_SYSROOT_DIR="$stage" PKG_CONFIG_LIBDIR="$stage$prefix/lib/pkgconfig"
flags=$(pkg-config --cflags --libs masu)
version=$(pkg-config --modversion masu)
# A sanitized library needs its consumer linked with the sanitizer.
[ "${config:-}" != sanitize ] || flags="$flags -fsanitize=address,undefined"
[ "${config:-}" != coverage ] || flags="$flags --coverage"
warnings="-Wall -Wextra -Wpedantic -Werror"

# shellcheck disable=SC2086
${CC:-gcc} -std=c11 $warnings tests/consumers/minimal.c $flags -o "$folder/minimal_c"
# shellcheck disable=SC2086
${CXX:-g++} -std=c++17 $warnings -x c++ tests/consumers/minimal.c -x none $flags \
    -o "$folder/minimal_cpp"
[ "$("$folder/minimal_c")" = "masu $version: success" ]
[ "$("$folder/minimal_cpp")" = "masu $version: success" ]

make --no-print-directory uninstall DESTDIR="$stage" PREFIX=$prefix
left=$(find "$stage" -type f)
[ -z "$left" ] || { echo "uninstall leaves $left"; exit 1; }
