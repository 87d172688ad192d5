#!/usr/bin/env bash
# The add-on's tests in the Blender of a later Debian, with the zip that is built here for all Pythons.
#   tests/addon/in_debian.sh SUITE [CTEST OPTION…]
# SUITE: trixie (Blender 4.3) or sid (the newest; what there is of it that day). Its root is made once, in build/SUITE (2 GB), as root
# or with sudo. The tests are ctest's with the label addon, as in this Blender; --tests-regex 'addon\.(look|playing)$' takes some.
set -euo pipefail
case "${1:-}" in
trixie | sid) suite=$1 && shift ;;
*) sed -n '2,5s/^# //p' "$0" && exit 2 ;;
esac
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)

install_packages
command -v debootstrap >/dev/null || apt_install debootstrap
for python in 3.13 3.14; do "$PELAGIC_ROOT/plugin/host/python/headers.sh" $python "$PELAGIC_PYTHONS/$python"; done
build release pelagic pelagic_python addon-zip
build=$PELAGIC_ROOT/build/release

root=$PELAGIC_ROOT/build/$suite
mirror=$(debian_mirror)
make_root() {
    [ -x "$root/usr/bin/apt-get" ] || "${as_root[@]}" debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"}
    "${as_root[@]}" cp /etc/resolv.conf "$root/etc/"
    # Services don't start; sid's mirror may be some weeks old. What the command line is linked with and the zip doesn't have is here too.
    printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$root/usr/sbin/policy-rc.d" >/dev/null
    "${as_root[@]}" chmod +x "$root/usr/sbin/policy-rc.d"
    "${as_root[@]}" chroot "$root" sh -ec '
        mount -t proc proc /proc
        trap "umount /proc" EXIT
        apt-get -q -o Acquire::Check-Valid-Until=false update
        DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends blender cmake libegl1 libgl1-mesa-dri libglfw3 \
            libstb0 python3 python3-cattr python3-numpy python3-openvdb python3-requests xauth xvfb'
    "${as_root[@]}" touch "$root/is-made"
}
[ -f "$root/is-made" ] || make_root

# The zip's modules and libraries lie where the tests look for those of the build, and where the command line looks.
unpacked=$(mktemp -d)
trap 'rm -rf "$unpacked"' EXIT
(cd "$unpacked" && cmake -E tar xf "$build"/pelagic_ocean-*.zip)
"${as_root[@]}" unshare --mount bash -euc '
    root=$1 project=$2 lib=$3
    shift 3
    mkdir -p "$root$project"
    mount --bind "$project" "$root$project"
    for folder in python lib; do mount --bind "$lib" "$root$project/build/release/$folder"; done
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs tmpfs "$root/tmp"
    cd "$project"
    chroot "$root" env HOME=/root blender --version | head -n 1
    chroot "$root" env HOME=/root ctest --test-dir "$project/build/release/tests/addon" --exclude-regex "^addon\.zip\$|nightly\$" \
        --fixture-exclude-setup . --no-tests=error --output-on-failure "$@"
' in_debian.sh "$root" "$PELAGIC_ROOT" "$unpacked/pelagic_ocean/lib" "$@"
