"""Water that is seen through: what lies under a level sea, in Cycles."""

import math
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable(sky_width=256)
import pelagic
from pelagic_ocean import compat, depths, light, material, nodes, upwelling
from pictures import cycles_exr

SAMPLES = 24


def square(name, half_m, z_m):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x * half_m, y * half_m, z_m) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], [], [(0, 1, 2, 3)])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def level_sea(water="ocean", depth_m=math.inf, sun_deg=60.0, floor=0.4):
    """A level sea seen through, from straight above, over sand where it isn't deep; its scene and object."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy_scene = bpy.context.scene
    obj = square("Sea", 3e3, 0.0)
    scene = pelagic.Scene()
    scene.light.sun_elevation_deg = sun_deg
    scene.sea.wind_speed_mps, scene.sea.depth_m, scene.water.floor_colour = 0.5, depth_m, (floor,) * 3
    scene.light.turbidity = 3.0  # the clearer the air, the more of the light goes down straight: another 2 % of that
    scene.water.type = water
    light.ensure_light(bpy_scene, scene)
    obj.pelagic.see_through = True
    material.ensure_material(obj, scene)
    data = bpy.data.cameras.new("Camera")
    data.type, data.ortho_scale = "ORTHO", 1.0
    bpy_scene.camera = bpy.data.objects.new("Camera", data)
    bpy_scene.collection.objects.link(bpy_scene.camera)
    bpy_scene.camera.location.z = 20.0
    return scene, obj


def seen(samples=SAMPLES):
    with tempfile.TemporaryDirectory() as folder:
        pixels = cycles_exr(Path(folder) / "picture.exr", (16, 16), samples)
    assert np.isfinite(pixels).all()
    return pixels[..., :3].mean((0, 1))


def bent_cosine(cosine):
    """Below the surface, of light at this one above it."""
    return np.sqrt(1.0 - (1.0 - cosine**2) / 1.34**2)


def painted(white):
    made = bpy.data.materials.new("Paint")
    made.use_nodes = True
    paint = made.node_tree.nodes["Principled BSDF"].inputs
    paint["Base Color"].default_value = (white,) * 3 + (1.0,)
    paint["Specular" if "Specular" in paint else "Specular IOR Level"].default_value = 0.0  # since 4.0
    return made


def of_plane(plane, z_m):
    """What comes from a white plane so deep, without what the water over it scatters."""
    plane.location.z = z_m
    pictures = []
    for paint in (painted(0.5), painted(0.0)):
        plane.data.materials.clear()
        plane.data.materials.append(paint)
        pictures.append(seen(8 * SAMPLES))  # a difference is noisier
    return pictures[0] - pictures[1]


with checking("a plane under a level sea is dimmed by the water over it, on the way in and out"):
    for water in ("ocean", "turbid"):
        scene, _ = level_sea(water)
        bpy.context.scene.world = None  # the sun alone, whose way through the water is known
        bpy.context.scene.cycles.diffuse_bounces = 0  # not what water lights the plane with
        c = np.sum(depths.coefficients(scene), axis=0)
        plane = square("Plane", 20.0, 0.0)
        ratio = of_plane(plane, -2.5) / of_plane(plane, -0.5)
        expected = np.exp(-2.0 * c * (1.0 + 1.0 / bent_cosine(pelagic.Sky(scene).sun_direction[2])))
        print("  ", water, ratio, expected)
        assert np.allclose(ratio, expected, rtol=0.01)

with checking("without SHARP, as since Blender 4.0, a refraction of no roughness is as sharp"):
    def with_distributions(*names):
        distribution = SimpleNamespace(enum_items={name: None for name in names})
        return SimpleNamespace(bl_rna=SimpleNamespace(properties={"distribution": distribution}))

    choose, node = compat.sharp_refraction, nodes.Tree.node
    own = bpy.types.ShaderNodeBsdfRefraction.bl_rna.properties["distribution"].enum_items.keys()
    assert choose(with_distributions("SHARP", "BECKMANN", "GGX")) == "SHARP" and choose() == choose(with_distributions(*own))

    def node_of_4(tree, kind, inputs=(), **settings):
        if kind == "ShaderNodeBsdfRefraction" and settings.get("distribution") not in ("BECKMANN", "GGX"):
            raise TypeError(f"enum {settings.get('distribution')} not found in ('BECKMANN', 'GGX')")
        return node(tree, kind, inputs, **settings)

    pictures = []
    for is_4 in (False, True):
        if is_4:
            compat.sharp_refraction = lambda: choose(with_distributions("BECKMANN", "GGX"))
            nodes.Tree.node = node_of_4
        _, obj = level_sea()
        refraction = [each for each in obj.data.materials[0].node_tree.nodes
                      if each.type == "BSDF_REFRACTION" and not each.inputs["Roughness"].is_linked]  # the one from below is rough
        assert [each.distribution for each in refraction] == ["BECKMANN" if is_4 else choose()]
        square("Plane", 0.3, -2.5).data.materials.append(painted(0.5))  # its edges are in the picture
        pictures.append(seen())
    compat.sharp_refraction, nodes.Tree.node = choose, node
    print("  ", pictures[1] / pictures[0])
    assert np.allclose(pictures[0], pictures[1], rtol=0.01)

with checking("deep water is as bright as it is opaque"):
    for water in ("ocean", "turbid"):
        scene, obj = level_sea(water)
        clear = seen()
        obj.pelagic.see_through = False
        material.update_material(obj, scene)
        opaque = seen()
        print("  ", water, clear / opaque)
        assert np.allclose(clear, opaque, rtol=0.15)

# Alone this sees that the volume's colours are the core's, with what the surface sends down again and the bent way of a low sun.
with checking("water over a floor that is seen through is as bright as opaque water of the core's colour"):
    for water, depth_m, sun_deg, floor in (("jerlov-IB", 2.0, 70.0, 0.9), ("coastal", 2.0, 12.0, 0.5), ("jerlov-IB", 20.0, 35.0, 0.5)):
        scene, obj = level_sea(water, depth_m, sun_deg, floor)
        clear = seen(2 * SAMPLES)
        obj.pelagic.see_through = False
        material.update_material(obj, scene)
        # The opaque water is for an eye at 45 degrees.
        straight_down, aslant = (upwelling.albedo(scene, to_eye=eye)[0] for eye in (np.array([[0, 0, 1]], np.float32), None))
        opaque = seen() * (1.0 + (straight_down - aslant) / np.maximum(aslant, 1e-3))
        print("  ", water, depth_m, sun_deg, np.round(clear, 3), np.round(clear / opaque, 3))
        assert np.allclose(clear, opaque, rtol=0.15, atol=0.02 * opaque.max())

with checking("the volume's coefficients are finite and not negative, in the dark and in a puddle, too"):
    scene = pelagic.Scene()
    for depth_m, sun_deg, water in ((2.5, -30.0, "ocean"), (0.01, 40.0, "ocean"), (0.05, 0.0, "turbid"), (1e6, 40.0, "jerlov-9C")):
        scene.sea.depth_m, scene.light.sun_elevation_deg, scene.water.type = depth_m, sun_deg, water
        found = np.array(depths.coefficients(scene))
        assert np.isfinite(found).all() and (found >= 0.0).all() and found.sum() > 0.0, (depth_m, sun_deg, found)

    scene = pelagic.Scene()
    scene.sea.depth_m = 2.5
    calm = depths.coefficients(scene)
    scene.sea.swell = [pelagic.Swell(height_m=1.0, period_s=9.0, direction_deg=0.0)]  # more than the water could carry that the volume is measured with
    assert np.allclose(depths.coefficients(scene), calm)

with checking("by itself water is seen through where its floor shows, out to the horizon; and as somebody chooses"):
    fresh_file()
    obj = add_ocean(horizon=True, water__type="jerlov-IB")

    def is_clear():
        bpy.context.view_layer.update()
        assert (depths.OUTPUT in obj.data.materials[0].node_tree.nodes) == (len(obj.children) == 1)
        return len(obj.children) == 1

    assert not is_clear()
    change(obj, sea__use_depth_m=True, sea__depth_m=20.0)
    assert is_clear()
    scene = pelagic.Scene()
    scene.water.type = "jerlov-IB"
    water, clear_m = pelagic.WaterBody(scene), depths.clear_to_m(scene)
    least = min(a + b for a, b in zip(water.absorption_per_m, water.backscatter_per_m))
    assert math.isclose(math.exp(-2.35 * least * clear_m), 0.05, rel_tol=0.02) and 25.0 < clear_m < 60.0, clear_m
    for settings in ({"water__type": "turbid"}, {"sea__depth_m": 1.1 * clear_m}, {"water__body": False}, {"surface__kind": "projected-grid"}):
        before = {path: getattr(getattr(obj.pelagic, path.split("__")[0]), path.split("__")[1]) for path in settings}
        change(obj, **settings)
        assert not is_clear(), settings
        change(obj, **before)
        assert is_clear(), settings
    obj.pelagic.see_through = False
    assert not is_clear()
    obj.pelagic.see_through_by_hand = False
    assert is_clear()

with checking("the switch of an ocean brings the floor and takes it away"):
    fresh_file()
    obj = add_ocean()
    for is_on in (True, False, True):
        obj.pelagic.see_through = is_on
        bpy.context.view_layer.update()
        assert len(obj.children) == is_on and (depths.OUTPUT in obj.data.materials[0].node_tree.nodes) == is_on
