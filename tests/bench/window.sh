#!/usr/bin/env bash
# Frames a second of the preview's window, 640 x 360, draft, drawn by the processor at the scale that it chooses, and at
# every scale: the median of five, in turn, after one to warm up. On two idle cores.
#   window.sh PELAGIC [REFERENCE]      REFERENCE: another build's program, beside it at the same scale, --scale 2
set -euo pipefail
program=$1 reference=${2:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '[shot]\nname = "window"\n[quality]\nlevel = "draft"\n' > "$folder/window.toml"

# The seconds of 41 pictures without those of one, which compile and build.
rate() {
    local start middle
    start=$(date +%s.%N)
    one "$1" "${*:2}" 1
    middle=$(date +%s.%N)
    one "$1" "${*:2}" 41
    python3 -c "from sys import argv; a, b, c = map(float, argv[1:]); print(f'{40 / max((c - b) - (b - a), 1e-9):.2f}')" \
        "$start" "$middle" "$(date +%s.%N)"
}
one() {
    # shellcheck disable=SC2086
    LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 640x400x24" "$1" preview "$folder/window.toml" --size 640x360 $2 \
        --screenshot "$folder/window.png" --after "$3" > "$folder/told.txt"
}

sides=("chosen:$program:" "scale 1:$program:--scale 1" "scale 2:$program:--scale 2" "scale 4:$program:--scale 4")
[ -z "$reference" ] || sides+=("reference, scale 2:$reference:--scale 2")
for turn in 0 1 2 3 4 5; do
    for side in "${sides[@]}"; do
        IFS=: read -r name which scale <<< "$side"
        measured=$(rate "$which" "$scale")
        [ "$turn" = 0 ] || echo "$measured" >> "$folder/$name.rates"
    done
done
echo "Frames a second of the window, 640 x 360, draft, drawn by the processor"
for side in "${sides[@]}"; do
    name=${side%%:*}
    median=$(sort -g "$folder/$name.rates" | sed -n 3p)
    verdict=
    [ "$name" != chosen ] || verdict=$(python3 -c "print('  >= 10', 'met' if $median >= 10 else 'missed')")
    printf '  %-20s %6.2f%s\n' "$name" "$median" "$verdict"
done
