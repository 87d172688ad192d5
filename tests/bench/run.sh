#!/usr/bin/env bash
# Builds the benchmarks and prints their tables.
#   tests/bench/run.sh [PROGRAM…]      default: all of them:
#     frame construction query procedural sky water living_foam places bake cost_model preview rays trace farm window ocean baked played memory blender_water
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
[ $# -gt 0 ] || set -- frame construction query procedural sky water living_foam places bake cost_model preview rays trace farm window ocean baked played memory blender_water
targets=()
for program in "$@"; do
    case $program in
        ocean | played | memory) targets+=(pelagic_python) ;;
        baked | blender_water) targets+=(pelagic pelagic_python) ;;
        window) targets+=(pelagic) ;;
        places) targets+=(bench_places test_evaluate test_waves test_render) ;;
        farm) targets+=(pelagic bench_procedural test_procedural_unload pelagic_test_no_locks) ;;
        *) targets+=("bench_$program") ;;
    esac
done
install_packages program preview python blender
build release "${targets[@]}" >/dev/null
in_blender() {
    # Without --python-exit-code Blender hides a script's failure.
    PYTHONPATH=$PELAGIC_ROOT/build/release/python PYTHONDONTWRITEBYTECODE=1 blender -b --factory-startup \
        --python-exit-code 1 --python "$here/$1" -- "${@:2}" | grep -vE '^(Blender|Read prefs|Warning|Fra:|Saved| Time)|^$'
}
for program in "$@"; do
    case $program in
        baked) in_blender blender_baked.py "$PELAGIC_ROOT/build/release/pelagic" ;;
        blender_water) in_blender blender_water.py "$PELAGIC_ROOT/build/release/pelagic" ;;
        ocean | played | memory) in_blender "blender_$program.py" ;;
        farm) "$here/farm.py" "$PELAGIC_ROOT/build/release" ;;
        window) "$here/window.sh" "$PELAGIC_ROOT/build/release/pelagic" ;;
        places) python3 "$here/places.py" "$PELAGIC_ROOT/build/release" ;;
        *) "$PELAGIC_ROOT/build/release/bench/bench_$program" ;;
    esac
    echo
done
