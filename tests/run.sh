#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests.
#   tests/run.sh [PRESET] [--label LABEL] [--share K/N]
#   tests/run.sh --nightly [OPTION…]
# PRESET: release (default), debug, sanitize (addresses and undefined behaviour) or tsan (threads: the tests of what has some).
# LABEL: unit (three minutes on two cores, once built), slow, gl (OpenGL) or external (with Blender, node, clang-format); default:
# all of these. Those that run at night are left out, unless LABEL is theirs: nightly, or openusd, which installs Chromium.
# --share K/N: each Nth test, beginning with the Kth.
# --nightly takes two and a half hours, and goes on where it was stopped: tests/nightly.sh --help.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
[ "${1:-}" != --nightly ] || exec "$here/nightly.sh" "${@:2}"
preset=release label="" share=""
usage() { sed -n '2,9s/^# //p' "$0"; }
while [ $# -gt 0 ]; do
    case $1 in
    release | debug | sanitize | tsan) preset=$1 ;;
    --label)
        label=${2:-}
        shift
        case $label in
        unit | slow | gl | external | nightly | openusd) ;;
        *)
            echo "run.sh: label \"$label\"; accepted: unit, slow, gl, external, nightly, openusd" >&2
            exit 2
            ;;
        esac
        ;;
    --share)
        share=${2:-}
        shift
        [[ $share =~ ^[1-9][0-9]*/[1-9][0-9]*$ ]] && [ "${share%/*}" -le "${share#*/}" ] || {
            echo "run.sh: share \"$share\"; wanted: as 1/4" >&2
            exit 2
        }
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

install_packages program preview python blender tests
[ "$label" != openusd ] || install_packages openusd
"$here/plugin/format/usd/openusd/install.sh"
[ "$preset" != tsan ] || "$here/sanitizers/onetbb.sh"
build "$preset"
cd "$PELAGIC_ROOT"
in_memory
# None of the tests minds another beside it; each uses all cores itself, and takes up to 2 GiB. One more than there are cores
# works while the others wait.
cores=$(nproc)
options=(--parallel $((cores < 4 ? cores + 1 : 4)))
case $label in
nightly | openusd) options+=(--label-regex "^$label\$") ;;
*)
    options+=(--label-exclude '^(nightly|openusd)$')
    [ -z "$label" ] || options+=(--label-regex "^$label\$")
    ;;
esac
[ -z "$share" ] || options+=(--tests-information "${share%/*},,${share#*/}")
ctest --preset "$preset" --no-tests=error "${options[@]}"
