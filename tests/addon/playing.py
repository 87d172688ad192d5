"""An ocean follows the timeline and its settings, and is the core's."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import meshes, ocean, play

scene = bpy.context.scene

with checking("the attributes equal the core's for the same shot"):
    fresh_file()
    scene = bpy.context.scene
    obj = add_ocean(sea__wind_speed_mps=17.0, surface__size_m=150.0)
    scene.frame_set(31)
    shot = ocean.scene_of(obj, scene)
    assert shot.sea.wind_speed_mps == 17.0 and shot.surface.resolution == 32
    rest, _ = pelagic.patch(150.0, 32)
    frame = pelagic.Frame(pelagic.Sea(shot))
    frame.set(shot.shot.time_s(31))
    core = frame.evaluate(rest)
    for name, product in (("position", "position"), ("velocity", "velocity"), ("slope_variance", "slope_variance"),
                          ("whitecap_coverage", "coverage")):
        assert np.array_equal(numbers(evaluated_mesh(obj), name), core[product]), name
    assert core["coverage"].max() > 0.01 and core["position"][:, 2].std() > 0.3

with checking("with a horizon the patch's vertices are the same"):
    near = numbers(obj.data)
    obj.pelagic.horizon = True
    bpy.context.view_layer.update()
    far = numbers(obj.data)
    assert len(far) > len(near) and np.array_equal(far[:len(near)], near)
    assert np.abs(far[:, :2]).max() == 90e3 and np.abs(far[far[:, 0] > 20e3, 2]).max() < 1e-3

with checking("the patch comes first, and the mesh is closed to the horizon"):
    rest, quads = pelagic.patch(150.0, 32)
    at_rest = numbers(obj.data, "rest_position").astype(np.float64)
    assert np.array_equal(at_rest[:len(rest), :2], rest)
    corners = np.empty(len(obj.data.loops), np.int32)
    obj.data.loops.foreach_get("vertex_index", corners)
    corners = corners.reshape(-1, 4)
    assert np.array_equal(corners[:len(quads)], quads) and len(np.unique(corners)) == len(at_rest)
    # Every quad faces up, and together they are the outermost square without gap or overlap.
    a, b, c, d = (at_rest[corners[:, i]] for i in range(4))
    area = 0.5 * ((c - a)[:, 0] * (d - b)[:, 1] - (c - a)[:, 1] * (d - b)[:, 0])
    side = 2 * at_rest.max()
    assert area.min() > 0 and side / 2 == 90e3 and abs(area.sum() / side**2 - 1) < 1e-6

with checking("the UV map is the bake's"):
    uv = np.empty((len(corners), 4, 2), np.float32)
    obj.data.uv_layers["UVMap"].data.foreach_get("uv", uv.ravel())
    assert (uv[:len(quads)].min(), uv[:len(quads)].max()) == (0.0, 1.0)
    assert np.allclose(uv[0], [[0, 0], [1 / 32, 0], [1 / 32, 1 / 32], [0, 1 / 32]], atol=1e-6)

with checking("frame 1 → 250 → 1 gives the same bits"):
    scene.frame_set(1)
    first = {name: numbers(obj.data, name) for name in ("position", "velocity", "slope_variance", "whitecap_coverage")}
    scene.frame_set(250)
    assert not np.array_equal(numbers(obj.data), first["position"])
    scene.frame_set(1)
    for name, before in first.items():
        assert np.array_equal(numbers(obj.data, name), before), name

with checking("played in even steps, and after a jump, each frame is its own"):
    alone = {}
    for frame in (12, 9, 10, 5, 3, 8, 4, 6, 11):
        scene.frame_set(frame)
        alone[frame] = numbers(obj.data)
    for frame in (3, 4, 5, 6, 10, 11, 12, 8, 9):
        scene.frame_set(frame)
        assert np.array_equal(numbers(obj.data), alone[frame]), frame

with checking("a changed setting is a changed sea; put back, it is the same again"):
    before = numbers(obj.data)
    change(obj, sea__wind_speed_mps=8.0)
    assert numbers(obj.data)[:, 2].std() < 0.6 * before[:, 2].std()
    change(obj, sea__wind_speed_mps=17.0)
    assert np.array_equal(numbers(obj.data), before)

with checking("an effect that is off has no attribute"):
    change(obj, effects__whitecaps=False)
    assert "whitecap_coverage" not in obj.data.attributes
    change(obj, effects__whitecaps=True)
    assert "whitecap_coverage" in obj.data.attributes

with checking("foam that lives has its age and what breaks now, the same after a jump as when it plays, and the core's"):
    obj.pelagic.effects.foam_decay_s = 3.0
    scene.frame_set(20)
    shot = ocean.scene_of(obj, scene)
    rest, _ = pelagic.patch(shot.surface.size_m, shot.surface.resolution)
    products = ("position", "velocity", "slope_variance", "coverage", "foam_active", "foam_age")
    frame = pelagic.Frame(pelagic.Sea(shot, products))
    named = (("whitecap_coverage", "coverage"), ("foam_active", "foam_active"), ("foam_age", "foam_age"))
    for number in (20, 90, 91, 92):
        scene.frame_set(number)
        frame.set(shot.shot.time_s(number))
        core = frame.evaluate(rest)
        for name, product in named:
            assert np.array_equal(numbers(obj.data, name)[:len(rest)], core[product]), (number, name)
    assert 1.0 < core["foam_age"].max() < 9.0 and (core["coverage"] > core["foam_active"] + 0.05).any()
    obj.pelagic.effects.foam_decay_s = 0.0
    bpy.context.view_layer.update()
    assert "foam_age" not in obj.data.attributes and "foam_active" not in obj.data.attributes

with checking("played in even steps, when frames are computed ahead, two oceans of one sea show what they do at a jump"):
    bpy.ops.object.duplicate()
    twin = bpy.context.object
    frames = (40, 42, 44, 46, 45, 44, 43)
    jumped = {}
    for frame in frames:
        scene.frame_set(1)
        scene.frame_set(frame)
        jumped[frame] = numbers(obj.data)
    for frame in frames:
        scene.frame_set(frame)
        for mesh in (obj.data, twin.data):
            assert np.array_equal(numbers(mesh), jumped[frame]), frame
    bpy.data.objects.remove(twin)
    bpy.context.view_layer.objects.active = obj

with checking("the UV map comes and goes"):
    obj.pelagic.uv_map = False
    bpy.context.view_layer.update()
    assert not obj.data.uv_layers
    obj.pelagic.uv_map = True
    bpy.context.view_layer.update()
    uv = np.empty(2 * len(obj.data.loops), np.float32)
    obj.data.uv_layers["UVMap"].data.foreach_get("uv", uv)
    assert uv[:2].tolist() == [0.0, 0.0]

with checking("velocity is there where it is asked for, or motion is blurred, and nothing else moves by that"):
    places = numbers(obj.data)
    obj.pelagic.velocity = False
    bpy.context.view_layer.update()
    assert "velocity" not in obj.data.attributes and np.array_equal(numbers(obj.data), places)
    scene.render.use_motion_blur = True
    bpy.context.view_layer.update()
    assert numbers(obj.data, "velocity").any() and np.array_equal(numbers(obj.data), places)
    scene.render.use_motion_blur = False
    bpy.context.view_layer.update()
    assert "velocity" not in obj.data.attributes
    fresh = ocean.make("Fresh", bpy.context.collection)
    assert not fresh.pelagic.velocity and not fresh.pelagic.uv_map
    bpy.data.objects.remove(fresh)
    obj.pelagic.velocity = True
    bpy.context.view_layer.update()

with checking("a hidden ocean costs nothing"):
    obj.hide_set(True)
    before = numbers(obj.data)
    scene.frame_set(9)
    assert np.array_equal(numbers(obj.data), before)
    obj.hide_set(False)
    bpy.context.view_layer.update()
    assert not np.array_equal(numbers(obj.data), before)

with checking("simulation_of gives the sea that plays, at any time"):
    simulation = play.simulation_of(obj)
    assert simulation.sea.significant_height_m > 1 and simulation.scene.sea.wind_speed_mps == 17.0
    assert simulation.frame_at(3.0).time_s == 3.0 and simulation.frame_at(1.0).time_s == 1.0

with checking("the projected grid is the core's for the camera, at every frame"):
    fresh_file()
    scene = bpy.context.scene
    obj = add_ocean(surface__kind="projected-grid", surface__cell_px=40.0)
    camera = scene.camera
    camera.rotation_euler.y = 0.1  # rolled
    for frame, height_m in ((1, 3.0), (40, 30.0)):
        camera.location.z = height_m
        camera.keyframe_insert("location", frame=frame)

    def core_grid(frame):
        shot = ocean.scene_of(obj, scene)
        view = pelagic.View.of_scene(shot, frame)
        sea = pelagic.Sea(shot, views=[view])
        grid = sea.projected_grid(view)
        answer = pelagic.Frame(sea)
        answer.set(shot.shot.time_s(frame))
        made = answer.evaluate(grid.rest_m, grid.origin_m, cell_m=grid.cell_m, pixel_m=grid.cell_m,
                               cell_axis_m=grid.cell_axis_m, pixel_axis_m=grid.cell_axis_m)
        made["position"][:, :2] += np.array(grid.origin_m, np.float32)
        return made

    counts = set()
    for frame in (1, 20, 40, 1):
        scene.frame_set(frame)
        core, mine = core_grid(frame), numbers(obj.data)
        assert core["position"].shape == mine.shape, frame
        counts.add(len(mine))
        # The camera's axes are single precision in Blender, and go through a point in the shot.
        near = np.linalg.norm(mine - camera.matrix_world.translation, axis=1) < 200
        assert np.abs(mine - core["position"])[near].max() < 0.05, np.abs(mine - core["position"])[near].max()
        assert "UVMap" in obj.data.uv_layers and len(obj.data.attributes["rest_position"].data) == len(mine)
    assert len(counts) > 1, "the grid's size follows the camera"

with checking("its cells are coarser where the viewport's share is less"):
    before = len(obj.data.vertices)
    obj.pelagic.viewport_percentage = 50
    bpy.context.view_layer.update()
    assert 0.2 * before < len(obj.data.vertices) < 0.35 * before

with checking("a budget of vertices holds in the viewport, of the grid and of a patch; the panel's numbers are the mesh's and the render's"):
    obj.pelagic.viewport_percentage, obj.pelagic.viewport_vertices = 100, 3000
    scene.frame_set(1)
    whole = len(core_grid(1)["position"])
    assert 2700 < len(obj.data.vertices) <= 3000 and play.vertices_of(obj) == (len(obj.data.vertices), whole)
    obj.pelagic.viewport_percentage = 10  # the smaller counts
    bpy.context.view_layer.update()
    assert len(obj.data.vertices) < 0.015 * whole
    obj.pelagic.viewport_percentage = 100
    for horizon in (False, True):
        obj.pelagic.surface.kind, obj.pelagic.horizon = "patch", horizon
        for budget in (0, 700, 1):
            obj.pelagic.viewport_vertices = budget
            bpy.context.view_layer.update()
            count = len(obj.data.vertices)
            whole = count if budget == 0 else whole
            assert (0.7 * budget < count <= budget or budget < 2) and play.vertices_of(obj) == (count, whole), (budget, count)
    obj.pelagic.surface.kind, obj.pelagic.viewport_vertices = "projected-grid", 500_000
    bpy.context.view_layer.update()

with checking("it follows a camera that is moved by hand, also under water and looking up"):
    camera.animation_data_clear()
    for height_m, tilt in ((2.0, 1.5), (-3.0, 1.5), (5.0, 2.8), (5.0, 0.0)):
        camera.location.z, camera.rotation_euler.x = height_m, tilt
        bpy.context.view_layer.update()
        assert not play.simulation_of(obj).problem and np.isfinite(numbers(obj.data)).all()

with checking("without a camera it says so, and goes on with one"):
    scene.camera = None
    scene.frame_set(2)
    assert "camera" in play.simulation_of(obj).problem
    scene.camera = camera
    scene.frame_set(3)
    assert not play.simulation_of(obj).problem

with checking("velocity is per second of the screen, and the clock is the shot's"):
    fresh_file()
    scene = bpy.context.scene
    obj = add_ocean()
    scene.frame_set(25)
    full, there = numbers(obj.data, "velocity"), numbers(obj.data)
    change(obj, shot__time_scale=0.5)
    scene.frame_set(49)
    assert np.array_equal(numbers(obj.data), there) and np.array_equal(numbers(obj.data, "velocity"), 0.5 * full)
    change(obj, shot__time_scale=1.0, shot__time_offset_s=1.0)
    scene.frame_set(1)
    assert np.array_equal(numbers(obj.data), there)

with checking("a loop is a loop"):
    change(obj, shot__time_offset_s=0.0, shot__loop_s=2.0)
    scene.frame_set(1)
    first = numbers(obj.data)
    scene.frame_set(25)
    assert not np.array_equal(numbers(obj.data), first)
    scene.frame_set(49)
    assert np.abs(numbers(obj.data) - first).max() < 1e-3

with checking("on a render's own thread a frame is tagged, and the window gets no note that its loop may be reading"):
    class Told:
        attributes, vertices = {}, type("Vertices", (), {"foreach_set": lambda *_: None})()

        def __init__(self):
            self.how = []

        def update(self):
            self.how.append("update")

        def update_tag(self):
            self.how.append("update_tag")

    # From 4.0 on update() also drops normals that the evaluated mesh shares.
    for own_thread, how in ((False, "update"), (True, "update" if bpy.app.version >= (4, 0) else "update_tag")):
        told = Told()
        put = threading.Thread(target=meshes.put_frame, args=(told, {"position": np.zeros((1, 3), np.float32)}))
        put.start() if own_thread else put.run()
        if own_thread:
            put.join()
        assert told.how == [how], told.how
