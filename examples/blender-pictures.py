"""A shot by the add-on and Cycles, as a picture: examples/blender-pictures.sh makes those of the gallery.

    PYTHONPATH=… blender -b --factory-startup --python-exit-code 1 --python examples/blender-pictures.py -- \
        SHOT.toml OUT.jpg [frame=N] [size=WxH] [samples=N] [stops=X] [beside=core]

beside: to the left of it the same frame by the core, seen through the same view transform. stops: brighter by these.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tests" / "addon")]

import pelagic_ocean

pelagic_ocean.register()
from pictures import core_layers, cycles_exr, shot_in_blender


def main():
    shot, out, *rest = sys.argv[sys.argv.index("--") + 1:]
    named = dict(each.split("=", 1) for each in rest)
    out = Path(out).absolute()
    size = tuple(int(side) for side in named.get("size", "960x540").split("x"))
    with tempfile.TemporaryDirectory() as folder:
        parts = []
        if "beside" in named:
            parts.append(sum(core_layers(shot, size).values()))
        sea = shot_in_blender(shot, size)
        bpy_scene = bpy.context.scene
        bpy_scene.frame_set(int(named.get("frame", bpy_scene.frame_start)))
        if sea.pelagic.effects.spray:
            bpy_scene.frame_start = bpy_scene.frame_end = bpy_scene.frame_current
            sea.pelagic_bake.folder = folder
            bpy.ops.pelagic.bake_volume(kind="spray")
        bpy_scene.cycles.max_bounces, bpy_scene.cycles.sample_clamp_indirect = 3, 10.0
        parts.append(cycles_exr(Path(folder) / "cycles.exr", size, int(named.get("samples", 64)))[..., :3])
    pixels = np.concatenate(parts, axis=1)
    image = bpy.data.images.new("Picture", pixels.shape[1], pixels.shape[0], float_buffer=True)
    image.pixels.foreach_set(np.pad(pixels, ((0, 0), (0, 0), (0, 1)), constant_values=1).astype(np.float32).ravel())
    bpy_scene.view_settings.exposure += float(named.get("stops", 0))
    bpy_scene.view_settings.look = "Medium High Contrast"
    settings = bpy_scene.render.image_settings
    settings.file_format = "PNG" if out.suffix == ".png" else "JPEG"
    settings.color_depth, settings.quality = "8", 88
    image.save_render(str(out), scene=bpy_scene)


main()
