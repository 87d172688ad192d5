# SPDX-License-Identifier: GPL-3.0-or-later
"""The water as a volume, for Cycles: what is under the surface shows, dimmed and coloured by what is in the water.

Together absorption and scattering are the core's extinction. Scattering is isotropic, since the forward part of real scattering goes
on nearly as light does that isn't scattered, and as much as makes deep water, by the single scattering that Cycles does unless it is
asked for more, as bright as the opaque water.

Light comes in straight: Cycles finds no lamp through a surface that bends. What it loses on that way is brought to what it would lose
on the bent one, and of what comes from below the surface sends down its share. Seen from above, things stand where refraction shows them.
EEVEE keeps the opaque water: a volume fills its object's box there, and the air over the sea with it.

While the scene's camera is under water, any sea is seen through (UNDER), and its surface from below is that of below.glsl.
"""

import copy
import math

import bpy

from . import compat, diving, light, upwelling
from .facets import WATER_INDEX, add_fresnel
from .module import pelagic
from .nodes import Tree

SURFACE, VOLUME, OUTPUT = "Clear Surface", "Water Volume", "Clear Water"  # nodes, the last one only where it is switched on
ABSORPTION, SCATTERING, EXTINCTION = "Water Absorption", "Water Scattering", "Water Extinction"
FROM_BELOW = "Camera Under Water"  # the node: 1 while it is

UNDER = "pelagic_camera_under"  # on an ocean whose water the scene's camera is in: how far below its level at rest [m]
MARK = "pelagic_floor"  # on the object under clear water
FLOOR_M, FLOOR_DEPTH_M = 40e3, 500.0
WALL_M = 20.0  # how high the floor's walls are above the water at rest, while the camera is under it
SCATTERED_ONCE = 0.147
MOST_GIVEN_BACK = 15.0  # as an exponent: a sun 5 degrees high over the deepest floor that shows
RETURNED = 0.48  # of a uniform light from below a level surface
LEAST = 0.05  # of the floor's light, by which it is worth a volume's time
SKY_SLANT = 1.17  # kSkySlant of water.glsl
BOTH_WAYS = SKY_SLANT + 1.18  # with the way up to an eye at 45 degrees


def add_depths(tree, part, foam, mirror, white, upwards, before_air):
    """Adds what connect() shows. foam: add_foam()'s; mirror, white: shaders, of the reflected light and of foam; upwards: the vertical;
    before_air: puts the air before a shader."""
    path, geometry = tree.node("ShaderNodeLightPath"), tree.node("ShaderNodeNewGeometry")
    # Outside, radiance is spread over n² times the angles; Cycles leaves that to the colour.
    out = tree.vector(1.0, 1.0, 1.0) * ((1.0 - part["Fresnel"]) * WATER_INDEX**-2)
    bent = tree.add("ShaderNodeBsdfRefraction", {"Color": out, "Roughness": 0.0, "IOR": WATER_INDEX,
                                                 "Normal": part["Normal"]}, distribution=compat.sharp_refraction())
    seen = tree.add("ShaderNodeAddShader", {0: mirror, 1: bent})
    bubbles = tree.named(upwelling.CLEAR_OUT, "ShaderNodeVectorMath", {0: (0.0, 0.0, 0.0), "Scale": 1.0 - part["Fresnel"]}, operation="SCALE")
    tree.named(upwelling.CLEAR_LIGHT, "ShaderNodeBsdfDiffuse", {"Color": bubbles, "Normal": upwards})
    seen = tree.named(upwelling.CLEAR_SUM, "ShaderNodeAddShader", {0: seen})
    seen = before_air(tree.add("ShaderNodeMixShader", {0: foam["Foam"], 1: seen, 2: white}))

    # From below: nothing comes through beyond the critical angle, and within it radiance is n² times that of the sky. A facet has the same
    # Fresnel term on both sides, each at its own angle.
    facet = {"Roughness": part["Roughness"], "Normal": part["Normal"]}
    beyond = (1.0 - (1.0 - part["Facet Cosine"] * part["Facet Cosine"]) * WATER_INDEX**2).sqrt()
    kept = add_fresnel(tree, beyond)
    underside = tree.add("ShaderNodeAddShader", {
        0: tree.add("ShaderNodeBsdfAnisotropic", {"Color": tree.vector(1.0, 1.0, 1.0) * kept, "Anisotropy": 0.0, **facet},
                    distribution="BECKMANN"),
        1: tree.add("ShaderNodeBsdfRefraction", {"Color": tree.vector(1.0, 1.0, 1.0) * ((1.0 - kept) * WATER_INDEX**2),
                                                 "IOR": WATER_INDEX, **facet}, distribution="BECKMANN")})
    through_foam = tree.add("ShaderNodeBsdfTranslucent", {"Color": foam["Color"] * -diving.LETS_THROUGH + (diving.LETS_THROUGH,) * 3})
    underside = tree.add("ShaderNodeMixShader", {0: foam["Foam"], 1: underside,
                                                 2: tree.add("ShaderNodeAddShader", {0: white, 1: through_foam})})
    seen = tree.add("ShaderNodeMixShader", {0: tree.value(geometry, "Backfacing"), 1: seen, 2: underside})

    # Towards lamp and sky, and for rays that happen to find the sky, it is a window without a bend. What such a ray has lost on its way
    # through the water is brought to what it would have lost on the way of a bent one, under level water: as if it stood at the
    # angle of refraction.
    cosine = tree.math("ABSOLUTE", tree.value(geometry, "Incoming").parts()[2])
    below = (1.0 - (1.0 - cosine * cosine) * WATER_INDEX**-2).sqrt()
    extinction = tree.named(EXTINCTION, "ShaderNodeCombineXYZ")
    # Only where it leaves the water the first time: beyond, its length is that of its way through air, too. Before, it has come through
    # the surface once, or not at all from a camera in the water.
    above = tree.value(path, "Transmission Depth").above(0.5)
    in_water = tree.value(geometry, "Backfacing") * tree.math("ABSOLUTE", above - tree.named(FROM_BELOW, "ShaderNodeValue"))
    in_water = in_water * (1.0 - tree.value(path, "Transparent Depth").above(0.5))
    longer_m = in_water * tree.value(path, "Ray Length") * (1.0 - cosine / below)
    let_in = (1.0 - add_fresnel(tree, cosine)) * (1.0 - foam["Hidden"])
    given_back = tree.vector(*[(each * longer_m).at_most(MOST_GIVEN_BACK).exp() for each in extinction.parts()])
    straight = tree.add("ShaderNodeBsdfTransparent", {"Color": given_back * let_in})
    # And light from below is sent down again, its share of a uniform light. That isn't taken from the window: what comes in through it is
    # all there, whether by a lamp's ray or by one that finds the sky.
    mirrored = tree.add("ShaderNodeBsdfDiffuse", {"Color": (RETURNED,) * 3 + (1.0,)})
    inside = tree.add("ShaderNodeAddShader", {0: straight, 1: mirrored})
    is_shadow = tree.value(path, "Is Shadow Ray")
    from_below = tree.value(geometry, "Backfacing") * (1.0 - tree.value(path, "Is Camera Ray"))
    window = tree.add("ShaderNodeMixShader", {0: is_shadow, 1: inside, 2: straight})
    tree.named(SURFACE, "ShaderNodeMixShader", {0: is_shadow.at_least(from_below), 1: seen, 2: window})
    tree.named(VOLUME, "ShaderNodeAddShader", {0: tree.named(ABSORPTION, "ShaderNodeVolumeAbsorption"),
                                               1: tree.named(SCATTERING, "ShaderNodeVolumeScatter")})


_clear_to_m = {}  # a water's text → clear_to_m()


def clear_to_m(scene):
    """How deep a floor still shows [m]: of the light that goes down and comes up again LEAST is left there, in the band that goes
    farthest. None for a scene that isn't valid."""
    key = repr(scene.water)
    if key not in _clear_to_m:
        try:
            water = pelagic.WaterBody(scene)
        except (ValueError, pelagic.ShotError):
            return None
        if len(_clear_to_m) > 64:
            _clear_to_m.clear()
        least = min(a + b for a, b in zip(water.absorption_per_m, water.backscatter_per_m))
        _clear_to_m[key] = -math.log(LEAST) / (BOTH_WAYS * least)
    return _clear_to_m[key]


def is_seen_through(obj, scene):
    """Whether an ocean's water is a volume for Cycles: by hand, or where the camera is in it, or its floor shows and the surface reaches to
    the horizon."""
    if obj.pelagic.see_through_by_hand:
        return obj.pelagic.see_through
    if UNDER in obj:
        return scene.water.body
    return scene.water.body and scene.sea.depth_m < (clear_to_m(scene) or 0.0) and reaches_far(obj)


def reaches_far(obj):
    """Whether light comes in all round what is seen: not past the edge of a camera's grid, a cage or a mesh of one's own."""
    return obj.pelagic.surface.kind == "patch" and obj.pelagic.horizon and not obj.pelagic.own_mesh


def connect(obj, material, scene):
    """Makes Cycles show the volume of the scene's water over its floor, or the opaque water."""
    tree, is_on = material.node_tree, is_seen_through(obj, scene)
    output = tree.nodes.get(OUTPUT)
    if output is not None and not is_on:
        tree.nodes.remove(output)
        for floor in [child for child in obj.children if MARK in child]:
            bpy.data.objects.remove(floor)
    elif output is None and is_on and SURFACE in tree.nodes and VOLUME in tree.nodes:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.name = output.label = OUTPUT
        output.target = "CYCLES"
        output.location = tree.nodes[SURFACE].location
        output.location.x += 200
        tree.links.new(tree.nodes[SURFACE].outputs[0], output.inputs["Surface"])
        tree.links.new(tree.nodes[VOLUME].outputs[0], output.inputs["Volume"])
        _add_floor(obj)
    if is_on:
        _set_floor(obj, scene)
    floor = next((child for child in obj.children if MARK in child), None)
    diving.connect(material, floor, scene, obj.get(UNDER) if is_on and scene.water.body else None)


def _set_floor(obj, scene):
    """Where the sea has one, and black where no light comes from any more: what hits nothing is in no volume for Cycles."""
    is_seen = scene.water.body and scene.sea.depth_m < FLOOR_DEPTH_M
    depth_m, colour = (scene.sea.depth_m, scene.water.floor_colour) if is_seen else (FLOOR_DEPTH_M, (0.0, 0.0, 0.0))
    for floor in [child for child in obj.children if MARK in child]:
        floor.scale = (1.0, 1.0, -depth_m / floor.data.vertices[0].co.z)
        # A camera in the water sees it, and its walls, past which a level sight would meet nothing. And Cycles takes a camera to be in
        # a volume only where it is within the box of an object that has one: a sea's is flat.
        floor.visible_camera = floor.visible_glossy = UNDER in obj
        for corner in floor.data.vertices[4:]:
            corner.co.z = WALL_M / depth_m if UNDER in obj else floor.data.vertices[0].co.z
        floor.data.update()
        for node in floor.data.materials[0].node_tree.nodes if floor.data.materials else ():
            if node.type == "BSDF_DIFFUSE":
                node.inputs["Color"].default_value = (*colour, 1.0)


def _add_floor(obj):
    mesh = bpy.data.meshes.new("Pelagic Floor")
    mesh.from_pydata(2 * [(x * FLOOR_M, y * FLOOR_M, -1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], [],
                     [(0, 1, 2, 3)] + [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)])
    black = bpy.data.materials.new("Pelagic Floor")
    black.use_nodes = True
    tree = Tree(black.node_tree)
    # The volume is empty: the water is the sea's.
    tree.node("ShaderNodeOutputMaterial", {"Surface": tree.add("ShaderNodeBsdfDiffuse", {"Color": (0.0, 0.0, 0.0, 1.0)}),
                                           "Volume": tree.add("ShaderNodeVolumeAbsorption", {"Density": 0.0})})
    diving.add_floor(tree)
    mesh.materials.append(black)
    floor = bpy.data.objects.new("Pelagic Floor", mesh)
    floor[MARK] = True
    floor.parent, floor.hide_select, floor.display_type = obj, True, "BOUNDS"
    floor.visible_camera = floor.visible_glossy = False  # past the edge of a patch it isn't there, from above
    for collection in obj.users_collection:
        collection.objects.link(floor)


def coefficients(scene):
    """(absorption, scattering), (r, g, b) each [1/m]. Together they are the extinction by which the floor's light is the core's, of six bands;
    without a floor that shows the core's a + b_b. Of it so much is scattered that deep water has the core's reflectance."""
    deep = copy.copy(scene)
    deep.sea.depth_m = math.inf  # a floor is there to be seen through it
    water = pelagic.WaterBody(deep)
    absorption, scattering = [], []
    for extinction, reflectance in zip(_extinction(scene, water), water.reflectance):
        # Of the light that comes in at the cosine μ₀, b/c / (4 (μ + μ₀)) comes back to μ, scattered once: with both as in an even sky's
        # light below the surface and an eye at 45° SCATTERED_ONCE. c: absorption and scattering, b. Light that the surface sends down
        # again counts too.
        share = min(reflectance / (1.0 - RETURNED * reflectance) / SCATTERED_ONCE, 0.9)
        scattering.append(extinction * share)
        absorption.append(extinction * (1.0 - share))
    return tuple(absorption), tuple(scattering)


def _extinction(scene, water):
    """(r, g, b) [1/m]. water: of the scene without a floor."""
    extinction = [a + b for a, b in zip(water.absorption_per_m, water.backscatter_per_m)]
    near_m = 0.02
    if not scene.water.body or not 2.0 * near_m < scene.sea.depth_m < (clear_to_m(scene) or 0.0):
        return extinction
    tried, sky = pelagic.Scene(), light.sky_of(scene)
    tried.water = scene.water  # alone: a centimetre of water carries no swell

    def of_floor(depth_m):
        tried.sea.depth_m, tried.water.floor_colour = depth_m, (0.0,) * 3
        black = upwelling.albedo(tried, sky=sky)[0]
        tried.water.floor_colour = (0.02,) * 3  # so little that what is sent down again doesn't count
        return upwelling.albedo(tried, sky=sky)[0] - black

    near = of_floor(near_m)
    if not near.all():  # in the dark
        return extinction
    way_m = _slants(sky) * (scene.sea.depth_m - near_m)
    left = of_floor(scene.sea.depth_m) / near
    return [-math.log(min(max(each, 1e-3), 1.0)) / way_m for each in left]


def _slants(sky):
    """1/cosine of the light's way down, sun's and sky's, and up to the eye that upwelling.albedo() is for."""
    def below(cosine):
        return 1.0 / math.sqrt(1.0 - (1.0 - cosine**2) / WATER_INDEX**2)

    sun, dome = sky.sun_irradiance[1], sky.sky_irradiance[1]
    return (sun * below(sky.sun_direction[2]) + dome * SKY_SLANT) / max(sun + dome, 1e-12) + below(upwelling.FROM[2])


def node_inputs(scene):
    """{node: {input: value}}. Blender's absorption is density · (1 − colour), its scattering density · colour."""
    absorption, scattering = coefficients(scene)
    most, dense = max(absorption), max(scattering)
    return {ABSORPTION: {"Color": tuple(1.0 - each / most for each in absorption) + (1.0,), "Density": most},
            SCATTERING: {"Color": tuple(each / dense for each in scattering) + (1.0,), "Density": dense},
            EXTINCTION: dict(zip("XYZ", map(sum, zip(absorption, scattering))))}
