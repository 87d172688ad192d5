#!/usr/bin/env bash
# Checks that "is it on?" is asked in the table of effects alone: elsewhere no switch of an effect is read, and no strength of
# one is compared. The keys' own room checks that they don't contradict each other.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
found=$(grep -rnE 'effects\.(whitecaps|spray)\b *([^= ]|==|$)|\b(foam_decay_s|foam_structure|gust_strength) *([<>!=]=|[<>])' core plugin \
    --include='*.h' --include='*.cpp' --include='*.inl' |
    grep -vE '^core/scene/|^core/plan/effects\.cpp:|^[^:]*:[0-9]+: *(//|\*)|"[^"]*effects\.' || true)
[ -z "$found" ] || { echo "$found"; echo "ask is_on() of core/plan/effects.h"; exit 1; }
