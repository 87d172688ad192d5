# SPDX-License-Identifier: GPL-3.0-or-later
"""What a camera in the water sees in EEVEE.

Nothing there bends light up to a critical angle and mirrors it beyond, and no light comes through the surface into a volume. So all that
isn't an object of the artist's glows by the core's numbers: the surface by the sky that its facets let through and the water that they
mirror, and water and floor by a picture of what the camera sees of both in each direction, which is the glow of a volume as wide as
the floor, too, where EEVEE can have one: before the artist's objects it takes as much of their light away as it adds of its own. Cycles has its own (depths.py).
"""

import math

import numpy as np

from . import compat, light
from .facets import WATER_INDEX, add_fresnel
from .module import pelagic

SURFACE, SHOWN = "Surface from Below", "Seen from Below"  # nodes of the water's material, the second only while it shows
SKY, WATER, AHEAD = "Sky from Below", "Water Around the Camera", "Water before the Surface"
SUN, SUN_LIGHT, ON_SEA = "Sun from Below", "Sunlight", "Light on the Sea"
FOG = "Lost before the Eye"  # [1/m], of both
GLOW, BETWEEN = "Light from the Floor", "Water in Between"  # of the floor's
PICTURE, OWN_SKY = "Pelagic Water", "Pelagic Sky from Below"  # images, the second where the world is an artist's
LETS_THROUGH = 0.5  # kFoamLetsThrough of below.glsl
WIDTH = 256  # of the picture: what it has of the sun is wide
SUN_WIDTH = 0.03  # by how much the sun behind a facet is blurred [rad]: of its disc next to no sample would find any
FOG_AT_M = 5.0  # one decay for all distances: that of what is so far away, where a diver sees
DEEPEST_M = 10e3  # of pelagic.water_radiance()


def add_surface(tree, part, foam, above):
    """Adds what connect() shows. part, foam: of add_facets() and add_foam(); above: the shader of the surface from above."""
    geometry, facet, cosine = tree.node("ShaderNodeNewGeometry"), part["Normal"], part["Facet Cosine"]
    to_eye = tree.value(geometry, "Incoming")
    beyond = (1.0 - (1.0 - cosine * cosine) * WATER_INDEX**2).sqrt()
    kept = add_fresnel(tree, beyond)
    let = (1.0 - kept) * WATER_INDEX**2
    x, y, z = (facet * (cosine * WATER_INDEX - beyond) - to_eye * WATER_INDEX).parts()
    ray = tree.vector(x, y, z.at_least(1e-3)).normalized()
    # The chord of a small angle serves as well.
    chord = (ray - tree.named(SUN, "ShaderNodeCombineXYZ")).length() * (1.0 / SUN_WIDTH)
    sun = tree.named(SUN_LIGHT, "ShaderNodeRGB") * ((chord * chord * -0.5).at_least(-80.0).exp() * (1.0 / (2.0 * math.pi * SUN_WIDTH**2)))
    x, y, z = (facet * (2.0 * cosine) - to_eye).parts()
    mirrored = tree.named(WATER, "ShaderNodeTexEnvironment", {"Vector": tree.vector(x, y, z.at_most(-1e-3))})
    seen = (tree.named(SKY, "ShaderNodeTexEnvironment", {"Vector": ray}) + sun) * let + mirrored * kept
    through_foam = tree.named(ON_SEA, "ShaderNodeRGB") * (foam["Color"] * -LETS_THROUGH + (LETS_THROUGH,) * 3) * (1.0 / math.pi)
    before = lambda seen: seen  # noqa: E731
    if not compat.eevee_volumes_reach_far():  # then the surface has the water before it itself
        away = tree.add("ShaderNodeCameraData", output="View Distance")
        left = tree.vector(*[(-(each * away)).at_least(-80.0).exp() for each in tree.named(FOG, "ShaderNodeRGB").parts()])
        x, y, z = (-to_eye).parts()
        ahead = tree.named(AHEAD, "ShaderNodeTexEnvironment", {"Vector": tree.vector(x, y, z.at_most(-1e-3))})
        before = lambda seen: tree.mix(left, ahead, seen)  # noqa: E731
    glow = tree.add("ShaderNodeMixShader", {0: foam["Foam"], 1: tree.add("ShaderNodeEmission", {"Color": before(seen)}),
                                            2: tree.add("ShaderNodeEmission", {"Color": before(through_foam)})})
    seen = tree.add("ShaderNodeMixShader", {0: tree.value(geometry, "Backfacing"), 1: above, 2: glow})
    # What is in the water has the lamps' light.
    tree.named(SURFACE, "ShaderNodeMixShader", {0: tree.add("ShaderNodeLightPath", output="Is Shadow Ray"), 1: seen,
                                           2: tree.add("ShaderNodeBsdfTransparent")})


def add_floor(tree):
    """Adds what connect() shows of a floor, and before it."""
    x, y, z = (-tree.add("ShaderNodeNewGeometry", output="Incoming")).parts()
    around = tree.named(WATER, "ShaderNodeTexEnvironment", {"Vector": tree.vector(x, y, z.at_most(-1e-3))})
    tree.named(GLOW, "ShaderNodeEmission", {"Color": around})
    lost = tree.named(FOG, "ShaderNodeRGB")
    if compat.eevee_volumes_reach_far():
        most = tree.add("ShaderNodeVectorMath", {0: lost, 1: (1.0, 1.0, 1.0)}, "Value", operation="DOT_PRODUCT")
        tree.named(BETWEEN, "ShaderNodeAddShader", {
            0: tree.add("ShaderNodeVolumeAbsorption", {"Color": lost * (-1.0 / most.at_least(1e-6)) + (1.0, 1.0, 1.0), "Density": most}),
            1: tree.add("ShaderNodeEmission", {"Color": around * lost})})


def connect(material, floor, scene, depth_m):
    """Makes EEVEE show the surface from below, the water and the floor (an object) to a camera this deep [m], None: to none."""
    nodes = material.node_tree.nodes
    floor_tree = floor.data.materials[0].node_tree if floor is not None and floor.data.materials else None
    below = floor_tree.nodes if floor_tree else {}
    is_shown = depth_m is not None and SURFACE in nodes and FOG in below
    _show(material.node_tree, is_shown, {"Surface": SURFACE})
    if FOG in below:
        _show(floor_tree, is_shown, {"Surface": GLOW, "Volume": BETWEEN})
        floor.display_type = "TEXTURED" if is_shown else "BOUNDS"  # a view draws nothing else of it
    if not is_shown:
        return
    sky, water = light.sky_of(scene), pelagic.WaterBody(scene)
    nodes[WATER].image = below[WATER].image = light.packed_image(PICTURE, _around(sky, water, min(float(depth_m), DEEPEST_M)), nodes[WATER].image)
    for socket, value in zip(nodes[SUN].inputs, sky.sun_direction):
        socket.default_value = value
    _set(nodes[SUN_LIGHT], np.array(sky.sun_radiance) * math.pi * sky.sun_angular_radius**2)
    _set(nodes[ON_SEA], np.array(sky.sun_irradiance) + np.array(sky.sky_irradiance))
    lost = [-math.log(max(part, 1e-6)) / FOG_AT_M for part in water.lets_through(FOG_AT_M)]
    _set(below[FOG], lost)
    if AHEAD in nodes:
        nodes[AHEAD].image = nodes[WATER].image
        _set(nodes[FOG], lost)


def put_sky(material, scene, image):
    """The sky that shows through the surface. image: of the scene's sky, None: Blender has another one."""
    node = material.node_tree.nodes.get(SKY)
    if node is None or SHOWN not in material.node_tree.nodes:
        return
    is_own = node.image is not None and node.image.name.startswith(OWN_SKY)
    if image is not None:
        node.image = image
    elif not is_own or material.get(OWN_SKY) != repr(scene.light):
        sky = light.sky_of(scene)
        node.image = light.packed_image(OWN_SKY, sky.image(light.SKY_WIDTH), node.image if is_own else None)
        material[OWN_SKY] = repr(scene.light)


def _show(tree, is_shown, sources):
    """An output for EEVEE of the nodes of these names by socket, those that there are, or none."""
    output = tree.nodes.get(SHOWN)
    if output is not None and not is_shown:
        tree.nodes.remove(output)
    elif output is None and is_shown:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.name = output.label = SHOWN
        output.target = "EEVEE"
        for socket, name in sources.items():
            if name in tree.nodes:
                tree.links.new(tree.nodes[name].outputs[0], output.inputs[socket])
                output.location = tree.nodes[name].location.x + 200, tree.nodes[name].location.y
        output.is_active_output = True


def _set(node, colour):
    node.outputs[0].default_value = (*map(float, colour), 1.0)


def _around(sky, water, depth_m):
    """float32 (WIDTH/2, WIDTH, 3), rows from the top: the water's light in each direction; above the horizon that of the horizon."""
    up = 0.5 * math.pi - 2.0 * math.pi * (np.arange(WIDTH // 2) + 0.5) / WIDTH
    up, azimuth = np.meshgrid(np.minimum(up, -1e-3), math.pi - 2.0 * math.pi * (np.arange(WIDTH) + 0.5) / WIDTH, indexing="ij")
    towards = np.stack([np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)], axis=-1).astype(np.float32)
    return pelagic.water_radiance(sky, water, towards.reshape(-1, 3), depth_m).reshape(towards.shape)
