#!/bin/bash
# What `make install` leaves is what a port needs: with PREFIX and DESTDIR apart, exactly the files
# that it should, paths in masu.pc that know nothing of DESTDIR, and libraries with which
# tests/consumers/ build by pkg-config as C and as C++, and by CMake, static and shared, and run. From
# an empty folder the installed program finds its suites, and says what is missing without its scenes; manual
# pages and completion have every command and option of --help. `make uninstall` then leaves nothing.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
stage=$folder/stage
prefix=/opt/masu

# What others have there stays, empty folders too.
mkdir -p "$stage/opt/others" "$stage/usr/share"
find "$stage" | sort > "$folder/before"
make --no-print-directory install DESTDIR="$stage" PREFIX=$prefix > "$folder/said"
view=
[ ! -f "${BUILD:-build}/bin/masu-view" ] || view=$(printf '\n%s' ".$prefix/bin/masu-view")
smoke=$(sed -n 's/.*"scene": "\([^"]*\)".*/\1/p' suites/smoke.json | sort -u)
scenes=
for s in $smoke; do
    if [ -f "${MADE:-build}/scenes/$s.masu" ]; then
        scenes="$scenes$(printf '\n%s' ".$prefix/share/masu/scenes/$s.masu")"
    else
        grep -q "not baked.* $s" "$folder/said" || { echo "nothing is said about $s"; exit 1; }
    fi
done
version=$(sed -n 's/^.define MASU_VERSION_[A-Z]* //p' include/masu.h | paste -sd.)
(cd "$stage" && find . ! -type d | sort) > "$folder/files"
sort > "$folder/expected" << END
.$prefix/bin/masu
.$prefix/bin/masu-bake
.$prefix/bin/masu-meso
.$prefix/bin/masu-sdfc$view
.$prefix/include/masu.h
.$prefix/include/masu.hpp
.$prefix/include/masu_knobs.h
.$prefix/include/masu_study.h
.$prefix/lib/cmake/masu/masu-config-version.cmake
.$prefix/lib/cmake/masu/masu-config.cmake
.$prefix/lib/libmasu.a
.$prefix/lib/libmasu.so
.$prefix/lib/libmasu.so.${version%.*}
.$prefix/lib/libmasu.so.$version
.$prefix/lib/pkgconfig/masu-static.pc
.$prefix/lib/pkgconfig/masu.pc
$(for f in README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md LICENSE docs/*.md docs/*.jpg docs/design/*.md docs/report/ladders.txt; do
    echo ".$prefix/share/doc/masu/$f"
done)
.$prefix/share/doc/masu/folders
$(for f in examples/*.[ch] examples/*.cpp examples/*.lua examples/*.frag examples/*.vert examples/shared/*.[ch] examples/drive/*.[ch] \
    examples/Makefile examples/host_pass_frag.spv.h examples/host_pass_vert.spv.h; do
    echo ".$prefix/share/doc/masu/$f"
done)
$(for f in atomic_file file_kind headless headless_image image image_parts image_write exr; do
    for e in c h; do [ ! -f platform/$f.$e ] || echo ".$prefix/share/doc/masu/examples/platform/$f.$e"; done
done)
$(for p in masu masu-bake masu-meso masu-sdfc ${view:+masu-view}; do
    printf '%s\n' ".$prefix/share/man/man1/$p.1" ".$prefix/share/bash-completion/completions/$p"
done)
.$prefix/share/masu/masu.cdef
.$prefix/share/masu/suites/extreme.json
.$prefix/share/masu/suites/full.json
.$prefix/share/masu/suites/smoke.json$scenes
END
diff "$folder/expected" "$folder/files"
if grep -r "$stage" "$stage$prefix/lib/pkgconfig" "$stage$prefix/lib/cmake"; then exit 1; fi
if grep -r '@[A-Z]*@' "$stage$prefix/lib/pkgconfig" "$stage$prefix/lib/cmake"; then exit 1; fi

# ---- Consumers -----------------------------------------------------------------------------------

# To build against a staged tree, pkg-config is told where / is.
export PKG_CONFIG_SYSROOT_DIR="$stage" PKG_CONFIG_LIBDIR="$stage$prefix/lib/pkgconfig"
[ "$(pkg-config --modversion masu)" = "$version" ]
# A sanitized library needs its consumer linked with the sanitizer.
extra=
[ "${config:-}" != sanitize ] || extra='-fsanitize=address,undefined'
[ "${config:-}" != coverage ] || extra='--coverage'
warnings='-Wall -Wextra -Wpedantic -Werror'

# needs PROGRAM: whether it asks for the shared library by its soname
needs() { objdump -p "$1" | grep -q "NEEDED *libmasu.so.${version%.*}\$"; }

# works PROGRAM: says what it should
works() {
    said=$(LD_LIBRARY_PATH="$stage$prefix/lib" "$1")
    [ "$said" = "masu $version: success" ] || { echo "$1: $said"; exit 1; }
}

for package in masu masu-static; do
    flags="$(pkg-config --cflags --libs $package) $extra"
    # shellcheck disable=SC2086
    ${CC:-gcc} -std=c11 $warnings tests/consumers/minimal.c $flags -o "$folder/$package-c"
    # shellcheck disable=SC2086
    ${CXX:-g++} -std=c++17 $warnings -x c++ tests/consumers/minimal.c -x none $flags -o "$folder/$package-cpp"
    for p in "$folder/$package-c" "$folder/$package-cpp"; do
        works "$p"
        if [ $package = masu ]; then needs "$p"; elif needs "$p"; then echo "$p is not static"; exit 1; fi
    done
done

# by_cmake NAME ARGUMENTS...: builds tests/consumers/cmake to that folder
by_cmake() {
    { cmake -S tests/consumers/cmake -B "$folder/$1" -DCMAKE_C_COMPILER="${CC:-gcc}" \
        -DCMAKE_CXX_COMPILER="${CXX:-g++}" -DCMAKE_PREFIX_PATH="$stage$prefix" \
        -DCMAKE_C_FLAGS="-std=c11 $warnings $extra" "${@:2}" && cmake --build "$folder/$1"; } \
        > "$folder/cmake-said" 2>&1 || { cat "$folder/cmake-said" && return 1; }
}
by_cmake by-default
by_cmake static -DWANT=static
by_cmake shared -DWANT=shared
works "$folder/by-default/consumer"
works "$folder/static/consumer"
works "$folder/shared/consumer"
needs "$folder/shared/consumer"
if needs "$folder/static/consumer" || needs "$folder/by-default/consumer"; then echo 'not static'; exit 1; fi
if by_cmake other -DWANT=other > "$folder/said"; then echo 'CMake finds a component other'; exit 1; fi
grep -q 'components static and shared, not' "$folder/said"

# ---- Documents and examples ----------------------------------------------------------------------

doc=$stage$prefix/share/doc/masu
(cd "$doc" && find . -name '*.md') | while read -r file; do
    awk '/^```/ { fenced = !fenced; next } !fenced { gsub(/`[^`]*`/, ""); print }' "$doc/$file" |
        grep -o '](\([^)]*\))' | sed 's/](\(.*\))/\1/; s/#.*//' | while read -r link; do
        case $link in http://* | https://* | "") continue ;; esac
        [ -e "$doc/$(dirname "$file")/$link" ] || echo "$file links to $link"
    done
done > "$folder/dead"
[ ! -s "$folder/dead" ] || { echo 'installed documents have dead links:'; cat "$folder/dead"; exit 1; }
grep -q '](../../../include/masu.h)' "$doc/README.md" || { echo 'README.md: no link to masu.h'; exit 1; }
if [ "${config:-release}" = release ]; then # a sanitized library needs its examples sanitized, too
    cp -r "$doc/examples" "$folder/examples"
    make -C "$folder/examples" PREFIX="$stage$prefix" CC="${CC:-gcc}" CFLAGS=-O0 > "$folder/said" 2>&1 ||
        { cat "$folder/said" && exit 1; }
    for f in minimal split_screen cloth host_pass raii; do
        [ -x "$folder/examples/$f" ] || { echo "$f is not built from the prefix"; exit 1; }
    done
fi

# ---- Manual pages and completion -----------------------------------------------------------------

bin=$stage$prefix/bin
share=$stage$prefix/share
for page in "$share"/man/man1/*.1; do
    for part in NAME SYNOPSIS OPTIONS; do
        grep -qE "^\.S[HS] $part" "$page" || { echo "$page has no $part"; exit 1; }
    done
    if command -v groff > /dev/null; then
        warned=$(groff -man -ww -z -Tutf8 "$page" 2>&1)
        [ -z "$warned" ] || { echo "$page: $warned"; exit 1; }
    fi
done

# completes WORDS...: what bash offers for the last, which is begun
completes() {
    # shellcheck disable=SC2016
    bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _'"${1//-/_}"'; printf "%s\n" "${COMPREPLY[@]}"' \
        bash "$share/bash-completion/completions/$1" "$@"
}
[ "$(completes masu ren)" = render ]
[ "$(completes masu render --si)" = --size ]
[ "$(completes masu render a.masu --size 1x1 --tar)" = --target-ms ]
[ -z "$(completes masu compare --size)" ]
[ "$(completes masu-bake --prob | paste -sd' ')" = '--probe-report --probes' ]
sed 's/\\-/-/g' "$share/man/man1/masu.1" > "$folder/page"
for command in render plan bench conform; do
    "$bin/masu" "$command" --help | grep -oE '^ +(-[a-z], )?--[a-z-]+' | grep -oE -e '--[a-z-]+' | sort -u > "$folder/options"
    completes masu "$command" -- | sort -u | diff - "$folder/options"
    # The parser appends the default: a text that states it too states it twice.
    if "$bin/masu" "$command" --help | grep -E '\(default.*\(default'; then exit 1; fi
    while read -r option; do
        grep -qF -e "$option" "$folder/page" || { echo "masu.1 has no $option"; exit 1; }
    done < "$folder/options"
done

# From an empty folder, by name and by default; without scenes, one line that says what to do.
mkdir "$folder/empty"
masu=$bin/masu
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
find "$stage" | sort | diff "$folder/before" - || { echo 'uninstall leaves something, or takes more'; exit 1; }
# Into folders that were there before: they stay.
mkdir -p "$stage$prefix/bin" "$stage$prefix/share/man"
find "$stage" | sort > "$folder/before"
make --no-print-directory install-lib install-docs DESTDIR="$stage" PREFIX=$prefix > "$folder/said"
make --no-print-directory uninstall DESTDIR="$stage" PREFIX=$prefix
find "$stage" | sort | diff "$folder/before" - || { echo 'uninstall leaves something, or takes more'; exit 1; }
