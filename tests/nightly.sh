#!/usr/bin/env bash
# What is too long for each change: every test in release and under the sanitizers, six million rays, ten thousand random scenes,
# an hour of fuzzing, and the campaigns in full, in parts. A night begins parts while they fit its time, and the next one goes on
# where it stopped, also on another commit, until each part has a result; then a new round begins.
#   tests/nightly.sh [--minutes M] [--results DIR] [PART…]
#   tests/nightly.sh --list
# M: of a night, default 150. DIR: where results and each part's output are kept, default build/nightly. PART: only these, again
# where they have a result. Ends with a line for each part; the exit status is 0 if none of those that have run has failed.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
usage() { sed -n '2,8s/^# //p' "$0"; }
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"

# rays, random_scenes: longer than ctest runs them.
rays() {
    install_packages && build release test_procedural_rays &&
        PELAGIC_RAYS=6000000 "$PELAGIC_ROOT/build/release/tests/test_procedural_rays"
}
random_scenes() {
    install_packages && build release test_random_scenes &&
        PELAGIC_SCENES=10000 "$PELAGIC_ROOT/build/release/tests/test_random_scenes"
}
at_night() { "$here/run.sh" release --label nightly && "$here/run.sh" release --label openusd; }
# What a unity build would hide: a file that doesn't include what it needs, or that gets another's function of the same name.
each_source() {
    install_packages && build each-source && ctest --test-dir "$PELAGIC_ROOT/build/each-source" --label-regex '^unit$' --parallel "$(nproc)"
}
benches() {
    install_packages && build release benches
}
campaign() {
    install_packages && build release pelagic pelagic_python && "$here/campaigns/run.sh" "$1"
}

# The parts: name, minutes that it takes at most on two quiet cores, command.
names=() commands=()
declare -A minutes
part() {
    names+=("$1") commands+=("$3")
    minutes[$1]=$2
}
part release 60 "$here/run.sh release"
part at-night 60 at_night
part each-source 45 each_source
for share in 1 2 3 4; do part "sanitize-$share" 75 "$here/run.sh sanitize --share $share/4"; done
for share in 1 2; do part "tsan-$share" 75 "$here/run.sh tsan --share $share/2"; done
for suite in trixie sid; do part "blender-$suite" 60 "$here/addon/in_debian.sh $suite"; done
part packages 45 "$here/package/debian.sh"
part older-cpus 30 "$here/farm/older_cpus.sh"
part benches 10 benches
part rays 30 rays
part random-scenes 75 random_scenes
for target in "$here"/fuzz/*_fuzz.cpp; do
    name=$(basename "$target" _fuzz.cpp)
    part "fuzz-$name" 15 "$here/fuzz/run.sh 500 $name"
done
for script in "$here"/campaigns/*.py; do
    name=$(basename "$script" .py)
    [[ $name = common* ]] || part "campaign-$name" 60 "campaign $name"
done

night=150 results=$PELAGIC_ROOT/build/nightly chosen=()
while [ $# -gt 0 ]; do
    case $1 in
    --minutes) night=${2:-} && shift ;;
    --results) results=${2:-} && shift ;;
    --list)
        for name in "${names[@]}"; do echo "$name (${minutes[$name]} min)"; done
        exit 0
        ;;
    -h | --help) usage && exit 0 ;;
    *)
        [ -n "${minutes[$1]:-}" ] || { echo "nightly.sh: \"$1\" is no part; --list names them" >&2 && exit 2; }
        chosen+=("$1")
        ;;
    esac
    shift
done
[[ $night =~ ^[0-9]+$ ]] || { echo "nightly.sh: --minutes \"$night\"; wanted: a whole number" >&2 && exit 2; }
mkdir -p "$results" && results=$(cd "$results" && pwd) || exit 2

# A part's result is a line in its file: how it ended, on which commit, in how many minutes, when.
is_done() { [ -f "$results/$1" ]; }
is_asked_for() { [ ${#chosen[@]} -eq 0 ] || [[ " ${chosen[*]} " == *" $1 "* ]]; }
round_is_whole() {
    local name
    for name in "${names[@]}"; do is_done "$name" || return 1; done
}
if [ ${#chosen[@]} -gt 0 ]; then
    for name in "${chosen[@]}"; do rm -f "$results/$name"; done
elif round_is_whole; then
    for name in "${names[@]}"; do rm -f "$results/$name"; done
fi

begun=$SECONDS is_first=true
commit=$(git -C "$PELAGIC_ROOT" describe --always --dirty)
for i in "${!names[@]}"; do
    name=${names[i]}
    is_asked_for "$name" && ! is_done "$name" || continue
    # The first one in any case: a part that is longer than a night would never run.
    if ! $is_first && [ $(((SECONDS - begun) / 60 + minutes[$name])) -gt "$night" ]; then continue; fi
    is_first=false
    echo "== $name"
    start=$SECONDS
    # In a shell of its own: what it changes there is gone with it.
    (${commands[i]}) 2>&1 | tee "$results/$name.log"
    ended=${PIPESTATUS[0]}
    [ "$ended" -eq 0 ] && outcome=passed || outcome="FAILED ($ended)"
    echo "$outcome, $commit, $(((SECONDS - start + 59) / 60)) min, $(date -u '+%F %R')" >"$results/$name"
done

echo "== results"
failures=0 left=0
for name in "${names[@]}"; do
    if is_done "$name"; then
        echo "$name: $(cat "$results/$name")"
        grep -q ^passed "$results/$name" || failures=$((failures + 1))
    else
        echo "$name: not yet"
        left=$((left + 1))
    fi
done
[ $left -eq 0 ] || echo "$left of ${#names[@]} parts to go: the same command goes on with them"
[ $failures -eq 0 ]
