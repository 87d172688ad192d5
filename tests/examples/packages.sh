#!/usr/bin/env bash
# The first bake's section of the list has no test's program in it, all sections together have them, and what each script
# installs is a section of the list. dpkg and the commands are out of reach, as if nothing were installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=../../examples/setup.sh
source examples/setup.sh
dpkg-query() { return 1; }
command() { return 1; }
failed=0
program=$(missing_packages program) everything=$(missing_packages)
for package in build-essential cmake libfftw3-dev libopenexr-dev; do
    grep -qx "$package" <<<"$program" || { echo "[program] lacks $package"; failed=1; }
done
for package in blender chromium nodejs npm clang-format-14 libgtest-dev libglfw3-dev libimgui-dev libegl-dev python3-dev xvfb; do
    ! grep -qx "$package" <<<"$program" || { echo "a first bake would install $package"; failed=1; }
    grep -qx "$package" <<<"$everything" || { echo "the tests wouldn't install $package"; failed=1; }
done
[ "$(sort <<<"$everything" | uniq -d)" = "" ] || { echo "a package stands twice in the list"; failed=1; }
for section in preview python blender tests; do
    [ "$(installed $section)" = OFF ] || { echo "[$section] counts as installed"; failed=1; }
done
grep -qx 'install_packages program' examples/bake-first-shot.sh || { echo "bake-first-shot.sh installs more than [program]"; failed=1; }
while read -r section; do
    missing_packages "$section" >/dev/null || failed=1
done < <(grep -rhoE '\binstall_packages [a-z ]+( &&.*)?$' examples/*.sh tests/*.sh tests/*/*.sh | sed -E 's/install_packages //; s/ &&.*//' | tr ' ' '\n' | sort -u)
! missing_packages no-such-section 2>/dev/null || { echo "an unknown section is taken"; failed=1; }
exit $failed
