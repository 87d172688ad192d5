"""A first look at a shot in Blender: its sea as a mesh that moves with the timeline, to the horizon, under its sun.

    blender -b --factory-startup --python examples/blender-first-look.py -- SHOT.toml --out DIR
    blender --factory-startup --python examples/blender-first-look.py -- SHOT.toml

The first renders two pictures, DIR/NAME.####.png; the second leaves the sea in the window, to play and to look
around in. examples/blender-first-look.sh builds the module `pelagic`, whose folder has to be in PYTHONPATH, and
calls this.
How the buffers get into the mesh, and why in this way: examples/blender-buffers.md.
"""

import argparse
import math
import os
import sys
import tempfile

import bpy
import numpy as np
from bpy.app.handlers import persistent
from mathutils import Matrix, Vector

try:
    import pelagic
except ImportError as error:
    sys.exit(f"{error}: put the folder of the module pelagic into PYTHONPATH; examples/blender-first-look.sh does")

OBJECT = "Sea"
HORIZON_M = 30e3  # ends less than a pixel below the true horizon for cameras up to about 15 m above the sea
RING_GROWTH = 1.05  # each ring of quads round the patch is wider than the last by this factor
WATER_IOR = 1.34


# ---- The points: the patch, as the bake writes it, and rings of growing quads round it out to the horizon


def sea_points(size_m, resolution):
    """(rest, quads, cell_m): the patch's points first; cell_m is each point's distance to its neighbours."""
    rest, quads = pelagic.patch(size_m, resolution)
    spacing_m = size_m / resolution
    side = np.arange(resolution)
    row = resolution + 1
    # The patch's edge, counter-clockwise from its south-west corner: 4N points.
    edge = np.concatenate([side, side * row + resolution, (row * row - 1) - side, (resolution - side) * row])
    steps_m = spacing_m * RING_GROWTH ** np.arange(1, 1 + math.ceil(
        math.log(1 + HORIZON_M / spacing_m * (RING_GROWTH - 1), RING_GROWTH)))
    scale = 1 + np.cumsum(steps_m) / (size_m / 2)
    rings = scale[:, None, None] * rest[edge].astype(np.float64)

    first = np.concatenate([[0], len(rest) + len(edge) * np.arange(len(scale))])
    inner = np.concatenate([edge[None], first[1:-1, None] + np.arange(len(edge))[None]])
    outer = first[1:, None] + np.arange(len(edge))[None]
    ring_quads = np.stack([inner, outer, np.roll(outer, -1, 1), np.roll(inner, -1, 1)], axis=-1)

    cell_m = np.concatenate([np.full(len(rest), spacing_m),
                             np.repeat(np.maximum(steps_m, spacing_m * scale), len(edge))])
    return (np.concatenate([rest, rings.reshape(-1, 2)]).astype(np.float32),
            np.concatenate([quads, ring_quads.reshape(-1, 4)]).astype(np.int32), cell_m.astype(np.float32))


def make_mesh(rest, quads, size_m):
    """A flat mesh with the UV map UVMap: 0 … 1 over the patch, and on outside it, as in the bake's primvars:st."""
    mesh = bpy.data.meshes.new(OBJECT)
    mesh.vertices.add(len(rest))
    mesh.loops.add(quads.size)
    mesh.polygons.add(len(quads))
    mesh.vertices.foreach_set("co", np.pad(rest, ((0, 0), (0, 1))).ravel())
    mesh.loops.foreach_set("vertex_index", quads.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(quads), 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(quads), dtype=bool))
    mesh.update(calc_edges=True)
    uv = mesh.uv_layers.new(name="UVMap")
    uv.data.foreach_set("uv", (rest[quads.ravel()] / size_m + 0.5).astype(np.float32).ravel())
    return mesh


# ---- The sea, frame by frame


class LivingSea:
    """Holds the sea, one frame of it and the arrays; writes the sea at a time into the object that it made."""

    # The mesh's attributes: name, type, the property for foreach_set, the module's name.
    ATTRIBUTES = (("velocity", "FLOAT_VECTOR", "vector", "velocity"),
                  ("slope_variance", "FLOAT_VECTOR", "vector", "slope_variance"),
                  ("whitecap_coverage", "FLOAT", "value", "coverage"))

    def __init__(self, shot):
        self.shot = shot
        surface = shot.surface
        self.rest, quads, self.cell_m = sea_points(surface.size_m, surface.resolution)
        # Filter levels a factor of two apart, from the patch's quads to the farthest. Waves that a quad can't
        # show go into the variance and the coverage, so that the far sea is as rough as the near one.
        spacing_m = surface.size_m / surface.resolution
        rungs = 1 + math.ceil(math.log2(max(self.cell_m.max() / spacing_m, 1)))
        ladder_m = [spacing_m * 2**i for i in range(rungs + 1)]
        products = ["position", "velocity", "slope_variance"] + ["coverage"] * shot.effects.whitecaps
        self.frame = pelagic.Frame(pelagic.Sea(shot, products, cell_m=ladder_m, pixel_m=ladder_m))
        points = len(self.rest)
        self.arrays = {product: np.empty(points if product == "coverage" else (points, 3), np.float32)
                       for product in products}
        self.time_s = None

        self.object = bpy.data.objects.new(OBJECT, make_mesh(self.rest, quads, surface.size_m))
        self.name = self.object.name  # the object itself may not outlive an undo
        for name, kind, _, product in self.ATTRIBUTES:
            if product in self.arrays:
                self.object.data.attributes.new(name, kind, "POINT")

    def show(self, frame):
        """Any frame, also between two, in any order, repeatedly, from any thread."""
        time_s = self.shot.shot.time_s(frame)
        if time_s != self.time_s:
            self.frame.set(time_s)
            self.frame.evaluate(self.rest, cell_m=self.cell_m, pixel_m=self.cell_m, **self.arrays)
            self.time_s = time_s
        sea = bpy.data.objects.get(self.name)
        if sea is None or len(sea.data.vertices) != len(self.rest):
            return  # deleted or edited: no longer ours
        sea.data.vertices.foreach_set("co", self.arrays["position"].ravel())
        for name, _, numbers, product in self.ATTRIBUTES:
            if product in self.arrays:
                sea.data.attributes[name].data.foreach_set(numbers, self.arrays[product].ravel())
        sea.data.update()

    def follow_timeline(self):
        @persistent
        def show_current(scene, _depsgraph=None):
            self.show(scene.frame_current_final)

        for handlers in (bpy.app.handlers.frame_change_post, bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
            handlers.append(show_current)


# ---- Materials, light, camera


class Nodes:
    """Shorthand for building a node tree: values and other nodes' sockets alike become a node's inputs."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, inputs=None, output=0, **settings):
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        self.connect(node, inputs or {})
        return node.outputs[output] if len(node.outputs) else None

    def connect(self, node, inputs):
        for name, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value

    def math(self, operation, *values, clamp=False):
        return self.add("ShaderNodeMath", dict(enumerate(values)), operation=operation, use_clamp=clamp)


def water_material(shot):
    material = bpy.data.materials.new("Water")
    material.use_nodes = True
    nodes = Nodes(material.node_tree)
    add, calc = nodes.add, nodes.math

    place = add("ShaderNodeVectorMath", {0: add("ShaderNodeUVMap", uv_map="UVMap"), 1: (shot.surface.size_m,) * 3},
                operation="MULTIPLY")  # the rest position [m]: the texture moves with the water
    along = add("ShaderNodeVectorRotate", {"Vector": place, "Angle": -math.radians(shot.sea.wind_direction_deg)})
    hidden = add("ShaderNodeAttribute", attribute_name="slope_variance", output="Vector")
    variance = add("ShaderNodeSeparateXYZ", {"Vector": hidden}).node.outputs
    normal = ripples(nodes, shot, along, variance)
    # The rest is roughness: microfacets of width α² = 2σ², where σ² is the mean of the variances along x and
    # y. Principled's roughness is √α. So roughness = ((1 − part)(σxx + σyy))^¼.
    roughness = calc("POWER", calc("MULTIPLY", calc("ADD", variance[0], variance[1]), 1 - RIPPLE_PART), 0.25)
    # Light from under the surface: a dark body, slightly greener in the thin crests.
    height = add("ShaderNodeSeparateXYZ", {"Vector": add("ShaderNodeNewGeometry", output="Position")}, output=2)
    crest = add("ShaderNodeMapRange", {"Value": height, "From Min": 0.0, "From Max": 3.0})
    body = add("ShaderNodeMixRGB",
               {"Fac": crest, "Color1": (0.004, 0.035, 0.052, 1), "Color2": (0.012, 0.1, 0.105, 1)})
    normal_reflectance = ((WATER_IOR - 1) / (WATER_IOR + 1)) ** 2
    water = add("ShaderNodeBsdfPrincipled",
                {"Base Color": body, "Roughness": roughness, "Specular": normal_reflectance / 0.08,
                 "Normal": normal})

    # Foam: coverage is the fraction of the surface that is white. Fine noise decides where, so that a
    # half-covered crest has streaks of foam instead of grey.
    coverage = add("ShaderNodeAttribute", attribute_name="whitecap_coverage", output="Fac")
    # Streaks are elongated along the wind.
    streaks = add("ShaderNodeVectorMath", {0: along, 1: (FOAM_PER_M / 4, FOAM_PER_M, 1)}, operation="MULTIPLY")
    noise = add("ShaderNodeTexNoise", {"Vector": streaks, **NOISE})
    foam = foam_mask(nodes, coverage, noise)
    white = add("ShaderNodeBsdfDiffuse", {"Color": FOAM_ALBEDO})
    surface = add("ShaderNodeMixShader", {0: foam, 1: water, 2: white})
    add("ShaderNodeOutputMaterial", {"Surface": surface})
    return material


# Blender's noise, its mean and deviation measured over 512² points. Between its 0.1 % and 99.9 % quantiles it
# is as good as normally distributed.
NOISE = {"Scale": 1.0, "Detail": 6.0, "Roughness": 0.65}
NOISE_MEAN, NOISE_DEVIATION = 0.5, 0.0602
RIPPLE_PART = 0.8  # of the hidden slope variance, drawn as ripples; the rest becomes roughness
RIPPLE_PER_M = 1.4  # the noise's coarsest octave along the wind; half as frequent across it, as crests are
FOAM_PER_M = 1.6  # the noise's coarsest octave across the wind
FOAM_EDGE = 1.6  # half the width of the soft edge, in logits: foam thins out before it ends
FOAM_ALBEDO = (0.55, 0.565, 0.57, 1)  # dense fresh foam (Koepke 1984)


def scaled(nodes, along, per_m):
    return nodes.add("ShaderNodeVectorMath", {0: along, 1: (per_m, per_m / 2, 1)}, operation="MULTIPLY")


def ripples(nodes, shot, along, variance):
    """A normal: the mesh's, tilted by noise whose slopes have the hidden variance. So the waves that are too short
    for the mesh are there, if not at their own places, and near and far the sea is as rough as the shot says."""
    add = nodes.add
    noise = nodes.tree.nodes.new("ShaderNodeTexNoise")
    noise.noise_dimensions = "4D"
    nodes.connect(noise, {"Vector": scaled(nodes, along, RIPPLE_PER_M), **NOISE})
    # The noise changes over about a second.
    noise.inputs["W"].driver_add("default_value").driver.expression = f"frame / {shot.shot.fps}"
    numbers = add("ShaderNodeSeparateXYZ", {"Vector": noise.outputs["Color"]}).node.outputs
    slopes = [nodes.math("MULTIPLY", nodes.math("SUBTRACT", NOISE_MEAN, numbers[axis]),
                         nodes.math("SQRT", nodes.math("MULTIPLY", variance[axis], RIPPLE_PART / NOISE_DEVIATION**2)))
              for axis in (0, 1)]
    tilt = add("ShaderNodeCombineXYZ", {"X": slopes[0], "Y": slopes[1]})
    mesh_normal = add("ShaderNodeNewGeometry", output="Normal")
    tilted = add("ShaderNodeVectorMath", {0: mesh_normal, 1: tilt}, operation="ADD")
    unit = add("ShaderNodeVectorMath", {0: tilted}, operation="NORMALIZE")
    # As the colour of a normal map: only this node keeps reflections above the surface at grazing angles.
    colour = add("ShaderNodeVectorMath", {0: unit, 1: (0.5,) * 3, 2: (0.5,) * 3}, operation="MULTIPLY_ADD")
    return add("ShaderNodeNormalMap", {"Color": colour}, space="WORLD")


def foam_mask(nodes, coverage, noise):
    """A mask of the surface where the noise has its largest values, with the mean `coverage`."""
    calc = nodes.math
    part = calc("MINIMUM", calc("MAXIMUM", coverage, 1e-9), 1 - 1e-6)
    asked = calc("LOGARITHM", calc("DIVIDE", part, calc("SUBTRACT", 1.0, part)), math.e)
    # The logit of the normal distribution of z, within 1.4e-4 in probability: 1.5976 z + 0.070566 z³.
    z = calc("DIVIDE", calc("SUBTRACT", noise, NOISE_MEAN), NOISE_DEVIATION)
    rank = calc("MULTIPLY", z, calc("MULTIPLY_ADD", calc("MULTIPLY", z, z), 0.070566, 1.5976))
    return nodes.add("ShaderNodeMapRange", {"Value": calc("ADD", rank, asked), "From Min": -FOAM_EDGE,
                                            "From Max": FOAM_EDGE}, interpolation_type="SMOOTHSTEP")


DUST, OZONE = 0.15, 4.0  # in Blender's units, whose defaults are 1: less haze and more ozone, for a bluer sky


def make_world(light):
    """Sun and sky: Blender's own clear sky, whose sun azimuth is clockwise from +y."""
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    nodes = Nodes(world.node_tree)
    sky = nodes.add("ShaderNodeTexSky", sky_type="NISHITA", sun_disc=True, dust_density=DUST, ozone_density=OZONE,
                    sun_elevation=math.radians(light.sun_elevation_deg),
                    sun_rotation=math.radians(90.0 - light.sun_azimuth_deg))
    nodes.add("ShaderNodeOutputWorld", {"Surface": nodes.add("ShaderNodeBackground", {"Color": sky})})
    return world


def camera_matrix(position_m, look_at_m):
    """The camera looks along its −z, with z up in the picture; looking straight down or up, +y is up."""
    back = (Vector(position_m) - Vector(look_at_m)).normalized()
    up = Vector((0, 0, 1)) if back.xy.length > 1e-6 else Vector((0, 1, 0))
    right = up.cross(back).normalized()
    axes = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    return Matrix.Translation(position_m) @ axes


def make_camera(shot):
    camera = bpy.data.cameras.new("Camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.angle = math.radians(shot.camera.fov_deg)
    camera.clip_end = 2 * HORIZON_M
    eye = bpy.data.objects.new("Camera", camera)
    eye.rotation_mode = "QUATERNION"
    keys = [(key.frame, Vector(key.position_m), Vector(key.look_at_m)) for key in shot.camera.keys]
    if not keys:
        eye.matrix_world = camera_matrix(shot.camera.position_m, shot.camera.look_at_m)
    # Position and target are linear between keys; the rotation isn't, hence a key for each frame.
    for (frame, at, target), (next_frame, next_at, next_target) in zip(keys, keys[1:] + keys[-1:]):
        for here in range(frame, max(next_frame, frame + 1)):
            part = (here - frame) / max(next_frame - frame, 1)
            eye.matrix_world = camera_matrix(at.lerp(next_at, part), target.lerp(next_target, part))
            eye.keyframe_insert("location", frame=here)
            eye.keyframe_insert("rotation_quaternion", frame=here)
    return eye


def make_scene(shot):
    """A new Blender scene of the shot, in the window if there is one; its LivingSea follows the timeline."""
    scene = bpy.data.scenes.new(shot.shot.name)
    if bpy.context.window:
        bpy.context.window.scene = scene
    scene.frame_start, scene.frame_end = shot.shot.frames
    fps = shot.shot.fps
    scene.render.fps, scene.render.fps_base = max(round(fps), 1), max(round(fps), 1) / fps

    sea = LivingSea(shot)
    sea.object.data.materials.append(water_material(shot))
    scene.collection.objects.link(sea.object)
    scene.camera = make_camera(shot)
    scene.collection.objects.link(scene.camera)
    scene.world = make_world(shot.light)

    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False  # Debian's Blender has no denoiser
    scene.cycles.max_bounces = 3
    scene.cycles.caustics_reflective = False
    scene.cycles.sample_clamp_indirect = 10.0
    scene.view_settings.view_transform = "Filmic"
    scene.render.use_lock_interface = True  # frames change on the render thread
    scene.render.resolution_x, scene.render.resolution_y = shot.camera.resolution
    scene.render.resolution_percentage = 100
    sea.follow_timeline()
    scene.frame_set(scene.frame_start)
    return scene, sea


# ---- Pictures


def render(scene, path):
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True, scene=scene.name)


MIDDLE_GREY, HIGHLIGHT = 0.22, 6.5  # scene-linear; Filmic's curve ends at 16


def meter(scene):
    """Sets the exposure as a camera's meter does, from a thumbnail: the median becomes a middle grey, unless the
    brightest fiftieth, a sun's glitter, would lose its drawing."""
    settings, samples = scene.render.image_settings, scene.cycles.samples
    with tempfile.TemporaryDirectory() as folder:
        settings.file_format, scene.cycles.samples = "OPEN_EXR", min(samples, 4)
        scene.render.resolution_percentage = 10
        thumbnail = os.path.join(folder, "meter.exr")
        render(scene, thumbnail)
        image = bpy.data.images.load(thumbnail)
        pixels = np.array(image.pixels[:], dtype=np.float32).reshape(-1, 4)
        bpy.data.images.remove(image)
    scene.cycles.samples, scene.render.resolution_percentage = samples, 100
    luminance = pixels[:, :3] @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
    middle, bright = np.maximum(np.percentile(luminance, [50, 98]), 1e-6)
    scene.view_settings.exposure = math.log2(min(MIDDLE_GREY / middle, HIGHLIGHT / bright))


def parse_arguments(arguments):
    def size(text):
        width, height = (int(part) for part in text.lower().split("x"))
        return width, height

    def frames(text):
        return [int(part) for part in text.split(",")]

    parser = argparse.ArgumentParser(prog="blender-first-look.py", description=__doc__.splitlines()[0])
    parser.add_argument("shot", metavar="SHOT.toml")
    parser.add_argument("--out", metavar="DIR", help="where the pictures go; without it none are rendered")
    parser.add_argument("--frames", metavar="A,B", type=frames, help="default: the shot's first and its middle one")
    parser.add_argument("--samples", metavar="N", type=int, default=48, help="a pixel; default 48")
    parser.add_argument("--size", metavar="WxH", type=size, help="of the pictures; default: the shot's resolution")
    return parser.parse_args(arguments)


def main():
    arguments = parse_arguments(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    try:
        shot = pelagic.Scene.from_file(arguments.shot)
    except pelagic.ShotError as error:
        sys.exit(str(error))
    scene, _ = make_scene(shot)
    scene.cycles.samples = arguments.samples
    if arguments.size:
        scene.render.resolution_x, scene.render.resolution_y = arguments.size
    if not arguments.out:
        return
    first, last = shot.shot.frames
    wanted = arguments.frames or [first, (first + last + 1) // 2]
    scene.frame_set(wanted[0])
    meter(scene)
    scene.render.image_settings.file_format = "PNG"
    for frame in wanted:
        scene.frame_set(frame)
        render(scene, os.path.join(os.path.abspath(arguments.out), f"{shot.shot.name}.{frame:04d}.png"))


if __name__ == "__main__":
    main()
