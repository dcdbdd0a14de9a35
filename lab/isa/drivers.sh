#!/bin/bash
# drivers.sh FOLDER: builds what `masu-lab isa` needs for Intel's and Adreno's GPUs into FOLDER: ANV, Turnip and
# Mesa's no-op kernel shims, from Debian's source package of Mesa (the version of Debian 12). Ten minutes on two
# cores, 1.5 GB while it builds. No test runs it.
#
# Needs PACKAGES_isa of packages.mk (make isa-drivers). MASU_DEBIAN_MIRROR replaces http://deb.debian.org/debian.
set -euo pipefail
folder=${1:?usage: lab/isa/drivers.sh FOLDER}
version=22.3.6
sum=737cb8e5d380ce1a0ad01fb8b74db7f27303435c353e753d2302e8cf3927bad2
mirror=${MASU_DEBIAN_MIRROR:-http://deb.debian.org/debian}
wanted='libvulkan_intel.so libvulkan_freedreno.so libintel_noop_drm_shim.so libfreedreno_noop_drm_shim.so'

fail() {
    echo "drivers.sh: $1" >&2
    exit 1
}

mkdir -p "$folder"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "drivers.sh: fetching Mesa $version" >&2
curl -fsSL "$mirror/pool/main/m/mesa/mesa_$version.orig.tar.gz" -o "$work/mesa.tar.gz" ||
    fail "no source of Mesa $version at $mirror"
echo "$sum  $work/mesa.tar.gz" | sha256sum --quiet -c - || fail "the source of Mesa $version is not Debian's"
tar -xzf "$work/mesa.tar.gz" -C "$work" --strip-components=1
cd "$work"
# python3 in PATH may not be Debian's, which has mako.
cat > native.ini << END
[binaries]
python3 = '/usr/bin/python3'
END
PATH=/usr/bin:$PATH meson setup build --native-file native.ini --buildtype release -Db_ndebug=true \
    -Dvulkan-drivers=intel,freedreno -Dgallium-drivers= -Dplatforms= -Dllvm=disabled -Dtools=drm-shim,intel \
    -Dopengl=false -Dgles1=disabled -Dgles2=disabled -Degl=disabled -Dgbm=disabled -Dglx=disabled > log 2>&1 ||
    fail "meson: $(tail -n 1 log)"
PATH=/usr/bin:$PATH ninja -C build src/intel/vulkan/libvulkan_intel.so src/intel/tools/libintel_noop_drm_shim.so \
    src/freedreno/vulkan/libvulkan_freedreno.so src/freedreno/drm-shim/libfreedreno_noop_drm_shim.so > log 2>&1 || fail "ninja: $(tail -n 3 log)"
cd "$OLDPWD"
for file in $wanted; do
    built=$(find "$work/build" -name "$file" -type f | head -n 1)
    [ "$built" ] || fail "Mesa $version has not built $file"
    strip -o "$folder/$file" "$built"
done
echo "drivers.sh: MASU_ISA_DRIVERS=$folder" >&2
