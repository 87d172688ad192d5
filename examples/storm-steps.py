"""A table and a sheet of pictures from `pelagic accuracy SHOT.toml --rows picture-steps --pictures --out RUN`.

    python3 examples/storm-steps.py RUN OUT      writes OUT/storm-steps.md and OUT/storm-steps.png

How different two pictures look is scikit-image's to say, of the pictures as a screen shows them: the colour difference
CIEDE2000, whose 1 is about what an eye just notices, and 1 - SSIM, the structural similarity of lightness, 0 … 1.
"""

import csv
import sys
from pathlib import Path

import numpy as np
from skimage import color, io
from skimage.metrics import structural_similarity

COLUMNS = 2
GAP = 6  # pixels between pictures
LESSON = ("Breaking makes the storm: the horizontal displacement, the foam with its past and its structure, and the spray are seen at a "
          "glance. Air changes the horizon; multiple reflections, nine lookups of the sky for one, and the integral over it are "
          "seen by switching between two pictures at most.")


def prices_of(steps):
    """What was dear, in a sentence."""
    whole, before, added = float(steps[-1]["ms"]), 0.0, []
    for step in steps:
        added.append(((float(step["ms"]) - before) / whole, step["setting"].removeprefix("+ ")))
        before = float(step["ms"])
    dearest = sorted(added, reverse=True)[:2]
    return "The dearest steps: " + ", then ".join(f"{name} ({100 * share:.0f} % of the time)" for share, name in dearest) + "."


def lab_of(picture):
    return color.rgb2lab(picture[..., :3] / 255.0)


def seen_difference(a, b):
    """(mean CIEDE2000, 1 - SSIM) of two pictures."""
    a, b = lab_of(a), lab_of(b)
    alike = structural_similarity(a[..., 0], b[..., 0], data_range=100.0, gaussian_weights=True, sigma=1.5,
                                  use_sample_covariance=False)
    return float(color.deltaE_ciede2000(a, b).mean()), 1.0 - float(alike)


def sheet_of(pictures):
    height, width = pictures[0].shape[:2]
    rows = -(-len(pictures) // COLUMNS)
    sheet = np.full((rows * (height + GAP) - GAP, COLUMNS * (width + GAP) - GAP, 3), 255, np.uint8)
    for i, picture in enumerate(pictures):
        row, column = divmod(i, COLUMNS)
        top, left = row * (height + GAP), column * (width + GAP)
        sheet[top:top + height, left:left + width] = picture[..., :3]
    return sheet


def table_of(steps, pictures):
    whole_ms = float(steps[-1]["ms"])
    lines = ["| | Step | ms | adds | radiance: from the whole | from before | ΔE: from the whole | from before "
             "| 1 − SSIM: from the whole | from before |",
             "|" + "---|" * 10]
    before, before_ms = pictures[0], 0.0
    for number, (step, picture) in enumerate(zip(steps, pictures), 1):
        ms = float(step["ms"])
        whole, last = seen_difference(picture, pictures[-1]), seen_difference(picture, before)
        cells = [str(number), step["setting"], f"{ms:.0f}", f"{100 * (ms - before_ms) / whole_ms:.1f} %",
                 f"{float(step['error_1']):.3g}", f"{float(step['error_3']):.3g}",
                 f"{whole[0]:.2f}", f"{last[0]:.2f}", f"{whole[1]:.3f}", f"{last[1]:.3f}"]
        lines.append("| " + " | ".join(cells) + " |")
        before, before_ms = picture, ms
    return "\n".join(lines) + "\n"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    run, out = map(Path, sys.argv[1:])
    with open(run / "accuracy.csv", newline="", encoding="utf-8") as table:
        steps = [line for line in csv.DictReader(table) if line["row"] == "picture-steps"]
    pictures = [io.imread(run / "pictures" / f"picture-steps.{i}.png") for i in range(1, len(steps) + 1)]
    out.mkdir(parents=True, exist_ok=True)
    (out / "storm-steps.md").write_text(
        "# A storm, effect by effect\n\n"
        "`examples/storm-steps.sh` made this: each step adds an effect to those before it "
        f"(`pelagic accuracy --rows picture-steps`, {steps[0]['machine']}). How far its picture is from the whole one and from "
        "that of the step before: the 95th percentile over pixels of water of the relative error of radiance; and of the "
        "pictures as a screen shows them the mean of ΔE (CIEDE2000), of which an eye just notices 1, and 1 − SSIM, 0 where "
        "the structure is the same. *Adds*: of the whole picture's time.\n\n"
        + table_of(steps, pictures) + "\n" + LESSON + " " + prices_of(steps) + "\n"
        "\n![The steps, from left to right and down](storm-steps.png)\n", encoding="utf-8")
    io.imsave(out / "storm-steps.png", sheet_of(pictures), check_contrast=False)


main()
