#!/usr/bin/env bash
# A first look at a shot in Blender: builds the Python module if it is missing, and renders two pictures.
#   examples/blender-first-look.sh [SHOT.toml [OPTION…]]     default: examples/first-shot.toml, into baked/first-look
#   OPTION: --out DIR, --frames A,B, --samples N, --size WxH
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,4s/^# //p' "$0"
    exit 0
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=setup.sh
source "$here/setup.sh"
shot=${1:-$here/first-shot.toml}
[ $# -eq 0 ] || shift
module=$PELAGIC_ROOT/build/release/python

if ! compgen -G "$module/pelagic.*.so" >/dev/null; then
    echo "The Python module isn't built yet: installing what is missing, and building it into $module"
    install_packages program python
    build release pelagic_python
fi
command -v blender >/dev/null || install_packages blender

# If an option is given twice, the caller's counts: it is the later one. Blender needs --python-exit-code to
# report a script's failure.
PYTHONPATH=$module PYTHONDONTWRITEBYTECODE=1 blender -b --factory-startup --python-exit-code 1 \
    --python "$here/blender-first-look.py" -- "$shot" --out "$PELAGIC_ROOT/baked/first-look" --size 960x540 "$@"

cat <<EOT

To look around in it, and play it:
  PYTHONPATH=$module blender --factory-startup --python $here/blender-first-look.py -- $shot
EOT
