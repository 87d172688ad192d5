"""Objects in the light of the sea: what an artist puts into it in Blender is in the shot file, at the same place and of the same size, and
looks the same by Cycles and by `pelagic render`.

    in_light.py -- PELAGIC_PROGRAM
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from mathutils import Matrix, Vector
from pictures import cycles_exr

from pelagic_ocean import courses, exchange, farm, floating, in_light

PROGRAM, FOLDER = sys.argv[-1], Path(tempfile.mkdtemp())
SIZE = (320, 180)


def select(*objects):
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj


def exported(name):
    file = FOLDER / f"{name}.toml"
    assert bpy.ops.pelagic.export_shot(filepath=str(file)) == {"FINISHED"}
    return pelagic.Scene.from_file(file)


def remarks():
    return exchange.shot_of(bpy.context, exchange.ocean_of(bpy.context), FOLDER / "remarks")[1]


def points_of(obj, frame):
    """Where the evaluated mesh's points are in calm water (n, 3)."""
    bpy.context.scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrix = np.array(floating.calm_matrix(obj, depsgraph))
    return numbers(obj.evaluated_get(depsgraph).data) @ matrix[:3, :3].T + matrix[:3, 3]


def points_in(shot, index, frame):
    pose = shot.object_pose(index, frame)
    return shot.object_mesh(index)["points_m"] @ pose[:3, :3].T + pose[:3, 3]


def box(points):
    return np.concatenate((points.min(0), points.max(0)))


# ---- The clicks of the add-on's README

with checking("a trawler with its wake, put together by clicks, is in the shot: one body, on its vessel, afloat, at the same place and as large"):
    fresh_file()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 96
    sea = add_ocean(sea__wind_speed_mps=3.0, surface__size_m=160.0, surface__kind="projected-grid")
    assert bpy.ops.wm.obj_import(filepath=str(ROOT / "examples/data/trawler.obj"), forward_axis="Y", up_axis="Z") == {"FINISHED"}
    trawler = bpy.context.selected_objects[0]
    select(trawler)
    trawler.rotation_mode = "XYZ"
    for frame, x, y in ((1, -14.0, -6.0), (96, 6.0, 4.0)):
        trawler.location = x, y, 0.0
        trawler.keyframe_insert("location", frame=frame)
    trawler.rotation_euler = 0.0, 0.0, math.atan2(10.0, 20.0)
    assert bpy.ops.pelagic.make_wake() == {"FINISHED"}
    assert bpy.ops.pelagic.float() == {"FINISHED"}
    assert bpy.ops.pelagic.add_to_sea() == {"FINISHED"}
    eye = scene.camera
    eye.location, eye.data.lens = (24.0, -44.0, 9.0), 40.0
    eye.rotation_mode = "QUATERNION"
    eye.rotation_quaternion = (eye.location - Vector((-2.0, 0.0, 4.0))).to_track_quat("Z", "Y")
    eye.data.clip_end = 100e3
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.frame_set(48)
    assert not remarks(), remarks()
    shot = exported("trawler")
    body, = shot.objects
    assert (body.vessel, body.floats, body.holdout, body.path, body.scale) == (1, True, False, "", 1.0), body
    assert 'file = "trawler_objects/' in (FOLDER / "trawler.toml").read_text(), "a path from the shot's folder"
    for frame in (1, 48, 96):
        off = np.abs(box(points_of(trawler, frame)) - box(points_in(shot, 0, frame)))
        assert off.max() < 0.02, (frame, off)
    scene.frame_set(48)

with checking("its materials come along"):
    told = {each["name"]: each for each in shot.object_mesh(0)["materials"]}
    assert len(told) == len(trawler.material_slots) and np.allclose(told["hull"]["colour"], (0.02, 0.075, 0.16), atol=1e-3), told
    assert np.allclose(told["lamp"]["glow"], (1.0, 0.86, 0.6), atol=1e-3) and math.isclose(body.glow_cd_m2, 1000.0, rel_tol=1e-3)

with checking("the command line renders it, and its silhouette is Cycles'"):
    ended = subprocess.run([PROGRAM, "render", str(FOLDER / "trawler.toml"), "--out", str(FOLDER), "--frames", "48", "--samples", "2", "--layers",
                            "none"], capture_output=True, text=True)
    assert ended.returncode == 0 and (FOLDER / "Ocean.0048.exr").is_file(), ended.stderr
    matte = pelagic.render(shot, 48, SIZE, 3, layers=["cryptomatte"])["cryptomatte"][::-1].reshape(SIZE[1], SIZE[0], 6, 2)
    water = matte[0, 0, 0, 0]  # a corner below, where nothing else is
    seen = ((matte[..., 0] != water) & (matte[..., 0] != 0.0)) * matte[..., 1]
    by_program = seen.sum(-1) > 0.5
    # What water hides of it is hidden: its waves are there, and are nothing.
    sea.is_holdout, scene.render.film_transparent = True, True
    by_cycles = cycles_exr(FOLDER / "mask.exr", SIZE, 16)[..., 3] > 0.5
    sea.is_holdout, scene.render.film_transparent = False, False
    both = (by_program & by_cycles).sum() / (by_program | by_cycles).sum()
    print(f"    {by_program.sum()} pixels by the program, {by_cycles.sum()} by Cycles, of either both have {both:.4f}")
    assert by_program.sum() > 2000 and both >= 0.97
