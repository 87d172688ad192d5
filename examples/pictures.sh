#!/usr/bin/env bash
# Renders the gallery's pictures from their shots in examples/pictures, on the CPU: those that the README shows, a sheet of foam near and far, a sheet of bodies in the
# light of the sea, each rendered and in the preview, a strip of eight frames a second apart, one of water types, and a sheet of all presets, which becomes the add-on's
# thumbnails. Takes some minutes.
#   examples/pictures.sh [DIR]      DIR: the folder for the JPEGs, default examples/gallery
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,5s/^# //p' "$0"
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
sheet() {  # COLUMNS JPEG PICTURE…
    blender -b --factory-startup --python-exit-code 1 --python "$here/contact-sheet.py" -- \
        --columns "$1" --out "$out/$2" "${@:3}" >/dev/null
}
render() {  # SHOT FRAMES
    "$PELAGIC_ROOT/build/release/pelagic" render "$here/pictures/$1.toml" --frames "$2" --samples 2 --out "$scratch"
}
beside_preview() {  # SHOT: a render at half the size, with as many samples, and the same in the preview
    "$PELAGIC_ROOT/build/release/pelagic" render "$here/pictures/$1.toml" --frames 12 --size 640x360 --samples 4 --out "$scratch/small"
    "$PELAGIC_ROOT/build/release/pelagic" preview "$here/pictures/$1.toml" --frame 12 --size 640x360 --offscreen "$scratch/small/$1.preview.png"
    bodies+=("$scratch/small/$1.0012.png" "$scratch/small/$1.preview.png")
}
for shot in noon low-sun overcast storm storm-trough spray from-8-km patch lagoon tiles atoll glassy-backlit half-under from-below sailboat-sunset; do
    render $shot 12
    sheet 1 $shot.jpg "$scratch/$shot.0012.png"
done
"$PELAGIC_ROOT/build/release/pelagic" render "$here/beach.toml" --frames 40 --size 640x360 --samples 2 --out "$scratch"
sheet 1 beach.jpg "$scratch/beach.0040.png"
bodies=()
for shot in sailboat-sunset trawler-noon trawler-sunset buoy-storm lighthouse-dusk; do beside_preview $shot; done
sheet 2 objects.jpg "${bodies[@]}"
for shot in foam-breeze foam-gale foam-storm; do render $shot 1-2; done
sheet 2 foam.jpg "$scratch"/foam-{breeze,gale,storm}.000{1,2}.png
render foam-strip 25-193x24
sheet 4 foam-strip.jpg "$scratch"/foam-strip.*.png
# Side by side as in Darles et al. 2007, Fig. 8.
for type in jerlov-I jerlov-III coastal jerlov-3C jerlov-5C turbid; do
    sed "s/^name = .*/name = \"$type\"/; s/^type = .*/type = \"$type\"/" "$here/pictures/water-types.toml" > "$scratch/$type.toml"
    "$PELAGIC_ROOT/build/release/pelagic" render "$scratch/$type.toml" --frames 12 --samples 2 --out "$scratch"
done
sheet 3 water-types.jpg "$scratch"/{jerlov-I,jerlov-III,coastal,jerlov-3C,jerlov-5C,turbid}.0012.png
"$PELAGIC_ROOT/build/release/pelagic" presets --sheet "$scratch/presets.png"
sheet 1 presets.jpg "$scratch/presets.png"
mapfile -t presets < <("$PELAGIC_ROOT/build/release/pelagic" presets | cut -d ' ' -f 1)
blender -b --factory-startup --python-exit-code 1 --python "$here/preset-thumbnails.py" -- \
    "$scratch/presets.png" "$PELAGIC_ROOT/addon/pelagic_ocean/thumbnails" "${presets[@]}" >/dev/null
ls -l "$out"/{presets,noon,low-sun,overcast,storm,storm-trough,spray,from-8-km,patch,lagoon,tiles,atoll,beach,glassy-backlit,half-under,from-below,sailboat-sunset,water-types,foam,objects,foam-strip}.jpg
