"""The pictures of the add-on's page, by the add-on: a shot as an artist would have it, rendered by Cycles.

    PYTHONPATH=… blender -b --factory-startup --python-exit-code 1 --python examples/blender-pictures.py -- \
        SHOT.toml OUT.jpg [frame=N] [size=WxH] [samples=N] [view=core]

view=core: with the core's own tone curve instead of Blender's Filmic, for a side by side with `pelagic render`.
examples/blender-pictures.sh makes them all.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tests" / "addon")]

import pelagic_ocean

pelagic_ocean.register()
from pictures import cycles_exr, shot_in_blender


def options():
    shot, out, *rest = sys.argv[sys.argv.index("--") + 1:]
    named = dict(each.split("=", 1) for each in rest)
    size = tuple(int(side) for side in named.get("size", "960x540").split("x"))
    return shot, Path(out).absolute(), size, int(named.get("samples", 64)), named


def main():
    shot, out, size, samples, named = options()
    shot_in_blender(shot, size)
    bpy_scene = bpy.context.scene
    if "frame" in named:
        bpy_scene.frame_set(int(named["frame"]))
    bpy_scene.view_settings.look = "Medium High Contrast"
    bpy_scene.cycles.max_bounces = 3
    bpy_scene.cycles.sample_clamp_indirect = 10.0
    bpy_scene.render.image_settings.quality = 88
    exr = out.with_suffix(".exr")
    cycles_exr(exr, size, samples)
    image = bpy.data.images.load(str(exr))
    bpy_scene.render.image_settings.file_format = "PNG" if out.suffix == ".png" else "JPEG"
    bpy_scene.render.image_settings.color_depth = "8"
    image.save_render(str(out), scene=bpy_scene)
    exr.unlink()


main()
