#!/bin/bash
# drivers.sh FOLDER [SET...]: builds what `masu-lab isa` needs into FOLDER, from Debian's source packages of Mesa: the
# drivers and the no-op kernel shims. No test runs it. Sets, both by default:
#   intel   ANV, Turnip: Mesa 22.3.6 of Debian 12. Ten minutes on two cores, 1.5 GB while it builds
#   mobile  V3DV, PanVK: Mesa 25.0.7 of its backports, as long. It needs meson 1.1: of its backports, too
#
# Needs PACKAGES_isa of packages.mk (make isa-drivers). MASU_DEBIAN_MIRROR replaces http://deb.debian.org/debian.
# CONFIGURE_ONLY=1 ends each set after meson.
set -euo pipefail
folder=${1:?usage: lab/isa/drivers.sh FOLDER [SET...]}
shift
[ $# -gt 0 ] || set -- intel mobile
mirror=${MASU_DEBIAN_MIRROR:-http://deb.debian.org/debian}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "drivers.sh: $1" >&2
    exit 1
}

# fetch VERSION SUFFIX SUM: unpacks Mesa's source into $work/VERSION
fetch() {
    echo "drivers.sh: fetching Mesa $1" >&2
    curl -fsSL "$mirror/pool/main/m/mesa/mesa_$1.orig.$2" -o "$work/$1.$2" || fail "no source of Mesa $1 at $mirror"
    echo "$3  $work/$1.$2" | sha256sum --quiet -c - || fail "the source of Mesa $1 is not Debian's"
    mkdir "$work/$1"
    tar -xf "$work/$1.$2" -C "$work/$1" --strip-components=1
    rm "$work/$1.$2"
}

# build VERSION OPTIONS TARGET...: configures with these options of meson, builds and strips the targets
build() {
    local source=$work/$1 options=$2 target
    shift 2
    # python3 in PATH may not be Debian's, which has mako.
    printf "[binaries]\npython3 = '/usr/bin/python3'\n" > "$source/native.ini"
    # shellcheck disable=SC2086 # a list
    (cd "$source" && PATH=/usr/bin:$PATH meson setup build --native-file native.ini --buildtype release -Db_ndebug=true \
        -Dgallium-drivers= -Dplatforms= -Dllvm=disabled -Dopengl=false -Degl=disabled -Dgbm=disabled -Dglx=disabled \
        $options > log 2>&1) || fail "meson: $(grep -m 1 ERROR "$source/log")"
    [ -z "${CONFIGURE_ONLY:-}" ] || return 0
    (cd "$source" && PATH=/usr/bin:$PATH ninja -C build "$@" > log 2>&1) || fail "ninja: $(tail -n 3 "$source/log")"
    for target in "$@"; do strip -o "$folder/${target##*/}" "$source/build/$target"; done
}

# is_newer VERSION: whether meson has at least this version
is_newer() { printf '%s\n' "$1" "$(PATH=/usr/bin:$PATH meson --version)" | sort -CV; }

mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
for set in "$@"; do
    case $set in
    intel)
        fetch 22.3.6 tar.gz 737cb8e5d380ce1a0ad01fb8b74db7f27303435c353e753d2302e8cf3927bad2
        build 22.3.6 '-Dvulkan-drivers=intel,freedreno -Dtools=drm-shim,intel -Dgles1=disabled -Dgles2=disabled' \
            src/intel/vulkan/libvulkan_intel.so src/intel/tools/libintel_noop_drm_shim.so \
            src/freedreno/vulkan/libvulkan_freedreno.so src/freedreno/drm-shim/libfreedreno_noop_drm_shim.so
        ;;
    mobile)
        is_newer 1.1 || fail 'V3DV and PanVK need meson 1.1 (bookworm-backports)'
        fetch 25.0.7 tar.xz 592272df3cf01e85e7db300c449df5061092574d099da275d19e97ef0510f8a6
        # The shim is a Raspberry Pi 4; V3D_SHIM_VER=71 makes it a Pi 5.
        shim=$work/25.0.7/src/broadcom/drm-shim/v3d_noop.c
        value='gp->value = v3d42_reg_map\[gp->param\];'
        grep -q "$value" "$shim" || fail 'the shim of V3D has changed'
        sed -i "s/$value/& const char *version = getenv(\"V3D_SHIM_VER\"); if (version \&\& version[0] == '7') { \
            if (gp->param == DRM_V3D_PARAM_V3D_CORE0_IDENT0) gp->value = 0x07443356; \
            if (gp->param == DRM_V3D_PARAM_V3D_CORE0_IDENT1) gp->value = 0x81001431; }/" "$shim"
        build 25.0.7 '-Dvulkan-drivers=broadcom,panfrost -Dtools=drm-shim -Dvideo-codecs=' \
            src/broadcom/vulkan/libvulkan_broadcom.so src/broadcom/drm-shim/libv3d_noop_drm_shim.so \
            src/panfrost/vulkan/libvulkan_panfrost.so src/panfrost/drm-shim/libpanfrost_noop_drm_shim.so
        ;;
    *) fail "there is no set '$set': intel, mobile" ;;
    esac
done
echo "drivers.sh: MASU_ISA_DRIVERS=$folder" >&2
