#!/bin/bash
# drivers.sh NAME: makes the Vulkan driver NAME available and prints the path of its ICD file.
#
#   system       the lavapipe that the system's mesa-vulkan-drivers has installed
#   lavapipe-25  the lavapipe of bookworm-backports
#   swiftshader  the SwiftShader that Debian's chromium packages carry
#   any          whatever the Vulkan loader finds (a real GPU); prints an empty line
#
# Drivers that the system does not have are unpacked to build/drivers/NAME, once. Nothing is
# installed, no source is added to the system's apt, and no root is needed: apt works in
# build/drivers/apt with its own configuration and lists. Where a driver needs libraries that the
# system lacks, build/drivers/NAME/env says how it finds them: to be sourced. The package and its
# version are in build/drivers/NAME/version.
#
# Exit 0: there. 1: not to be had; the last line on stderr says why. 2: NAME is none of these.
# MASU_DEBIAN_MIRROR replaces http://deb.debian.org/debian.
set -euo pipefail
cd "$(dirname "$0")/.."

name=${1:?usage: tests/drivers.sh system|lavapipe-25|swiftshader|any}
home=$PWD/build/drivers
mirror=${MASU_DEBIAN_MIRROR:-http://deb.debian.org/debian}
arch=$(uname -m)

fail() {
    echo "drivers.sh: $name: $1" >&2
    exit 1
}

# The system's apt settings for fetching (a proxy, say) hold; its sources, lists, pins and hooks do
# not.
private_apt() {
    local apt=$home/apt
    local key=/usr/share/keyrings/debian-archive-keyring.gpg
    command -v apt-get > /dev/null || fail "no apt-get to fetch it with"
    mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
    for suite in bookworm bookworm-backports; do
        echo "deb [signed-by=$key] $mirror $suite main"
    done > "$apt/sources.list"
    {
        apt-config dump | grep '^Acquire::' |
            grep -Ev '^Acquire::(IndexTargets|Languages|GzipIndexes)'
        cat << END
Dir::Etc::main "/dev/null";
Dir::Etc::parts "/dev/null";
Dir::Etc::sourcelist "$apt/sources.list";
Dir::Etc::sourceparts "/dev/null";
Dir::Etc::preferences "/dev/null";
Dir::Etc::preferencesparts "/dev/null";
Dir::State::lists "$apt/lists";
Dir::Cache "$apt/cache";
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
Acquire::Languages "none";
Acquire::GzipIndexes "true";
APT::Sandbox::User "";
END
    } > "$apt/apt.conf"
    export APT_CONFIG=$apt/apt.conf
    apt-get -qq update >&2 || fail "apt-get update failed"
}

# fetch PACKAGE...: the .deb files to the current folder. What the system has installed does not
# count: apt would ask for that very version, which may come from a suite that is not listed here
# (a security update), and find no source for it.
fetch() {
    apt-get -qq -o Dir::State::status=/dev/null -o Acquire::Retries=3 download "$@" >&2 ||
        fail "apt-get could not download: $*"
}

# icd SOURCE LIBRARY TARGET: copies an ICD file, with LIBRARY as the absolute path of the driver
icd() {
    sed "s|\"library_path\": *\"[^\"]*\"|\"library_path\": \"$2\"|" "$1" > "$3"
}

# lacks LIBRARY [PATH]: the libraries that the loader would not find
lacks() {
    LD_LIBRARY_PATH=${2:-} ldd "$1" | sed -n 's/^\s*\(\S*\) => not found/\1/p'
}

unpack_lavapipe() {
    local packages lib missing
    private_apt
    # What apt would install or upgrade here to have that driver: it and whatever the system lacks.
    packages=$(apt-get -s -qq --no-install-recommends --allow-downgrades install \
        mesa-vulkan-drivers/bookworm-backports | sed -n 's/^Inst \(\S*\) .*(\(\S*\) .*/\1=\2/p')
    [[ $packages == *mesa-vulkan-drivers=25* ]] || fail "bookworm-backports has no version 25"
    # shellcheck disable=SC2086
    fetch $packages
    for deb in *.deb; do
        dpkg -x "$deb" root
        rm "$deb"
    done
    lib=$(dirname root/usr/lib/*/libvulkan_lvp.so)
    missing=$(lacks "$lib/libvulkan_lvp.so" "$PWD/$lib")
    [ -z "$missing" ] || fail "it lacks ${missing//$'\n'/ }"
    icd root/usr/share/vulkan/icd.d/lvp_icd*.json "$home/$name/$lib/libvulkan_lvp.so" icd.json
    # The other vendors' drivers and the files around them are not wanted.
    find root -type f ! -name '*.so*' -delete
    find root -name 'libvulkan_*.so' ! -name libvulkan_lvp.so -delete
    find root -name 'libVkLayer_*.so' -delete
    # Of the two lavapipes this one compiles for vectors of 128 bits and without its optimiser: half of the time, which
    # goes into compiling, and a width of subgroups that the other does not have.
    {
        echo "export LD_LIBRARY_PATH=$home/$name/$lib\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
        echo "export LP_NATIVE_VECTOR_WIDTH=128 GALLIVM_PERF=nopt"
    } > ./env
    sed -n 's/^mesa-vulkan-drivers=/mesa-vulkan-drivers /p' <<< "$packages" > version
}

unpack_swiftshader() {
    local missing
    private_apt
    # Newer versions of Debian's Chromium keep it in chromium-common, older ones in chromium itself.
    for package in chromium-common chromium; do
        fetch $package
        # shellcheck disable=SC2016
        dpkg-deb -W --showformat '${Package} ${Version}\n' $package* > version
        dpkg-deb --fsys-tarfile $package* |
            tar -x --wildcards '*/libvk_swiftshader.so' '*/vk_swiftshader_icd.json' 2> /dev/null &&
            break
    done
    rm -f chromium*.deb
    mv usr/lib/chromium/*swiftshader* . || fail "Debian's chromium does not carry it any more"
    rm -r usr
    missing=$(lacks libvk_swiftshader.so)
    [ -z "$missing" ] || fail "it lacks ${missing//$'\n'/ }"
    icd vk_swiftshader_icd.json "$home/$name/libvk_swiftshader.so" icd.json
    rm vk_swiftshader_icd.json
}

# unpacked COMMAND: runs it in an empty folder, which gets its name only when it is complete. ICD
# files hold absolute paths: after the tree has been moved, it is done again.
unpacked() {
    if ! grep -qs "\"$home/$name/" "$home/$name/icd.json"; then
        rm -rf "${home:?}/$name" "$home/$name.part"
        mkdir -p "$home/$name.part"
        (cd "$home/$name.part" && "$1")
        mv "$home/$name.part" "$home/$name"
    fi
    echo "$home/$name/icd.json"
}

case $name in
    system)
        for file in {/etc,/usr/share}/vulkan/icd.d/lvp_icd{."$arch",,.*}.json; do
            [ -e "$file" ] && echo "$file" && exit 0
        done
        fail "no lavapipe; install mesa-vulkan-drivers"
        ;;
    lavapipe-25) unpacked unpack_lavapipe ;;
    swiftshader) unpacked unpack_swiftshader ;;
    any) echo ;;
    *)
        echo "drivers.sh: no driver $name: system, lavapipe-25, swiftshader or any" >&2
        exit 2
        ;;
esac
