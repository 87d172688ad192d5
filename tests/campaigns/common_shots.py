"""Values of any key of the whole table, as the module tells it: a new key is drawn without a word here."""

import math

import numpy as np

from common import ROOT
from common_files import write_exr

BUOY = ROOT / "examples/data/made-up-99002w2024.txt"

# Keys whose table allows more than a campaign can pay for, or that rarely fit by chance. The campaigns of hostile
# inputs ask for the rest.
_SMALL = {
    "shot.frames": lambda draw: _frames(draw),
    "shot.loop_s": lambda draw: 0.0,  # others must be whole numbers of frames
    "sea.spectrum": lambda draw: draw.choice([word for word in _words("sea.spectrum") if word != "file"]),
    "sea.spectrum_file": None,
    "sea.spectrum_time": None,
    "waves.trains": lambda draw: draw.choice([1, 2, 7, 60, 150]),
    "waves.cascades": lambda draw: _cascades(draw),
    "surface.kind": lambda draw: draw.choice([word for word in _words("surface.kind") if word != "cage"]),
    "surface.cage_file": None,
    "surface.cage_level": lambda draw: draw.choice([0, 1, 2, 3, "adaptive"]),
    "surface.size_m": lambda draw: draw.choice([0.01, 30.0, 200.0, 200.0, 3e4, 1e6]),
    "surface.resolution": lambda draw: draw.choice([1, 2, 3, 8, 17, 32]),
    "surface.cell_px": lambda draw: draw.choice([6.0, 8.0, 16.0, 50.0, 256.0]),
    "camera.position_m": lambda draw: _place(draw, [0.3, 2.0, 4.0, 30.0, 1e3, 2e4]),
    "camera.look_at_m": lambda draw: _place(draw, [0.0, 0.0, 1.0, 100.0]),
    "camera.resolution": lambda draw: [draw.choice([1, 16, 64, 100]), draw.choice([1, 9, 36])],
    "light.sky": None,
    "output.map_resolution": lambda draw: draw.choice([1, 2, 5, 16, 33, 64]),
}

_rows = {}


def learn(pelagic):
    """The table of keys: before anything is drawn. The rows of tables, without those of lists' entries."""
    for row in pelagic.keys():
        _rows[row["path"]] = row
    return [row for row in _rows.values() if "[]" not in row["path"] and "." in row["path"]]


def _words(path):
    return list(_rows[path]["choices"])


def _frames(draw):
    first = draw.choice([1, 1, 1, -3, 0, 24, 100000, 50_000_000])
    return [first, first + draw.choice([0, 1, 2])]


def _place(draw, heights):
    far = draw.choice([0.0, 0.0, 0.0, 1e5])
    return [far + draw.uniform(-60, 60), far + draw.uniform(-60, 60), draw.choice(heights)]


def _cascades(draw):
    size = draw.choice([1.0, 37.0, 100.0, 400.0, 5000.0])
    entries = [{"size_m": size, "resolution": draw.choice([16, 18, 30, 64, 96])}]
    # The next tile begins where the one before still shows waves: coarser ones are refused for the gap.
    while draw.random() < 0.4 and len(entries) < 3:
        entries[-1]["resolution"] = draw.choice([48, 64, 64])
        size /= draw.choice([1.3, 1.618, 2.0])
        entries.append({"size_m": size, "resolution": draw.choice([16, 32, 64])})
    for entry in entries:
        if draw.random() < 0.2:
            entry["choppiness"] = draw.choice([0.0, draw.uniform(0.0, 2.0), 10.0])
    return entries


def _number(draw, row):
    low, high = row["range"]
    kind = draw.random()
    if kind < 0.15 and row["default"] is not None:
        return row["default"]
    if kind < 0.3:
        return draw.choice([low, high])
    soft = row["soft_range"] or row["range"]
    value = draw.uniform(*soft)
    if kind < 0.5 and soft[0] >= 0:  # also the small ones
        value = max(soft[0], soft[1] * 10 ** draw.uniform(-4, 0))
    return int(value) if row["type"] == "integer" else value


def _entries(draw, row):
    entries = []
    for _ in range(draw.choice([0, 1, 1, 2])):
        entry = {}
        for key in row["keys"]:
            if key["required"] or draw.random() < 0.7:
                entry[key["name"]] = value(draw, key)
        entries.append(entry)
    if row["path"] == "camera.keys":
        for frame, entry in enumerate(entries, draw.choice([-5, 1, 2])):
            entry["frame"] = frame * draw.choice([1, 1, 7]) if len(entries) == 1 else frame
            for name, heights in (("position_m", [0.5, 4.0, 300.0]), ("look_at_m", [0.0, 2.0])):
                if name in entry:
                    entry[name] = _place(draw, heights)
    return entries


def value(draw, row):
    """A value of a key, as Python has it; None: none is drawn."""
    if row["path"] in _SMALL:
        small = _SMALL[row["path"]]
        return small(draw) if small else None
    kind = row["type"]
    if kind in ("number", "integer"):
        if not row["range"]:
            return row["default"]
        return _number(draw, row)
    if kind == "truth":
        return draw.random() < 0.5
    if kind == "word":
        return draw.choice(row["choices"]) if row["choices"] else row["default"]
    if kind == "words":
        return [word for word in row["choices"] if draw.random() < 0.6]
    if kind == "entries":
        return _entries(draw, row)
    if kind == "pair" or kind == "point":
        low, high = row["range"]
        return [draw.uniform(max(low, -100.0), min(high, 100.0)) for _ in range(2 if kind == "pair" else 3)]
    if kind == "text":
        return draw.choice(["sea", "a", "7th-sea", "A_b-c", "x" * 200])
    if kind == "data file":  # none lies there: edits lays some out
        return None
    raise AssertionError(f"{row['path']}: a type of value that this drawing doesn't know, {kind}")


def as_toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value if value.startswith("2") and value.endswith("Z") else f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {as_toml(part)}" for name, part in value.items()) + " }"
    if isinstance(value, float) and math.isinf(value):
        return "inf"
    return repr(value)


def shot_text(keys):
    """The text of a shot file: keys is {path: value}."""
    tables = {"": []}
    for path, value in keys.items():
        table, _, name = path.rpartition(".")
        tables.setdefault(table, []).append(f"{name} = {as_toml(value)}\n")
    return "".join((f"[{table}]\n" if table else "") + "".join(lines) for table, lines in tables.items())


def write_sky(path, draw=None):
    """A small lat-long picture of a sky, brighter towards the zenith."""
    height = 8
    rows = np.linspace(3.0, 0.5, height, dtype=np.float32)[:, None] * np.ones((1, 2 * height), np.float32)
    write_exr(path, {"R": rows * (draw.uniform(0, 2) if draw else 0.5), "G": rows * 0.8, "B": rows})
