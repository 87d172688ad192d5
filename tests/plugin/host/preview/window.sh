#!/usr/bin/env bash
# The preview's window on a virtual display with software rendering: it opens, plays a small shot, saves
# itself and closes. Without a display it says what to do.
#   window.sh PELAGIC FOLDER
set -euo pipefail
program=$1
folder=$2
rm -rf "$folder"
mkdir -p "$folder"
cat > "$folder/small.toml" <<'TOML'
[shot]
name = "small"
[waves]
cascades = [ { size_m = 200.0, resolution = 64 } ]
[camera]
position_m = [0.0, -60.0, 8.0]
[quality]
level = "draft"
TOML

fail() {
    echo "window.sh: $1" >&2
    exit 1
}

# Once more where xvfb-run itself failed, which shares /tmp with those of other tests: 5, it couldn't remove its folder; 6, no Xvfb.
on_display() {
    local status=0
    LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 640x400x24" "$@" || status=$?
    case $status in 5 | 6) ;; *) return "$status" ;; esac
    LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 640x400x24" "$@"
}

status=0
env -u DISPLAY -u WAYLAND_DISPLAY "$program" preview "$folder/small.toml" 2> "$folder/no-display.txt" || status=$?
[ "$status" = 2 ] || fail "status $status without a display, not 2"
grep -q -e "--offscreen" "$folder/no-display.txt" || fail "no word of --offscreen: $(cat "$folder/no-display.txt")"
grep -q "xvfb-run" "$folder/no-display.txt" || fail "no word of xvfb-run: $(cat "$folder/no-display.txt")"

# Nothing is shown from under water that has no body, but a message.
{ sed 's/-60.0, 8.0/-60.0, -8.0/' "$folder/small.toml"; printf '[water]\nbody = false\n'; } > "$folder/diving.toml"
status=0
on_display "$program" preview "$folder/diving.toml" \
    --size 320x180 --scale 4 --screenshot "$folder/diving.png" 2> "$folder/diving.txt" || status=$?
[ "$status" = 2 ] && [ ! -e "$folder/diving.png" ] || fail "status $status under water, not 2"
grep -q "the camera is under water" "$folder/diving.txt" || fail "no word of the water: $(cat "$folder/diving.txt")"

on_display "$program" preview "$folder/small.toml" \
    --size 640x360 --screenshot "$folder/window.png" --after 3 > "$folder/window.txt"
grep -q "320 x 180, drawn by" "$folder/window.txt" || fail "not half as large by itself: $(cat "$folder/window.txt")"

# The panel covers the left half: sky and sea are on the right, text and sliders on the left.
python3 - "$folder/window.png" <<'PYTHON'
import struct, sys, zlib

data = open(sys.argv[1], "rb").read()
width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
assert (width, height, depth, kind) == (640, 360, 8, 2), (width, height, depth, kind)
packed, at = b"", 8
while at < len(data):
    size, name = struct.unpack(">I4s", data[at:at + 8])
    packed += data[at + 8:at + 8 + size] if name == b"IDAT" else b""
    at += size + 12
lines, stride = zlib.decompress(packed), 3 * width
rows, above = [], bytearray(stride)
for y in range(height):  # PNG's five filter types
    start = y * (stride + 1)
    how, row = lines[start], bytearray(lines[start + 1:start + 1 + stride])
    for i in range(stride):
        a, b, c = (row[i - 3] if i >= 3 else 0), above[i], (above[i - 3] if i >= 3 else 0)
        nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        row[i] = (row[i] + (0, a, b, (a + b) // 2, nearest)[how]) % 256
    rows.append(row)
    above = row
def colours(x_from, x_to, y_from, y_to):
    return len({bytes(row[3 * x:3 * x + 3]) for row in rows[y_from:y_to] for x in range(x_from, x_to)})
for name, count in (("panel", colours(20, 330, 20, 280)), ("sky", colours(360, 640, 0, 60)),
                    ("sea", colours(360, 640, 180, 290))):
    print(name, count, "colours")
    assert count > 8, name + ": a single colour, nearly"
PYTHON
