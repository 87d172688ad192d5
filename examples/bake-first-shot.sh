#!/usr/bin/env bash
# Installs what is missing, builds, and bakes the first example: 24 frames of a 14 m/s wind sea with a swell.
#   examples/bake-first-shot.sh [DIR]      DIR: the folder for the files, default baked/first-shot
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,3s/^# //p' "$0"
    exit 0
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=setup.sh
source "$here/setup.sh"
out=${1:-$PELAGIC_ROOT/baked/first-shot}

install_packages program
build release pelagic
"$PELAGIC_ROOT/build/release/pelagic" bake "$here/first-shot.toml" --out "$out"

cat <<EOF

The sea is in $out
  first-shot.usda    the stage: open it in a program that reads OpenUSD (usdview; Blender 3.5 or later, File > Import > USD)
  first-shot.sky.exr the sky of the stage's dome light; its sun is in the stage
  mesh/              a layer a frame: positions, normals, velocities, slope variances, whitecap coverage
  maps/              displacement and whitecaps as OpenEXR, for a shader on a flat plane
  first-shot.json    what was baked, and each frame's statistics
Debian's Blender has no USD. To see the sea there:
  examples/blender-first-look.sh examples/first-shot.toml
EOF
