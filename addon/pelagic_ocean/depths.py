# SPDX-License-Identifier: GPL-3.0-or-later
"""The water as a volume, for Cycles: what is under the surface shows, dimmed and coloured by what is in the water.

Absorption is the water's. Scattering is isotropic, since the forward part of real scattering goes on nearly as light does
that isn't scattered, and as much as makes deep water, by the single scattering that Cycles does unless it is asked for
more, as bright as the opaque water. Twice the backscatter, which would do with all scattering, is a little less.

Light comes in straight: Cycles finds no lamp through a surface that bends. Hence for the light from a low sun the way
through the water is longer than it should be. Seen from above, things stand where refraction shows them.
EEVEE keeps the opaque water: a volume fills its object's box there, and the air over the sea with it.
"""

import copy
import math

import bpy

from . import compat
from .facets import WATER_INDEX, add_fresnel
from .module import pelagic
from .nodes import Tree

SURFACE, VOLUME, OUTPUT = "Clear Surface", "Water Volume", "Clear Water"  # nodes, the last one only where it is switched on
ABSORPTION, SCATTERING = "Water Absorption", "Water Scattering"

MARK = "pelagic_floor"  # on the object under clear water
FLOOR_M, FLOOR_DEPTH_M = 40e3, 500.0


def add_depths(tree, part, foam, mirror, white, before_air):
    """Adds what connect() shows. foam: add_foam()'s; mirror, white: shaders, of the reflected light and of foam; before_air: puts
    the air before a shader."""
    def named(name, kind, inputs=()):
        node = tree.node(kind, inputs)
        node.name = node.label = name
        return tree.value(node, 0)

    path, geometry = tree.node("ShaderNodeLightPath"), tree.node("ShaderNodeNewGeometry")
    # Outside, radiance is spread over n² times the angles; Cycles leaves that to the colour.
    out = tree.vector(1.0, 1.0, 1.0) * ((1.0 - part["Fresnel"]) * WATER_INDEX**-2)
    bent = tree.add("ShaderNodeBsdfRefraction", {"Color": out, "Roughness": 0.0, "IOR": WATER_INDEX,
                                                 "Normal": part["Normal"]}, distribution=compat.sharp_refraction())
    seen = before_air(tree.add("ShaderNodeMixShader", {0: foam["Foam"], 1: tree.add("ShaderNodeAddShader", {0: mirror, 1: bent}),
                                                         2: white}))

    # Towards lamp and sky it is as a level surface for the light that comes in, and for rays that happen to find the sky, too,
    # or Cycles would count it twice.
    cosine = tree.math("ABSOLUTE", tree.value(geometry, "Incoming").parts()[2])
    let_in = (1.0 - add_fresnel(tree, cosine)) * (1.0 - foam["Hidden"])
    straight = tree.add("ShaderNodeBsdfTransparent", {"Color": tree.vector(1.0, 1.0, 1.0) * let_in})
    from_below = tree.value(geometry, "Backfacing") * (1.0 - tree.value(path, "Is Camera Ray"))
    named(SURFACE, "ShaderNodeMixShader", {0: tree.value(path, "Is Shadow Ray").at_least(from_below), 1: seen, 2: straight})
    named(VOLUME, "ShaderNodeAddShader", {0: named(ABSORPTION, "ShaderNodeVolumeAbsorption"),
                                          1: named(SCATTERING, "ShaderNodeVolumeScatter")})


def connect(obj, material, scene):
    """Makes Cycles show the volume of the scene's water over its floor, or the opaque water."""
    tree, is_on = material.node_tree, obj.pelagic.see_through
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


def _set_floor(obj, scene):
    """Where the sea has one, and black where no light comes from any more: what hits nothing is in no volume for Cycles."""
    is_seen = scene.water.body and scene.sea.depth_m < FLOOR_DEPTH_M
    depth_m, colour = (scene.sea.depth_m, scene.water.floor_colour) if is_seen else (FLOOR_DEPTH_M, (0.0, 0.0, 0.0))
    for floor in [child for child in obj.children if MARK in child]:
        floor.scale = (1.0, 1.0, -depth_m / floor.data.vertices[0].co.z)
        for node in floor.data.materials[0].node_tree.nodes if floor.data.materials else ():
            if node.type == "BSDF_DIFFUSE":
                node.inputs["Color"].default_value = (*colour, 1.0)


def _add_floor(obj):
    mesh = bpy.data.meshes.new("Pelagic Floor")
    mesh.from_pydata([(x * FLOOR_M, y * FLOOR_M, -1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], [],
                     [(0, 1, 2, 3)])
    black = bpy.data.materials.new("Pelagic Floor")
    black.use_nodes = True
    tree = Tree(black.node_tree)
    tree.node("ShaderNodeOutputMaterial", {"Surface": tree.add("ShaderNodeBsdfDiffuse", {"Color": (0.0, 0.0, 0.0, 1.0)})})
    mesh.materials.append(black)
    floor = bpy.data.objects.new("Pelagic Floor", mesh)
    floor[MARK] = True
    floor.parent, floor.hide_select, floor.display_type = obj, True, "BOUNDS"
    floor.visible_camera = floor.visible_glossy = False  # past the edge of a patch it isn't there
    for collection in obj.users_collection:
        collection.objects.link(floor)


def coefficients(scene):
    """(absorption, scattering), (r, g, b) each [1/m]."""
    deep = copy.copy(scene)
    deep.sea.depth_m = math.inf  # a floor is there to be seen through it
    water = pelagic.WaterBody(deep)
    scattering = []
    for absorption, reflectance in zip(water.absorption_per_m, water.reflectance):
        # Of the light that comes in at the cosine μ₀, b/c / (4 (μ + μ₀)) comes back to μ, scattered once: 0.13 … 0.21 b/c,
        # 0.15 of a whole sky's. c: absorption and scattering, b. Light that the surface sends down again counts too.
        back = reflectance / (1.0 - 0.48 * reflectance)
        share = min(back / 0.16, 0.9)
        scattering.append(absorption * share / (1.0 - share))
    return water.absorption_per_m, tuple(scattering)


def node_inputs(scene):
    """{node: {input: value}}. Blender's absorption is density · (1 − colour), its scattering density · colour."""
    absorption, scattering = coefficients(scene)
    most, dense = max(absorption), max(scattering)
    return {ABSORPTION: {"Color": tuple(1.0 - each / most for each in absorption) + (1.0,), "Density": most},
            SCATTERING: {"Color": tuple(each / dense for each in scattering) + (1.0,), "Density": dense}}
