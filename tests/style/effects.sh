#!/usr/bin/env bash
# Checks that "is it on?" is asked in the table of effects alone: elsewhere no switch that its rows read is read, and no strength
# compared, but for the wind's. The keys' own room checks that they don't contradict each other.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
table=core/plan/effects.cpp
switches=$(grep -oP 'return scene\.\K[a-z.]+(?=;| &&)' $table | sed 's/\./\\./' | paste -sd'|')
strengths=$(grep -oP 'scene\.[a-z]+\.\K[a-z_]+(?= > 0)' $table | grep -v '^wind' | paste -sd'|')
[ -n "$switches" ] && [ -n "$strengths" ]
found=$(grep -rnE "($switches)\b *([^= ]|==|\$)|\b($strengths) *([<>!=]=|[<>])" core plugin --include='*.h' --include='*.cpp' --include='*.inl' |
    grep -vE "^core/scene/|^$table:|^[^:]*:[0-9]+: *(//|\*)|\"[^\"]*effects\." || true)
[ -z "$found" ] || { echo "$found"; echo "ask is_on() of core/plan/effects.h"; exit 1; }
