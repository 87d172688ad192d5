"""The add-on's light and material against the core's: the example shots by Cycles and by `pelagic render`, same camera, sun
and sea.

    PYTHONPATH=… blender -b --factory-startup --python-exit-code 1 --python tests/bench/blender_light.py -- \
        PROGRAM [keep=DIR] [SHOT…]

PROGRAM is the command pelagic. keep: where the pictures stay. Prints ratios, Blender's over the core's: mean sea and mean sky
per channel; luminance of each line of the picture, where there is no foam; the glitter's energy, and its part of the
sea's light. A quarter of an hour on two quiet cores.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tests" / "addon")]

import pelagic_ocean

pelagic_ocean.register()
from pictures import LUMINANCE, core_layers, cycles_exr, glitter_exr, shot_in_blender

SHOTS = ("glassy-swell", "trade-wind", "first-shot", "north-sea-storm", "seamless-loop", "shallow-bay", "buoy-hour",
         "wave-trains")
SIZE = (320, 180)
SAMPLES = 32
LEAST_GLITTER = 1e-3  # of the sea's light; less isn't in the picture


def line_ratios(ours, core, clear):
    """Of the lines with 32 pixels of clear sea or more."""
    return np.array([(ours[row][clear[row]] @ LUMINANCE).mean() / (core[row][clear[row]] @ LUMINANCE).mean()
                     for row in range(len(clear)) if clear[row].sum() >= 32])


def verdict(ratio, tolerance):
    return "met" if np.all(np.abs(np.asarray(ratio) - 1) <= tolerance) else "missed"


def row_of(program, shot, folder):
    layers = core_layers(program, shot, folder, SIZE)
    shot_in_blender(shot, SIZE)
    ours = cycles_exr(folder / f"{shot.stem}.cycles.exr", SIZE, SAMPLES)[..., :3]
    glitter = glitter_exr(folder / f"{shot.stem}.glitter.exr", SIZE, SAMPLES)
    core = sum(layers.values())
    # Pixels on the horizon and on crests before it belong to neither.
    sea = (layers["sea"] @ LUMINANCE > 0) & (glitter[..., 3] > 0.999)
    sky = (layers["sea"] @ LUMINANCE == 0) & (glitter[..., 3] < 0.001)
    sea_ratio, sky_ratio = (ours[where].mean(0) / core[where].mean(0) for where in (sea, sky))
    clear = sea & (layers["foam"] @ LUMINANCE < 0.02 * (core @ LUMINANCE))
    lines = line_ratios(ours, core, clear)
    sun, all_light = (layers["sun"][sea] @ LUMINANCE).sum(), (core[sea] @ LUMINANCE).sum()
    share = sun / all_light
    ratio = f"{(glitter[..., :3][sea] @ LUMINANCE).sum() / sun:.2f}" if share > LEAST_GLITTER else "–"
    in_20 = np.mean(np.abs(lines - 1) <= 0.2)
    return " | ".join([
        shot.stem, " ".join(f"{r:.2f}" for r in sea_ratio), verdict(sea_ratio, 0.1),
        " ".join(f"{r:.2f}" for r in sky_ratio), verdict(sky_ratio, 0.1),
        f"{lines.min():.2f} … {lines.max():.2f}, {100 * in_20:.0f} % of {len(lines)}", verdict(lines, 0.2),
        f"{ratio} ({100 * share:.1f} %)", verdict(float(ratio), 0.2) if share > LEAST_GLITTER else "–"])


def main():
    program, *rest = sys.argv[sys.argv.index("--") + 1:]
    keep = next((Path(a[5:]) for a in rest if a.startswith("keep=")), None)
    shots = [a for a in rest if not a.startswith("keep=")] or SHOTS
    print("| shot | mean sea, r g b | 10 % | mean sky, r g b | 10 % | lines without foam | 20 % | glitter (its part) | 20 % |")
    print("|---|---|---|---|---|---|---|---|---|")
    for shot in shots:
        with tempfile.TemporaryDirectory() as folder:
            row = row_of(program, ROOT / "examples" / f"{shot}.toml", keep or Path(folder))
        print(f"| {row} |", flush=True)


main()
