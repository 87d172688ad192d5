#!/usr/bin/env bash
# tests/nightly.sh over parts that do nothing: it goes on where it was stopped, a failure is kept and told, and each night asks others.
set -euo pipefail
tests=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{examples,tests/addon,tests/fuzz,tests/campaigns,tests/package,tests/farm,build/release/tests}
cp "$tests/nightly.sh" "$root/tests/"
printf 'PELAGIC_ROOT=%s\ninstall_packages() { :; }\nbuild() { :; }\nin_memory() { :; }\nctest() { echo "ctest $PELAGIC_SEED" >>"%s/ran"; }\n' "$root" "$root" \
    >"$root/examples/setup.sh"
for program in tests/run.sh tests/addon/in_debian.sh tests/fuzz/run.sh tests/campaigns/run.sh tests/package/debian.sh tests/farm/older_cpus.sh build/release/tests/test_procedural_rays; do
    printf '#!/bin/sh\necho "%s $*" >>"%s/ran"\n' "$(basename "$program")" "$root" >"$root/$program"
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
grep -q '^run.sh edits -- --first [0-9]*[1-9][0-9]* --count' "$root/ran" || fail "the campaigns are each night's first cases"
cp "$root/fuzz" "$root/tests/fuzz/run.sh"
night fuzz || fail "a mended part that ran again still fails"
[ "$(wc -l <<<"$parts")" = "$(grep -c ': passed' "$root/out")" ] || fail "a part has no result"
sort -u "$root/ran" >"$root/before"
night --seed 42
[ "$(ran '^run.sh release --label nightly')" = 2 ] || fail "after a whole night the next one didn't begin anew"
[ "$(sort -u "$root/ran" | comm -13 "$root/before" - | wc -l)" -gt 12 ] || fail "the next night asks the same again"
night
grep -q "^This is --seed $(($(date +%s) / 86400))$" "$root/out" || fail "a night without a number isn't the day's"
! night nonsense || fail "an unknown part was taken"
