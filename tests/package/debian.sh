#!/usr/bin/env bash
# The Debian packages on a clean Debian 12 without a compiler: installed by apt, used as a newcomer would; then with one, by C, C++ and CMake.
#   tests/package/debian.sh
# The root is made anew in build/clean (2 GB with Blender), as root or with sudo.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"$PELAGIC_ROOT/packages/make.sh"
command -v debootstrap >/dev/null || apt_install debootstrap
root=$PELAGIC_ROOT/build/clean
mirror=$(debian_mirror)
"${as_root[@]}" rm -rf --one-file-system "$root"
"${as_root[@]}" debootstrap --variant=minbase bookworm "$root" ${mirror:+"$mirror"}
"${as_root[@]}" cp /etc/resolv.conf "$root/etc/"
"${as_root[@]}" mkdir "$root/given"
"${as_root[@]}" cp "$PELAGIC_ROOT"/build/packages/*.deb "$PELAGIC_ROOT"/examples/first_sea.c "$here"/consumer/* "$root/given/"
"${as_root[@]}" unshare --mount bash -euc '
    mount -t proc proc "$1/proc"
    mount --rbind /dev "$1/dev"
    exec chroot "$1" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive bash -euxc "
        cd /given
        apt-get update -q >/dev/null
        install() { apt-get install -y -q --no-install-recommends \"\$@\" >/dev/null; }
        install ./pelagic_*.deb ./python3-pelagic_*.deb
        if command -v cc; then exit 1; fi
        printf \"[shot]\\nframes = [1, 2]\\n[surface]\\nsize_m = 40.0\\nresolution = 64\\n[output]\\nvolumes = [\\\"level-set\\\"]\\nvoxel_m = 2.0\\n\" >shot.toml
        pelagic bake shot.toml --out baked
        ls baked/*.usda baked/*/*.vdb
        pelagic verify baked
        pelagic render shot.toml --out pictures --frames 1 --size 64x36 --samples 1
        test -s pictures/sea.0001.png
        test -s /usr/share/man/man1/pelagic-bake.1
        python3 -c \"import pelagic; s = pelagic.Scene.from_file(\\\"shot.toml\\\"); pelagic.bake(s, \\\"by_python\\\")\"
        ls by_python/*/*.vdb
        install bash-completion
        bash -c \". /usr/share/bash-completion/bash_completion; _completion_loader pelagic || true; complete -p pelagic\"
        install ./blender-pelagic_*.deb
        blender -b --factory-startup --python-exit-code 1 --python-expr \"import addon_utils, bpy; addon_utils.enable(\\\"pelagic_ocean\\\"); bpy.ops.pelagic.add_ocean(); assert len(bpy.context.object.data.vertices) > 1000\"
        install ./libpelagic*.deb g++ make cmake pkg-config
        gcc first_sea.c \$(pkg-config --cflags --libs pelagic) -o first_sea
        ./first_sea shot.toml
        cmake -S . -B by_cmake
        cmake --build by_cmake
        by_cmake/consumer
        apt-get remove -y -q \"*pelagic*\" >/dev/null
        if find /usr -iname \"*pelagic*\" | grep .; then exit 1; fi
    "
' debian.sh "$root"
"${as_root[@]}" rm -rf --one-file-system "$root"
echo "the packages install, work, and leave"
