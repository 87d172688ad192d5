"""Objects that float, drivers and samples: where the water is, in any order of frames."""

import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from mathutils import Matrix, Vector

from pelagic_ocean import compat
from pelagic_ocean.query import Water

fresh_file()
scene = bpy.context.scene
sea = add_ocean(sea__wind_speed_mps=14.0, surface__size_m=100.0)
sea.pelagic.surface.resolution = 256
bpy.context.view_layer.update()


def buoy(location, size=(1, 1, 1), **settings):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=location)
    obj = bpy.context.object
    obj.scale = size
    for name, value in {"enabled": True, **settings}.items():
        setattr(obj.pelagic_float, name, value)
    return obj


def state(obj):
    return tuple(obj.delta_location), tuple(obj.delta_rotation_euler), tuple(obj.delta_rotation_quaternion)


def mesh_height(x, y):
    """Of the ocean's mesh itself: the ray's hit on its triangles, in its own coordinates."""
    hit, place, *_ = sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).ray_cast((x, y, 50), (0, 0, -1))
    assert hit
    return place.z


with checking("a small thing that follows everything lies on the mesh's own surface, to millimetres"):
    # At the mesh's points there is no chord between the mesh and the water.
    things = [buoy((x, y, 0.0), damping=0.0, drift=0.0, tilt=0.0) for x, y in ((3.0, 4.0), (-20.5, 11.25), (30, -33))]
    worst = 0.0
    for frame in (1, 30, 100):
        scene.frame_set(frame)
        points = numbers(sea.data)
        for thing in things:
            nearest = points[np.argmin(np.hypot(*(points[:, :2] - thing.location.xy).T))]
            thing.location.xy = nearest[:2]
        bpy.context.view_layer.update()
        bpy.context.view_layer.update()
        for thing in things:
            nearest = points[np.argmin(np.hypot(*(points[:, :2] - thing.location.xy).T))]
            worst = max(worst, abs(thing.matrix_world.translation.z - nearest[2]))
            assert abs(nearest[2]) > 0.0
    print(f"worst {1000 * worst:.3f} mm")
    assert worst < 0.002

with checking("and with drift it is carried as the mesh's points are"):
    rest = numbers(sea.data, "rest_position")
    index = 100 * 257 + 77
    thing = buoy((*rest[index][:2], 0.0), damping=0.0)
    for frame in (2, 50):
        scene.frame_set(frame)
        gap = (thing.matrix_world.translation - Vector(numbers(sea.data)[index])).length
        assert gap < 0.002, gap
    assert abs(thing.delta_rotation_euler.x) + abs(thing.delta_rotation_euler.y) > 1e-3

with checking("any order of frames, the same bits"):
    raft = buoy((5, 5, 0.5), (8, 3, 1), damping=1.0)
    raft.rotation_euler.z = 0.7
    first = {}
    for frame in (1, 2, 3, 40, 3.25):
        scene.frame_set(int(frame), subframe=frame % 1)
        first[frame] = state(raft)
    assert len(set(first.values())) == len(first)
    for frame in (3.25, 40, 1, 3, 2, 40, 1):
        scene.frame_set(int(frame), subframe=frame % 1)
        assert state(raft) == first[frame], frame

with checking("no matter how often it is evaluated"):
    for _ in range(3):
        raft.update_tag()
        bpy.context.view_layer.update()
    assert state(raft) == first[1]

with checking("a larger or heavier thing moves less"):
    spread = {}
    for name, size, damping in (("small", 1, 1), ("large", 30, 1), ("heavy", 30, 3)):
        thing = buoy((0, 0, 0), (size, size, 1), damping=damping)
        spread[name] = []
        for frame in range(1, 200, 10):
            scene.frame_set(frame)
            spread[name].append((thing.delta_location.z, thing.delta_rotation_euler.x))
        bpy.data.objects.remove(thing)
    for column in (0, 1):
        small, large, heavy = (np.std(np.array(spread[name])[:, column]) for name in ("small", "large", "heavy"))
        assert small > 1.1 * large > 1.1 * 1.1 * heavy, (small, large, heavy)

with checking("tilt and drift as asked for"):
    still = buoy((7, -3, 0), (4, 2, 1), tilt=0.0, drift=0.0)
    scene.frame_set(9)
    assert still.delta_location.x == still.delta_location.y == 0.0 and still.delta_location.z != 0.0
    assert tuple(still.delta_rotation_euler) == (0, 0, 0)
    still.pelagic_float.tilt = 1.0
    bpy.context.view_layer.update()
    up = still.matrix_world.to_3x3() @ Vector((0, 0, 1))
    water = Water(sea, scene, bpy.context.evaluated_depsgraph_get())
    east, west, north, south = water.world_heights([(9, -3), (5, -3), (7, -2), (7, -4)])
    assert up.normalized().angle(Vector((-(east - west) / 4, -(north - south) / 2, 1))) < 0.1

with checking("an ocean that is moved, turned and scaled carries its floats along"):
    thing = buoy((4, 2, 0), damping=0.0)
    scene.frame_set(17)
    level = thing.matrix_world.copy()
    change_of_ocean = Matrix.Translation((50, 20, 3)) @ Matrix.Rotation(0.8, 4, "Z") @ Matrix.Scale(2, 4)
    sea.matrix_world = change_of_ocean
    thing.location = change_of_ocean @ Vector((4, 2, 0))
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()
    gap = (thing.matrix_world.translation - change_of_ocean @ level.translation).length
    assert gap < 0.01, gap
    sea.matrix_world = Matrix()

with checking("parents, quaternions and own deltas count"):
    thing = buoy((4, 2, 0), damping=0.0)
    scene.frame_set(18)
    expected = thing.matrix_world.copy()
    bpy.ops.object.empty_add(location=(10, 20, 30), rotation=(0.4, 0.5, 0.6))
    parent = bpy.context.object
    bpy.context.view_layer.update()
    other = buoy((4, 2, 0), damping=0.0, enabled=False)
    other.rotation_mode = "QUATERNION"
    other.delta_location = (-1, 0, 0)
    other.parent = parent
    other.matrix_parent_inverse = parent.matrix_world.inverted()
    other.location.x += 1
    other.pelagic_float.enabled = True
    scene.frame_set(17)
    scene.frame_set(18)
    assert np.allclose(other.matrix_world, expected, atol=2e-5), np.array(other.matrix_world) - np.array(expected)

with checking("what is parented to a floating object goes with it"):
    mast = buoy((5, 5, 4))
    mast.parent = raft
    scene.frame_set(30)
    assert tuple(mast.delta_location) == (0, 0, 0)
    bpy.data.objects.remove(mast)

with checking("the user's own keyframes stay, and are followed"):
    ship = buoy((0, 0, 0), (6, 2, 1))
    for frame, x in ((1, 0.0), (50, 20.0)):
        ship.location.x = x
        ship.keyframe_insert("location", index=0, frame=frame)
    scene.frame_set(50)
    assert ship.location.x == 20.0 and len(compat.curves(ship)) == 1
    here = Water(sea, scene, bpy.context.evaluated_depsgraph_get())
    assert abs(here.world_heights([ship.matrix_world.translation.xy])[0] - ship.matrix_world.translation.z) < 0.5

with checking("with the ocean hidden, too"):
    scene.frame_set(60)
    shown = state(raft)
    sea.hide_set(True)
    sea.hide_render = True
    scene.frame_set(61)
    assert state(raft) != shown
    scene.frame_set(60)
    assert state(raft) == shown
    sea.hide_set(False)

with checking("a setting of the sea moves what floats"):
    before = state(raft)
    change(sea, sea__wind_speed_mps=4.0)
    bpy.context.view_layer.update()
    assert state(raft) != before
    change(sea, sea__wind_speed_mps=14.0)
    bpy.context.view_layer.update()
    assert state(raft) == before

with checking("in the projected grid's sea, too, and in an own mesh's"):
    scene.frame_set(60)
    change(sea, surface__kind="projected-grid", surface__cell_px=30.0)
    bpy.context.view_layer.update()
    assert np.allclose(state(raft)[0], shown[0], atol=0.1) and state(raft) != shown, (state(raft), shown)
    change(sea, surface__kind="patch")
    bpy.context.view_layer.update()
    assert state(raft) == shown
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=100)
    bpy.ops.pelagic.use_mesh()
    own = bpy.context.object
    raft.pelagic_float.ocean = own
    bpy.context.view_layer.update()
    assert state(raft) != shown and np.isfinite(state(raft)[0]).all()
    raft.pelagic_float.ocean = None
    bpy.data.objects.remove(own)
    bpy.context.view_layer.update()
    assert state(raft) == shown

with checking("in renders of an animation, too: the picture shows it where it is at each frame"):
    folder = Path(tempfile.mkdtemp())
    lamp = buoy((0, 0, 0), (1, 1, 1), tilt=0.0, drift=0.0)
    shine = bpy.data.materials.new("Shine")
    shine.use_nodes = True
    shine.node_tree.nodes.clear()
    emission = shine.node_tree.nodes.new("ShaderNodeEmission")
    output = shine.node_tree.nodes.new("ShaderNodeOutputMaterial")
    shine.node_tree.links.new(emission.outputs[0], output.inputs[0])
    lamp.data.materials.append(shine)
    hidden = [obj for obj in scene.objects if obj != lamp and not obj.hide_render]
    for obj in hidden:
        obj.hide_render = True
    bpy.ops.object.camera_add(location=(0, -50, 0), rotation=(math.pi / 2, 0, 0))
    scene.camera = bpy.context.object
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 8.0
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage = "CYCLES", 64, 64, 100
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.world = bpy.data.worlds.new("Black")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes.clear()
    render.filepath = str(folder / "lamp.")
    scene.frame_start, scene.frame_end, scene.frame_step = 20, 60, 20
    bpy.ops.render.render(animation=True)
    rows = {}
    for frame in (20, 40, 60):
        picture = bpy.data.images.load(str(folder / f"lamp.{frame:04}.png"))
        pixels = np.array(picture.pixels).reshape(64, 64, 4)[..., 0] > 0.3  # the rest is a background, almost black
        rows[frame] = (np.average(np.arange(64) + 0.5, weights=pixels.sum(1)) / 64 - 0.5) * 8
        scene.frame_set(frame)
        assert abs(rows[frame] - lamp.matrix_world.translation.z) < 0.06, (frame, rows, lamp.matrix_world.translation.z)
    assert np.ptp(list(rows.values())) > 0.12, rows  # more than both errors that are allowed above
    # With motion blur it is as much longer as it moves while the shutter is open.
    change(sea, shot__time_scale=16.0)
    speeds, lengths = {}, {}
    for frame in range(20, 60):
        scene.frame_set(frame, subframe=0.25)
        late = lamp.matrix_world.translation.z
        scene.frame_set(frame - 1, subframe=0.75)
        speeds[frame] = abs(late - lamp.matrix_world.translation.z)
    fast = max(speeds, key=speeds.get)
    scene.frame_set(fast)
    for blurred in (False, True):
        render.use_motion_blur = blurred
        bpy.ops.render.render(write_still=True)
        pixels = np.array(bpy.data.images.load(render.filepath + "png").pixels).reshape(64, 64, 4)[..., 0]
        lengths[blurred] = (pixels.max(1) > 0.2 * pixels.max()).sum() / 8  # whatever the scene's exposure
    assert speeds[fast] > 0.4 and abs(lengths[True] - lengths[False] - speeds[fast]) < 0.3, (speeds[fast], lengths)
    render.use_motion_blur = False
    change(sea, shot__time_scale=1.0)
    scene.frame_step = 1
    for obj in hidden:
        obj.hide_render = False
    bpy.data.objects.remove(lamp)

with checking("off, it is as it was"):
    other.pelagic_float.enabled = False
    assert tuple(other.delta_location) == (-1, 0, 0) and tuple(other.delta_rotation_quaternion) == (1, 0, 0, 0)
    bpy.ops.object.select_all(action="DESELECT")
    raft.select_set(True)
    bpy.ops.pelagic.float(enabled=False)
    assert state(raft) == ((0, 0, 0), (0, 0, 0), (1, 0, 0, 0))
    scene.frame_set(61)
    assert state(raft) == ((0, 0, 0), (0, 0, 0), (1, 0, 0, 0))
    bpy.ops.pelagic.float()
    scene.frame_set(60)
    assert state(raft) == shown

with checking("undone and redone it floats on"):
    names = sea.name, raft.name
    bpy.ops.ed.undo_push(message="before")
    raft.pelagic_float.damping = 3.0
    bpy.context.view_layer.update()
    heavy = state(raft)
    bpy.ops.ed.undo_push(message="heavy")
    scene.frame_set(9)
    bpy.ops.ed.undo_push(message="another frame")
    for step, expected in ((bpy.ops.ed.undo, heavy), (bpy.ops.ed.undo, shown), (bpy.ops.ed.redo, heavy),
                           (bpy.ops.ed.undo, shown)):
        step()
        scene, sea, raft = bpy.context.scene, *(bpy.data.objects[name] for name in names)
        bpy.context.view_layer.update()
        assert scene.frame_current == 60 and state(raft) == expected

with checking("saved and loaded it floats on, in the same places"):
    path = str(folder / "float.blend")
    name = raft.name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene, sea, raft = bpy.context.scene, bpy.data.objects["Ocean"], bpy.data.objects[name]
    assert state(raft) == shown
    scene.frame_set(61)
    scene.frame_set(60)
    assert state(raft) == shown

with checking("a driver with pelagic_height lies on the water"):
    bpy.context.preferences.filepaths.use_scripts_auto_execute = True
    bpy.ops.object.empty_add(location=(11, 12, 0))
    driven = bpy.context.object
    driver = driven.driver_add("location", 2).driver
    driver.expression = "pelagic_height(11, 12, frame)"
    scene.frame_set(33)
    water = Water(sea, scene, bpy.context.evaluated_depsgraph_get())
    assert abs(driven.matrix_world.translation.z - water.world_heights([(11, 12)])[0]) < 1e-5
    assert abs(water.world_heights([(11, 12)])[0] - mesh_height(11, 12)) < 0.05
    height = bpy.app.driver_namespace["pelagic_height"]
    assert height(11, 12, 33, "Ocean") == height(11, 12) != height(11, 12, 34)

with checking("sample_heights: keyframes, attribute, text"):
    scene.frame_start, scene.frame_end = 1, 5
    bpy.ops.object.empty_add(location=(1, 2, 9))
    empty = bpy.context.object
    bpy.ops.pelagic.sample_heights(into="KEYFRAMES")
    assert len(compat.curves(empty)[0].keyframe_points) == 5
    scene.frame_set(4)
    expected = Water(sea, scene, bpy.context.evaluated_depsgraph_get()).world_heights([(1, 2)])[0]
    assert abs(empty.matrix_world.translation.z - expected) < 1e-5
    bpy.ops.pelagic.sample_heights(into="TEXT")
    rows = bpy.data.texts["Ocean heights.csv"].as_string().splitlines()
    assert rows[0] == "frame,object,x,y,z" and len(rows) == 6 and abs(float(rows[4].split(",")[4]) - expected) < 1e-4
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=10)
    grid = bpy.context.object
    bpy.ops.pelagic.sample_heights(into="ATTRIBUTE")
    sampled = numbers(grid.data, "sea_height")
    places = numbers(grid.data)
    assert np.allclose(sampled, Water(sea, scene, bpy.context.evaluated_depsgraph_get()).world_heights(places[:, :2]))
    assert sampled.std() > 0.01
