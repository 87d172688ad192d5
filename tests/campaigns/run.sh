#!/usr/bin/env bash
# Runs the campaigns: thousands of hostile or random runs of the program, each judged.
#   tests/campaigns/run.sh [NAME…] [-- OPTION…]      NAME: a script here without .py, default all; OPTION: as --count 100
# Each says how many cases it ran and how many failed. The program must have been built: build/release/pelagic.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,4s/^# //p' "$0"
    exit 0
fi
names=()
while [ $# -gt 0 ] && [ "$1" != "--" ]; do
    names+=("$1")
    shift
done
[ $# -eq 0 ] || shift
if [ ${#names[@]} -eq 0 ]; then
    for script in "$here"/*.py; do
        name=$(basename "$script" .py)
        [[ $name = common* ]] || names+=("$name")
    done
fi
status=0
for name in "${names[@]}"; do
    [ -f "$here/$name.py" ] || { echo "no campaign called $name in $here" >&2; exit 2; }
    /usr/bin/python3 "$here/$name.py" "$@" || status=1
done
exit $status
