#!/usr/bin/env bash
# Renders the five pictures of the README from their shots in examples/pictures, on the CPU. Takes some
# minutes.
#   examples/pictures.sh [DIR]      DIR: the folder for the JPEGs, default examples/gallery
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,3s/^# //p' "$0"
    exit 0
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=${1:-$here/gallery}
# shellcheck source=setup.sh
source "$here/setup.sh"
install_packages program blender
build release pelagic >/dev/null
mkdir -p "$out"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for shot in noon low-sun overcast storm from-8-km; do
    "$PELAGIC_ROOT/build/release/pelagic" render "$here/pictures/$shot.toml" --frames 12 --samples 2 --out "$scratch"
    blender -b --factory-startup --python-exit-code 1 --python "$here/contact-sheet.py" -- \
        --columns 1 --out "$out/$shot.jpg" "$scratch/$shot.0012.png" >/dev/null
done
ls -l "$out"/{noon,low-sun,overcast,storm,from-8-km}.jpg
