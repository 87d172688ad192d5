"""A first look at a shot in Blender: its sea by the add-on, to the horizon, under its own sun and sky.

    blender -b --factory-startup --python examples/blender-first-look.py -- SHOT.toml --out DIR
    blender --factory-startup --python examples/blender-first-look.py -- SHOT.toml

The first renders two pictures, DIR/NAME.####.png; the second leaves the sea in the window, to play and to look
around in. examples/blender-first-look.sh builds the module `pelagic`, whose folder has to be in PYTHONPATH, and
calls this.
"""

import argparse
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
import pelagic_ocean  # noqa: E402, from the folder above


def parse_arguments(arguments):
    def size(text):
        width, height = (int(part) for part in text.lower().split("x"))
        return width, height

    def frames(text):
        return [int(part) for part in text.split(",")]

    parser = argparse.ArgumentParser(prog="blender-first-look.py", description=__doc__.splitlines()[0])
    parser.add_argument("shot", metavar="SHOT.toml")
    parser.add_argument("--out", metavar="DIR", help="where the pictures go; without it none are rendered")
    parser.add_argument("--frames", metavar="A,B", type=frames, help="default: the shot's first and its middle one")
    parser.add_argument("--samples", metavar="N", type=int, default=48, help="a pixel; default 48")
    parser.add_argument("--size", metavar="WxH", type=size, help="of the pictures; default: the shot's resolution")
    return parser.parse_args(arguments)


def show(path):
    """The shot's ocean in a scene of its own."""
    for obj in list(bpy.data.objects):  # of Blender's start-up file
        bpy.data.objects.remove(obj)
    bpy.ops.pelagic.import_shot(filepath=str(path))
    obj = bpy.context.object
    obj.pelagic.horizon = True
    return obj


def main():
    arguments = parse_arguments(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    pelagic_ocean.register()
    try:
        obj = show(Path(arguments.shot).resolve())
    except RuntimeError as error:
        sys.exit(str(error))
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = arguments.samples
    scene.cycles.use_denoising = False  # Debian's Blender has no denoiser
    if arguments.size:
        scene.render.resolution_x, scene.render.resolution_y = arguments.size
    if not arguments.out:
        return
    scene.render.image_settings.file_format = "PNG"
    for frame in arguments.frames or [scene.frame_start, (scene.frame_start + scene.frame_end + 1) // 2]:
        scene.frame_set(frame)
        scene.render.filepath = str(Path(arguments.out).resolve() / f"{obj.name}.{frame:04d}.png")
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
