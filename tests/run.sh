#!/usr/bin/env bash
# Installs what is missing, builds, and passes the tests.
#   tests/run.sh [PRESET] [--label LABEL]
#   tests/run.sh --nightly
# PRESET: release (default), debug, sanitize (addresses and undefined behaviour) or tsan (threads: the tests of what has some).
# LABEL: unit (three minutes on two cores, once built), slow, gl (OpenGL) or external (with Blender, OpenUSD, node, clang-format);
# default: all.
# --nightly takes hours: every test in release and under the sanitizers, six million rays, ten thousand random scenes, an hour
# of fuzzing, then the campaigns in full. It goes on after a failure, ends with a line for each part, and fails if one did.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
preset="" label="" nightly=false
usage() { sed -n '2,9s/^# //p' "$0"; }
while [ $# -gt 0 ]; do
    case $1 in
    release | debug | sanitize | tsan) preset=$1 ;;
    --nightly) nightly=true ;;
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
if $nightly && [ -n "$preset$label" ]; then
    echo "run.sh: --nightly runs all there is: it takes no preset and no label" >&2
    exit 2
fi
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"

# pass PRESET [LABEL]: builds, and passes the tests.
pass() {
    install_packages
    "$here/plugin/usd/openusd/install.sh"
    [ "$1" != tsan ] || "$here/sanitizers/onetbb.sh"
    build "$1"
    cd "$PELAGIC_ROOT"
    # None of the tests minds another beside it; each uses all cores itself, and takes up to 2 GiB.
    local cores options
    cores=$(nproc)
    options=(--parallel $((cores < 4 ? cores : 4)))
    [ -z "${2:-}" ] || options+=(--label-regex "^$2\$")
    ctest --preset "$1" --no-tests=error "${options[@]}"
}

# built TARGET…: the release build of them.
built() {
    install_packages
    build release "$@"
}

rays() {
    built test_procedural_rays
    PELAGIC_RAYS=6000000 "$PELAGIC_ROOT/build/release/tests/test_procedural_rays"
}

random_scenes() {
    built test_random_scenes
    PELAGIC_SCENES=10000 "$PELAGIC_ROOT/build/release/tests/test_random_scenes"
}

campaigns() {
    built pelagic pelagic_python
    "$here/campaigns/run.sh"
}

if ! $nightly; then
    pass "${preset:-release}" "$label"
    exit
fi
results=() failures=0
# part NAME COMMAND…: a part of the night, in a shell of its own that ends with the first command that fails.
part() {
    local name=$1 ended=0
    shift
    echo "== $name"
    set +e  # where a shell's status is tested, bash lets it go on after a failure
    (
        set -e
        "$@"
    )
    ended=$?
    set -e
    [ $ended -eq 0 ] || failures=$((failures + 1))
    results+=("$name: $([ $ended -eq 0 ] && echo passed || echo FAILED)")
}
for preset in release sanitize tsan; do part "tests, $preset" pass "$preset"; done
part "rays" rays
part "random scenes" random_scenes
part "fuzzing" "$here/fuzz/run.sh" 500  # [s] of each of seven targets
part "campaigns" campaigns
printf '%s\n' "== results" "${results[@]}"
[ $failures -eq 0 ]
