"""What a screen shows of Cycles' sea beside what it shows of `pelagic render`'s: mean luminances over the sea's pixels, of the light itself and
through Blender's view transforms at the exposure that the add-on meters. By day two shots, at night eight.

    displays.py -- PELAGIC_PROGRAM
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable(sky_width=None)
import pelagic
from pelagic_ocean import light
from pictures import LUMINANCE, cycles_exr, read_exr, shot_in_blender

PROGRAM, FOLDER = sys.argv[-1], Path(tempfile.mkdtemp())
SIZE, SAMPLES, MOST_OFF = ((160, 90), 96, 0.1) if at_night() else ((96, 54), 32, 0.15)  # noise makes a displayed mean darker
CURVES_OFF = 0.2  # of Blender's curve beside ours: 1.19 in the darkest of the eight shots, whose mean is 0.10
# A preset, how high the sun is, and where: 90 is in front of the camera, 270 behind it.
SHOTS = (("beaufort-6", 12.0, 150.0), ("north-sea-storm", 25.0, 120.0), ("beaufort-1", 60.0, 180.0), ("beaufort-3", 8.0, 60.0),
         ("beaufort-4", 30.0, 270.0), ("beaufort-5", 45.0, 90.0), ("beaufort-8", 35.0, 200.0), ("beaufort-11", 6.0, 300.0))
FOAMY = ("beaufort-8", "beaufort-11")


def linear(display):
    """Of sRGB display values, 0 … 1: the light of the screen."""
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)


def by_program(shot):
    """The light of the program's picture, and its display values."""
    subprocess.run([PROGRAM, "render", str(shot), "--out", str(FOLDER), "--frames", "1", "--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", "2",
                    "--alpha", "--layers", "none"], check=True, stdout=subprocess.DEVNULL)
    return read_exr(FOLDER / f"{shot.stem}.0001.exr"), read_exr(FOLDER / f"{shot.stem}.0001.png")


def displayed(picture):
    """Display values of a picture, as Blender's scene shows it."""
    bpy_scene = bpy.context.scene
    bpy_scene.view_settings.look = "None"
    image = bpy.data.images.new("Light", *SIZE, float_buffer=True)
    image.pixels.foreach_set(picture.astype(np.float32).ravel())
    settings = bpy_scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"
    image.save_render(str(FOLDER / "shown.png"), scene=bpy_scene)
    bpy.data.images.remove(image)
    settings.color_mode = "RGBA"
    return read_exr(FOLDER / "shown.png")


def transforms():
    known = []
    for name in ("Filmic", "AgX"):
        try:
            bpy.context.scene.view_settings.view_transform = name
            known.append(name)
        except TypeError:  # another Blender's
            pass
    return known


def seen(scene):
    """A scene's sea by Cycles and by the program: name → both means, of the light and through each view transform."""
    shot = FOLDER / f"{scene.shot.name}.toml"
    scene.save(shot)
    program, program_shown = by_program(shot)
    shot_in_blender(shot, SIZE)
    bpy_scene = bpy.context.scene
    own = math.log2(pelagic.Sky(scene).exposure(scene))
    bpy_scene.render.film_transparent = True
    bpy_scene.cycles.max_bounces, bpy_scene.cycles.sample_clamp_indirect = 3, 10.0
    cycles = cycles_exr(FOLDER / "cycles.exr", SIZE, SAMPLES)
    sea = (program[..., 3] > 0.99) & (cycles[..., 3] > 0.99)

    def mean(picture):
        return float((picture[sea][:, :3] @ LUMINANCE).mean())

    cycles[..., 3] = program[..., 3] = 1.0
    found = {"light": (mean(cycles), mean(program))}
    for transform in transforms():
        bpy_scene.view_settings.view_transform = transform
        bpy.context.view_layer.update()
        shown = mean(linear(program_shown))
        found[transform] = mean(linear(displayed(cycles))), shown
        found[f"{transform}, the program's light"] = mean(linear(displayed(program))), shown
        stops = bpy_scene.view_settings.exposure - own
        assert abs(stops - light.VIEW_STOPS.get(transform, 0.0)) < 0.01, (transform, stops)
    return found


off = {}
for preset, elevation_deg, azimuth_deg in SHOTS if at_night() else SHOTS[:2]:
    scene = pelagic.Scene()
    scene.apply_preset(preset)
    scene.shot.name, scene.shot.frames = preset, (1, 1)
    scene.effects.spray = False  # the veil before the sea, which Blender has as a bake's volume
    scene.light.sun_elevation_deg, scene.light.sun_azimuth_deg = elevation_deg, azimuth_deg
    scene.camera.position_m, scene.camera.look_at_m = (0.0, 0.0, 8.0), (0.0, 100.0, 0.0)
    # Foam's pattern is elsewhere in each sea, and another one in Blender: where foam is most of the light, one place says little of it.
    places = []
    for scene.shot.seed in (1, 7, 8) if preset in FOAMY else (1,):
        places.append(seen(scene))
    row = {name: sum(each[name][0] for each in places) / sum(each[name][1] for each in places) for name in places[0]}
    print(f"   {preset:16s} sun {elevation_deg:3.0f} {azimuth_deg:4.0f}  ", "  ".join(f"{name} {value:6.3f}" for name, value in row.items()),
          f"  shown by the program {places[0]['Filmic'][1]:.3f}, light at each place", *(f"{each['light'][0] / each['light'][1]:.2f}" for each in places), flush=True)
    # What is Cycles' doing is seen through one curve: Blender's. That curve beside ours is another matter: where a shot is dark, ours is darker.
    for name in row:
        value, most = row[name], MOST_OFF
        if name.endswith("the program's light"):
            most = CURVES_OFF
        elif name != "light":
            value /= row[f"{name}, the program's light"]
        if not abs(value - 1.0) < most:
            off[preset, name] = value

with checking("the sea is as bright by Cycles as by the program, and so is what is shown of it"):
    assert not off, off
