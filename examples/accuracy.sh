#!/usr/bin/env bash
# What accuracy costs on the examples: examples/accuracy/NAME, a page with plots each (pelagic accuracy --help).
#   examples/accuracy.sh [NAME…]      default: first-shot
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
case ${1:-} in -h | --help)
    sed -n '2,3s/^# //p' "$0"
    exit
    ;;
esac
# shellcheck source=setup.sh
source "$here/setup.sh"
install_packages
build release pelagic
[ $# -gt 0 ] || set -- first-shot
for name in "$@"; do
    "$PELAGIC_ROOT/build/release/pelagic" accuracy "$here/$name.toml" --out "$here/accuracy/$name"
done
