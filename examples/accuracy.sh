#!/usr/bin/env bash
# What accuracy costs on the examples: examples/accuracy/NAME, a page with plots each (pelagic accuracy --help). Some minutes for each.
#   examples/accuracy.sh [NAME…]      default: all of them, examples/*.toml
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
case ${1:-} in -h | --help)
    sed -n '2,3s/^# //p' "$0"
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
    out="$here/accuracy/$name"
    "$PELAGIC_ROOT/build/release/pelagic" accuracy "$here/$name.toml" --out "$out" --repeats 3
    [ "$name" = first-shot ] || rm -f "$out"/*.svg # the page has the plots; those of the first shot are for other pages
done
