#!/usr/bin/env python3
"""Edits of every key: a folder holds a shot's files, one key is changed, and the program is run again. The shot's files
are then those of an empty folder, byte for byte; and so they are when the key is put back."""

import math
import pathlib
import random
import tempfile

import numpy as np

from common import Campaign
import common_files
import common_shots

campaign = Campaign(__doc__.splitlines()[0], 500)
pelagic = common_files.module(campaign.program)
ROWS = [*common_shots.learn(pelagic), next(row for row in pelagic.keys() if row["path"] == "objects")]
DEFAULTS = {row["path"]: row["default"] for row in ROWS}

SMALL = {
    "shot.frames": [1, 2], "waves.cascades": [{"size_m": 80.0, "resolution": 64}, {"size_m": 24.0, "resolution": 32}],
    "sea.swell": [{"height_m": 1.0, "period_s": 9.0, "direction_deg": 40.0}], "surface.size_m": 80.0,
    "surface.resolution": 8, "camera.resolution": [64, 36], "output.map_resolution": 8, "quality.level": "preview",
}
DESCENDS = {
    "shot.frames": [2, 4], "camera.resolution": [160, 90],
    "camera.keys": [{"frame": 1, "position_m": [0.0, -60.0, 40.0], "look_at_m": [0.0, 20.0, 0.0]},
                    {"frame": 10, "position_m": [0.0, -40.0, 9.0], "look_at_m": [0.0, 20.0, 0.0]}],
}
ALL_MAPS = {"output.maps": ["displacement", "normal", "slope-variance", "whitecaps"], "output.cascade_tiles": True}
BASES = [
    ("bake", {**SMALL, **ALL_MAPS}),
    ("bake", {**SMALL, **ALL_MAPS, "waves.model": "trochoid", "waves.trains": 12, "output.mesh": "usda",
              "waves.cascades": [{"size_m": 20.0, "resolution": 32}]}),
    ("bake", {**SMALL, **DESCENDS, "surface.kind": "projected-grid", "output.maps": ["slope-variance"]}),
    ("bake", {**SMALL, **DESCENDS, "surface.kind": "near-far", "surface.size_m": 20.0}),
    ("bake", {**SMALL, "surface.kind": "cage", "surface.cage_file": "cage.obj"}),
    ("bake", {**SMALL, **DESCENDS, "surface.kind": "cage", "surface.cage_file": "cage.obj",
              "surface.cage_level": "adaptive"}),
    ("bake", {**SMALL, "sea.spectrum": "file", "sea.spectrum_file": "buoy-1w2024.txt", "output.maps": ["normal"],
              "sea.spectrum_time": "2024-10-03T06:00:00Z"}),
    ("bake", {**SMALL, "effects.spray": True, "effects.spray_drops": True, "output.volumes": ["spray", "level-set"], "output.voxel_m": 5.0}),
    ("render", {**SMALL, "camera.resolution": [24, 14], "quality.level": "draft", "sea.depth_m": 20.0, "sea.depth_file": "sky.exr",
                "water.floor_pattern": "pattern.exr", "effects.foam_pattern": "pattern.exr"}),
    ("render", {**SMALL, **DESCENDS, "camera.resolution": [24, 14], "quality.level": "draft", "light.sky": "sky.exr"}),
]
# What is drawn of keys whose values lie in files, and of one that goes by another.
CHOICES = {
    "shot.loop_s": [1.0, 2.0],
    "light.sky": ["daylight", "sky.exr", "other.exr"],
    "surface.cage_file": ["cage.obj", "other.obj"],
    "camera.file": ["camera.chan", "other.chan"],
    "sea.depth_file": ["none", "floor.obj", "other.exr"],
    "water.floor_pattern": ["plain", "pattern.exr"],
    "effects.foam_pattern": ["lace", "pattern.exr"],
    "objects": [[], [{"file": "hull.obj"}], [{"file": "hull.obj", "east_m": 3.0}]],
    "sea.spectrum_file": ["buoy-1w2024.txt", "other-1w2024.txt"],
    "sea.spectrum_time": ["2024-10-03T06:00:00Z", "2024-10-03T07:00:00Z"],
}
CASES = [(verb, keys, row) for row in ROWS for verb, keys in BASES]
STRIDE = next(step for step in range(101, 1000) if math.gcd(step, len(CASES)) == 1)  # few cases are spread over all


def lay_out(draw, folder):
    """The files that shots name."""
    common_shots.write_sky(folder / "sky.exr")
    common_shots.write_sky(folder / "other.exr", draw)
    stripes = np.tile(np.linspace(0.1, 0.9, 16, dtype=np.float32), (16, 1))
    common_files.write_exr(folder / "pattern.exr", {name: stripes for name in "RGB"})
    for name, height in (("cage", 0), ("other", 3)):
        (folder / f"{name}.obj").write_text(
            f"v -20 -20 0\nv 20 -20 {height}\nv 20 20 0\nv -20 20 0\nv 40 0 2\nf 1 2 3 4\nf 2 5 3\nt crease 2/1/0 1 2 1.5\n",
            encoding="utf-8")
    for name, east in (("camera", 0), ("other", 4)):  # frame, place, turns about x, y and z (y up), field of view
        (folder / f"{name}.chan").write_text(
            "".join(f"{frame} {east} 4 30 -5 {frame} 0 40\n" for frame in range(1, 5)), encoding="utf-8")
    (folder / "floor.obj").write_text("v -40 -40 -9\nv 40 -40 -9\nv 40 40 -4\nv -40 40 -4\nf 1 2 3 4\n", encoding="utf-8")
    (folder / "hull.obj").write_text("v 6 0 1\nv -3 2 1\nv -3 -2 1\nv 0 0 -1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n", encoding="utf-8")
    for kind in "wdijk":
        source = common_shots.BUOY.with_name(common_shots.BUOY.name.replace("99002w", f"99002{kind}"))
        if source.exists():
            text = source.read_text(encoding="utf-8")
            (folder / f"buoy-1{kind}2024.txt").write_text(text, encoding="utf-8")
            # Another swell, the same columns.
            (folder / f"other-1{kind}2024.txt").write_text(text.replace("13.16", "18.16").replace("9.54", "4.54"),
                                                     encoding="utf-8")


def other_value(draw, row, keys):
    """Another value of the key than the shot's; None: there was none."""
    path = row["path"]
    other = draw.choice(CHOICES[path]) if path in CHOICES else common_shots.value(draw, row)
    return None if other == keys.get(path, DEFAULTS[path]) else other


def fits_somewhere(row, folder):
    """Whether one of a few values fits one of the shots."""
    draw = random.Random(row["path"])
    for _ in range(24):
        for _, keys in BASES:
            other = other_value(draw, row, keys)
            if other is None:
                continue
            try:
                pelagic.Scene.from_text(common_shots.shot_text({**keys, row["path"]: other}), folder)
                return True
            except pelagic.ShotError:
                pass
    return False


def keys_without_values():
    """A sentence if a new key wants what this doesn't draw: its cases would say nothing."""
    with tempfile.TemporaryDirectory() as name:
        lay_out(random.Random(0), pathlib.Path(name))
        none = [row["path"] for row in ROWS if not fits_somewhere(row, pathlib.Path(name))]
    return f"no value that fits {', '.join(none)}" if none else None


def run(verb, shot, keys, out):
    shot.write_text(common_shots.shot_text(keys), encoding="utf-8")
    done = campaign.run(verb, shot, "--out", out, *(("--samples", "1") if verb == "render" else ()), timeout=300)
    campaign.ended_well(done, (0, 2, 75))
    return done


def judge(draw, folder):
    verb, keys, row = CASES[draw.case * STRIDE % len(CASES)]
    path = row["path"]
    lay_out(draw, folder)
    shot, out, fresh = folder / "shot.toml", folder / "out", folder / "fresh"
    done = run(verb, shot, keys, out)
    campaign.expect(done.status == 0, f"{verb}: its own shot is refused", done)
    before = common_files.bytes_below(out)

    for _ in range(12):
        other = other_value(draw, row, keys)
        if other is None:
            continue
        edited = {**keys, path: other}
        done = run(verb, shot, edited, fresh)
        if done.status == 0:
            break
        campaign.expect(not fresh.exists(), f"{path}: refused, and something was written", done)
        run(verb, shot, edited, out)
        campaign.expect(not (wrong := common_files.differences(before, common_files.bytes_below(out))),
                        f"{path} = {other!r}: refused, and the folder is another: {wrong}", done)
    else:
        campaign.count(f"without another value that fits {path}")
        return
    campaign.count(f"edited and {'baked' if verb == 'bake' else 'rendered'}")
    expected = common_files.bytes_below(fresh)
    campaign.expect(run(verb, shot, edited, out).status == 0, f"{path} = {other!r}: refused where files lie")
    found = common_files.bytes_below(out)
    left = {name for name in found if name not in expected}
    campaign.expect(left <= before.keys(), f"{path} = {other!r}: files that neither shot has: {left - before.keys()}")
    wrong = common_files.differences(expected, {name: data for name, data in found.items() if name in expected})
    campaign.expect(not wrong, f"{path} = {other!r}, {verb}: not as in an empty folder: {wrong}")

    campaign.expect(run(verb, shot, keys, out).status == 0, f"{path}: refused when put back")
    again = {name: data for name, data in common_files.bytes_below(out).items() if name in before}
    campaign.expect(not (wrong := common_files.differences(before, again)),
                    f"{path} = {other!r}, {verb}: put back, and not as it was: {wrong}")


campaign.go(judge, keys_without_values)
