#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests.
#   tests/run.sh [PRESET]      PRESET: release (default), debug or sanitize
set -euo pipefail
case "${1:-release}" in
release | debug | sanitize) preset=${1:-release} ;;
*)
    sed -n '2,3s/^# //p' "$0"
    [ "$1" = "--help" ] || [ "$1" = "-h" ]
    exit
    ;;
esac
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"

install_packages
"$here/plugin/usd/openusd/install.sh"
build "$preset"
cd "$PELAGIC_ROOT"
ctest --preset "$preset" --no-tests=error
