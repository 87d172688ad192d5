"""Drops of spray: those of the core, at each frame; come, gone, saved and undone with their key; and as Cycles sees them."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import drops, light, ocean, play
from pictures import cycles_exr

folder = Path(tempfile.mkdtemp())
known = {}  # the core's, of settings and an eye


def all_that_is_theirs():
    kinds = (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.node_groups, bpy.data.images)
    return [each for kind in kinds for each in kind if drops.MARK in each]


def stormy():
    """A small sea that breaks, before a camera near the water."""
    fresh_file()
    camera = bpy.context.scene.camera
    camera.location, camera.rotation_euler = (3.0, -20.0, 5.0), (1.4, 0.0, 0.0)
    sea = add_ocean(sea__wind_speed_mps=11.0, surface__size_m=40.0, effects__spray=True)
    for size_m, resolution in ((150.0, 96), (31.0, 64)):
        row = sea.pelagic.waves.cascades.add()
        row.size_m, row.resolution = size_m, resolution
    return sea


def in_air(sea, frame, eye):
    """The core's own; eye None: over the patch."""
    shot = ocean.scene_of(sea, bpy.context.scene)
    asked = repr((shot.sea, shot.effects, eye))
    if asked not in known:
        known[asked] = pelagic.SprayDrops(pelagic.Sea(shot, ["position"]), None if eye else shot.surface.size_m)
    return known[asked].in_air(shot.shot.time_s(frame), eye=eye)


def expect_the_core(sea, frame, eye=(3.0, -20.0, 5.0)):
    mesh, core = drops.drops_of(sea).data, in_air(sea, frame, eye)
    assert len(core["id"]) > 100 and np.array_equal(numbers(mesh), core["position"].astype(np.float32)), (len(core["id"]), len(mesh.vertices))
    for name, values in (("radius", core["width_m"] / 2), ("opacity", core["opacity"]), ("velocity", core["velocity"])):
        assert np.allclose(numbers(mesh, name), values * (0.5 if name == "velocity" else 1.0), rtol=1e-6), name
    return core


with checking("off there is nothing; on, an object below the ocean, its vertices the core's drops of the frame"):
    sea = stormy()
    assert not all_that_is_theirs()
    change(sea, effects__spray_drops=True, shot__time_scale=0.5)
    made = drops.drops_of(sea)
    assert made.parent == sea and not made.visible_shadow and made.matrix_world == sea.matrix_world
    bpy.context.scene.frame_set(9)
    first = expect_the_core(sea, 9)
    bpy.context.scene.frame_set(10)
    assert set(expect_the_core(sea, 10)["id"]) != set(first["id"])
    assert bpy.context.scene.cycles.transparent_max_bounces == drops.LAYERS

with checking("they follow the camera, a turned ocean, settings; without a camera they are the patch's"):
    camera = bpy.context.scene.camera
    sea.rotation_euler.z, sea.location.x = np.pi / 2, 100.0
    camera.location = (120.0, 4.0, 5.0)
    bpy.context.view_layer.update()
    core = in_air(sea, 10, tuple(sea.matrix_world.inverted() @ camera.location))  # 4, -20, 5
    assert len(core["id"]) == len(made.data.vertices) and np.allclose(numbers(made.data), core["position"], atol=1e-5)
    sea.rotation_euler.z, sea.location.x, camera.location = 0.0, 0.0, (3.0, -20.0, 5.0)
    change(sea, effects__spray_gain=3.0)
    expect_the_core(sea, 10)
    bpy.context.scene.camera = None
    bpy.context.view_layer.update()
    core = expect_the_core(sea, 10, None)
    assert np.abs(core["position"][:, :2]).max() < 20.0
    bpy.context.scene.camera = camera

with checking("of a hidden ocean none; hidden themselves they are let alone"):
    sea.hide_set(True)
    bpy.context.view_layer.update()
    assert not made.data.vertices
    sea.hide_set(False)
    bpy.context.view_layer.update()
    made.hide_set(True)
    bpy.context.scene.frame_set(11)
    expect_the_core(sea, 10)
    made.hide_set(False)
    bpy.context.view_layer.update()
    expect_the_core(sea, 11)

with checking("nothing of them is in a file; opened, they are there again"):
    file = str(folder / "drops.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file, copy=True)
    expect_the_core(sea, 11)
    with bpy.data.libraries.load(file) as (source, target):
        target.meshes = [made.data.name]
    assert not target.meshes[0].vertices and drops.MARK in target.meshes[0]
    bpy.data.meshes.remove(target.meshes[0])
    bpy.ops.wm.open_mainfile(filepath=file)
    sea = bpy.data.objects["Ocean"]
    bpy.context.view_layer.update()
    expect_the_core(sea, 11)

with checking("off they are gone with all that was theirs, also by undo, and come back by redo"):
    bpy.ops.ed.undo_push(message="with drops")
    change(sea, effects__spray_drops=False)
    assert not all_that_is_theirs()
    bpy.ops.ed.undo_push(message="without")
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    sea = bpy.data.objects["Ocean"]
    expect_the_core(sea, 11)
    bpy.ops.ed.redo()
    bpy.context.view_layer.update()
    sea = bpy.data.objects["Ocean"]
    assert not all_that_is_theirs()
    change(sea, effects__spray_drops=True, effects__spray_law="monahan-1986")
    assert drops.drops_of(sea) is None, "a law without such drops"

with checking("a duplicate of both has its own; without its ocean an object of drops goes"):
    change(sea, effects__spray_law="andreas-1998")
    for obj in bpy.data.objects:
        obj.select_set(obj == sea)
    bpy.context.view_layer.objects.active = sea
    bpy.ops.object.duplicate()
    bpy.context.view_layer.update()
    twin = bpy.context.object
    assert drops.drops_of(twin) not in (None, drops.drops_of(sea))
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    assert [obj for obj in bpy.data.objects if drops.MARK in obj] == [drops.drops_of(sea)]

with checking("a script that sets the key and renders gets each frame's own"):
    change(sea, effects__spray_drops=False)
    seen = {}

    def look_at(bpy_scene, *_):
        seen[bpy_scene.frame_current] = numbers(drops.drops_of(sea).data)

    bpy.app.handlers.render_post.append(look_at)
    sea.pelagic.effects.spray_drops = True
    bpy_scene = bpy.context.scene
    bpy_scene.frame_start, bpy_scene.frame_end = 11, 12
    bpy_scene.render.filepath = str(folder / "frame")
    bpy_scene.render.engine, bpy_scene.cycles.samples = "CYCLES", 1
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = 16, 16
    bpy.ops.render.render(animation=True)
    bpy.app.handlers.render_post.remove(look_at)
    for frame in (11, 12):
        assert np.array_equal(seen[frame], in_air(sea, frame, (3.0, -20.0, 5.0))["position"].astype(np.float32)), frame

with checking("in Cycles a parcel hides what the core's disc does, many hide as all of them together, and have the core's light"):
    shot = ocean.scene_of(sea, bpy_scene)
    material = drops._material_of(drops.drops_of(sea))
    group = drops.drops_of(sea).modifiers[0].node_group
    for obj in list(bpy.data.objects):
        obj.hide_render = obj.type != "CAMERA"
    bpy_scene.view_layers[0].use_pass_z = False
    bpy_scene.render.film_transparent = True
    camera = bpy_scene.camera
    camera.location, camera.rotation_euler = (0.0, 0.0, 0.0), (np.pi / 2, 0.0, 0.0)  # towards +y
    camera.data.angle = 2 * np.arctan(0.01)

    def picture(places, opacity):
        mesh = bpy.data.meshes.new("Some")
        mesh.from_pydata(places, [], [])
        for name, value in (("radius", 0.8), ("opacity", opacity)):
            mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", [value] * len(places))
        some = bpy.data.objects.new("Some", mesh)
        some.modifiers.new("Points", "NODES").node_group = group
        bpy_scene.collection.objects.link(some)
        pixels = cycles_exr(folder / "some.exr", (32, 32), 16)
        bpy.data.objects.remove(some)
        return pixels

    one = picture([(0.0, 100.0, 0.0)], 0.6)
    # The picture is 2 m wide there. The core: 1 − exp(−3 t (1 − ρ²)²), t = −ln(1 − 0.6).
    inner = (np.arange(1000) + 0.5) / 1000  # 1 − ρ², whose shares of the disc are equal
    hidden_m2 = np.pi * 0.8**2 * np.mean(1 - 0.4 ** (3 * inner**2))
    got_m2 = one[..., 3].mean() * 4.0
    print(f"    a parcel hides {got_m2:.3f} m², the core's {hidden_m2:.3f}")
    assert abs(got_m2 / hidden_m2 - 1.0) < 0.02
    many = picture([(0.0, 100.0 + 0.01 * i, 0.0) for i in range(40)], 0.02)[12:20, 12:20].mean(axis=(0, 1))
    beside = ((np.arange(12, 20) + 0.5) / 16 - 1.0) / 0.8
    expected = np.mean(1 - 0.98 ** (120 * (1 - beside**2 - beside[:, None] ** 2) ** 2))
    print(f"    40 one behind another hide {many[3]:.3f}, all of them together {expected:.3f}")
    assert abs(many[3] - expected) < 0.02
    towards = pelagic.Sky(shot).spray_image(shot, 256)[63:65, 63:65].mean(axis=(0, 1))
    print(f"    light of spray: {many[:3] / many[3]}, the core's {towards}")
    assert np.allclose(many[:3] / many[3], towards, rtol=0.06)  # 16 samples' noise
    world, bpy_scene.world = bpy_scene.world, bpy.data.worlds.new("Own")
    drops.put_light(sea, shot, light.sky_picture(bpy_scene))
    assert material.node_tree.nodes[drops.OWN_LIGHT].outputs[0].default_value == 0.0
    bpy_scene.world.use_nodes = True
    bpy_scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (2.0, 2.0, 2.0, 1.0)
    white = picture([(0.0, 100.0, 0.0)], 0.9999)[16, 16]
    assert np.allclose(white, (2.0, 2.0, 2.0, 1.0), rtol=0.1), white
