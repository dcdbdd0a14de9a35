#!/bin/sh
# What `make install` leaves is what a port needs: with PREFIX and DESTDIR apart, exactly the files
# that it should, paths in masu.pc that know nothing of DESTDIR, and a library with which
# tests/consumers/ build by pkg-config as C and as C++, and run. From an empty folder the installed
# program finds its suites, and says what is missing without its scenes. `make uninstall` then leaves
# nothing.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
stage=$folder/stage
prefix=/opt/masu

make --no-print-directory install DESTDIR="$stage" PREFIX=$prefix > "$folder/said"
smoke=$(sed -n 's/.*"scene": "\([^"]*\)".*/\1/p' suites/smoke.json | sort -u)
scenes=
for s in $smoke; do
    if [ -f "${MADE:-build}/scenes/$s.masu" ]; then
        scenes="$scenes$(printf '\n%s' ".$prefix/share/masu/scenes/$s.masu")"
    else
        grep -q "not baked.* $s" "$folder/said" || { echo "nothing is said about $s"; exit 1; }
    fi
done
(cd "$stage" && find . -type f | sort) > "$folder/files"
sort > "$folder/expected" << END
.$prefix/bin/masu
.$prefix/bin/masu-bake
.$prefix/bin/masu-meso
.$prefix/bin/masu-sdfc
.$prefix/include/masu.h
.$prefix/lib/libmasu.a
.$prefix/lib/pkgconfig/masu.pc
.$prefix/share/masu/suites/full.json
.$prefix/share/masu/suites/smoke.json$scenes
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

# From an empty folder, by name and by default; without scenes, one line that says what to do.
mkdir "$folder/empty"
masu=$stage$prefix/bin/masu
cases=$(cd "$folder/empty" && "$masu" conform --list | wc -l)
[ "$cases" -gt 30 ] || { echo "conform --list: $cases cases"; exit 1; }
(cd "$folder/empty" && "$masu" conform --suite full --list) | grep -q '^1080p.engine '
(cd "$folder/empty" && "$masu" conform --suite none --list 2>&1 || true) | grep -q 'suites/none.json'
mkdir -p "$folder/apart/bin" "$folder/apart/share/masu"
cp "$masu" "$folder/apart/bin"
cp -r "$stage$prefix/share/masu/suites" "$folder/apart/share/masu"
if (cd "$folder/empty" && "$folder/apart/bin/masu" conform) > "$folder/out" 2>&1; then exit 1; fi
grep -q 'no baked scenes .*make scenes install.*--scenes' "$folder/out"

make --no-print-directory uninstall DESTDIR="$stage" PREFIX=$prefix
left=$(find "$stage" -type f; find "$stage" -path '*/share/masu')
[ -z "$left" ] || { echo "uninstall leaves $left"; exit 1; }
