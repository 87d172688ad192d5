#!/usr/bin/env bash
# tests/nightly.sh over parts that do nothing: it goes on where it was stopped, a failure is told until it is mended, and nights in turn
# ask all there is.
set -euo pipefail
tests=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{examples,tests/addon,tests/fuzz,tests/campaigns,tests/package,tests/farm,build/release/tests}
cp "$tests/nightly.sh" "$root/tests/"
printf 'PELAGIC_ROOT=%s\ninstall_packages() { :; }\nbuild() { :; }\nin_memory() { :; }\n' "$root" >"$root/examples/setup.sh"
for program in tests/run.sh tests/addon/in_debian.sh tests/fuzz/run.sh tests/campaigns/run.sh tests/package/debian.sh tests/farm/older_cpus.sh \
    build/release/tests/test_procedural_rays build/release/tests/test_random_scenes; do
    printf '#!/bin/sh\necho "%s $* $PELAGIC_SEED" >>"%s/ran"\n' "$(basename "$program")" "$root" >"$root/$program"
    chmod +x "$root/$program"
done

fail() { echo "$1" && exit 1; }
night() { "$root/tests/nightly.sh" "$@" >"$root/out" 2>&1; }
ran() { grep -c "$1" "$root/ran" || true; }
parts=$("$root/tests/nightly.sh" --list)
for campaign in "$tests"/campaigns/*.py; do
    name=$(basename "$campaign" .py)
    [[ $name = common* ]] || grep -q "^campaign-$name " <<<"$parts" || fail "the campaign $name isn't in the night"
done

# Stopped while it fuzzes.
cp "$root/tests/fuzz/run.sh" "$root/fuzz"
printf '#!/bin/sh\nkill $(cat "%s/night")\n' "$root" >"$root/tests/fuzz/run.sh"
if (echo $BASHPID >"$root/night" && exec "$root/tests/nightly.sh" --seed 41) >"$root/out" 2>&1; then fail "a stopped night ends well"; fi
printf '#!/bin/sh\nexit 3\n' >"$root/tests/fuzz/run.sh"
night && fail "a failed part isn't in the exit status"
grep -q '^fuzz: FAILED (3), .*--seed 41' "$root/out" || fail "the failed part isn't told"
! grep -q 'not yet' "$root/out" || fail "a night left something out"
[ "$(ran '^run.sh release --label nightly')" = 1 ] || fail "a night that goes on began a part again"
cp "$root/fuzz" "$root/tests/fuzz/run.sh"
night && fail "a failure is forgotten the next night"
grep -q '^This is --seed 42$' "$root/out" || fail "the next night isn't the next number's"
[ "$(wc -l <<<"$parts")" = "$(grep -c ': passed' "$root/out")" ] || fail "a part has no result"
grep -q '^--seed 41 fuzz: FAILED (3)' "$root/out" || fail "it isn't told how a failure is run again"
night fuzz && fail "a failure counts as mended by another night's part"
rm "$root/build/nightly/fuzz"
night --seed 41 fuzz || fail "a mended part that ran again still fails"
grep -q '^fuzz: not yet' "$root/out" || fail "another night's part is taken for this night's"

# What is drawn by numbers goes on where it ended.
awk '/^run.sh [a-z]+ -- --first/ {
    of = $2 " " $9
    if (of in wanted && $5 != wanted[of]) { print of ": from case " $5 ", not " wanted[of]; bad = 1 }
    wanted[of] = $5 + $7
}
END { exit bad }' "$root/ran" ||
    fail "nights leave cases of campaigns out"

# 24 nights ask each share.
sed '/^# The parts:/,$d' "$tests/nightly.sh" >"$root/tests/asked.sh"
(
    source "$root/tests/asked.sh"
    for ((seed = 41; seed <= 64; ++seed)); do at_night && sanitize && tsan && blender && rays && random_scenes; done
) || fail "parts that do nothing failed"
asks() { # HOW_MANY PATTERN
    local found
    found=$(grep "^$2" "$root/ran" | sort -u | wc -l)
    [ "$found" = "$1" ] || fail "$2: $found different ones in 24 nights, not $1"
}
asks 3 'run.sh release --label nightly --share [123]/3'
for share in unit:2 slow:8 gl:8 external:16; do asks "${share#*:}" "run.sh sanitize --label ${share%:*} --share [0-9]*/${share#*:}"; done
asks 2 'run.sh tsan --share [12]/2'
asks 6 'in_debian.sh [a-z]* --tests-information [123],,3'
asks 24 'test_procedural_rays'
asks 24 'test_random_scenes --gtest_filter=Batch/\*/0'
asks 24 'test_random_scenes --gtest_filter=Batch/\*/1'

# Results of before there were numbers.
mkdir "$root/old" && echo "passed" >"$root/old/fuzz"
before=$(($(date +%s) / 86400))
night --results "$root/old" rays || fail "a first night's part failed"
grep -q '^fuzz: not yet' "$root/out" || fail "a result of no night is taken for this night's"
grep -qE "^This is --seed ($before|$(($(date +%s) / 86400)))$" "$root/out" || fail "the first night isn't the day's"
! night nonsense || fail "an unknown part was taken"
