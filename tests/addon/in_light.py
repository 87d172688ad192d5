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
SIZE = (144, 80)


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
    scene.render.resolution_x, scene.render.resolution_y = SIZE
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
    ended = subprocess.run([PROGRAM, "render", str(FOLDER / "trawler.toml"), "--out", str(FOLDER), "--frames", "48", "--samples", "1", "--size", "40x22",
                            "--layers", "none"], capture_output=True, text=True)
    assert ended.returncode == 0 and (FOLDER / "Ocean.0048.exr").is_file(), ended.stderr
    matte = pelagic.render(shot, 48, SIZE, 3, layers=["cryptomatte"])["cryptomatte"][::-1].reshape(SIZE[1], SIZE[0], 6, 2)
    water = matte[0, 0, 0, 0]  # a corner below, where nothing else is
    seen = ((matte[..., 0] != water) & (matte[..., 0] != 0.0)) * matte[..., 1]
    by_program = seen.sum(-1) > 0.5
    # What water hides of it is hidden: its waves are there, and are nothing.
    sea.is_holdout, scene.render.film_transparent = True, True
    by_cycles = cycles_exr(FOLDER / "mask.exr", SIZE, 8)[..., 3] > 0.5
    sea.is_holdout, scene.render.film_transparent = False, False
    both = (by_program & by_cycles).sum() / (by_program | by_cycles).sum()
    print(f"    {by_program.sum()} pixels by the program, {by_cycles.sum()} by Cycles, of either both have {both:.4f}")
    assert by_program.sum() > 350 and both >= 0.97

with checking("imported again it is at the same place, with its wake, afloat and in colour; a round trip keeps it"):
    fresh_file()
    assert bpy.ops.pelagic.import_shot(filepath=str(FOLDER / "trawler.toml")) == {"FINISHED"}
    ship, = in_light.of_scene(bpy.context.scene)
    assert ship.pelagic_float.enabled and len(ship.material_slots) == len(told)
    for frame in (1, 48, 96):
        assert np.abs(box(points_of(ship, frame)) - box(points_in(shot, 0, frame))).max() < 0.02, frame
    again = exported("again")
    assert again.objects[0]._replace(file="", name="") == shot.objects[0]._replace(file="", name=""), (again.objects, shot.objects)
    assert again.waves.vessels == shot.waves.vessels
    for name, values in shot.object_mesh(0).items():
        if name == "points_m":
            assert np.allclose(values, again.object_mesh(0)[name], atol=2e-3)
    assert ship.pelagic_in_light.buoyancy == shot.objects[0].buoyancy == "plane"
    ship.pelagic_in_light.buoyancy, ship.pelagic_in_light.roll_damping, ship.pelagic_in_light.caustics = "response", 0.3, 1.5
    body = exported("by-mass").objects[0]
    assert (body.buoyancy, body.roll_damping, body.caustics) == ("response", 0.3, 1.5)
    assert bpy.ops.pelagic.import_shot(filepath=str(FOLDER / "by-mass.toml")) == {"FINISHED"}
    assert {(obj.pelagic_in_light.buoyancy, round(obj.pelagic_in_light.roll_damping, 6), obj.pelagic_in_light.caustics)
            for obj in in_light.of_scene(bpy.context.scene)} == {("response", 0.3, 1.5)}


# ---- Hard cases


def empty_sea():
    fresh_file()
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 24
    return add_ocean(sea__wind_speed_mps=5.0)


def cube(size=(2.0, 1.0, 1.0), location=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0)):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=location, rotation=turn)
    obj = bpy.context.object
    obj.scale = size
    obj.pelagic_in_light.enabled = True
    bpy.context.view_layer.update()
    return obj


def keyed(obj, path, rows):
    for frame, value in rows.items():
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)


with checking("scales by axes, mirrored ones, a sheared child, turns and a moved sea: all of it is in the mesh, and nothing is off"):
    sea = empty_sea()
    sea.location, sea.rotation_euler = (5.0, 2.0, 0.0), (0.0, 0.0, 0.5)
    mirrored = cube((4.0, -2.0, 1.0), (3.0, 8.0, 0.5), (0.1, -0.3, 0.7))
    parent = cube((6.0, 2.0, 1.0), (-12.0, 4.0, 0.2), (0.0, 0.0, 0.4))
    bpy.ops.mesh.primitive_cone_add(radius1=0.4, depth=1.0, location=(0.2, 0.1, 0.9), rotation=(0.3, 0.2, 0.5))
    mast = bpy.context.object
    mast.parent = parent
    mast.scale = -0.3, 0.4, 2.0
    bpy.context.view_layer.update()
    assert [sentence for sentence in remarks() if "moved or turned" not in sentence] == []
    shot = exported("stretched")
    bodies = {each.name: index for index, each in enumerate(shot.objects)}
    assert set(bodies) == {mirrored.name, parent.name} and not any(each.path or each.floats for each in shot.objects)
    into_sea = np.array(sea.matrix_world.inverted())
    for obj, parts in ((mirrored, [mirrored]), (parent, [parent, mast])):
        wanted = np.concatenate([points_of(part, 1) for part in parts]) @ into_sea[:3, :3].T + into_sea[:3, 3]
        assert np.abs(box(wanted) - box(points_in(shot, bodies[obj.name], 1))).max() < 1e-4, obj.name
        mesh = shot.object_mesh(bodies[obj.name])
        a, b, c = (mesh["points_m"][mesh["triangles"][:, i]].astype(float) for i in range(3))
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
        assert volume > 0.0, "it is seen from outside"
        facing = np.einsum("ij,ij->i", np.cross(b - a, c - a), mesh["normals"].reshape(-1, 3, 3).mean(1))
        assert (facing > 0.0).all()

with checking("an empty with parts floats by their box, as the shot's one body does"):
    sea = empty_sea()
    bpy.ops.object.empty_add(location=(4.0, 3.0, 0.0))
    root = bpy.context.object
    parts = [cube((6.0, 3.0, 1.0), (9.0, 3.0, 0.0)), cube((4.0, 3.0, 1.0), (-3.0, 3.0, 0.0))]
    for part in parts:
        part.parent, part.matrix_parent_inverse, part.pelagic_in_light.enabled = root, root.matrix_world.inverted(), False
    root.pelagic_in_light.enabled = root.pelagic_float.enabled = True
    bpy.context.view_layer.update()
    shot = exported("parts")
    least, most = (edge(shot.object_mesh(0)["points_m"][:, :2], axis=0) for edge in (np.min, np.max))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert shot.objects[0].floats and np.allclose(floating._box(root, floating.calm_matrix(root, depsgraph), depsgraph), (least, most), atol=1e-3)
    assert np.allclose((least, most), ((-9.0, -1.5), (8.0, 1.5)), atol=1e-3)

with checking("what moves by itself goes along a path, its bow ahead; a way that bends"):
    sea = empty_sea()
    boat = cube((5.0, 2.0, 1.0), turn=(0.0, 0.0, 0.0))
    boat.rotation_mode = "XYZ"
    ways = {frame: (0.5 * frame, 8.0 * math.sin(0.04 * frame), 0.3) for frame in range(1, 25)}
    keyed(boat, "location", ways)
    keyed(boat, "rotation_euler", {frame: (0.0, 0.0, math.atan2(0.32 * math.cos(0.04 * frame), 0.5)) for frame in ways})
    said = remarks()
    assert not said, said
    shot = exported("bends")
    body, = shot.objects
    assert body.path and body.vessel == 0 and math.isclose(body.up_m, 0.3, abs_tol=1e-6)
    for frame in (1, 12, 24):
        assert np.abs(box(points_of(boat, frame)) - box(points_in(shot, 0, frame))).max() < 0.03, frame

with checking("a wake's way is its hull's, also where it bends: the boat is the vessel"):
    select(boat)
    bpy.ops.pelagic.make_wake()
    shot = exported("hull")
    assert (shot.objects[0].vessel, shot.objects[0].path) == (1, "")
    way = [(frame, *ways[frame][:2]) for frame in ways]
    keys = np.array([[float(word) for word in key.split()] for key in shot.waves.vessels[0].path.split(",")])
    print("   ", len(keys), "keys")
    assert len(keys) < 16 and np.hypot(*(courses.smooth(keys, np.array(list(ways), float)) - np.array(way)[:, 1:]).T).max() <= courses.ERROR_M
    core = [shot.object_pose(0, frame)[:2, 3] for frame in ways]
    assert np.allclose(core, courses.smooth(keys, np.array(list(ways), float)), atol=2e-3), "the core's own path"

with checking("said in a sentence: what rises, turns on the spot, changes its shape, has no faces, or has pictures for colours"):
    sea = empty_sea()
    turning, lift, soft = cube(location=(0, 0, 0)), cube(location=(9, 0, 0)), cube(location=(18, 0, 0))
    keyed(turning, "rotation_euler", {1: (0.0, 0.0, 0.0), 24: (0.0, 0.0, 1.5)})
    keyed(lift, "location", {1: (9.0, 0.0, 0.0), 24: (9.0, 0.0, 3.0)})
    key = soft.shape_key_add(name="Basis"), soft.shape_key_add(name="Bent")
    key[1].data[0].co.x += 0.4
    keyed(key[1], "value", {1: 0.0, 24: 1.0})
    bpy.ops.object.empty_add()
    nothing = bpy.context.object
    nothing.pelagic_in_light.enabled = True
    hidden = cube(location=(27, 0, 0))
    hidden.hide_render = True
    material = bpy.data.materials.new("Painted")
    material.use_nodes = True
    tree = material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeTexImage").outputs["Color"], next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"])
    turning.data.materials.append(material)
    bpy.context.scene.frame_set(1)
    said = "\n".join(remarks())
    for words in (f"{turning.name} moves as no body", f"{lift.name} moves as no body", "3 m from where", f"{soft.name} changes its shape",
                  f"{nothing.name} has no faces", "Painted"):
        assert words in said, (words, said)
    shot = exported("said")
    assert {each.name for each in shot.objects} == {turning.name, lift.name, soft.name}

with checking("an image as base colour comes along, with its UV coordinates, and back again"):
    sea = empty_sea()
    block, bare, odd = cube(location=(0, 5, 0)), cube(location=(0, 9, 0)), cube(location=(0, 13, 0))
    image = bpy.data.images.new("Chart", width=4, height=2)
    # Rows from the bottom, of whole steps of eight bits.
    pixels = np.ones((2, 4, 4), np.float32)
    pixels[..., :3] = np.random.default_rng(1).integers(0, 256, (2, 4, 3)) / 255.0
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    linear = np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)[..., :3]

    def painted(name, of, extension="REPEAT"):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        tree = material.node_tree
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image, texture.extension = of, extension
        tree.links.new(texture.outputs["Color"], next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"])
        return material

    chart = painted("Chart paint", image)
    for obj in (block, bare):
        obj.data.materials.append(chart)
    odd.data.materials.append(painted("Odd paint", image, "CLIP"))
    bare.data.uv_layers.remove(bare.data.uv_layers[0])
    block.data.calc_loop_triangles()
    uv = np.array([[block.data.uv_layers.active.data[loop].uv[:] for loop in each.loops] for each in block.data.loop_triangles])
    shot = exported("chart")
    assert "Odd paint" in "\n".join(remarks()) and "Chart paint" not in "\n".join(remarks())
    index = {each.name: number for number, each in enumerate(shot.objects)}
    first = block.name
    told = shot.object_mesh(index[first])
    assert len(told["images"]) == 1 and np.allclose(told["images"][0], linear, rtol=2e-3, atol=1e-6), (told["images"], linear)
    assert np.allclose(told["materials"][0]["colour"], linear.mean((0, 1)), atol=2e-3) and told["materials"][0]["image"] == 0
    assert np.allclose(np.sort(told["image_at"].reshape(-1, 6), 0), np.sort(uv.reshape(-1, 6), 0), atol=1e-6)
    told = shot.object_mesh(index[bare.name])
    assert told["materials"][-1]["image"] == -1 and np.allclose(told["materials"][-1]["colour"], linear.mean((0, 1)), atol=2e-3)
    assert not shot.object_mesh(index[odd.name])["images"]
    fresh_file()
    assert bpy.ops.pelagic.import_shot(filepath=str(FOLDER / "chart.toml")) == {"FINISHED"}
    again = exported("chart-again")
    one, other = (each.object_mesh([of.name for of in each.objects].index(first)) for each in (shot, again))
    assert np.array_equal(one["images"][0], other["images"][0]) and np.allclose(one["image_at"], other["image_at"], atol=1e-6)

with checking("a holdout, names for mattes, fewer triangles, and a list to take them out of"):
    sea = empty_sea()
    buoy = cube(location=(0, 5, 0))
    buoy.is_holdout, buoy.name = True, 'Sea "mark"'
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
    ball = bpy.context.object
    ball.name = "sea"
    bpy.ops.pelagic.add_to_sea()
    ball.pelagic_in_light.proxy = 20
    shot = exported("odd")
    by_name = {each.name: index for index, each in enumerate(shot.objects)}
    assert set(by_name) == {"Sea _mark_", "sea-2"}, by_name
    assert shot.objects[by_name["Sea _mark_"]].holdout
    triangles = len(shot.object_mesh(by_name["sea-2"])["triangles"])
    assert 0.15 < triangles / (2 * 64 * 31) < 0.25, triangles
    assert "Pelagic Proxy" not in bpy.data.meshes and "Pelagic Proxy" not in bpy.data.objects
    bpy.ops.pelagic.add_to_sea(name=buoy.name, enabled=False)
    assert in_light.of_scene(bpy.context.scene) == [ball]
    ball.select_set(True)
    bpy.ops.pelagic.add_to_sea(enabled=False)
    assert not exported("none").objects and not (FOLDER / "none_objects").exists()

with checking("a farm's job has the meshes, and is the same shot from another folder"):
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "job.blend"))
    ball.pelagic_in_light.enabled = True
    select(sea)
    assert bpy.ops.pelagic.write_job() == {"FINISHED"}
    out = FOLDER / "bakes" / "Ocean"
    moved = FOLDER / "moved"
    (out / farm.JOB).rename(moved)
    shot = pelagic.Scene.from_file(moved / "Ocean.toml")
    assert shot.objects[0].name == "sea-2" and len(shot.object_mesh(0)["materials"]) == 1 and not (moved / "files").exists()
    assert (moved / "objects/sea-2.mtl").is_file()

with checking("the catcher: the water's picture times its pass, with the objects over it, is the whole picture; and it can be switched off"):
    fresh_file()
    scene = bpy.context.scene
    sea = add_ocean(sea__wind_speed_mps=3.0, surface__kind="projected-grid", light__sun_elevation_deg=35.0, light__sun_azimuth_deg=140.0)
    bpy.ops.mesh.primitive_cube_add(size=6.0, location=(0.0, 0.0, 2.0))
    block = bpy.context.object
    black = bpy.data.materials.new("Black")
    black.use_nodes = True
    node = next(node for node in black.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    node.inputs["Base Color"].default_value, node.inputs["Roughness"].default_value = (0.01, 0.01, 0.01, 1.0), 1.0
    block.data.materials.append(black)
    scene.camera.location, scene.camera.rotation_mode = (6.0, -26.0, 9.0), "QUATERNION"
    scene.camera.rotation_quaternion = (scene.camera.location - Vector((0.0, 0.0, -1.0))).to_track_quat("Z", "Y")
    small, samples = ((80, 60), 48) if at_night() else ((40, 30), 8)
    scene.frame_set(2)
    whole = cycles_exr(FOLDER / "whole.exr", small, samples)
    block.hide_render = True
    water = cycles_exr(FOLDER / "water.exr", small, samples)
    block.hide_render = False
    select(sea)
    assert bpy.ops.pelagic.catcher() == {"FINISHED"}
    objects = cycles_exr(FOLDER / "objects.exr", small, samples)
    scene.use_nodes = True
    tree = scene.node_tree
    layers, composite = (next(node for node in tree.nodes if node.type == kind) for kind in ("R_LAYERS", "COMPOSITE"))
    tree.links.new(layers.outputs["Shadow Catcher"], composite.inputs["Image"])
    caught = cycles_exr(FOLDER / "caught.exr", small, samples)
    over = objects[..., :3] + (1.0 - objects[..., 3:]) * caught[..., :3] * water[..., :3]
    bare = objects[..., 3] < 0.01
    changes = bare & (caught[..., :3].mean(-1) < 0.8)
    errors = [abs(over[part][:, :3].mean() / whole[part][:, :3].mean() - 1.0) for part in (changes, bare & ~changes)]
    print(f"    where it catches, {changes.mean():.3f} of the picture: {errors[0]:.2g} off, beside it {errors[1]:.2g}; the water there is "
          f"{whole[changes][:, :3].mean() / water[changes][:, :3].mean():.2f} of what it is without")
    assert changes.mean() > 0.03 and max(errors) < 0.01  # 0: they have the same samples
    assert whole[changes][:, :3].mean() < 0.8 * water[changes][:, :3].mean()
    assert bpy.ops.pelagic.catcher(enabled=False) == {"FINISHED"}
    assert not (sea.is_shadow_catcher or scene.render.film_transparent or bpy.context.view_layer.cycles.use_pass_shadow_catcher)
