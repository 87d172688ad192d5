#!/usr/bin/env bash
# Renders a picture of each example shot and puts them on one sheet. Takes some minutes.
#   examples/contact-sheet.sh [DIR]      DIR: the folder for the pictures, default examples/gallery
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,3s/^# //p' "$0"
    exit 0
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=${1:-$here/gallery}
mkdir -p "$out"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for shot in first-shot glassy-swell trade-wind north-sea-storm shallow-bay buoy-hour; do
    "$here/blender-first-look.sh" "$here/$shot.toml" --out "$scratch" --frames 12 --samples 64 --size 720x405
done
blender -b --factory-startup --python-exit-code 1 --python "$here/contact-sheet.py" -- \
    --columns 2 --out "$out/contact-sheet.jpg" "$scratch"/{first-shot,glassy-swell,trade-wind,north-sea-storm,shallow-bay,buoy-hour}.0012.png
