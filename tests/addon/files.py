"""Several oceans, duplicates, undo, files, deletion, memory."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import compat, ocean, play, properties

folder = Path(tempfile.mkdtemp())


def select(obj):
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def go_to(frame):
    bpy.context.scene.frame_set(frame)


with checking("three oceans, each with its own sea"):
    fresh_file()
    three = [add_ocean(sea__wind_speed_mps=wind) for wind in (4.0, 12.0, 24.0)]
    go_to(8)
    heights = [numbers(obj.data)[:, 2].std() for obj in three]
    assert heights[0] < heights[1] < heights[2], heights

with checking("a duplicate goes its own way; a linked one shares the mesh, which its first ocean drives"):
    first = three[1]
    select(first)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy.data != first.data
    change(copy, sea__wind_speed_mps=30.0)
    go_to(9)
    assert numbers(copy.data)[:, 2].std() > 2 * numbers(first.data)[:, 2].std()
    select(first)
    bpy.ops.object.duplicate_move_linked()
    linked = bpy.context.object
    assert linked.data == first.data
    before = numbers(first.data)
    change(linked, sea__wind_speed_mps=30.0)
    assert np.array_equal(numbers(first.data), before)
    assert play.simulation_of(linked) is play.simulation_of(first)

with checking("renamed oceans play on, also with swapped names"):
    low, high = three[0], three[2]
    go_to(10)
    expected = numbers(low.data), numbers(high.data)
    low.name, high.name = "swap", low.name
    low.name = "Ocean.002"
    go_to(11)
    go_to(10)
    assert np.array_equal(numbers(low.data), expected[0]) and np.array_equal(numbers(high.data), expected[1])

with checking("saved and loaded: the same settings, the same sea, playing"):
    path = str(folder / "three.blend")
    names = sorted(obj.name for obj in ocean.oceans())
    expected = {obj.name: numbers(obj.data) for obj in ocean.oceans()}
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile()
    bpy.ops.wm.open_mainfile(filepath=path)
    assert sorted(obj.name for obj in ocean.oceans()) == names
    go_to(40)
    go_to(10)
    for obj in ocean.oceans():
        assert np.array_equal(numbers(obj.data), expected[obj.name]), obj.name

with checking("what is generated isn't in the file, and is there again after saving and loading; without it there is a marker"):
    fresh_file()
    scene = bpy.context.scene
    scene.frame_set(7)
    scene.render.resolution_x, scene.render.resolution_y, scene.camera.location = 160, 90, (0, 0, 9)
    seas = {kind: add_ocean(surface__kind=kind, sea__wind_speed_mps=12.0) for kind in ("patch", "projected-grid")}
    bpy.ops.mesh.primitive_cube_add(size=20)
    bpy.ops.pelagic.use_cage()
    seas["cage"] = bpy.context.object
    painted = add_ocean()
    painted.vertex_groups.new(name="By hand").add([3], 0.5, "ADD")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=50, y_subdivisions=50, size=40)
    bpy.ops.pelagic.use_mesh()
    own = bpy.context.object
    held = {obj.name: (obj.data.name, numbers(obj.data), list(obj.data.attributes.keys()), obj.data.materials[:])
            for obj in ocean.oceans()}
    meshes_before = set(bpy.data.meshes)

    def expect_as_before():
        for obj in ocean.oceans():
            name, positions, attributes, materials = held[obj.name]
            assert (obj.data.name, list(obj.data.attributes.keys())) == (name, attributes), obj.name
            assert np.array_equal(numbers(obj.data), positions) and len(obj.data.materials) == len(materials), obj.name

    light_file, copied = str(folder / "light.blend"), str(folder / "copied.blend")  # Blender reads no library out of its own file
    for file in (light_file, copied):
        bpy.ops.wm.save_as_mainfile(filepath=file, copy=file == copied)
        assert set(bpy.data.meshes) == meshes_before
        expect_as_before()
    assert refused(lambda: bpy.ops.wm.save_as_mainfile(filepath=str(folder / "no" / "where.blend")), "no")
    scene.frame_set(7)
    expect_as_before()
    in_file = {}
    with bpy.data.libraries.load(copied) as (source, target):
        target.meshes = list(source.meshes)
    for mesh, name in zip(target.meshes, source.meshes):
        in_file[name] = len(mesh.polygons)
        bpy.data.meshes.remove(mesh)
    for obj in seas.values():
        assert in_file[obj.data.name] == 128 and "needs the add-on Pelagic Ocean" in obj["Pelagic Ocean"], in_file
    for obj in (painted, own):
        assert in_file[obj.data.name] == len(obj.data.polygons), obj.name
    bpy.ops.wm.open_mainfile(filepath=light_file)
    expect_as_before()
    assert "By hand" in bpy.data.objects["Ocean.002"].vertex_groups

with checking("a file of the first version gets today's number, and keeps what every mesh had then"):
    names_of_old = [obj.name for obj in ocean.oceans()]
    for obj in ocean.oceans():
        obj.pelagic.version = 0
        for name in ("uv_map", "velocity"):
            obj.pelagic.property_unset(name)
        obj.pelagic.sea.property_unset("growth")
        obj.pelagic.light.turbidity = 4.5
        obj.pelagic.effects.property_unset("whitecap_law")
        obj.pelagic.water.property_unset("body")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "old.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "old.blend"))
    assert [obj.pelagic.version for obj in ocean.oceans()] == [properties.VERSION] * len(names_of_old)
    assert all(obj.pelagic.uv_map and obj.pelagic.velocity for obj in ocean.oceans())
    for obj in ocean.oceans():  # the first edition's where nobody had chosen
        got = (obj.pelagic.sea.growth, obj.pelagic.effects.whitecap_law, obj.pelagic.light.turbidity, obj.pelagic.water.body)
        assert got == ("height", "monahan-1980", 4.5, False), got

with checking("words of before, when a drop-down rounded their numbers, or an F-curve did: those that are chosen, and those in animations"):
    old = bpy.data.objects[names_of_old[0]]
    before = {("surface", "kind"): "projected-grid", ("water", "type"): old.pelagic.water.type, ("sea", "spectrum"): "jonswap"}
    kind, vessel = old.pelagic.surface.kind, old.pelagic.waves.vessels.add()

    def put(group, name, number):
        kept = group.bl_system_properties_get(do_create=True) if hasattr(group, "bl_system_properties_get") else group
        kept[name] = number

    for version, number in ((5, lambda word: properties.number_of(word, 31)), (5, lambda word: int(np.float32(properties.number_of(word, 31)))),
                            (6, lambda word: properties.number_of(word, 24))):
        old.pelagic.version = version
        for (table, name), word in before.items():
            put(getattr(old.pelagic, table), name, number(word))
        put(vessel, "interpolation", number("linear"))
        old.animation_data_clear()
        for table, name, words in (("sea", "spectrum", ("jonswap", "pierson-moskowitz")), ("sea", "short_waves", ("none", "elfouhaily"))):
            for frame, word in enumerate(words, 1):
                old.keyframe_insert(f"pelagic.{table}.{name}", frame=frame)
                curve = next(each for each in compat.curves(old) if each.data_path == f"pelagic.{table}.{name}")
                curve.keyframe_points[-1].co.y = number(word)
        old.animation_data.nla_tracks.new().strips.new("Sea", 1, old.animation_data.action.copy())
        driver = old.driver_add("pelagic.effects.spray_law").driver
        driver.expression = f"{number('monahan-1986')} if frame < 1000 else {number('andreas-1998')}"
        ocean.migrate(old)
        assert old.pelagic.version == properties.VERSION and (vessel.interpolation, vessel.name) == ("linear", "1")
        for (table, name), word in before.items():
            assert getattr(getattr(old.pelagic, table), name) == word, (table, name, word)
        of_words = [curve for curve in compat.curves_of_actions() if curve.data_path in ("pelagic.sea.spectrum", "pelagic.sea.short_waves")]
        assert len(of_words) >= 4
        for curve in of_words:
            words = ("jonswap", "pierson-moskowitz") if curve.data_path.endswith("spectrum") else ("none", "elfouhaily")
            assert [point.co.y for point in curve.keyframe_points] == [properties.number_of(word) for word in words], curve.data_path
        assert driver.expression == f"{properties.number_of('monahan-1986')} if frame < 1000 else {properties.number_of('andreas-1998')}"
    old.animation_data_clear()
    old.pelagic.waves.vessels.clear()
    old.pelagic.surface.kind = kind

with checking("a file of the second edition has its water, and today's waves"):
    for obj in ocean.oceans():
        obj.pelagic.version = 3
        obj.pelagic.sea.property_unset("growth")
        obj.pelagic.water.property_unset("body")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "second.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "second.blend"))
    for obj in ocean.oceans():
        got = (obj.pelagic.sea.growth, obj.pelagic.water.body)
        assert got == (obj.pelagic.sea.bl_rna.properties["growth"].default, False), got

with checking("a file from before water was seen through by itself keeps its body, and opaque water"):
    for obj in ocean.oceans():
        obj.pelagic.version = 4
        obj.pelagic.water.property_unset("body")
        obj.pelagic.property_unset("see_through_by_hand")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "fourth.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "fourth.blend"))
    for obj in ocean.oceans():
        got = (obj.pelagic.water.body, obj.pelagic.see_through_by_hand, obj.pelagic.see_through, obj.pelagic.version)
        assert got == (True, True, False, properties.VERSION), got

with checking("appended into another file, it plays there"):
    fresh_file()
    with bpy.data.libraries.load(path) as (source, target):
        target.objects = [names[0]]
    obj = target.objects[0]
    bpy.context.collection.objects.link(obj)
    go_to(10)
    assert np.array_equal(numbers(obj.data), expected[names[0]])

with checking("one of an older file that is appended plays at once, by a frame or by an update"):
    fresh_file()
    older = add_ocean(sea__spectrum="jonswap")
    put(older.pelagic.sea, "spectrum", properties.number_of("jonswap", 24))
    older.pelagic.version = 6
    bpy.data.libraries.write(str(folder / "older.blend"), {older})
    for look_again in (lambda: go_to(4), lambda: [bpy.context.view_layer.update() for _ in range(2)]):
        fresh_file()
        with bpy.data.libraries.load(str(folder / "older.blend")) as (source, target):
            target.objects = list(source.objects)
        obj = next(each for each in target.objects if ocean.is_ocean(each))
        assert obj.pelagic.version == 6
        bpy.context.collection.objects.link(obj)
        look_again()
        assert obj.pelagic.sea.spectrum == "jonswap" and play.simulation_of(obj).sea and not play.simulation_of(obj).problem

def link_seas(path):
    with bpy.data.libraries.load(path, link=True) as (source, target):
        target.collections = ["Seas"]
    return target.collections[0]


def instance_of(collection):
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    bpy.context.collection.objects.link(instance)
    return instance


with checking("linked from another file, instanced, or overridden, it plays as at home, and a render has it"):
    fresh_file()
    for horizon in (False, True):
        add_ocean(horizon=horizon)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=50, y_subdivisions=50, size=40)
    bpy.ops.pelagic.use_mesh()
    names = [obj.name for obj in ocean.oceans()]
    seas_collection = bpy.data.collections.new("Seas")
    bpy.context.scene.collection.children.link(seas_collection)
    for name in names:
        seas_collection.objects.link(bpy.data.objects[name])
    at_home = {}
    for frame in (1, 12):
        go_to(frame)
        at_home[frame] = {name: (numbers(bpy.data.objects[name].data), numbers(bpy.data.objects[name].data, "slope_variance"))
                          for name in names}
    seas_file = str(folder / "seas.blend")
    bpy.ops.wm.save_as_mainfile(filepath=seas_file)

    def expect_at_home(objects, frame):
        for obj in objects:
            held = at_home[frame][obj.name]
            assert np.array_equal(numbers(obj.data), held[0]) and np.array_equal(numbers(obj.data, "slope_variance"), held[1]), obj.name
            assert obj.data.library and obj.data.materials[0] and (obj.pelagic.own_mesh or obj.data.polygons[3].use_smooth)

    for how in ("link", "instance", "override"):
        fresh_file()
        collection = link_seas(seas_file)
        objects = [obj for obj in collection.objects if ocean.is_ocean(obj)]
        if how == "link":
            bpy.context.collection.children.link(collection)
        else:
            instance = instance_of(collection)
        if how == "override":
            collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, reference=instance)
            objects = [obj for obj in bpy.data.objects if ocean.is_ocean(obj) and obj.override_library]
            changed, changed_name = objects[0], objects[0].name
            settings = changed.pelagic
            settings.water.type, settings.output.attributes, settings.light.turbidity = "turbid", {"velocity"}, 4.0
            for height_m in (0.0, 0.0):  # which leave the waves
                properties.add_row(settings.sea.swell).height_m = height_m
            changed.pelagic_bake.folder, changed.pelagic_in_light.proxy = "//elsewhere", 30
        assert len(objects) == 3
        for frame in (12, 1):
            go_to(frame)
            expect_at_home(objects, frame)
        assert all(play.simulation_of(obj).sea for obj in objects)
        shot_file = str(folder / "shot.blend")
        bpy.ops.wm.save_as_mainfile(filepath=shot_file)
        fresh_file()
        with bpy.data.libraries.load(shot_file) as (source, _):
            assert not source.meshes, source.meshes
        bpy.ops.wm.open_mainfile(filepath=shot_file)
        if how == "override":  # what it has its own way is in the file
            changed = next(obj for obj in ocean.oceans() if obj.override_library and obj.name == changed_name)
            settings = changed.pelagic
            assert (settings.water.type, settings.output.attributes, settings.light.turbidity) == ("turbid", {"velocity"}, 4.0)
            assert len(settings.sea.swell) == 2, len(settings.sea.swell)
            assert (changed.pelagic_bake.folder, changed.pelagic_in_light.proxy) == ("//elsewhere", 30)
        render = bpy.context.scene.render
        render.engine, render.resolution_percentage = "CYCLES", 2
        bpy.context.scene.cycles.samples, bpy.context.scene.cycles.use_denoising = 1, False
        bpy.context.scene.frame_current = 12
        bpy.ops.render.render()
        expect_at_home([obj for obj in ocean.oceans() if obj.library is None or how != "override"], 12)

with checking("in a collection that is there only as an instance, it plays"):
    fresh_file()
    obj = add_ocean()
    collection = bpy.data.collections.new("Seas")
    collection.objects.link(obj)
    bpy.context.collection.objects.unlink(obj)
    instance_of(collection)
    go_to(3)
    before = numbers(obj.data)
    go_to(9)
    assert not np.array_equal(numbers(obj.data), before)

STEPS = 20 if at_night() else 8
with checking(f"undo and redo, {STEPS} times each"):
    fresh_file()
    bpy.ops.ed.undo_push(message="start")
    obj = add_ocean()
    expected = []
    for step in range(STEPS):
        if step % 4 == 3:
            go_to(step)
        change(obj, sea__wind_speed_mps=3.0 + step)
        bpy.ops.ed.undo_push(message=f"wind {step}")
        expected.append((bpy.context.scene.frame_current, 3.0 + step, numbers(obj.data)))

    def agrees(step):
        sea = bpy.context.scene.objects["Ocean"]
        frame, wind, positions = expected[step]
        assert bpy.context.scene.frame_current == frame and sea.pelagic.sea.wind_speed_mps == wind
        bpy.context.view_layer.update()
        assert np.array_equal(numbers(sea.data), positions), step
        go_to(frame)
        assert np.array_equal(numbers(sea.data), positions), step

    for step in reversed(range(STEPS - 1)):
        bpy.ops.ed.undo()
        agrees(step)
    for step in range(1, STEPS):
        bpy.ops.ed.redo()
        agrees(step)
    # A step that was kept before the mesh had followed the setting.
    obj = bpy.context.scene.objects["Ocean"]
    obj.pelagic.sea.wind_speed_mps = 30.0
    bpy.ops.ed.undo_push(message="wind 30")
    bpy.context.view_layer.update()
    followed = numbers(obj.data)
    bpy.ops.ed.undo_push(message="nothing")
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert np.array_equal(numbers(bpy.context.scene.objects["Ocean"].data), followed)
    bpy.ops.ed.undo()
    for _ in range(STEPS):
        bpy.ops.ed.undo()
    assert not ocean.oceans()
    go_to(3)

with checking("a deleted ocean's simulation is freed"):
    fresh_file()
    obj = add_ocean()
    go_to(2)
    assert list(play._simulations) == [obj.name]
    bpy.data.objects.remove(obj)
    go_to(3)
    assert not play._simulations and not list(play._built)

FRAMES = 100 if at_night() else 40
with checking(f"{2 * FRAMES} frames of scrubbing, {FRAMES // 2} settings: the resident size stays flat"):
    obj = add_ocean(surface__resolution=128, effects__foam_decay_s=0.5)
    order = np.random.default_rng(1).integers(1, 250, FRAMES)

    def scrub():
        for step, frame in enumerate(order):
            if step % 4 == 0:
                change(obj, sea__wind_speed_mps=5.0 + frame / 25)
            go_to(int(frame))
        return resident_mib()

    # A round ends with the sea that the round before ended with: what differs is what was not freed. The wind decides how
    # much of foam's past there is, so that seas of two winds can't be compared.
    before = scrub()
    grown = scrub() - before
    print(f"resident: {before:.0f} MiB, then {grown:+.1f} MiB")
    assert grown < 20

with checking("keyframed settings: each frame has its own sea"):
    obj = add_ocean()
    obj.pelagic.sea.wind_speed_mps = 4.0
    obj.pelagic.sea.keyframe_insert("wind_speed_mps", frame=1)
    obj.pelagic.sea.wind_speed_mps = 24.0
    obj.pelagic.sea.keyframe_insert("wind_speed_mps", frame=11)
    heights = []
    for frame in (1, 6, 11):
        go_to(frame)
        heights.append(numbers(obj.data)[:, 2].std())
    assert heights[0] < heights[1] < heights[2], heights

with checking("a render has its own resolution, and the viewport gets its own back"):
    fresh_file()
    obj = add_ocean()
    obj.pelagic.viewport_vertices = 90
    bpy.context.view_layer.update()
    assert len(obj.data.vertices) == 9**2
    counts = []
    bpy.app.handlers.render_post.append(lambda *_: counts.append(len(obj.data.vertices)))
    render = bpy.context.scene.render
    render.engine, render.resolution_percentage, render.filepath = "CYCLES", 2, str(folder / "picture")
    bpy.context.scene.cycles.samples, bpy.context.scene.cycles.use_denoising = 1, False
    bpy.ops.render.render()
    assert counts == [33**2], counts
    bpy.context.view_layer.update()
    assert len(obj.data.vertices) == 9**2
