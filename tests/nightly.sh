#!/usr/bin/env bash
# What is too long for each change, in one night: two and a half hours of two cores, an hour more where nothing has been compiled before.
#   tests/nightly.sh [--seed N] [--results DIR] [PART…]
#   tests/nightly.sh --list
# Each night asks another share of the tests, other rays, scenes and cases of the campaigns: N says which, default the one after the
# last night's (the first has the number of the day); with it a night begins anew. One that was stopped goes on where it was, with
# its N, also on another commit. PART: only these, again where they have a result; of another N than the night's they aren't its results.
# DIR: where results and each part's output are kept, default build/nightly. Ends with a line for each part and one for each failure
# of this and earlier nights: `--seed N PART` is kept until that passes, and until then the exit status is 1.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
usage() { sed -n '2,10s/^# //p' "$0"; }
# shellcheck source=../examples/setup.sh
source "$here/../examples/setup.sh"

# share N: this night's of N, as run.sh takes it.
share() { echo "$((seed % $1 + 1))/$1"; }
at_night() { "$here/run.sh" release --label nightly --share "$(share 3)"; }
openusd() { "$here/run.sh" release --label openusd; }
# What a unity build would hide: a missing include, a missing definition. Compiled, not run, and all of it, whatever fails.
each_source() { install_packages && build each-source all benches -- -k 0; }
# Half of the short tests, and some of the others. The campaigns' program as well: what damaged files do to memory is seen there.
sanitize() {
    local failed=0
    "$here/run.sh" sanitize --label unit --share "$(share 2)" || failed=1
    "$here/run.sh" sanitize --label slow --share "$(share 8)" || failed=1
    "$here/run.sh" sanitize --label gl --share "$(share 8)" || failed=1
    "$here/run.sh" sanitize --label external --share "$(share 16)" || failed=1
    campaign mutations 100 --program "$PELAGIC_ROOT/build/sanitize/pelagic" || failed=1
    return $failed
}
tsan() { "$here/run.sh" tsan --share "$(share 2)"; }
# The next Debian's Blender and the newest in turn, a third of the scripts each.
blender() {
    local suites=(trixie sid)
    "$here/addon/in_debian.sh" "${suites[seed % 2]}" --tests-information "$((seed / 2 % 3 + 1)),,3"
}
# rays, random_scenes: others than ctest runs.
rays() {
    install_packages && build release test_procedural_rays &&
        PELAGIC_SEED=$seed PELAGIC_RAYS=1000000 "$PELAGIC_ROOT/build/release/tests/test_procedural_rays"
}
# Both halves of the scenes side by side, and not under ctest: a scene that hangs says its number by an alarm of its own.
random_scenes() {
    install_packages && build release test_random_scenes &&
        printf '%s\n' 0 1 | PELAGIC_SEED=$((seed * 400)) PELAGIC_SCENES=400 xargs -P 2 -I{} \
            "$PELAGIC_ROOT/build/release/tests/test_random_scenes" '--gtest_filter=Batch/*/{}'
}
# campaign NAME COUNT [OPTION…]: so many cases, from where the night before ended.
campaign() {
    install_packages && build release pelagic pelagic_python && in_memory &&
        "$here/campaigns/run.sh" "$1" -- --first "$((seed * $2))" --count "$2" "${@:3}"
}

# The parts: name, minutes on two quiet cores where ccache has all, command.
names=() commands=()
declare -A minutes
part() {
    names+=("$1") commands+=("$3")
    minutes[$1]=$2
}
part at-night 8 at_night
part openusd 2 openusd
part each-source 3 each_source
part sanitize 28 sanitize
part tsan 15 tsan
part blender 15 blender
part packages 10 "$here/package/debian.sh"
part older-cpus 2 "$here/farm/older_cpus.sh"
part rays 1 rays
part random-scenes 4 random_scenes
part fuzz 9 "$here/fuzz/run.sh 60"
# The campaigns: name, cases.
campaigns="arguments 1500 arrays 150 damage 120 edits 120 limits 280 memory 12 mutations 800 poses 100 signals 80"
read -ra cases <<<"$campaigns"
for ((i = 0; i < ${#cases[@]}; i += 2)); do part "campaign-${cases[i]}" 3 "campaign ${cases[i]} ${cases[i + 1]}"; done

seed="" results=$PELAGIC_ROOT/build/nightly chosen=()
while [ $# -gt 0 ]; do
    case $1 in
    --seed)
        seed=${2:-} && shift
        [[ $seed =~ ^(0|[1-9][0-9]{0,7})$ ]] || { echo "nightly.sh: --seed \"$seed\"; wanted: a whole number" >&2 && exit 2; }
        ;;
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
mkdir -p "$results" && results=$(cd "$results" && pwd) || exit 2

# A part's result is a line in its file: how it ended, on which commit, in how many minutes, when. The night's number is in `seed`.
is_done() { [ -f "$results/$1" ]; }
night_is_whole() {
    local name
    for name in "${names[@]}"; do is_done "$name" || return 1; done
}
begin_night() {
    rm -f "${names[@]/#/$results/}"
    night=$1
    echo "$night" >"$results/seed"
}
[ ${#chosen[@]} -gt 0 ] && is_whole_night=false || is_whole_night=true
night=$(cat "$results/seed" 2>/dev/null)
if $is_whole_night && [ -n "$seed" ]; then
    begin_night "$seed"
elif [ -z "$night" ]; then
    begin_night $(($(date +%s) / 86400))
elif $is_whole_night && night_is_whole; then
    begin_night $((night + 1))
fi
seed=${seed:-$night}
if $is_whole_night; then
    chosen=("${names[@]}")
elif [ "$seed" = "$night" ]; then
    rm -f "${chosen[@]/#/$results/}"
fi
echo "This is --seed $seed"

commit=$(git -C "$PELAGIC_ROOT" describe --always --dirty)
for i in "${!names[@]}"; do
    name=${names[i]}
    if [[ " ${chosen[*]} " != *" $name "* ]] || { [ "$seed" = "$night" ] && is_done "$name"; }; then continue; fi
    echo "== $name"
    start=$SECONDS log=$results/$name-$seed.log
    # In a shell of its own: what it changes there is gone with it.
    (${commands[i]}) 2>&1 | tee "$log"
    ended=${PIPESTATUS[0]}
    [ "$ended" -eq 0 ] && outcome=passed || outcome="FAILED ($ended)"
    result="$outcome, $commit, --seed $seed, $(((SECONDS - start + 59) / 60)) min, $(TZ=UTC printf '%(%F %R)T' -1)"
    # That of a failure stays with it.
    [ "$ended" -ne 0 ] || mv "$log" "$results/$name.log"
    if [ -s "$results/failures" ]; then
        grep -v "^--seed $seed $name: " "$results/failures" >"$results/failures.new"
        mv "$results/failures.new" "$results/failures"
    fi
    [ "$ended" -eq 0 ] || echo "--seed $seed $name: $result" >>"$results/failures"
    [ "$seed" != "$night" ] || echo "$result" >"$results/$name"
done

echo "== results of --seed $night"
left=0
for name in "${names[@]}"; do
    if is_done "$name"; then
        echo "$name: $(cat "$results/$name")"
    else
        echo "$name: not yet"
        left=$((left + 1))
    fi
done
[ $left -eq 0 ] || echo "$left of ${#names[@]} parts to go: the same command goes on with them"
if [ -s "$results/failures" ]; then
    echo "== failures, with what runs each again; their output is $results/PART-N.log"
    cat "$results/failures"
    exit 1
fi
