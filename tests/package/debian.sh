#!/usr/bin/env bash
# What is given away, where nothing of ours is: the tarball on Debian 11, whose C library is older, on a bare Debian 12 and where there is
# no C library; the Debian packages on Debian 12, installed by apt and used as a newcomer would; both with a compiler, by C, C++ and CMake.
#   tests/package/debian.sh
# The roots are made anew in build/clean (3 GB with Blender), as root or with sudo.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
clean=$PELAGIC_ROOT/build/clean
given=$clean/given
mirror=$(debian_mirror)

# root SUITE: $clean/SUITE, a Debian of nothing but what apt needs, with what is given in /given.
root() {
    "${as_root[@]}" debootstrap --variant=minbase "$1" "$clean/$1" ${mirror:+"$mirror"}
    "${as_root[@]}" cp /etc/resolv.conf "$clean/$1/etc/"
    echo force-unsafe-io | "${as_root[@]}" tee "$clean/$1/etc/dpkg/dpkg.cfg.d/no-sync" >/dev/null  # it is thrown away
    "${as_root[@]}" cp -r "$given" "$clean/$1/given"
}
# in_root SUITE: runs the script from standard input in it, in /given.
in_root() {
    "${as_root[@]}" tee "$clean/$1/given/script" >/dev/null
    "${as_root[@]}" unshare --mount bash -euc '
        mount -t proc proc "$1/proc"
        mount --rbind /dev "$1/dev"
        exec chroot "$1" env -i HOME=/root PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive \
            bash -euxc "cd /given; source ./script"' debian.sh "$clean/$1"
}

"$PELAGIC_ROOT/packages/make.sh"
command -v debootstrap >/dev/null || apt_install debootstrap
"${as_root[@]}" rm -rf --one-file-system "$clean"
mkdir -p "$given"
cp "$PELAGIC_ROOT"/build/packages/*.{deb,tar.gz} "$PELAGIC_ROOT"/examples/first_sea.c "$here"/consumer/* "$here/two_tbb.cpp" "$given"
cat >"$given/shot.toml" <<'TOML'
[shot]
frames = [1, 2]
[surface]
size_m = 40.0
resolution = 64
[output]
volumes = ["level-set"]
voxel_m = 2.0
TOML
baked=$clean/baked
for set in "" sse4; do
    "$PELAGIC_ROOT/build/release/pelagic" bake "$given/shot.toml" --out "$baked$set" ${set:+--instruction-set $set}
done

# The tarball, moved and linked to: each system's bake is the build's own, byte by byte, with the older mathematics of SSE4 as well.
for suite in bullseye bookworm; do
    root $suite
    in_root $suite <<'SH'
        place="/opt/a place: ours"
        mkdir "$place"
        tar xzf pelagic-*.tar.gz -C "$place"
        ln -s "$place"/pelagic-*/bin/pelagic /usr/local/bin/pelagic
        pelagic bake shot.toml --out baked
        pelagic bake shot.toml --out bakedsse4 --instruction-set sse4
        pelagic verify baked
        pelagic render shot.toml --out pictures --frames 1 --size 64x36 --samples 1
        test -s pictures/sea.0001.png
        pelagic farm shot.toml --out farmed
        bash farmed/farm/*.bake.sh 0
        pelagic verify farmed
        if pelagic preview shot.toml; then exit 1; fi
        test -s "$place"/pelagic-*/share/man/man1/pelagic-bake.1
        bash -n "$place"/pelagic-*/share/bash-completion/completions/pelagic
SH
    for set in "" sse4; do diff -r "$baked$set" "$clean/$suite/given/baked$set"; done
done

# In a root without any C library but the tarball's: as on a system of another kind, or of any age.
in_root bookworm <<'SH'
    apt-get update -q >/dev/null
    apt-get download -q busybox-static
    dpkg-deb -x busybox-static_*.deb /none
    mkdir -p /none/proc /none/dev /none/tmp
    mount -t proc proc /none/proc
    mount --bind /dev /none/dev
    for name in sh readlink; do ln -s busybox /none/bin/$name; done
    cp -r /opt/*/pelagic-* /none/pelagic
    cp shot.toml /none
    chroot /none /pelagic/bin/pelagic bake shot.toml --out baked
    mv /none/baked bakednone
SH
diff -r "$baked" "$clean/bookworm/given/bakednone"

in_root bookworm <<'SH'
    rm -r /usr/local/bin/pelagic baked*
    install() { apt-get install -y -q --no-install-recommends "$@" >/dev/null; }
    install ./pelagic_*.deb ./python3-pelagic_*.deb
    if command -v cc; then exit 1; fi
    pelagic bake shot.toml --out baked
    ls baked/*.usda baked/*/*.vdb
    pelagic verify baked
    pelagic render shot.toml --out pictures --frames 1 --size 64x36 --samples 1
    test -s pictures/sea.0001.png
    test -s /usr/share/man/man1/pelagic-bake.1
    python3 -c 'import pelagic; s = pelagic.Scene.from_file("shot.toml"); pelagic.bake(s, "by_python")'
    ls by_python/*/*.vdb
    install bash-completion
    bash -c ". /usr/share/bash-completion/bash_completion; _completion_loader pelagic || true; complete -p pelagic"
    install ./blender-pelagic_*.deb
    blender -b --factory-startup --python-exit-code 1 --python-expr 'import addon_utils, bpy; addon_utils.enable("pelagic_ocean"); bpy.ops.pelagic.add_ocean(); assert len(bpy.context.object.data.vertices) > 1000'
    install ./libpelagic*.deb g++ make cmake pkg-config
    gcc first_sea.c $(pkg-config --cflags --libs pelagic) -o first_sea
    ./first_sea shot.toml
    cmake -S . -B by_cmake
    cmake --build by_cmake
    by_cmake/consumer
    apt-get remove -y -q "*pelagic*" >/dev/null
    if find /usr -iname "*pelagic*" | grep .; then exit 1; fi
SH
diff -r "$baked" "$clean/bookworm/given/baked"

# The tarball's library beside a host's own libraries: oneTBB at work; then all of them by their names, whose every function ends the process.
in_root bookworm <<'SH'
    mv /opt/*/pelagic-* /opt/pelagic
    export PKG_CONFIG_PATH=/opt/pelagic/lib/pkgconfig LD_LIBRARY_PATH=/opt/pelagic/lib
    gcc first_sea.c $(pkg-config --cflags --libs pelagic) -o by_tarball
    ./by_tarball shot.toml
    g++ -std=c++20 two_tbb.cpp $(pkg-config --cflags --libs pelagic) -ltbb -o two_tbb
    ./two_tbb shot.toml
    mkdir theirs
    for own in /opt/pelagic/lib/libpelagic/*; do
        name=$(basename "$own") && name=${name/-pelagic/}
        {
            echo .text
            nm -D --defined-only --format=posix "$own" | sed -E '/ A /d; s/(\.pelagic)?(@[^ ]*)? .*//' | sort -u |
                sed 's/.*/.globl "&"\n"&": ud2/'
        } >theirs.s
        gcc -shared -nostdlib -Wl,-soname,"$name" theirs.s -o "theirs/$name"
    done
    preloaded=$(printf '%s:' theirs/*)
    if LD_PRELOAD=$preloaded ./two_tbb shot.toml; then exit 1; fi
    test "$(LD_PRELOAD=$preloaded ./by_tarball shot.toml)" = "$(./by_tarball shot.toml)"
SH
"${as_root[@]}" rm -rf --one-file-system "$clean"
echo "packages and tarball install, work, and leave"
