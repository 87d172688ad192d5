"""What happens to artists: things done twice, taken away, or turned round."""

import shutil
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))
from bpy_extras.object_utils import world_to_camera_view
from harness import *  # noqa: F403
from mathutils import Vector

enable()
from pelagic_ocean import light, look, ocean, panels, play
from pelagic_ocean.query import Water


def cube():
    bpy.ops.mesh.primitive_cube_add(size=2)
    return bpy.context.object


def grid():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=40)
    return bpy.context.object


FOLDER = Path(tempfile.mkdtemp())
fresh_file()
scene = bpy.context.scene
sea = add_ocean()

with checking("Float No More for what never floated leaves its own delta transforms alone"):
    dry = cube()
    dry.delta_location.z = 5.0
    bpy.ops.pelagic.float(enabled=False)
    assert dry.delta_location.z == 5.0

with checking("Float, twice: the calm place stays where it was"):
    raft = cube()
    bpy.ops.pelagic.float()
    scene.frame_set(40)
    once = raft.delta_location.copy()
    bpy.ops.pelagic.float()
    scene.frame_set(41)
    scene.frame_set(40)
    assert raft.delta_location == once and once.length > 0.1
    bpy.ops.pelagic.float(enabled=False)
    assert raft.delta_location.length == 0.0

with checking("its ocean is released or deleted: it floats in the scene's first"):
    raft.pelagic_float.enabled = True
    for take_away in (bpy.ops.pelagic.release_mesh, bpy.ops.object.delete):
        other = add_ocean(sea__wind_speed_mps=25.0)
        raft.pelagic_float.ocean = other
        scene.frame_set(41)
        scene.frame_set(40)
        assert raft.delta_location != once
        take_away()
        scene.frame_set(41)
        scene.frame_set(40)
        assert raft.delta_location == once

with checking("the height of the water in what is no ocean is 0 for drivers, and refused by Water"):
    assert bpy.app.driver_namespace["pelagic_height"](0, 0, 1, raft.name) == 0.0
    try:
        Water(raft, scene)
        raise AssertionError("a raft isn't an ocean")
    except LookupError as error:
        assert "no ocean" in str(error)

with checking("samples of an ocean without a sea are refused in words, and the frame stays"):
    dry_sea = add_ocean(sea__spectrum="file")
    play._simulations.clear()
    raft.select_set(True)
    assert refused(lambda: bpy.ops.pelagic.sample_heights(into="TEXT"), "spectrum_file")
    assert scene.frame_current == 40
    bpy.data.objects.remove(dry_sea)

with checking("the rest of an own mesh is deleted: it plays on from where it is, and can be released"):
    obj = grid()
    bpy.ops.pelagic.use_mesh()
    for follows in (True, False):
        obj.data.attributes.remove(obj.data.attributes["rest_position"])
        if follows:
            before = numbers(obj.data)
            scene.frame_set(3)
            assert not play.simulation_of(obj).problem and not np.array_equal(numbers(obj.data), before)
    bpy.ops.pelagic.release_mesh()
    assert not ocean.is_ocean(obj)

with checking("a mesh with shape keys is refused: they would put its vertices back"):
    obj = grid()
    obj.shape_key_add(name="Basis")
    assert refused(bpy.ops.pelagic.use_mesh, "shape keys") and not ocean.is_ocean(obj)

fresh_file()
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = 160, 90
camera = scene.camera
camera.location, camera.rotation_euler = (0, 0, 9), (1.4, 0, 0)
sea = add_ocean(surface__kind="projected-grid", sea__wind_speed_mps=3.0)

with checking("planets and meshes from near to far are for bakes: the object says so, and shows what it showed"):
    shown = numbers(sea.data)
    for kind in ("planet", "near-far"):
        change(sea, surface__kind=kind)
        assert "bake" in play.simulation_of(sea).problem and (numbers(sea.data) == shown).all(), kind
    change(sea, surface__kind="projected-grid")
    assert not play.simulation_of(sea).problem

with checking("a lens shift: the projected grid is where the picture is"):
    for shift in ((0.4, 0.0), (-0.4, -0.3)):
        camera.data.shift_x, camera.data.shift_y = shift
        bpy.context.view_layer.update()
        seen = np.array([world_to_camera_view(scene, camera, Vector(point)) for point in numbers(sea.data)[::3]])
        seen = seen[seen[:, 2] > 0]
        assert seen[:, 0].min() < 0.0 and seen[:, 0].max() > 1.0 and seen[:, 1].min() < 0.0, shift

with checking("a sea that is being built for another view isn't taken for this one's"):
    simulation = play.simulation_of(sea)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    bpy.app.handlers.depsgraph_update_post.remove(play._on_update)  # it would wait for each sea
    sea.pelagic.shot.seed += 1
    camera.location.z = 9000.0
    depsgraph.update()
    far = simulation.follow(sea, scene, depsgraph, wait=False)
    camera.location.z = 9.0
    depsgraph.update()
    assert simulation.is_building
    view = simulation.follow(sea, scene, depsgraph, wait=True)
    assert view != far and simulation._built.serves(view)
    bpy.app.handlers.depsgraph_update_post.insert(0, play._on_update)

with checking("an ocean that is scaled to nothing has no camera, and is what it was when it comes back"):
    fresh_file()
    scene = bpy.context.scene
    sea = add_ocean(surface__kind="projected-grid", effects__foam_decay_s=0.0)
    play.show(sea, scene, bpy.context.evaluated_depsgraph_get())
    before = numbers(sea.data)
    for scale in (0.0, 1.0):
        sea.scale = (scale,) * 3
        bpy.context.view_layer.update()
        play.show(sea, scene, bpy.context.evaluated_depsgraph_get())
        assert (ocean.pinhole_of(sea, scene) is None) == (scale == 0.0)
        assert np.array_equal(numbers(sea.data), before), scale

with checking("a shot that can't be written is said in words"):
    assert refused(lambda: bpy.ops.pelagic.export_shot(filepath="/nowhere/at/all/sea.toml"), "can't be written")

with checking("what is made of frames says that it doesn't follow a stretched time"):
    scene.render.frame_map_new = 200
    assert refused(lambda: bpy.ops.pelagic.export_shot(filepath=str(FOLDER / "stretched.toml")), "Time Stretching")
    assert refused(bpy.ops.pelagic.bake, "Time Stretching") and refused(lambda: bpy.ops.pelagic.bake_volume(kind="spray"), "Time Stretching")
    raft = cube()
    assert refused(bpy.ops.pelagic.make_wake, "Time Stretching")
    assert refused(lambda: bpy.ops.pelagic.sample_heights(into="KEYFRAMES"), "Time Stretching") and not raft.animation_data
    bpy.data.objects.remove(raft)
    ocean.select_only(bpy.context, sea)
    scene.render.frame_map_new = 100
    assert bpy.ops.pelagic.export_shot(filepath=str(FOLDER / "stretched.toml")) == {"FINISHED"}

with checking("what an artist took out of the sky stays out, and the rest follows; Sun and Sky brings it back"):
    fresh_file()
    scene = bpy.context.scene
    sea = add_ocean()
    world = scene.world
    lamp = next(obj for obj in scene.objects if "pelagic_light" in obj)
    for gone in ("Pelagic Sun Disc", "Pelagic Sky"):
        nodes, before = world.node_tree.nodes, lamp.matrix_world.copy()
        nodes.remove(nodes[gone])
        world.use_nodes = False
        left = len(nodes)
        change(sea, light__sun_elevation_deg=sea.pelagic.light.sun_elevation_deg + 10.0)
        bpy.context.view_layer.update()
        assert lamp.matrix_world != before and len(nodes) == left, gone
        assert not world.use_nodes or bpy.app.version >= (5, 0), gone  # then each world has nodes
    bpy.ops.pelagic.add_light()
    assert scene.world == world and world.use_nodes and {"Pelagic Sun Disc", "Pelagic Sky"} <= set(nodes.keys())


class Layout:
    """Of a panel: keeps what it says."""

    def __init__(self):
        self.said = []

    def label(self, text="", **_):
        self.said.append(text)

    def operator(self, *_, **__):
        return SimpleNamespace()

    def __getattr__(self, name):
        return lambda *_, **__: self


def said_in(panel, **kept):
    layout = Layout()
    panel.draw(SimpleNamespace(layout=layout, **kept), bpy.context)
    return " ".join(layout.said)


with checking("whatever an ocean can't be is in its panel, and gone from there with its cause"):
    fresh_file()
    scene = bpy.context.scene
    sea = add_ocean()
    settings = sea.pelagic
    (FOLDER / "kept.exr").write_bytes(light.openexr(np.random.default_rng(1).random((16, 16, 3), np.float32)))

    def says(words):
        """words: what the panel says; "": that it says of nothing that it is wrong."""
        bpy.context.view_layer.update()
        wrong = play.simulation_of(sea).problem or look.problem_of(sea)
        assert words in wrong and bool(words) == bool(wrong), (words, wrong)
        assert "".join(wrong.split()) in "".join(said_in(panels.Main).split()), (wrong, said_in(panels.Main))

    says("")
    bpy.ops.pelagic.list_add(path="waves.vessels")
    path, settings.waves.vessels[0].path = settings.waves.vessels[0].path, ""
    says("waves.vessels[0].path")
    settings.waves.vessels[0].path = path
    says("")
    settings.waves.vessels.clear()
    bpy.ops.pelagic.list_add(path="waves.masks")
    for group, name in ((settings.waves.masks[0], "picture"), (settings.light, "sky"), (settings.effects, "foam_pattern"),
                        (settings.sea, "depth_file")):
        file, none = FOLDER / f"{name}.exr", getattr(group, name)
        setattr(group, name, str(file))
        says(file.name)
        scene.frame_set(scene.frame_current + 1)
        says(file.name)
        shutil.copy(FOLDER / "kept.exr", file)  # nothing of Blender's changes
        scene.frame_set(scene.frame_current + 1)
        says("")
        setattr(group, name, none)
    settings.waves.masks.clear()
    kept, play.wants_velocity = play.wants_velocity, lambda *_: {}["nobody thought of it"]
    scene.frame_set(scene.frame_current + 1)
    says("KeyError: 'nobody thought of it'. The console says where")
    play.wants_velocity = kept
    scene.frame_set(scene.frame_current + 1)
    says("")

with checking("a scene has one sun and sky: the second ocean says whose they are"):
    lamp = light.own_sun(scene)
    second = add_ocean()
    assert second != sea and "those of Ocean, its first ocean" in said_in(panels.Sub, bl_label="Light", tables=())
    before = lamp.matrix_world.copy()
    change(second, light__sun_elevation_deg=70.0)
    assert refused(bpy.ops.pelagic.add_light, "select Ocean") and lamp.matrix_world == before
    ocean.select_only(bpy.context, sea)
    assert "first ocean" not in said_in(panels.Sub, bl_label="Light", tables=())
    assert bpy.ops.pelagic.add_light() == {"FINISHED"}
