"""The water's light in Blender: its panel, bubbles and crests at vertices, and an artist's lagoon, against the core.

    water.py
"""

import math
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable(sky_width=256)
import pelagic
from mathutils import Matrix
from pelagic_ocean import depths, diving, ocean, play, query, surfaces, upwelling
from pelagic_ocean.properties import FIELDS
from pictures import core_layers, cycles_exr, shot_in_blender

FOLDER = Path(tempfile.mkdtemp())


class Layout:
    """Writes down which properties and words are drawn."""

    def __init__(self):
        self.drawn = []

    def prop(self, _owner, name, **_):
        self.drawn.append(name)

    def label(self, text="", **_):
        self.drawn.append(text)

    def __getattr__(self, _what):
        return lambda *_, **__: self


def drawn(panel):
    layout = Layout()
    panel.draw(SimpleNamespace(layout=layout, bl_label=panel.bl_label, tables=panel.tables), bpy.context)
    return layout.drawn


with checking("the panel Water has the artist's few, those that do something; the rest is in a closed one below"):
    fresh_file()
    obj = add_ocean(horizon=True)
    panel, more = bpy.types.PELAGIC_PT_view_water, bpy.types.PELAGIC_PT_view_water_more
    few = [name for name in drawn(panel) if name in {field.name for field in FIELDS} | {"use_depth_m", "see_through_by_hand"}]
    assert few == ["type", "chlorophyll_mg_m3", "use_depth_m", "crest_light", "bubbles", "see_through_by_hand"], few
    assert not panel.bl_options and more.bl_options == {"DEFAULT_CLOSED"} and more.bl_parent_id == panel.__name__
    assert "body" in drawn(more) and not {"type", "bubbles"} & {*drawn(more), *drawn(bpy.types.PELAGIC_PT_view_light)}
    change(obj, sea__use_depth_m=True, sea__depth_m=3.0, water__type="jerlov-II")
    shown = drawn(panel)
    assert "floor_colour" in shown and "depth_m" in shown and "chlorophyll_mg_m3" not in shown, shown
    assert any("near enough" in text for text in shown) and any(text.startswith("Clear down to") for text in shown), shown
    change(obj, sea__depth_m=200.0)
    assert any("too deep" in text for text in drawn(panel)), drawn(panel)
    obj.pelagic.see_through = True  # a script's choice is one by hand
    assert obj.pelagic.see_through_by_hand and "see_through" in drawn(panel)
    change(obj, water__body=False)
    assert not {"floor_colour", "crest_light", "bubbles"} & set(drawn(panel))

with checking("bubbles: turquoise where foam is, less as it ages, by the core; off there is no attribute and no node"):
    fresh_file()
    obj = add_ocean(sea__wind_speed_mps=18.0, effects__foam_decay_s=4.0, water__crest_light=0.0)
    assert upwelling.ATTRIBUTE not in obj.data.attributes  # nobody looks
    play.is_lit_in_a_view, is_lit = lambda: True, play.is_lit_in_a_view
    bpy.context.scene.frame_set(2)
    nodes = obj.data.materials[0].node_tree.nodes
    added, foam = numbers(obj.data, upwelling.ATTRIBUTE), {name: numbers(obj.data, attribute) for name, attribute in (
        ("coverage", "whitecap_coverage"), ("foam_active", "foam_active"), ("foam_age", "foam_age"))}
    scene = ocean.scene_of(obj, bpy.context.scene)
    sky, water = pelagic.Sky(scene), pelagic.WaterBody(scene)
    to_eye = np.tile(np.array(upwelling.FROM, np.float32), (len(added), 1))
    expected = pelagic.water_albedo(sky, water, to_eye, **foam) - pelagic.water_albedo(sky, water, to_eye)
    assert np.abs(added - expected)[foam["coverage"] > upwelling.LEAST_COVERAGE].max() < 1e-6
    seen = added[added[:, 1] > 0.005]
    assert len(seen) and (seen[:, 1] > 1.2 * seen[:, 0]).all(), added.max(0)
    before = added.max()
    change(obj, water__bubbles=2.0)  # live, without another sea
    assert numbers(obj.data, upwelling.ATTRIBUTE).max() > 1.3 * before and upwelling.NODE in nodes
    change(obj, water__bubbles=0.0)
    assert upwelling.ATTRIBUTE not in obj.data.attributes and upwelling.NODE not in nodes
    change(obj, water__bubbles=1.0)
    assert np.array_equal(numbers(obj.data, upwelling.ATTRIBUTE), added) and upwelling.NODE in nodes
    change(obj, water__body=False)
    assert upwelling.ATTRIBUTE not in obj.data.attributes and upwelling.NODE not in nodes
    play.is_lit_in_a_view = is_lit


def backlit(crest_light):
    """A swell before a low sun, without foam: (Cycles' picture, the core's light from the water), and what the mesh had while rendering."""
    scene = pelagic.Scene()
    scene.sea.wind_speed_mps, scene.sea.fetch_m = 11.0, 200e3
    scene.effects.whitecaps, scene.water.type, scene.water.crest_light = False, "coastal", crest_light
    scene.light.sun_elevation_deg, scene.light.sun_azimuth_deg = 20.0, 90.0
    scene.camera.position_m, scene.camera.look_at_m = (0.0, 0.0, 5.0), (0.0, 30.0, 0.0)
    scene.shot.name, scene.shot.frames = "backlit", (1, 1)
    shot = FOLDER / "backlit.toml"
    scene.save(shot)
    core = core_layers(shot, (64, 36))["sea"]
    obj = shot_in_blender(shot, (64, 36))
    tree = obj.data.materials[0].node_tree
    for mirror in [node for node in tree.nodes if node.type in ("BSDF_GLOSSY", "BSDF_ANISOTROPIC")]:  # whose noise would hide the water
        for link in mirror.inputs["Color"].links:
            tree.links.remove(link)
        mirror.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    held = []
    look = lambda *_: held.append(upwelling.ATTRIBUTE in obj.data.attributes)  # noqa: E731
    played = upwelling.ATTRIBUTE in obj.data.attributes
    bpy.app.handlers.render_post.append(look)
    cycles = cycles_exr(FOLDER / "cycles.exr", (64, 36), 48)
    bpy.app.handlers.render_post.remove(look)
    return cycles[..., :3], core, played, held


# Alone this sees that the light in waves is at its place in a picture, with its sign: two renders.
with checking("waves shape the light in the water as in the core's picture, while it is rendered, and not while it plays"):
    (lit, core_lit, played, held), (level, core_level, *_) = backlit(1.0), backlit(1e-3)  # 0 would leave out the eye's way, too
    sea = core_level[..., 1] > 0.05
    got, expected = ((lit - level)[sea][:, 1], (core_lit - core_level)[sea][:, 1])
    alike, slope = np.corrcoef(got, expected)[0, 1], (got * expected).sum() / (expected**2).sum()
    print("   correlation", round(alike, 2), "amplitude", round(slope, 2), "of", np.round(expected.std() / core_level[sea][:, 1].mean(), 2))
    assert not played and held == [True]
    assert alike > 0.8 and 0.7 < slope < 1.3, (alike, slope)

with checking("an ocean that is turned has the light of the world's sun"):
    added = []
    for turn in (0.0, math.radians(90.0)):
        scene = pelagic.Scene()
        scene.light.sun_elevation_deg, scene.light.sun_azimuth_deg = 20.0, 30.0 + math.degrees(turn)
        surface = surfaces.patch(60.0, 20, False)
        arrays = pelagic.Frame(pelagic.Sea(scene, ("position",), cell_m=surface.levels_m(), pixel_m=surface.levels_m()))
        arrays.set(3.0)
        eye = (20.0, -30.0, 4.0), tuple(number for row in Matrix.Rotation(turn, 3, "Z") for number in row)
        added.append(upwelling.Upwelling(scene).added(arrays.evaluate(surface.rest, cell_m=surface.cell_m), surface, 3.0, eye))
    # The waves' variances, which let light in, are the same along x and y to some per cent.
    assert np.abs(added[0]).max() > 1e-3 and np.allclose(*added, atol=0.1 * np.abs(added[0]).max()), np.abs(added[0] - added[1]).max()

# Alone this sees a lagoon as an artist gets it: preset, default settings of Cycles, clear water that came by itself.
with checking("a lagoon in three steps: added, its preset, rendered; as bright as the core's picture in each band"):
    fresh_file()
    bpy.ops.pelagic.add_ocean()
    obj, bpy_scene = bpy.context.object, bpy.context.scene
    bpy.ops.pelagic.preset_apply(name="lagoon")
    bpy.context.view_layer.update()
    assert depths.OUTPUT in obj.data.materials[0].node_tree.nodes and len(obj.children) == 1
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = 48, 27
    scene = ocean.scene_of(obj, bpy_scene)
    scene.shot.name, scene.shot.frames = "lagoon", (1, 1)
    scene.camera.resolution = (48, 27)
    scene.save(FOLDER / "lagoon.toml")
    core = sum(core_layers(FOLDER / "lagoon.toml", (48, 27)).values()).mean((0, 1))
    ratio = cycles_exr(FOLDER / "lagoon.exr", (48, 27), 64)[..., :3].mean((0, 1)) / core
    print("  ", np.round(ratio, 3))
    assert (np.abs(ratio - 1.0) < 0.15).all(), ratio


def from_below(z_m, pitch_deg, fov_deg):
    """The lagoon that is open from a camera in it: (Cycles' picture, the core's, directions of the pixels)."""
    size, bpy_scene = (48, 27), bpy.context.scene
    camera = bpy_scene.camera
    camera.data.sensor_fit, camera.data.angle = "HORIZONTAL", math.radians(fov_deg)
    camera.location, camera.rotation_euler = (0.0, 0.0, z_m), (math.radians(90.0 + pitch_deg), 0.0, 0.0)
    bpy.context.view_layer.update()
    scene = ocean.scene_of(obj, bpy_scene)
    scene.shot.name, scene.shot.frames = "below", (1, 1)
    scene.save(FOLDER / "below.toml")
    core = 1.34**2 * sum(core_layers(FOLDER / "below.toml", size).values())  # whose camera is in air, behind its glass
    x, y = np.meshgrid(*((np.arange(count) + 0.5 - 0.5 * count) * 2.0 * math.tan(math.radians(0.5 * fov_deg)) / size[0] for count in size))
    towards = np.stack([x, y, -np.ones_like(x)], axis=-1) @ np.array(camera.matrix_world.to_3x3()).T
    return cycles_exr(FOLDER / "below.exr", size, 32)[..., :3], core, towards / np.linalg.norm(towards, axis=-1, keepdims=True)


# Alone this sees the surface from below, the camera in the volume and the floor that it sees: two renders.
with checking("a camera in the lagoon sees Snell's window, the floor mirrored round it, and the water before it, as in the core's pictures"):
    cycles, core, towards = from_below(-1.5, 89.0, 120.0)
    sun = np.array(pelagic.Sky(scene).sun_direction) / 1.34
    sun[2] = math.sqrt(1.0 - sun[0] ** 2 - sun[1] ** 2)  # as it is seen from below
    window, outside = (towards[..., 2] > 0.77) & (towards @ sun < 0.9), towards[..., 2] < 0.57
    ahead, core_ahead, towards = from_below(-1.5, -10.0, 70.0)
    floor, level = towards[..., 2] < -0.25, np.abs(towards[..., 2]) < 0.02
    ratios = [mine[part].mean(0)[1:] / its[part].mean(0)[1:] for mine, its, part in (
        (cycles, core, window), (cycles, core, outside), (ahead, core_ahead, floor), (ahead, core_ahead, level))]
    print("   green and blue: window {}, outside {}, floor {}, level {}".format(*(np.round(each, 3) for each in ratios)))
    # Level views lack what the core scatters ahead; without water before it the floor would be five times as bright there.
    assert (np.abs(np.array(ratios[:3]) - 1.0) < 0.1).all() and (0.4 < ratios[3]).all() and (ratios[3] < 1.3).all(), ratios

with checking("a dive: deep water is a volume while the camera is below its surface, not its level at rest, and opaque again above"):
    fresh_file()
    obj, camera = add_ocean(horizon=True, sea__wind_speed_mps=12.0), bpy.context.scene.camera
    bpy.context.view_layer.update()
    surface = query.Water(obj, bpy.context.scene).world_heights([(0.0, 0.0)])[0]
    nodes, found = obj.data.materials[0].node_tree.nodes, []
    for frame, z in ((1, 3.0), (2, surface - 0.1), (3, surface + 0.1), (4, -3.0), (5, 3.0)):
        camera.location = (0.0, 0.0, z)
        camera.keyframe_insert("location", frame=frame)
    change(obj, shot__time_scale=0.01)  # the waves stand still
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)
        floor = [child for child in obj.children if depths.MARK in child and child.visible_camera]
        found.append((depths.OUTPUT in nodes, len(floor), nodes[depths.FROM_BELOW].outputs[0].default_value, diving.SHOWN in nodes))
        if frame == 4:
            assert any(text.startswith("The camera is under water") for text in drawn(panel)), drawn(panel)
            around = np.array(nodes[diving.WATER].image.pixels).reshape(diving.WIDTH // 2, diving.WIDTH, 4)[..., :3]
            down = pelagic.water_radiance(pelagic.Sky(ocean.scene_of(obj, bpy.context.scene)), pelagic.WaterBody(ocean.scene_of(obj, bpy.context.scene)),
                                          np.array([(0.0, 0.0, -1.0)], np.float32), 3.0)[0]
            assert np.allclose(around[0].mean(0), down, rtol=0.03), (around[0].mean(0), down)  # rows from the bottom
    above, below = (False, 0, 0.0, False), (True, 1, 1.0, True)
    assert found == [above, below, above, below, above], (surface, found)

with checking("a dive with See Through by hand in water without a body, and one under another world's sky"):
    fresh_file()
    obj, camera = add_ocean(horizon=True), bpy.context.scene.camera
    obj.pelagic.see_through = True
    camera.location = (0.0, 0.0, -12.345)
    bpy.context.view_layer.update()
    nodes = obj.data.materials[0].node_tree.nodes
    assert diving.SHOWN in nodes and obj[depths.UNDER] == 12.0, obj.get(depths.UNDER)
    bpy.context.scene.world = bpy.data.worlds.new("Somebody's")
    change(obj, light__sun_elevation_deg=33.0)
    assert nodes[diving.SKY].image.name.startswith(diving.OWN_SKY), nodes[diving.SKY].image
    change(obj, water__body=False)
    assert diving.SHOWN not in nodes
    assert not any(node.name == diving.SHOWN for child in obj.children for node in child.data.materials[0].node_tree.nodes)
