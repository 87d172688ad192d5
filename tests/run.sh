#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests.
#   tests/run.sh [PRESET] [--label LABEL]
# PRESET: release (default), debug, sanitize (addresses and undefined behaviour) or tsan (threads).
# LABEL: unit (in under a minute, once built), slow, gl (OpenGL) or external (with Blender, OpenUSD, node, clang-format);
# default: all. tests/nightly.sh does all there is.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
preset=release label=""
usage() { sed -n '2,6s/^# //p' "$0"; }
while [ $# -gt 0 ]; do
    case $1 in
    release | debug | sanitize | tsan) preset=$1 ;;
    --label)
        label=${2:-}
        shift
        case $label in
        unit | slow | gl | external) ;;
        *)
            echo "run.sh: label \"$label\"; accepted: unit, slow, gl, external" >&2
            exit 2
            ;;
        esac
        ;;
    -h | --help)
        usage
        exit 0
        ;;
    *)
        echo "run.sh: \"$1\"" >&2
        usage >&2
        exit 2
        ;;
    esac
    shift
done
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"

install_packages
"$here/plugin/usd/openusd/install.sh"
build "$preset"
cd "$PELAGIC_ROOT"
# None of the tests minds another beside it; each uses all cores itself, and takes up to 2 GiB.
cores=$(nproc)
options=(--parallel $((cores < 4 ? cores : 4)))
[ -z "$label" ] || options+=(--label-regex "^$label\$")
ctest --preset "$preset" --no-tests=error "${options[@]}"
