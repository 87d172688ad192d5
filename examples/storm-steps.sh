#!/usr/bin/env bash
# A storm effect by effect, from waves alone to the integral over the sky: what each adds to the time and to the picture, as a
# table and a sheet of the pictures. Takes a minute.
#   examples/storm-steps.sh [DIR]      DIR: the folder for both, default baked/accuracy/storm-steps
set -euo pipefail
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,4s/^# //p' "$0"
    exit 0
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=setup.sh
source "$here/setup.sh"
out=${1:-$PELAGIC_ROOT/baked/accuracy/storm-steps}
install_packages program compare
build release pelagic >/dev/null
mkdir -p "$out"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$PELAGIC_ROOT/build/release/pelagic" accuracy "$here/pictures/storm-steps.toml" --rows picture-steps --pictures --out "$scratch" >/dev/null
/usr/bin/python3 "$here/storm-steps.py" "$scratch" "$out"
