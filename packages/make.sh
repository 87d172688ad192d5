#!/usr/bin/env bash
# Debian packages of everything, into a folder: pelagic, libpelagic, libpelagic-dev, python3-pelagic, blender-pelagic; and a tarball for
# other distributions of the program and libpelagic, with what they need.
#   packages/make.sh [FOLDER]      default: build/packages
# On Debian 12, as root or with sudo; installs what is missing and builds first. The packages need what this Debian has.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"
folder=${1:-$PELAGIC_ROOT/build/packages}
mkdir -p "$folder" && folder=$(cd "$folder" && pwd)

install_packages program preview python packages
# A folder with everything may have been configured for tests too; their programs aren't built here.
build release pelagic pelagic_without_preview pelagic_procedural pelagic_python pelagic_openvdb_writer pelagic_ocio_module pelagic_rays_module
release=$PELAGIC_ROOT/build/release
"$here/man.sh" "$release/pelagic" "$release/man"
rm -f "$folder"/{,lib,python3-,blender-}pelagic*.deb "$folder"/pelagic-*-linux-x86_64.tar.gz  # of other versions
(cd "$release" && cpack -G DEB -B "$folder")
rm -rf "$folder/_CPack_Packages"
version=$("$release/pelagic" --version | sed -n '1s/^pelagic //p')
python3 "$here/tarball.py" "$release" "$folder/pelagic-$version-linux-x86_64.tar.gz"
ls -l "$folder"/*.deb "$folder"/*.tar.gz
