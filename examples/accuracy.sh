#!/usr/bin/env bash
# What accuracy costs on the examples: baked/accuracy/NAME, a page with plots each (pelagic accuracy --help). Some minutes for each.
# Of the first shot's, the table and the plot that other pages show go to examples/accuracy as well.
#   examples/accuracy.sh [NAME…]      default: all of them, examples/*.toml
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
case ${1:-} in -h | --help)
    sed -n '2,4s/^# //p' "$0"
    exit
    ;;
esac
# shellcheck source=setup.sh
source "$here/setup.sh"
install_packages program
build release pelagic
if [ $# -eq 0 ]; then
    for shot in "$here"/*.toml; do set -- "$@" "$(basename "$shot" .toml)"; done
fi
for name in "$@"; do
    out=$PELAGIC_ROOT/baked/accuracy/$name
    "$PELAGIC_ROOT/build/release/pelagic" accuracy "$here/$name.toml" --out "$out" --repeats 3
    [ "$name" != first-shot ] || cp "$out"/{accuracy.txt,interpolation.svg} "$here/accuracy/$name"
done
