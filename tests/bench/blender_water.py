"""Cycles' sea beside `pelagic render`'s, band by band: a lagoon of 2.5 m, a shelf of 20 m, a storm. Means of the light over the sea's
pixels, and over its far, middle and near third.

    blender_water.py -- PELAGIC_PROGRAM [--patch] [--see-through on|off] [--png FOLDER] [NAME…]

--patch: the sea as an artist adds it, a patch with rings to the horizon, instead of the camera's own grid.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "tests" / "addon")]
import pelagic  # noqa: E402
import pelagic_ocean  # noqa: E402
from pictures import cycles_exr, read_exr, shot_in_blender  # noqa: E402

SIZE, SAMPLES = (320, 180), 32
FOLDER = Path(tempfile.mkdtemp())


def scene_of(name):
    scene = pelagic.Scene()
    if name == "shelf":
        scene.sea.wind_speed_mps, scene.sea.depth_m = 7.0, 20.0
        scene.water.type = "jerlov-IB"
        scene.water.floor_colour = (0.55, 0.50, 0.40)
        scene.light.sun_elevation_deg, scene.light.sun_azimuth_deg = 45.0, 40.0
        scene.camera.position_m, scene.camera.look_at_m = (0.0, 0.0, 8.0), (0.0, 60.0, 0.0)
    else:
        scene.apply_preset({"lagoon": "lagoon", "storm": "north-sea-storm"}[name])
    scene.shot.name, scene.shot.frames = name, (1, 1)
    return scene


def by_program(program, shot):
    """The light of `pelagic render`'s picture, alpha where its sea is."""
    subprocess.run([program, "render", str(shot), "--out", str(FOLDER), "--frames", "1", "--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", "2",
                    "--alpha", "--layers", "none"], check=True, stdout=subprocess.DEVNULL)
    return read_exr(FOLDER / f"{shot.stem}.0001.exr")


def save_png(light, path, exposure):
    shown = np.clip(light[..., :3] * exposure * 0.8, 0, None)
    shown = np.clip(1.0 - np.exp(-1.4 * shown), 0, 1) ** (1 / 2.2)
    image = bpy.data.images.new("Shown", light.shape[1], light.shape[0])
    image.pixels.foreach_set(np.dstack([shown, np.ones(shown.shape[:2])]).astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    program = arguments.pop(0)
    options = {}
    for name in ("--see-through", "--png"):
        if name in arguments:
            at = arguments.index(name)
            options[name] = arguments[at + 1]
            del arguments[at:at + 2]
    is_patch = "--patch" in arguments
    names = [each for each in arguments if each != "--patch"] or ["lagoon", "shelf", "storm"]
    pelagic_ocean.register()
    for name in names:
        scene = scene_of(name)
        shot = FOLDER / f"{name}.toml"
        scene.save(shot)
        core = by_program(program, shot)
        obj = shot_in_blender(shot, SIZE)
        if is_patch:
            obj.pelagic.surface.kind, obj.pelagic.horizon = "patch", True
        if "--see-through" in options:
            obj.pelagic.see_through = options["--see-through"] == "on"
        bpy.context.view_layer.update()
        bpy.context.scene.render.film_transparent = True
        start = time.perf_counter()
        cycles = cycles_exr(FOLDER / "cycles.exr", SIZE, SAMPLES)
        took = time.perf_counter() - start
        if "--png" in options:
            exposure = pelagic.Sky(scene).exposure(scene)
            for who, light in (("core", core), ("cycles", cycles)):
                save_png(light, Path(options["--png"]) / f"{name}-{who}.png", exposure)
        sea = (core[..., 3] > 0.99) & (cycles[..., 3] > 0.99)
        assert np.isfinite(cycles).all()
        rows = np.flatnonzero(sea.any(axis=1))
        thirds = np.array_split(rows, 3)  # from the bottom

        def ratio(which):
            mask = np.zeros_like(sea)
            mask[which] = sea[which]
            return cycles[mask][:, :3].mean(0) / core[mask][:, :3].mean(0)

        print(f"{name:8s} all {np.round(ratio(rows), 3)}  far {np.round(ratio(thirds[2]), 3)}  middle {np.round(ratio(thirds[1]), 3)}  "
              f"near {np.round(ratio(thirds[0]), 3)}   Cycles {took:.1f} s, core's mean {np.round(core[sea][:, :3].mean(0), 3)}", flush=True)


main()
