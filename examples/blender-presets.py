"""Writes the presets as a library of assets: an ocean each, with its settings, its material and a rendered thumbnail.

    blender -b --factory-startup --python examples/blender-presets.py -- presets.blend

Put the file into a folder of Preferences > File Paths > Asset Libraries. An asset that is dropped into a scene is an ocean of
its own: its mesh is empty in the library, and made where it arrives. The module `pelagic` has to be in PYTHONPATH.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
import pelagic_ocean  # noqa: E402, from the folder above


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(prog="blender-presets.py", description=__doc__.splitlines()[0])
    parser.add_argument("out", metavar="OUT.blend")
    parser.add_argument("--presets", metavar="A,B", type=lambda text: text.split(","), help="their names; default: all")
    parser.add_argument("--samples", metavar="N", type=int, default=48, help="a pixel of a thumbnail; default 48")
    parser.add_argument("--size", metavar="PIXELS", type=int, default=256, help="of a thumbnail's side; default 256")
    return parser.parse_args(arguments)


def studio(samples, size):
    """A scene with a camera and without anything else."""
    scene = bpy.context.scene
    for obj in [obj for obj in bpy.data.objects if obj != scene.camera]:
        bpy.data.objects.remove(obj)
    scene.camera.rotation_euler = (1.5, 0.0, -0.6)  # down by 4 degrees
    scene.camera.data.lens = 28.0
    render = scene.render
    render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", samples, False
    render.resolution_x = render.resolution_y = size
    render.resolution_percentage, render.image_settings.file_format = 100, "PNG"
    return scene


def asset_of(preset, scene, picture):
    """The ocean of a preset, marked as an asset, its mesh empty again and in no scene any more."""
    bpy.ops.pelagic.add_ocean(light=True)
    obj = bpy.context.object
    bpy.ops.pelagic.preset_apply(name=preset["name"])
    bpy.context.view_layer.update()
    scene.camera.location = 0.0, 0.0, 2.0 + pelagic_ocean.play.simulation_of(obj).sea.significant_height_m
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    obj.data.clear_geometry()
    obj.name = obj.data.name = preset["label"]
    obj.asset_mark()
    obj.asset_data.description = preset["help"]
    image = bpy.data.images.load(str(picture))
    preview = obj.preview_ensure()
    preview.image_size = image.size
    preview.image_pixels_float.foreach_set(image.pixels[:])
    bpy.data.images.remove(image)
    return obj


def main():
    arguments = parse_arguments(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    pelagic_ocean.register()
    presets = {preset["name"]: preset for preset in pelagic_ocean.presets.pelagic.presets()}
    unknown = set(arguments.presets or ()) - set(presets)
    if unknown:
        sys.exit(f"{', '.join(sorted(unknown))}: no preset; accepted: {', '.join(presets)}")
    scene = studio(arguments.samples, arguments.size)
    with tempfile.TemporaryDirectory() as folder:
        assets = {asset_of(presets[name], scene, Path(folder) / f"{name}.png") for name in arguments.presets or presets}
    bpy.data.libraries.write(str(Path(arguments.out).resolve()), assets, compress=True)


if __name__ == "__main__":
    main()
