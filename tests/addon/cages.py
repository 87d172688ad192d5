"""A mesh of the file as the cage of a sea: its creases, its changes, what is refused."""

import sys
import tempfile
from pathlib import Path

from mathutils.kdtree import KDTree

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import baked, cages, exchange, ocean, play
from pictures import cycles_exr

folder = Path(tempfile.mkdtemp())


def hilly(size_m=80.0, side=4):
    """A grid with a hill, half creased edges and a sharp one."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side, size=size_m)
    obj = bpy.context.object
    mesh = obj.data
    mesh.vertices[12].co.z, mesh.vertices[7].co.z = 20.0, -5.0
    crease_edges(mesh, [1.0 if ends == {11, 12} else 0.5 if 12 in ends or 7 in ends else 0.0
                        for ends in (set(edge.vertices) for edge in mesh.edges)])
    return obj


def sea_on(cage):
    bpy.context.view_layer.objects.active = cage
    assert bpy.ops.pelagic.use_cage() == {"FINISHED"}
    return bpy.context.object


def farthest(points, others):
    """Of each point from the nearest of the others."""
    tree = KDTree(len(others))
    for index, other in enumerate(others):
        tree.insert(other, index)
    tree.balance()
    return max(tree.find(point)[2] for point in points)


with checking("a calm sea lies on the surface that Blender's own subdivision comes to, creases included"):
    fresh_file()
    cage = hilly()
    sea = sea_on(cage)
    change(sea, sea__wind_speed_mps=0.0, surface__cage_level=3)
    assert not play.simulation_of(sea).problem, play.simulation_of(sea).problem
    ours = numbers(sea.data)
    smooth = cage.copy()
    smooth.data = cage.data.copy()
    bpy.context.collection.objects.link(smooth)
    modifier = smooth.modifiers.new("Smooth", "SUBSURF")
    modifier.levels, modifier.quality, modifier.boundary_smooth = 3, 8, "PRESERVE_CORNERS"
    theirs = numbers(evaluated_mesh(smooth))
    assert len(ours) == len(theirs) == 33**2
    apart = farthest(ours, theirs)
    crease_edges(smooth.data, cages.compat.creases(smooth.data)[0]**0.5)  # what a sharpness of ten times the crease would be
    smooth.data.update()
    bpy.context.view_layer.update()
    other = farthest(ours, numbers(evaluated_mesh(smooth)))
    print(f"    from Blender's surface: {1e3 * apart:.2f} mm, from one of other creases {1e3 * other:.0f} mm")
    assert apart < 0.01 < 0.1 < other
    bpy.data.objects.remove(smooth)

with checking("waves are on top of it, and the sea follows when the cage changes or moves"):
    change(sea, sea__wind_speed_mps=15.0)
    wavy = numbers(sea.data)
    assert 0.2 < (wavy - ours)[:, 2].std() < 3.0 and wavy[:, 2].max() > 8.0
    cage.data.vertices[12].co.z = 0.0
    cage.data.update()
    bpy.context.view_layer.update()
    assert numbers(sea.data)[:, 2].max() < wavy[:, 2].max() - 3.0
    cage.location.z = 30.0
    bpy.context.view_layer.update()
    assert numbers(sea.data)[:, 2].min() > 15.0
    cage.location.z = 0.0

with checking("modifiers of the cage count; one that subdivides is refused in words"):
    waves = cage.modifiers.new("Lift", "DISPLACE")
    waves.strength, waves.direction = 10.0, "Z"
    waves.mid_level = 0.0
    bpy.context.view_layer.update()
    lifted = numbers(sea.data)[:, 2].mean()
    assert lifted > 5.0, lifted
    cage.modifiers.remove(waves)
    smooth = cage.modifiers.new("Smooth", "SUBSURF")
    bpy.context.view_layer.update()
    assert "subdivide it twice" in play.simulation_of(sea).problem
    cage.modifiers.remove(smooth)
    bpy.context.view_layer.update()
    assert not play.simulation_of(sea).problem

with checking("baked as it is, and played; a shot file can't name it"):
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 2
    bpy.context.scene.frame_set(2)
    sea.pelagic_bake.folder = str(folder)
    bpy.context.view_layer.objects.active = sea
    assert bpy.ops.pelagic.bake() == {"FINISHED"}
    live = numbers(sea.data)
    assert bpy.ops.pelagic.play_bake(filepath=str(folder / ocean.clean_name(sea.name))) == {"FINISHED"}
    played = bpy.context.object
    # A bake's footprints are powers of two, the live sea's begin at its smallest cell: the shortest waves differ a little.
    apart = np.abs(numbers(played.data) - live)
    print(f"    the bake is {apart.mean():.3f} m from the live sea, at most {apart.max():.3f} m")
    assert not baked.problems and apart.max() < 0.1 and apart.mean() < 0.02
    bpy.context.view_layer.objects.active = sea
    assert refused(lambda: bpy.ops.pelagic.export_shot(filepath=str(folder / "x.toml")), "came from no file")

with checking("the cage is evaluated in renders too, still and animated, and no picture shows it"):
    def rendered(animation):
        """The sea's mean height and its problem at each frame that is rendered."""
        seen = []

        def look(_scene, depsgraph):
            if depsgraph.mode == "RENDER":
                seen.append((numbers(sea.data)[:, 2].mean(), play.simulation_of(sea).problem))

        bpy.app.handlers.frame_change_post.append(look)
        bpy.ops.render.render(animation=animation)
        bpy.app.handlers.frame_change_post.remove(look)
        return seen

    fresh_file()
    cage = hilly()
    lift = cage.modifiers.new("Lift", "DISPLACE")
    lift.strength, lift.mid_level, lift.direction = 10.0, 0.0, "Z"
    sea = sea_on(cage)
    assert cage.display_type == "WIRE" and not cage.hide_render and not any(getattr(cage, each) for each in cages.RAYS)
    change(sea, sea__wind_speed_mps=0.0)
    scene = bpy.context.scene
    flat = numbers(sea.data)[:, 2].mean()
    scene.camera.location, scene.camera.rotation_euler = (0.0, 0.0, 120.0), (0.0, 0.0, 0.0)
    picture = cycles_exr(folder / "sea.exr", (48, 27), 4)
    assert [round(float(height - flat), 3) for height, _ in rendered(False)] == [0.0]
    cage.hide_render = True  # the sea that was there plays on
    without = cycles_exr(folder / "sea.exr", (48, 27), 4)
    assert np.array_equal(picture, without)
    for rays in cages.RAYS:
        setattr(cage, rays, True)
    cage.hide_render = False
    assert not np.array_equal(picture, cycles_exr(folder / "sea.exr", (48, 27), 4)), "the camera looks at the cage"
    for frame, strength in ((1, 10.0), (3, 30.0)):
        lift.strength = strength
        lift.keyframe_insert("strength", frame=frame)
    for curve in cages.compat.curves(cage):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene.frame_start, scene.frame_end = 1, 3
    scene.frame_set(1)
    scene.render.filepath = str(folder / "frame_")
    assert [round(float(height - flat), 2) for height, _ in rendered(True)] == [0.0, 10.0, 20.0]

with checking("a cage that Blender leaves out, and so doesn't evaluate, is refused with the remedy"):
    cage.hide_render = True
    for animation in (False, True):
        assert all("Disable in Renders" in problem for _, problem in rendered(animation))
    cage.hide_render, cage.hide_viewport = False, True
    bpy.context.view_layer.update()
    assert "Disable in Viewports" in play.simulation_of(sea).problem
    cage.hide_viewport = False
    bpy.context.view_layer.update()
    assert not play.simulation_of(sea).problem
    cage.hide_set(True)  # in this view alone: it is evaluated for the sea
    scene.frame_set(3)
    assert not play.simulation_of(sea).problem and abs(numbers(sea.data)[:, 2].mean() - flat - 20.0) < 0.01
    cage.hide_set(False)

with checking("a bake of an animated cage says that it has it as it is now, whatever moves it"):
    def is_told():
        bpy.context.view_layer.update()
        return any(remark.startswith(f"{cage.name} is animated") for remark in exchange.shot_of(bpy.context, sea)[1])

    assert is_told() and scene.frame_current == 3
    cage.animation_data_clear()
    assert not is_told()
    cage.keyframe_insert("location", frame=1)
    assert not is_told(), "keys that change nothing"
    cage.location.x = 5.0
    cage.keyframe_insert("location", frame=3)
    assert is_told()
    cage.animation_data_clear()
    driver = lift.driver_add("strength").driver
    driver.expression = "frame"
    assert is_told()
    lift.driver_remove("strength")
    cage.shape_key_add(name="Basis")
    key = cage.shape_key_add(name="Up")
    key.data[12].co.z += 3.0
    key.value = 0.0  # as it was from the start before 5.0
    key.keyframe_insert("value", frame=1)
    key.value = 1.0
    key.keyframe_insert("value", frame=3)
    assert is_told()
    cage.shape_key_clear()
    cage.modifiers.new("Wave", "WAVE")
    assert is_told()
    cage.modifiers.clear()
    scene.camera = None
    assert not is_told()

with checking("a still cage is read once, and again when it changes; what is no cage's is passed over"):
    scene.camera = bpy.data.objects["Camera"]
    built, walked = [], []
    of_mesh, all_oceans = cages.of_mesh, play.oceans
    cages.of_mesh = lambda *arguments: built.append(1) or of_mesh(*arguments)
    play.oceans = lambda: walked.append(1) or all_oceans()

    def built_by(what):
        built.clear(), walked.clear()
        what()
        bpy.context.view_layer.update()
        return len(built)

    other = bpy.data.objects.new("Other", None)
    bpy.context.collection.objects.link(other)
    scene.frame_set(1)
    assert built_by(lambda: [scene.frame_set(frame) for frame in (2, 3, 4)]) == 0
    assert built_by(lambda: setattr(other.location, "z", 4.0)) == 0 and not walked
    assert built_by(lambda: change(sea, sea__wind_speed_mps=3.0)) == 0
    assert built_by(lambda: setattr(cage.location, "z", 4.0)) >= 1
    hook = cage.modifiers.new("Hook", "HOOK")
    hook.object = other
    hook.vertex_indices_set([12])
    bpy.context.view_layer.update()
    before = numbers(sea.data)[:, 2].max()
    assert built_by(lambda: setattr(other.location, "z", 24.0)) >= 1
    assert numbers(sea.data)[:, 2].max() > before + 5.0
    for frame, z in ((5, 24.0), (8, 0.0)):
        other.location.z = z
        other.keyframe_insert("location", frame=frame)
    scene.frame_set(5)
    assert built_by(lambda: scene.frame_set(7)) == 1
    assert built_by(lambda: scene.frame_set(8)) == 1
    cages.of_mesh, play.oceans = of_mesh, all_oceans
    cage.modifiers.clear()

with checking("a cage that Blender mirrors has its faces the same way up"):
    cage.location = (0.0, 0.0, 0.0)
    change(sea, sea__wind_speed_mps=0.0)
    upright = numbers(sea.data)
    up = [polygon.normal.z for polygon in sea.data.polygons]
    cage.scale.x = -1.0
    bpy.context.view_layer.update()
    assert np.allclose(numbers(sea.data)[:, 0].max(), -upright[:, 0].min(), atol=1e-3)
    assert min(up) > 0.0 < min(polygon.normal.z for polygon in sea.data.polygons)
    cage.scale.x = 1.0

with checking("an ocean is nobody's cage, its own least"):
    assert cages.can_be(cage) and not cages.can_be(sea) and not cages.can_be(other)
    count = len(sea.data.vertices)
    twin = add_ocean(surface__kind="cage")
    for one, another in ((sea, sea), (sea, twin), (twin, sea)):
        one.pelagic.cage = another
        bpy.context.view_layer.update()
        for frame in (2, 3):
            scene.frame_set(frame)
        assert "is an ocean" in play.simulation_of(one).problem and len(sea.data.vertices) == count
    bpy.data.objects.remove(twin)

with checking("a deleted cage is gone, and no file keeps it"):
    sea.pelagic.cage = cage
    scene.frame_set(4)
    assert not play.simulation_of(sea).problem
    bpy.ops.object.select_all(action="DESELECT")
    cage.select_set(True)
    name = cage.name
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    assert "cage_file" in play.simulation_of(sea).problem, play.simulation_of(sea).problem
    scene.frame_set(5)
    assert "cage_file" in play.simulation_of(sea).problem
    name_of_sea = sea.name
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "deleted.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "deleted.blend"))
    assert name not in bpy.data.objects and bpy.data.objects[name_of_sea].pelagic.cage is None
    sea = bpy.data.objects[name_of_sea]

with checking("what is no cage is refused, and nothing is added"):
    mesh = bpy.data.meshes.new("Book")  # three faces round an edge
    mesh.from_pydata([(0, 0, 0), (0, 9, 0), (9, 0, 0), (-9, 0, 0), (0, 0, 9)], [], [(0, 2, 1), (0, 1, 3), (1, 0, 4)])
    book = bpy.data.objects.new("Book", mesh)
    bpy.context.collection.objects.link(book)
    bpy.context.view_layer.objects.active = book
    kinds = (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.lights, bpy.data.worlds)
    counts = [len(kind) for kind in kinds]
    give, given = cages.compat.creases, []
    cages.compat.creases = lambda mesh: given.append(1) or give(mesh)
    assert refused(bpy.ops.pelagic.use_cage, "Book")
    cages.compat.creases = give
    assert [len(kind) for kind in kinds] == counts
    assert len(given) == 1, "it is asked, and says why, once"

with checking("without a cage the sea says what it needs"):
    sea.pelagic.cage = None
    bpy.context.view_layer.update()
    assert "cage_file" in play.simulation_of(sea).problem
