"""The real window's 3D view, for tests of the viewport preview in it: what it shows, from where, and beside the program's own picture. After
enable(). Needs PELAGIC_PROGRAM, the program's path."""

import os
import subprocess
import tempfile
import time
from pathlib import Path

from harness import *  # noqa: F403
from mathutils import Euler, Vector
from pelagic_ocean import ocean, viewport

FOLDER = Path(tempfile.mkdtemp())


def view3d():
    window = bpy.context.window_manager.windows[0]
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    return window, max(areas, key=lambda area: area.width)


def in_view():
    window, area = view3d()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region)


def redraw():
    with in_view():
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)


def state(preview):
    """What a picture is made of."""
    drawing = preview.drawing
    return drawing.sea, drawing.light, list(preview.hidden_in), drawing.awaits_foam, drawing.is_coarse(), preview.is_building


def settle():
    """Until what is shown is all that the preview has to show; its timers don't run while a script does. In software a picture takes
    seconds: the last one is not drawn again."""
    for _ in range(20):
        preview = viewport._preview
        redraw()
        if preview is None or viewport._preview is not preview:
            return
        drawn = state(preview)
        if preview._job is not None:
            preview._job.finish()
        asked = preview.drawing.awaits_foam  # the next picture has it
        while preview.drawing.awaits_foam and preview.drawing.sea.is_foam_busy:
            time.sleep(0.01)
        viewport._tend()
        if state(preview) == drawn and not asked and not any(drawn[-3:]):
            return
    raise AssertionError("the preview doesn't come to rest")


def pixels_of(file):
    """float32 (height, width, 3), rows from the bottom, display values."""
    image = bpy.data.images.load(str(file))
    width, height = image.size
    numbers = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(numbers)
    channels = image.channels
    bpy.data.images.remove(image)
    return numbers.reshape(height, width, channels)[:, :, :3]


def picture():
    settle()
    window, area = view3d()
    with in_view():
        region = bpy.context.region
        x, y, width, height = region.x, region.y, region.width, region.height
    return window_pixels(window)[y:y + height, x:x + width]


def look(pitch_deg, height_m, distance_m=60.0):
    """From the south, along y; edges as they are, which Blender smooths from redraw to redraw."""
    bpy.context.preferences.system.viewport_aa = "OFF"
    _, area = view3d()
    region_3d = area.spaces.active.region_3d
    region_3d.view_perspective = "PERSP"
    rotation = Euler((np.radians(90 + pitch_deg), 0, 0)).to_quaternion()
    region_3d.view_rotation = rotation
    region_3d.view_distance = 1.0
    region_3d.view_location = Vector((0, -distance_m, height_m)) - rotation @ Vector((0, 0, 1))
    region_3d.update()


def place_of(point):
    """Row and column of a world point in the picture."""
    with in_view():
        region, region_3d = bpy.context.region, bpy.context.region_data
        clip = region_3d.perspective_matrix @ Vector((*point, 1))
        return (int((clip.y / clip.w * 0.5 + 0.5) * region.height), int((clip.x / clip.w * 0.5 + 0.5) * region.width))


def seen_from_here(obj):
    """The ocean's scene with the view as its camera."""
    with in_view():
        region, region_3d = bpy.context.region, bpy.context.region_data
        pose, projection = region_3d.view_matrix.inverted(), region_3d.window_matrix.copy()
        size = region.width, region.height
    scene = ocean.scene_of(obj, bpy.context.scene)
    scene.camera.position_m = tuple(pose.translation)
    scene.camera.look_at_m = tuple(pose.translation - 100 * pose.col[2].to_3d())
    scene.camera.fov_deg = float(np.degrees(2 * np.arctan(1 / projection[0][0])))
    scene.camera.resolution = size
    return scene


def programs_picture(scene, frame=1):
    """What `pelagic preview` draws of it."""
    shot, file = FOLDER / "same.toml", FOLDER / "same.png"
    scene.save(shot)
    subprocess.run([os.environ["PELAGIC_PROGRAM"], "preview", str(shot), "--offscreen", str(file), "--frame", str(frame)], check=True)
    return pixels_of(file)


def change_of(a, b):
    """Per pixel, 0 … 1."""
    return np.abs(a - b).max(axis=2)


def keep(file, pixels):
    """A picture for whoever looks at it."""
    image = bpy.data.images.new("kept", pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(np.dstack((pixels, np.ones(pixels.shape[:2], np.float32))).astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(file), "PNG"
    image.save()
    bpy.data.images.remove(image)
