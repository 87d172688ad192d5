#!/usr/bin/env bash
# Builds the benchmarks and prints their tables, the numbers first. Some half an hour on two cores.
#   tests/bench/run.sh [PROGRAM…]      default: all, the light last:
#     frame ocean baked construction sky daylight sampling query stages conservation weather trains copies sphere_tracing rays expand near_far trace cage fitted_cage crate bake optics whitecaps
#     breaking backoff foam living_foam spray skyline spray_rays horizon sharpness preview window fig10 light played memory picture
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
[ $# -gt 0 ] || set -- frame ocean baked construction sky daylight sampling query stages conservation weather trains copies sphere_tracing rays expand near_far trace cage fitted_cage crate bake \
    optics whitecaps breaking backoff foam living_foam spray skyline spray_rays horizon sharpness preview window fig10 light played memory picture
targets=()
for program in "$@"; do
    case $program in
        ocean | played | memory | picture) targets+=(pelagic_python) ;;
        light | baked) targets+=(pelagic pelagic_python) ;;
        window) targets+=(pelagic) ;;
        *) targets+=("bench_$program") ;;
    esac
done
install_packages program preview python blender bench
build release "${targets[@]}" >/dev/null
in_blender() {
    # Without --python-exit-code Blender hides a script's failure.
    PYTHONPATH=$PELAGIC_ROOT/build/release/python PYTHONDONTWRITEBYTECODE=1 blender -b --factory-startup \
        --python-exit-code 1 --python "$here/$1" -- "${@:2}" | grep -vE '^(Blender|Read prefs|Warning|Fra:|Saved| Time)|^$'
}
for program in "$@"; do
    if [ "$program" = light ] || [ "$program" = baked ]; then
        in_blender "blender_$program.py" "$PELAGIC_ROOT/build/release/pelagic"
    elif [ "$program" = window ]; then
        "$here/window.sh" "$PELAGIC_ROOT/build/release/pelagic"
    elif [ -f "$here/blender_$program.py" ]; then
        in_blender "blender_$program.py"
    elif [ "$program" = fig10 ]; then
        "$PELAGIC_ROOT/build/release/bench/bench_fig10" full plot="$PELAGIC_ROOT/build/release/fig10.png"
    else
        "$PELAGIC_ROOT/build/release/bench/bench_$program"
    fi
    echo
done
