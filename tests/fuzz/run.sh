#!/usr/bin/env bash
# Fuzzes the readers and the C interface with libFuzzer, under the sanitizers of addresses and undefined behaviour.
#   tests/fuzz/run.sh [SECONDS] [NAME…]      SECONDS: of each target, default 60; NAME: of NAME_fuzz.cpp, default all
# Installs clang 16 where it is missing: 14 has no parentheses round the values of an aggregate. Prints for each target how many
# inputs it ran, and what it covers. Inputs that break something are kept in build/fuzz/findings/NAME, and make the exit status 1:
# also of the next runs, which run them first, until they break nothing and join build/fuzz/corpus/NAME. There the next run
# begins: with what has been found to go new ways.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,8s/^# //p' "$0"
    exit 0
fi
seconds=60
if [[ "${1:-}" =~ ^[0-9]+$ ]]; then
    seconds=$1
    shift
fi
names=("$@")
if [ ${#names[@]} -eq 0 ]; then
    for source in "$here"/*_fuzz.cpp; do
        names+=("$(basename "$source" _fuzz.cpp)")
    done
fi
for name in "${names[@]}"; do
    [ -f "$here/${name}_fuzz.cpp" ] || { echo "no target called $name in $here" >&2; exit 2; }
done
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
# Not in packages.txt: nothing else needs these.
missing=()
for package in clang-16 libclang-rt-16-dev llvm-16; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] || apt_install "${missing[@]}" || exit 1
install_packages program tests || exit 1
cd "$PELAGIC_ROOT" || exit 1
cmake --preset fuzz >/dev/null && cmake --build --preset fuzz --parallel "$(nproc)" --target "${names[@]/%/_fuzz}" || exit 1

export ASAN_SYMBOLIZER_PATH=/usr/lib/llvm-16/bin/llvm-symbolizer UBSAN_OPTIONS=print_stacktrace=1
status=0
for name in "${names[@]}"; do
    corpus=build/fuzz/corpus/$name findings=build/fuzz/findings/$name
    mkdir -p "$corpus" "$findings"
    options=(-timeout=60 -rss_limit_mb=4096)
    for finding in "$findings"/*; do
        [ -f "$finding" ] || continue
        if "build/fuzz/tests/${name}_fuzz" "${options[@]}" "$finding" >"build/fuzz/$name.log" 2>&1; then
            mv "$finding" "$corpus"
        else
            status=1
            grep -E 'broken promise|runtime error|ERROR: ' -A1 "build/fuzz/$name.log"
            echo "$name: still breaks; again: build/fuzz/tests/${name}_fuzz $finding"
        fi
    done
    options+=(-max_total_time="$seconds" -artifact_prefix="$findings/")
    [ ! -f "$here/$name.dict" ] || options+=(-dict="$here/$name.dict")
    "build/fuzz/tests/${name}_fuzz" "${options[@]}" "$corpus" "$here/corpus/$name" >"build/fuzz/$name.log" 2>&1
    ended=$?
    printf '%s: %s\n' "$name" "$(grep -E '^#[0-9]+' "build/fuzz/$name.log" | tail -1)"
    if [ $ended -ne 0 ]; then
        status=1
        grep -E 'broken promise|runtime error|ERROR: |Test unit' -A1 "build/fuzz/$name.log"
        echo "$name: see build/fuzz/$name.log; again: build/fuzz/tests/${name}_fuzz FILE"
    fi
done
exit $status
