#!/usr/bin/env bash
# Puts the headers of Python 3.13 and a pybind11 that knows it into FOLDER, out of Debian 13's packages: a compiler and
# libraries of Debian 12 make a module of them that Blender 4.3 on Debian 13, and the official 5.1, load.
#   headers.sh FOLDER
# Nothing is installed. It takes the mirror that apt has, which must hold Debian 13 as well.
set -euo pipefail
[ $# -eq 1 ] && [[ $1 != -* ]] || { sed -n '2,5s/^# //p' "$0" && exit 2; }
[ ! -d "$1" ] || exit 0
folder=$(realpath -m "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' | head -n 1)
keys=/usr/share/keyrings/debian-archive-keyring.gpg
mkdir -p "$work"/{lists,cache}/partial
echo "deb [signed-by=$keys] ${mirror:-http://deb.debian.org/debian} trixie main" >"$work/sources.list"
cd "$work"
# A state of its own: apt on this machine doesn't hear of Debian 13.
options=(-q -o Dir::Etc::SourceList="$work/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$work/lists"
    -o Dir::Cache="$work/cache" -o APT::Sandbox::User="$(id -un)")
apt-get "${options[@]}" update
apt-get "${options[@]}" download libpython3.13-dev pybind11-dev
for package in ./*.deb; do dpkg -x "$package" unpacked; done
cp unpacked/usr/include/*-linux-gnu/python3.13/pyconfig.h unpacked/usr/include/python3.13/ # this machine's own
mkdir -p "$(dirname "$folder")"
mv unpacked/usr/include "$folder" # whole or not at all
