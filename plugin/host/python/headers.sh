#!/usr/bin/env bash
# Puts the headers of a later Python than Debian 12's into FOLDER, and a pybind11 that knows it, out of a later Debian's packages:
# the compiler and the libraries of Debian 12 make a module of them for later Blenders.
#   headers.sh VERSION FOLDER
# VERSION: 3.13 (Blender 5.1, and 4.3 on Debian 13) or 3.14 (Blender 5.2 on Debian). Nothing is installed. It takes the mirror
# that apt has, which must hold the later Debian as well.
set -euo pipefail
case "$#${1:-}" in
23.13) suite=trixie ;;
23.14) suite=forky ;;
*) sed -n '2,6s/^# //p' "$0" && exit 2 ;;
esac
[ ! -d "$2" ] || exit 0
version=$1 folder=$(realpath -m "$2")
# shellcheck source=../../../examples/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../../examples/setup.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mirror=$(debian_mirror)
[ -n "$mirror" ] || { echo "headers.sh: apt names no mirror of Debian 12; add one to its sources" >&2 && exit 1; }
keys=/usr/share/keyrings/debian-archive-keyring.gpg
mkdir -p "$work"/{lists,cache}/partial
echo "deb [signed-by=$keys] $mirror $suite main" >"$work/sources.list"
cd "$work"
# A state of its own: apt on this machine doesn't hear of the other Debian.
options=(-q -o Dir::Etc::SourceList="$work/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$work/lists"
    -o Dir::Cache="$work/cache" -o APT::Sandbox::User="$(id -un)")
apt-get "${options[@]}" update
apt-get "${options[@]}" download "libpython$version-dev" pybind11-dev
for package in ./*.deb; do dpkg -x "$package" unpacked; done
cp unpacked/usr/include/*-linux-gnu/"python$version"/pyconfig.h "unpacked/usr/include/python$version/" # this machine's own
mkdir -p "$(dirname "$folder")"
mv unpacked/usr/include "$folder" # whole or not at all
