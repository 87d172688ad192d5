#!/usr/bin/env bash
# tests/nightly.sh over parts that do nothing: a night begins what fits its time, the next one goes on, a failure is kept and told.
set -euo pipefail
tests=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{examples,tests/addon,tests/fuzz,tests/campaigns,tests/package,tests/farm}
cp "$tests/nightly.sh" "$root/tests/"
printf 'PELAGIC_ROOT=%s\ninstall_packages() { :; }\nbuild() { :; }\nctest() { :; }\n' "$root" >"$root/examples/setup.sh"
mkdir -p "$root/build/release/tests"
for program in tests/run.sh tests/addon/in_debian.sh tests/fuzz/run.sh tests/campaigns/run.sh tests/package/debian.sh tests/farm/older_cpus.sh build/release/tests/test_{procedural_rays,random_scenes}; do
    printf '#!/bin/sh\necho "%s $*" >>"%s/ran"\n' "$(basename "$program")" "$root" >"$root/$program"
    chmod +x "$root/$program"
done
touch "$root/tests/fuzz/shot_fuzz.cpp" "$root/tests/campaigns/edits.py"

fail() { echo "$1" && exit 1; }
night() { "$root/tests/nightly.sh" "$@" >"$root/out" 2>&1; }
night --minutes 1 || fail "the first night ended with $?"
[ "$(wc -l <"$root/ran")" = 1 ] || fail "a night of a minute began more than its first part"
grep -q 'parts to go' "$root/out" || fail "nothing said what is left"
printf '#!/bin/sh\nexit 3\n' >"$root/tests/fuzz/run.sh"
night --minutes 1000 && fail "a failed part isn't in the exit status"
grep -q '^fuzz-shot: FAILED (3)' "$root/out" || fail "the failed part isn't told"
[ "$(grep -c '^run.sh release$' "$root/ran")" = 1 ] || fail "the second night began the first one's part again"
! grep -q 'not yet' "$root/out" || fail "a long night left something out"
printf '#!/bin/sh\n' >"$root/tests/fuzz/run.sh"
night fuzz-shot || fail "a mended part that ran again still fails"
[ "$("$root/tests/nightly.sh" --list | wc -l)" = "$(grep -c ': passed' "$root/out")" ] || fail "a part has no result"
night --minutes 1
[ "$(grep -c 'not yet' "$root/out")" -gt 5 ] || fail "after a whole round the next one didn't begin anew"
! night nonsense || fail "an unknown part was taken"
