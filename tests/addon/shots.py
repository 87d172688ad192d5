"""Shot files in and out: what was imported comes out as it went in, and what Blender animates comes out as keys."""

import math
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from mathutils import Matrix, Vector

from pelagic_ocean import camera, exchange, ocean, play

folder = Path(tempfile.mkdtemp())
make = ocean.make


def make_coarse(name, collection):
    """Of meshes there is no question here: whole ones are made at night."""
    obj = make(name, collection)
    obj.pelagic.viewport_percentage = 100 if at_night() else 2
    return obj


ocean.make = make_coarse


@contextmanager
def unbuilt():
    """No sea is built: each example's takes seconds, and what goes in and comes out are settings. At night they are built, too."""
    show = play._show
    if not at_night():
        play._show = lambda *_, **__: None
    try:
        yield
    finally:
        play._show = show


def imported(path):
    fresh_file()
    assert bpy.ops.pelagic.import_shot(filepath=str(path)) == {"FINISHED"}
    return bpy.context.object


def exported(name="out"):
    path = folder / f"{name}.toml"
    assert bpy.ops.pelagic.export_shot(filepath=str(path)) == {"FINISHED"}
    return pelagic.Scene.from_file(path)


def written(text, name="shot"):
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return path


with checking("examples come out as they went in, by day every second, of which settings.py has all settings"):
    examples = sorted((ROOT / "examples").glob("*.toml"))
    assert len(examples) >= 8
    for path in examples if at_night() else examples[::2]:
        there, back = pelagic.Scene.from_file(path), None
        there.camera.glare = pelagic.Scene().camera.glare  # of the program's camera alone
        with unbuilt():
            imported(path)
            back = exported(path.stem)
        assert len(back.objects) == len(there.objects)
        there.objects = back.objects = []  # in_light.py has them
        assert str(back) == str(there) and back.shot.frames == there.shot.frames, \
            (path.name, set(str(there).splitlines()) ^ set(str(back).splitlines()))

with checking("numbers that single precision doesn't hold come out with the digits that they went in with"):
    text = """[shot]
name = "odd"
frames = [3, 17]
fps = 29.97
time_scale = 0.7
[sea]
wind_speed_mps = 12.3
swell = [ { height_m = 1.1, period_s = 9.7, direction_deg = 33.3 } ]
[waves]
cascades = [ { size_m = 133.3, resolution = 96, choppiness = 0.7 }, { size_m = 37.1, resolution = 64 } ]
[surface]
size_m = 133.7
[camera]
position_m = [0.1, -60.3, 4.7]
look_at_m = [1.7, 2.3, -0.9]
fov_deg = 47.3
[light]
sun_elevation_deg = 0.1
"""
    there = pelagic.Scene.from_file(written(text))
    imported(folder / "shot.toml")
    back = exported()
    assert str(back) == str(there), f"{there}\n{back}"

with checking("sun, sky and material come along"):
    scene = bpy.context.scene
    sun = next(obj for obj in scene.objects if obj.type == "LIGHT" and obj.data.type == "SUN")
    towards = sun.matrix_world.to_3x3() @ Vector((0, 0, 1))
    assert 0.0 < math.degrees(math.asin(towards.z)) < 0.4 and sun.data.energy > 0, towards  # half of it is below
    assert scene.world.use_nodes and bpy.context.object.data.materials[0] is not None

with checking("keys with angle and roll come out as they went in"):
    text = """[shot]
frames = [1, 30]
[camera]
keys = [ { frame = 1, position_m = [0.0, -60.0, 4.0], look_at_m = [0.0, 0.0, 1.0], fov_deg = 50.0, roll_deg = 0.0 },
         { frame = 13, position_m = [5.5, -50.0, 6.1], look_at_m = [1.0, 3.0, 0.0], fov_deg = 31.7, roll_deg = 7.5 },
         { frame = 30, position_m = [9.0, -47.0, 30.0], look_at_m = [2.0, 4.0, 0.0], fov_deg = 70.0, roll_deg = -12.25 } ]
"""
    there = pelagic.Scene.from_file(written(text, "keys"))
    imported(folder / "keys.toml")
    back = exported()
    assert str(back) == str(there), f"{there}\n{back}"
    assert back.camera.keys == there.camera.keys

with checking("the camera sees what the shot's camera sees"):
    scene = bpy.context.scene
    smooth = pelagic.Scene.from_file(written(text.replace("[camera]", '[camera]\ninterpolation = "smooth"'), "smooth"))
    for shot, frame in [(there, frame) for frame in (1, 7, 30)] + [(smooth, frame) for frame in (1, 7, 13, 21, 30)]:
        if shot == smooth and frame == 1:
            imported(folder / "smooth.toml")
            scene = bpy.context.scene
        scene.frame_set(frame)
        view = pelagic.View.of_scene(shot, frame)
        seen = scene.camera.matrix_world
        assert np.allclose(seen.translation, view.position_m, atol=1e-4), frame
        for axis, column in ((view.right, 0), (view.up, 1), (-np.array(view.forward), 2)):
            assert np.allclose(seen.col[column].xyz, axis, atol=1e-4), (frame, column)
        assert math.isclose(math.tan(scene.camera.data.angle_x / 2), view.tan_half_width, rel_tol=1e-5)

with checking("a camera that looks straight down, and one that rolls without moving"):
    for camera_keys in ("position_m = [0.0, 0.0, 50.0]\nlook_at_m = [0.0, 0.0, 0.0]",
                        "keys = [ { frame = 1, position_m = [0.0, -9.0, 5.0], look_at_m = [0.0, 0.0, 0.0], roll_deg = 30.0 } ]"):
        there = pelagic.Scene.from_file(written(f"[camera]\n{camera_keys}\n", "down"))
        imported(folder / "down.toml")
        assert str(exported()) == str(there)

with checking("a sky's picture beside the shot is found again from elsewhere"):
    sky = bpy.data.images.new("sky", 8, 4, float_buffer=True)
    sky.filepath_raw, sky.file_format = str(folder / "sky.exr"), "OPEN_EXR"
    sky.save()
    there = pelagic.Scene.from_file(written('[light]\nsky = "sky.exr"\n', "cloudy"))
    imported(folder / "cloudy.toml")
    (folder / "elsewhere").mkdir()
    assert str(exported("elsewhere/out")) == str(there)
    assert Path(bpy.context.object.pelagic.light.sky) == folder / "sky.exr"

with checking("an artist's camera, animated by curves and a parent, becomes keys on the same way"):
    fresh_file()
    sea = add_ocean()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 40
    eye = scene.camera
    eye.data.lens = 35
    bpy.ops.object.empty_add()
    parent = bpy.context.object
    eye.parent = parent
    for frame, angle, lens in ((1, 0.0, 35.0), (20, 0.4, 50.0), (40, 0.1, 50.0)):
        parent.rotation_euler = (0.1 * angle, 0.2 * angle, angle)
        parent.keyframe_insert("rotation_euler", frame=frame)
        eye.data.lens = lens
        eye.data.keyframe_insert("lens", frame=frame)
    scene.frame_set(8)
    shot = exported("artist")
    assert scene.frame_current == 8
    assert 25 < len(shot.camera.keys) <= 40
    for frame in (1, 2, 9, 20, 33, 40):
        scene.frame_set(frame)
        view = pelagic.View.of_scene(shot, frame)
        assert np.allclose(eye.matrix_world.translation, view.position_m, atol=2e-5), frame
        for axis, column in ((view.right, 0), (view.up, 1), (-np.array(view.forward), 2)):
            assert np.allclose(eye.matrix_world.col[column].xyz, axis, atol=1e-5), (frame, column)
        assert math.isclose(math.tan(eye.data.angle_x / 2), view.tan_half_width, rel_tol=1e-6)

with checking("a moved and turned ocean: the shot's camera is as seen from it"):
    sea.matrix_world = Matrix.Translation((100, 5, 2)) @ Matrix.Rotation(0.5, 4, "Z")
    scene.frame_set(9)
    shot, remarks = exchange.shot_of(bpy.context, sea)
    view = pelagic.View.of_scene(shot, 9)
    assert np.allclose(sea.matrix_world @ Vector(view.position_m), eye.matrix_world.translation, atol=1e-4)
    assert any("moved or turned" in remark for remark in remarks)
    sea.matrix_world = Matrix()

with checking("what a shot can't say is said; sensor fits and portrait pictures are understood"):
    eye.data.shift_x = 0.2
    sea.scale.x = 2.0
    scene.frame_set(1)
    shot, remarks = exchange.shot_of(bpy.context, sea)
    assert any("scaled" in remark for remark in remarks) and shot.camera.shift_x == 0.2 and shot.camera.f_stop == 0
    eye.data.shift_x, sea.scale.x = 0.0, 1.0
    sun = next(obj for obj in scene.objects if obj.type == "LIGHT" and obj.data.type == "SUN")
    assert not any("was turned" in remark for remark in remarks)
    sun.rotation_quaternion.rotate(Matrix.Rotation(0.1, 3, "Z"))
    scene.frame_set(1)
    _, remarks = exchange.shot_of(bpy.context, sea)
    assert any("was turned" in remark for remark in remarks)
    for x, y in ((1920, 1080), (600, 900)):
        for fit in ("AUTO", "HORIZONTAL", "VERTICAL"):
            scene.render.resolution_x, scene.render.resolution_y, eye.data.sensor_fit = x, y, fit
            corners = eye.data.view_frame(scene=scene)
            width = max(corner.x for corner in corners) - min(corner.x for corner in corners)
            expected = 2 * math.degrees(math.atan2(width / 2, -corners[0].z))
            assert math.isclose(camera.fov_deg(eye.data, scene.render), expected, rel_tol=1e-5), (x, y, fit)

with checking("refused in words: the own mesh, a broken file, a folder that can't be written, negative frames"):
    bpy.ops.mesh.primitive_grid_add(size=20)
    bpy.ops.pelagic.use_mesh()
    assert refused(lambda: exported(), "own mesh")
    assert refused(lambda: bpy.ops.pelagic.import_shot(filepath=str(written("[sea]\nwind = 3\n", "bad"))), "sea.wind")
    assert refused(lambda: bpy.ops.pelagic.import_shot(filepath=str(folder / "none.toml")), "does not exist")
    before = len(bpy.data.objects)
    assert refused(lambda: bpy.ops.pelagic.import_shot(filepath=str(written("[shot]\nframes = [-5, 3]\n", "early"))),
                   "begin at 0")
    assert refused(lambda: bpy.ops.pelagic.import_shot(filepath=str(written("[shot]\nseed = 9000000000\n", "seed"))),
                   "shot.seed")
    assert len(bpy.data.objects) == before
    bpy.context.view_layer.objects.active = sea
    assert refused(lambda: bpy.ops.pelagic.export_shot(filepath="/proc/no/such/folder.toml"), "/proc/no")
