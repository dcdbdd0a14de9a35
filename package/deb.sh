#!/bin/sh
# deb.sh VERSION ROOT TO: packs what `make install DESTDIR=ROOT PREFIX=/usr` has installed as
# TO/masu_VERSION_ARCH.deb. Dependencies are those of the programs, as dpkg-shlibdeps finds them.
set -eu
version=$1 root=$2 to=$3
arch=$(dpkg --print-architecture)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# `make uninstall` has no use for it here: dpkg knows the files.
rm -f "$root/usr/share/doc/masu/folders"
cp LICENSE "$root/usr/share/doc/masu/copyright"
find "$root" -type d -exec chmod 755 {} +
for f in "$root"/usr/bin/* "$root"/usr/lib/libmasu.so.*.*.*; do strip --strip-unneeded "$f"; done
strip --strip-debug "$root/usr/lib/libmasu.a"

mkdir -p "$folder/debian" "$root/DEBIAN"
printf 'Source: masu\n\nPackage: masu\nArchitecture: any\n' > "$folder/debian/control"
paths=$(find "$(realpath "$root")/usr/bin" "$(realpath "$root")/usr/lib" -name 'masu*' -type f -perm -u+x \
    -o -name 'libmasu.so.*.*.*' -type f)
# shellcheck disable=SC2086
depends=$(cd "$folder" && dpkg-shlibdeps --ignore-missing-info -O $paths 2> "$folder/said" |
    sed -n 's/^shlibs:Depends=//p') || { cat "$folder/said" >&2 && exit 1; }
cat > "$root/DEBIAN/control" << END
Package: masu
Version: $version
Architecture: $arch
Maintainer: The Masu authors <masu@localhost>
Section: graphics
Priority: optional
Installed-Size: $(du -sk "$root/usr" | cut -f 1)
Depends: $depends
Recommends: mesa-vulkan-drivers | vulkan-icd, glslang-tools, spirv-tools
Suggests: libvulkan-dev, pkgconf
Description: fixed-memory renderer of polygons and distance fields (Vulkan)
 The library for C and C++ (static and shared, with headers, pkg-config and
 CMake files), the programs masu, masu-bake, masu-sdfc and masu-meso, a viewer,
 manual pages, documents and examples.
END
cat > "$root/DEBIAN/triggers" << END
activate-noawait ldconfig
END
mkdir -p "$to"
dpkg-deb --root-owner-group -Zxz --build "$root" "$to/masu_${version}_$arch.deb" > /dev/null
echo "$to/masu_${version}_$arch.deb"
