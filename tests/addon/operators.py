"""Every operator, and what is refused in words."""

import math
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

from mathutils import Vector

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import compat, look, meshes, ocean, play, properties


def grid(side=8, size_m=40.0):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side, size=size_m)
    return bpy.context.object


with checking("add_ocean: an object with a mesh that moves, selected and active"):
    fresh_file()
    assert bpy.ops.pelagic.add_ocean() == {"FINISHED"}
    sea = bpy.context.object
    assert ocean.is_ocean(sea) and sea.select_get() and len(sea.data.vertices) > 257**2
    first = numbers(sea.data)
    bpy.context.scene.frame_set(12)
    assert not np.array_equal(numbers(sea.data), first)
    assert bpy.context.scene.camera.data.clip_end >= 60e3
    assert compat.can_denoise() or not bpy.context.scene.cycles.use_denoising, "Cycles couldn't render"
    assert all(polygon.use_smooth for polygon in sea.data.polygons[:100])

with checking("a script's ocean is written into its mesh once, with its foam"):
    fresh_file()
    written, put_frame = [], meshes.put_frame
    meshes.put_frame = lambda mesh, arrays: (written.append(arrays["coverage"].max()), put_frame(mesh, arrays))
    bpy.ops.pelagic.add_ocean()
    bpy.context.view_layer.update()
    meshes.put_frame = put_frame
    assert len(written) == 1 and written[0] > 0.0, written

with checking("a look that fails, whatever the reason, leaves the sea and a warning"):
    said, give, try_to = [], look.give, look.try_to
    hears = SimpleNamespace(report=lambda kind, text: said.append((kind, text)))
    look.try_to = lambda _, its_give: try_to(hears, its_give)

    def fails(*_):
        raise error

    for error in (TypeError('enum "SHARP" not found in (\'BECKMANN\', \'GGX\')'), KeyError("Specular"), ZeroDivisionError("zero"),
                  OSError("sky.exr isn't there")):
        fresh_file()
        look.give = fails
        assert bpy.ops.pelagic.add_ocean() == {"FINISHED"}
        look.give = give
        bare = bpy.context.object
        assert ocean.is_ocean(bare) and bare.select_get() and np.std(numbers(bare.data)[:, 2]) > 0.1
        (kind, text), = said
        assert kind == {"WARNING"} and str(error.args[0]) in text, said
        said.clear()
        bpy.context.scene.frame_set(9)
        bpy.ops.pelagic.add_material()
        assert "Pelagic" in bare.data.materials[0].name
    look.try_to = try_to

with checking("the faces look up, and the UV map is the patch"):
    sea = add_ocean(horizon=True)
    bpy.context.view_layer.update()
    assert sea.data.polygons[1000].normal.z > 0.5
    corner = np.array([entry.uv for entry in sea.data.uv_layers["UVMap"].data[:1]])
    assert np.allclose(corner, 0.0, atol=1e-6)

with checking("use_mesh: the mesh's own vertices and faces, and release_mesh gives them back"):
    obj = grid()
    obj.data.vertices[3].co.z = 1.5
    before = numbers(obj.data)
    bpy.ops.pelagic.use_mesh()
    assert ocean.is_ocean(obj) and obj.pelagic.own_mesh and len(obj.data.vertices) == len(before)
    moved = numbers(obj.data)
    assert np.std(moved[:, 2]) > 0.1 and np.array_equal(numbers(obj.data, "rest_position"), before)
    bpy.context.scene.frame_set(20)
    assert not np.array_equal(numbers(obj.data), moved)
    bpy.ops.pelagic.release_mesh()
    assert not ocean.is_ocean(obj) and np.array_equal(numbers(obj.data), before)
    assert "velocity" not in obj.data.attributes
    bpy.context.scene.frame_set(21)
    assert np.array_equal(numbers(obj.data), before)

with checking("a mesh's vertex stands at its own place on the same sea, raised by its own height"):
    import pelagic
    bpy.ops.pelagic.use_mesh()
    simulation = play.simulation_of(obj)
    cell_m = 40.0 / 8
    frame = pelagic.Frame(pelagic.Sea(simulation.scene, ["position"], cell_m=cell_m, pixel_m=cell_m))
    frame.set(simulation.scene.shot.time_s(21))
    core = frame.evaluate(np.ascontiguousarray(before[:, :2]))["position"]
    core[:, 2] += before[:, 2]
    assert np.abs(numbers(obj.data) - core).max() < 1e-4

with checking("use_mesh on a mesh without vertices is refused, and nothing is changed"):
    empty = bpy.data.objects.new("Empty mesh", bpy.data.meshes.new("Empty mesh"))
    bpy.context.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    assert refused(bpy.ops.pelagic.use_mesh, "has no vertices")
    assert not ocean.is_ocean(empty)

with checking("loose vertices, and a mesh whose points all lie in one place"):
    loose = bpy.data.meshes.new("Loose")
    loose.from_pydata([(0, 0, 0), (5, 0, 0), (5, 0, 0)], [], [])
    obj = bpy.data.objects.new("Loose", loose)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.pelagic.use_mesh()
    assert np.isfinite(numbers(loose)).all()

with checking("vertices taken away in edit mode: the rest plays on"):
    obj = grid()
    bpy.ops.pelagic.use_mesh()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.data.vertices[0].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.context.scene.frame_set(30)
    bpy.ops.object.mode_set(mode="OBJECT")
    count, before = len(obj.data.vertices), numbers(obj.data)
    assert count == 80
    bpy.context.scene.frame_set(31)
    assert len(obj.data.vertices) == count and not np.array_equal(numbers(obj.data), before)

with checking("list_add and list_remove"):
    sea = add_ocean()
    calm = numbers(sea.data)
    bpy.ops.pelagic.list_add(path="sea.swell")
    bpy.ops.pelagic.list_add(path="sea.swell")
    sea.pelagic.sea.swell[0].height_m = 4.0
    bpy.context.view_layer.update()
    assert len(ocean.scene_of(sea, bpy.context.scene).sea.swell) == 2
    assert not np.array_equal(numbers(sea.data), calm)
    bpy.ops.pelagic.list_remove(path="sea.swell", index=1)
    bpy.ops.pelagic.list_remove(path="sea.swell", index=0)
    bpy.context.view_layer.update()
    assert np.array_equal(numbers(sea.data), calm)

with checking("an entry of any list, as it comes, leaves a sea that plays"):
    for field in (field for field in properties.FIELDS if field.key["type"] == "entries"):
        before = numbers(sea.data)
        bpy.ops.pelagic.list_add(path=field.path)
        bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1)
        assert not play.simulation_of(sea).problem, (field.path, play.simulation_of(sea).problem)
        height = play.simulation_of(sea).significant_height_m
        assert height < 4.0, (field.path, height)  # 2.5 m without
        assert not np.array_equal(numbers(sea.data), before), field.path
        bpy.ops.pelagic.list_remove(path=field.path, index=0)

with checking("a hero wave stands at the cursor in the current frame"):
    sea, scene = add_ocean(), bpy.context.scene
    sea.pelagic.waves.second_order, sea.pelagic.surface.size_m, sea.pelagic.surface.resolution = 0.0, 60.0, 150
    sea.location, sea.rotation_euler[2] = (5.0, 2.0, 0.0), 0.5
    scene.frame_set(30)
    scene.cursor.location = (16.0, -9.0, 3.0)
    bpy.ops.pelagic.list_add(path="waves.heroes")
    hero, = sea.pelagic.waves.heroes
    bpy.context.view_layer.update()
    assert hero.frame == 30 and 1.0 < hero.height_m < 4.0, hero.height_m
    spots = numbers(sea.data) @ np.array(sea.matrix_world.to_3x3()).T + np.array(sea.location)
    near = np.hypot(spots[:, 0] - 16.0, spots[:, 1] + 9.0) < 1.0
    highest = spots[near, 2].max()
    assert abs(highest - hero.height_m) < 0.05 * hero.height_m, (highest, hero.height_m)
    scene.frame_set(70)
    later = (numbers(sea.data)[:, 2])[near].max()
    assert later < 0.8 * hero.height_m, later

with checking("a gust's front is at the cursor in the current frame, and goes along the wind"):
    sea, scene = add_ocean(), bpy.context.scene
    sea.location, sea.pelagic.sea.wind_direction_deg = (5.0, 2.0, 0.0), 40.0
    bpy.context.view_layer.update()
    scene.frame_set(30)
    scene.cursor.location = (16.0, -9.0, 3.0)
    bpy.ops.pelagic.list_add(path="sea.gust_fronts")
    front, = ocean.scene_of(sea, scene).sea.gust_fronts
    assert (front.frame, front.direction_deg, front.wind) == (30, 40.0, 2.0), front
    assert abs(front.east_m - 11.0) < 1e-5 and abs(front.north_m + 11.0) < 1e-5, front

with checking("a calm place stands at the cursor"):
    sea, scene = add_ocean(), bpy.context.scene
    sea.location, sea.rotation_euler[2] = (5.0, 2.0, 0.0), 0.5
    bpy.context.view_layer.update()
    before = numbers(sea.data)
    scene.cursor.location = (16.0, -9.0, 3.0)
    bpy.ops.pelagic.list_add(path="waves.masks")
    mask, = sea.pelagic.waves.masks
    mask.length_m = mask.width_m = mask.edge_m = 20.0
    bpy.context.view_layer.update()
    heights, after = before[:, 2], numbers(sea.data)[:, 2]
    spots = before @ np.array(sea.matrix_world.to_3x3()).T + np.array(sea.location)
    away = np.hypot(spots[:, 0] - 16.0, spots[:, 1] + 9.0)
    assert np.allclose(after[away < 8.0], 0.5 * heights[away < 8.0], atol=1e-5)
    assert np.array_equal(after[away > 34.0], heights[away > 34.0]) and (away > 34.0).any()

with checking("a painted mesh is a mask where it lies, in the sea's own axes; painted anew the mask has the new picture"):
    fresh_file()
    sea, scene = add_ocean(), bpy.context.scene
    sea.location, sea.rotation_euler[2] = (5.0, 2.0, 0.0), 0.5
    bpy.context.view_layer.update()
    before = numbers(sea.data)
    sheet = grid(side=20, size_m=60.0)
    sheet.location, sheet.rotation_euler[2], sheet.scale = (12.0, -7.0, 1.0), 0.9, (1.0, 0.5, 1.0)
    bpy.context.view_layer.update()
    assert refused(bpy.ops.pelagic.paint_mask, "isn't saved yet")
    with tempfile.TemporaryDirectory() as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "sea.blend"))
        assert refused(bpy.ops.pelagic.paint_mask, "isn't painted")
        colours = sheet.data.color_attributes.new("calm", "FLOAT_COLOR", "CORNER")
        sheet.data.color_attributes.active_color = colours
        local = numbers(sheet.data)[[loop.vertex_index for loop in sheet.data.loops]]
        white = np.clip(local[:, 0] / 10.0 + 0.5, 0.0, 1.0)  # black on its left, white on its right
        colours.data.foreach_set("color", np.repeat(white[:, None], 4, 1).astype(np.float32).ravel())
        bpy.ops.pelagic.paint_mask()
        mask, = sea.pelagic.waves.masks
        assert mask.waves == 0.5 and math.isclose(mask.length_m, 60.0, rel_tol=1e-5) and math.isclose(mask.width_m, 30.0, rel_tol=1e-5)
        assert math.isclose(mask.direction_deg, math.degrees(0.4), rel_tol=1e-4)
        at = sea.matrix_world @ Vector((mask.east_m, mask.north_m, 0.0))
        assert math.hypot(at.x - 12.0, at.y + 7.0) < 1e-4
        bpy.context.view_layer.update()
        spots = before @ np.array(sea.matrix_world.to_3x3()).T + np.array(sea.location)
        into = np.array(sheet.matrix_world.inverted())
        on_sheet = spots @ into[:3, :3].T + into[:3, 3]  # its scale undone: 60 m a side
        deep = (np.abs(on_sheet[:, 0] - 15.0) < 8.0) & (np.abs(on_sheet[:, 1]) < 20.0)
        off = (on_sheet[:, 0] < -12.0) | (np.abs(on_sheet[:, 1]) > 38.0) | (on_sheet[:, 0] > 38.0)
        heights, after = before[:, 2], numbers(sea.data)[:, 2]
        assert deep.sum() > 5 and np.allclose(after[deep], 0.5 * heights[deep], atol=2e-3 * np.abs(heights).max())
        assert off.any() and np.array_equal(after[off], heights[off])
        shot = ocean.scene_of(sea, scene)
        assert not shot.validate() and Path(shot.waves.masks[0].picture).parent == Path(folder) / "masks"
        first, mask.waves = mask.picture, 0.2
        sheet.data.attributes.new("rough", "FLOAT", "POINT").data.foreach_set("value", np.ones(len(sheet.data.vertices), np.float32))
        bpy.ops.pelagic.paint_mask(attribute="rough")
        mask, = sea.pelagic.waves.masks
        assert mask.picture != first and math.isclose(mask.waves, 0.2, rel_tol=1e-6)
        bpy.context.view_layer.update()
        deep = (np.abs(on_sheet[:, 0]) < 22.0) & (np.abs(on_sheet[:, 1]) < 20.0)
        assert np.allclose(numbers(sea.data)[deep, 2], 0.2 * heights[deep], atol=2e-3 * np.abs(heights).max())
        assert refused(lambda: bpy.ops.pelagic.paint_mask(attribute="none"), "has no attribute none")

with checking("a moving object leaves a wake along its path, in the sea's own axes; one that stands still leaves none"):
    fresh_file()
    scene = bpy.context.scene
    sea = add_ocean()
    sea.location, sea.rotation_euler = (5.0, 2.0, 0.0), (0.0, 0.0, 0.5)
    bpy.ops.mesh.primitive_cube_add()
    boat = bpy.context.object
    boat.scale = 6.0, 2.0, 1.0
    assert refused(bpy.ops.pelagic.make_wake, "doesn't move")
    scene.frame_start, scene.frame_end = 1, 121
    for frame, x in ((1, -20.0), (121, 20.0)):
        boat.location.x = x
        boat.keyframe_insert("location", frame=frame)
    before = numbers(sea.data)
    bpy.ops.pelagic.make_wake()
    vessel, = sea.pelagic.waves.vessels
    keys = [[float(word) for word in key.split()] for key in vessel.path.split(",")]
    for frame, x, y in keys:
        scene.frame_set(int(frame))
        assert (sea.matrix_world.inverted() @ boat.matrix_world.translation - Vector((x, y, boat.location.z))).length < 1e-3
    assert (keys[0][0], keys[-1][0]) == (1, 121) and (vessel.length_m, vessel.beam_m) == (12.0, 4.0)
    bpy.context.view_layer.update()
    assert not np.array_equal(numbers(sea.data)[:, 2], before[:, 2])

with checking("a new ocean brings water, sun and sky; a world of the artist's own stays unless the operator is asked"):
    fresh_file()
    scene = bpy.context.scene
    grey = scene.world
    first = add_ocean()
    assert first.data.materials[0] and scene.world != grey
    lamp = scene.objects["Light"]  # of the start-up file
    assert lamp.hide_render and lamp.hide_get()
    assert any(obj.type == "LIGHT" and obj.data.type == "SUN" for obj in scene.objects)
    fresh_file()
    scene = bpy.context.scene
    own = scene.world
    own.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.1, 0.1, 1)
    bpy.ops.pelagic.add_ocean()
    assert scene.world == own
    bpy.data.objects.remove(bpy.context.object)
    scene.objects["Light"].location.z += 1.0  # somebody wants it
    bpy.ops.pelagic.add_ocean(light=True)
    assert scene.world != own and not scene.objects["Light"].hide_render

with checking("where a Blender unit isn't a metre it says so, and an ocean that is scaled by hand is right"):
    fresh_file()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.camera.location = 160, 90, (0, 0, 9)
    sea = add_ocean(surface__kind="projected-grid")
    in_metres = numbers(sea.data)
    assert not ocean.unit_warning(sea, scene)
    scene.unit_settings.scale_length = 0.01
    assert "ocean's own scale to 100" in ocean.unit_warning(sea, scene)
    sea.scale, scene.camera.location.z = (100, 100, 100), 900
    bpy.context.view_layer.update()
    assert not ocean.unit_warning(sea, scene)
    assert len(in_metres) == len(sea.data.vertices) and np.allclose(numbers(sea.data), in_metres, rtol=1e-4, atol=1e-2)
