"""The viewport preview in Blender's window, as a picture: examples/gallery/blender-viewport.jpg. In software some minutes.

    PYTHONPATH=… xvfb-run -a -s "-screen 0 1280x760x24" blender --factory-startup --python-exit-code 1 \
        --python examples/blender-viewport.py -- OUT.jpg
"""

import math
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / "addon")]

from harness import *  # noqa: F403
from mathutils import Euler, Vector

enable()
from pelagic_ocean import viewport


def floating(location, colour, add, **shape):
    add(location=location, **shape)
    obj = bpy.context.object
    obj.color = (*colour, 1.0)
    obj.pelagic_float.enabled = True


def steps():
    window = bpy.context.window_manager.windows[0]
    area = max((each for each in window.screen.areas if each.type == "VIEW_3D"), key=lambda each: each.width)
    region = next(each for each in area.regions if each.type == "WINDOW")
    space = area.spaces.active
    with bpy.context.temp_override(window=window, area=area, region=region):
        for name in ("Cube", "Light"):
            bpy.data.objects.remove(bpy.data.objects[name])
        # The exposure is metered where the scene's camera is: there the view is, too.
        rotation, eye = Euler((math.radians(84.0), 0.0, 0.0)), Vector((0.0, -16.0, 4.0))
        camera = bpy.context.scene.camera
        camera.location, camera.rotation_euler = eye, rotation
        sea = add_ocean(sea__wind_speed_mps=14.0, light__sun_elevation_deg=18.0, light__sun_azimuth_deg=190.0)
        mesh = bpy.ops.mesh
        floating((-4.0, 0.0, 0.0), (0.6, 0.1, 0.05), mesh.primitive_cone_add, radius1=1.1, radius2=0.3, depth=3.0)
        floating((4.0, 12.0, 0.0), (0.5, 0.35, 0.15), mesh.primitive_cube_add, size=2.5)
        space.shading.color_type = "OBJECT"
        space.overlay.show_extras = space.overlay.show_cursor = space.overlay.show_object_origins = False
        region_3d = space.region_3d
        region_3d.view_perspective, region_3d.view_distance = "PERSP", 1.0
        region_3d.view_rotation = rotation.to_quaternion()
        region_3d.view_location = eye - rotation.to_quaternion() @ Vector((0.0, 0.0, 1.0))
        bpy.context.scene.frame_set(60)
        bpy.ops.object.select_all(action="DESELECT")
        bpy.context.window_manager.pelagic_preview.show_sky = True
        viewport.turn_on(sea)

    def is_at_rest():
        preview = viewport._preview
        return (preview.hidden_in and not preview.is_building and not preview.drawing.awaits_foam
                and not preview.drawing.is_coarse() and time.monotonic() > begun_s + 5.0)

    begun_s = time.monotonic()
    yield is_at_rest
    with bpy.context.temp_override(window=window):
        with tempfile.TemporaryDirectory() as folder:
            file = str(Path(folder) / "window.png")
            bpy.ops.screen.screenshot(filepath=file)
            image = bpy.data.images.load(file)
            image.pixels[0]  # reads it, before it has another name
            image.filepath_raw, image.file_format = str(Path(sys.argv[-1]).absolute()), "JPEG"
            image.save()


in_window(steps)
