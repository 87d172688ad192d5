#!/usr/bin/env bash
# What takes hours: every test under the sanitizers, six million rays, ten thousand random scenes, an hour of fuzzing, then the
# campaigns in full. Goes on after a failure; the exit status is 0 if nothing failed.
#   tests/nightly.sh
set -uo pipefail
if [ $# -gt 0 ]; then
    sed -n '2,4s/^# //p' "$0"
    [ "$1" = "--help" ] || [ "$1" = "-h" ]
    exit
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"
status=0
for preset in sanitize tsan; do
    echo "== tests, $preset"
    "$here/run.sh" "$preset" || status=1
done
echo "== rays"
{ install_packages && build release test_procedural_rays &&
    PELAGIC_RAYS=6000000 "$PELAGIC_ROOT/build/release/tests/test_procedural_rays"; } || status=1
echo "== random scenes"
{ install_packages && build release test_random_scenes &&
    PELAGIC_SCENES=10000 "$PELAGIC_ROOT/build/release/tests/test_random_scenes"; } || status=1
echo "== fuzzing"
"$here/fuzz/run.sh" 500 || status=1  # [s] of each of seven targets
echo "== campaigns"
{ install_packages && build release pelagic pelagic_python && "$here/campaigns/run.sh"; } || status=1
exit $status
