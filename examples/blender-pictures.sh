#!/usr/bin/env bash
# Renders the pictures of the add-on's page by Blender's Cycles into examples/gallery. An hour on two cores.
#   examples/blender-pictures.sh [SAMPLES]      per pixel; default: 256
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=setup.sh
source "$here/setup.sh"
install_packages program python blender
build release pelagic pelagic_python >/dev/null
samples=${1:-256}

picture() {
    PYTHONPATH=$PELAGIC_ROOT/build/release/python PYTHONDONTWRITEBYTECODE=1 blender -b --factory-startup \
        --python-exit-code 1 --python "$here/blender-pictures.py" -- "$here/$1.toml" "$here/gallery/$2.jpg" \
        samples="$samples" "${@:3}"
}

picture glassy-swell blender-calm
picture north-sea-storm blender-storm
picture trade-wind blender-beside size=480x270 beside=core
picture pictures/spray blender-spray size=560x315
