# SPDX-License-Identifier: GPL-3.0-or-later
"""The ocean's material, one tree for Cycles and EEVEE: facets that mirror (facets.py), light from the water, foam (foam.py)."""

import math

import bpy

from . import compat, depths, diving, upwelling
from .facets import add_facets, transformed
from .foam import COLOR, OPACITY, PICTURE, add_foam
from .light import extinction_per_m, packed_image
from .module import pelagic
from .nodes import Tree

MARK = "pelagic_water"  # on a material of the add-on: the version of its tree
VERSION = 7
AIR, AIR_SKY = "Air Extinction", "Air Sky"  # nodes
THIN = "Crest Light"  # the node: how much more light comes through high crests of water without a body
JUST_ABOVE = 0.006  # the horizon: half a row of the sky's picture


def ensure_material(obj, scene, dense_foam=None):
    """Gives an object without a material the ocean's; somebody else's stays. Returns the ocean's material, or None.
    dense_foam: as update_material()."""
    if not any(obj.data.materials):
        obj.data.materials.clear()
        obj.data.materials.append(new_material())
    return update_material(obj, scene, dense_foam=dense_foam)


HULLS = "In a Hull"


def cut_hulls(material):
    """Leaves the sea out where its mesh's attribute "dry" is above a half: in the hulls of a bake's objects."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    if HULLS in nodes:
        return
    compat.blend_by_threshold(material)
    dry, inside, nothing = (nodes.new(kind) for kind in ("ShaderNodeAttribute", "ShaderNodeMath", "ShaderNodeBsdfTransparent"))
    dry.attribute_name = "dry"
    inside.name = inside.label = HULLS
    inside.operation = "GREATER_THAN"
    inside.inputs[1].default_value = 0.5
    links.new(dry.outputs["Fac"], inside.inputs[0])
    for output in [node for node in nodes if node.type == "OUTPUT_MATERIAL" and node.inputs["Surface"].links]:
        cut = nodes.new("ShaderNodeMixShader")
        cut.location = output.location
        output.location.x += 200
        shown = output.inputs["Surface"].links[0].from_socket
        for socket, place in ((inside.outputs[0], 0), (shown, 1), (nothing.outputs[0], 2)):
            links.new(socket, cut.inputs[place])
        links.new(cut.outputs[0], output.inputs["Surface"])


def update_material(obj, scene, significant_height_m=None, dense_foam=None):
    """Brings the ocean's material to the scene's water, light and wind, and to the height of its waves and Sea.dense_foam
    where they are known; returns it, or None where there is none. What an artist changed stays until the scene's own value
    changes."""
    material = next((m for m in obj.data.materials if m and MARK in m), None)
    if material is not None:
        _set(material, "Water Color", (*map(float, upwelling.albedo(scene)[0]), 1.0))
        _set(material, "Wind Angle", math.radians(scene.sea.wind_direction_deg))
        _set(material, "Foam Structure", scene.effects.foam_structure)
        _set(material, "Foam Streaks", min(scene.effects.foam_streaks * min(max(scene.sea.wind_speed_mps / 10.0 - 0.5, 0.0), 2.0), 1.0))  # make_foam()
        _set(material, "Foam Color", _foam_colour(scene.effects.foam_new_albedo))
        _set(material, "Residual Foam Color", _foam_colour(scene.effects.foam_old_albedo))
        if material[MARK] >= 6 and (scene.water.body or f"{MARK} {THIN}" in material):
            _set(material, THIN, 0.0 if scene.water.body else 2.0)  # a body's crests are upwelling.py's
        _show_picture(material, scene)
        _drive(material, "Time", ripple_clock(scene.shot))
        for name, values in depths.node_inputs(scene).items():
            _fill(material, name, values)
        _set(material, depths.FROM_BELOW, float(depths.UNDER in obj))
        depths.connect(obj, material, scene)
        upwelling.connect(material, scene)
        if significant_height_m is not None:
            _set(material, "Wave Height", max(significant_height_m, 1e-3))
        if dense_foam is not None:
            for name, part in zip(("Active Foam Density", "Residual Foam Density"), dense_foam):
                _set(material, name, part)
    return material


def _foam_colour(albedo):
    return *(albedo * part for part in COLOR), 1.0


def _show_picture(material, scene):
    """The artist's pattern of foam, by rank a normal variable."""
    asked = scene.effects.foam_pattern, scene.effects.foam_pattern_m
    if material.get(f"{MARK} {PICTURE}") == repr(asked) or "Foam Picture Size" not in material.node_tree.nodes:
        return
    picture = pelagic.foam_picture(scene)  # a file that isn't there is asked for again
    node = _changed(material, PICTURE, asked)
    if node is None:
        return
    if picture is not None:
        node.image = packed_image("Pelagic Foam", picture.repeat(3, axis=2), node.image, is_data=True)
    material.node_tree.nodes["Foam Picture Size"].outputs[0].default_value = scene.effects.foam_pattern_m if picture is not None else 0.0


def _changed(material, name, value):
    """The node to write a value to; None where that value was the last one written, or the node is gone."""
    key = f"{MARK} {name}"
    if material.get(key) == repr(value):
        return None
    material[key] = repr(value)
    return material.node_tree.nodes.get(name)


def _set(material, name, value):
    node = _changed(material, name, value)
    if node is not None:
        node.outputs[0].default_value = value


def _fill(material, name, values):
    """The same for a node's inputs, {name: value}."""
    node = _changed(material, name, values)
    if node is not None:
        for socket, value in values.items():
            node.inputs[socket].default_value = value


def _drive(material, name, expressions):
    """The same with expressions of the frame for the node's first inputs."""
    node = _changed(material, name, expressions)
    if node is not None:
        for socket, expression in zip(node.inputs, expressions):
            socket.driver_add("default_value").driver.expression = expression


def ripple_clock(shot):
    """Where ripples are in their noise, whose two last axes are times [s], as expressions of the frame: the sea's time
    on one of them; in a loop a circle of the loop's length on both. So they repeat without a jump and never turn back."""
    time = f"({shot.time_offset_s!r} + {shot.time_scale / shot.fps!r} * (frame - 1))"
    loop_s = shot.time_scale * round(shot.loop_s * shot.fps) / shot.fps
    if loop_s == 0:
        return "0.1", time  # off the lattice, on which the noise is weaker
    radius = loop_s / (2 * math.pi)
    return tuple(f"{radius!r} * {function}({time} / {radius!r})" for function in ("cos", "sin"))


def new_material():
    material = bpy.data.materials.new("Pelagic Water")
    material[MARK] = VERSION
    material.use_nodes = True
    tree = Tree(material.node_tree)

    def labelled(kind, name, value):
        node = tree.node(kind)
        node.name = node.label = name
        node.outputs[0].default_value = value
        return tree.value(node, 0)

    water = labelled("ShaderNodeRGB", "Water Color", (0.0, 0.03, 0.05, 1.0))
    fresh_color = labelled("ShaderNodeRGB", "Foam Color", (0.55, 0.55, 0.55, 1.0))
    old_color = labelled("ShaderNodeRGB", "Residual Foam Color", (0.55, 0.55, 0.55, 1.0))
    wind = labelled("ShaderNodeValue", "Wind Angle", 0.0)
    structure = labelled("ShaderNodeValue", "Foam Structure", 1.0)
    streaks = labelled("ShaderNodeValue", "Foam Streaks", 0.5)
    picture_m = labelled("ShaderNodeValue", "Foam Picture Size", 0.0)
    fresh_opacity = labelled("ShaderNodeValue", "Active Foam Density", OPACITY)
    old_opacity = labelled("ShaderNodeValue", "Residual Foam Density", OPACITY)
    crest_light = labelled("ShaderNodeValue", THIN, 2.0)
    wave_height = labelled("ShaderNodeValue", "Wave Height", 1e6)
    clock = tree.node("ShaderNodeCombineXYZ")
    clock.name = clock.label = "Time"
    time = tree.value(clock, 0)

    part = add_facets(tree, ripples=0.4, ripple_length_m=0.35, detail_distance_m=60.0, wind_angle=wind, time=time)
    coverage = tree.attribute("whitecap_coverage", "Fac")
    foam = add_foam(tree, coverage, tree.attribute("foam_active", "Fac"), tree.attribute("foam_age", "Fac"),
                    (fresh_opacity, fresh_color), (old_opacity, old_color), structure, streaks, picture_m, size=1.0, detail_distance_m=400.0, wind_angle=wind)

    mirror = tree.add("ShaderNodeBsdfAnisotropic", {"Color": part["Reflection"], "Roughness": part["Roughness"],
                                                    "Anisotropy": 0.0, "Normal": part["Normal"]},
                      distribution="BECKMANN")
    again = tree.add("ShaderNodeBsdfAnisotropic", {"Color": part["Again"], "Roughness": part["Again Roughness"], "Anisotropy": 0.0,
                                                   "Normal": part["Again Normal"]}, distribution="BECKMANN")
    mirror = tree.add("ShaderNodeAddShader", {0: mirror, 1: again})
    # Light from the water has come in through a level surface, whatever its facets do: the normal is up.
    upwards = transformed(tree, tree.vector(0.0, 0.0, 1.0), "NORMAL", "OBJECT", "WORLD")
    # High crests are thin: more light comes through, and less of its red and green is lost.
    height = tree.add("ShaderNodeVectorTransform", {0: tree.add("ShaderNodeNewGeometry", output="Position")},
                      vector_type="POINT", convert_from="WORLD", convert_to="OBJECT").parts()[2]
    thin = tree.map_range(height / wave_height, 0.3, 1.0) * crest_light
    lit = water * (tree.vector(1.5, 1.2, 1.0) * thin + (1.0, 1.0, 1.0))
    lit = tree.add("ShaderNodeVectorMath", {0: lit, 1: (0.0, 0.0, 0.0)}, operation="ADD")
    lit.socket.node.name = lit.socket.node.label = upwelling.SUM
    lit = lit.at_least(0.0)  # of a darker colour than the core's
    body = tree.add("ShaderNodeBsdfDiffuse", {"Color": lit * (1.0 - part["Fresnel"]), "Normal": upwards})
    white = tree.add("ShaderNodeBsdfDiffuse", {"Color": foam["Color"], "Normal": part["Foam Normal"]})

    before_air = _add_air(tree)
    if hasattr(material, "cycles"):
        compat.dont_light_with(material)  # the air's glow is the camera's alone, and would take a third of all samples from sun and sky

    def show(mirror, **settings):
        seen = before_air(tree.add("ShaderNodeMixShader", {
            0: foam["Foam"], 1: tree.add("ShaderNodeAddShader", {0: mirror, 1: body}), 2: white}))
        tree.node("ShaderNodeOutputMaterial", {"Surface": seen}, **settings)
        return seen

    above = show(mirror)
    if not compat.eevee_mirrors_in_facets():
        above = show(tree.add("ShaderNodeBsdfAnisotropic", {"Color": part["Reflection"], "Roughness": part["Roughness"], "Anisotropy": 0.0},
                      distribution="BECKMANN"), target="EEVEE")
    depths.add_depths(tree, part, foam, mirror, white, upwards, before_air)
    diving.add_surface(tree, part, foam, above)
    return material


def _add_air(tree):
    """A function that puts the air between a shader and the camera: it takes light away, and adds what the sky's horizon in that azimuth
    is of: for eyes near the sea the core's table of air has that to 1 %, whatever the azimuth and the distance."""
    extinction = tree.node("ShaderNodeCombineXYZ")
    extinction.name = extinction.label = AIR
    away = tree.add("ShaderNodeCameraData", output="View Distance")
    lost = [1.0 - (-(channel * away)).at_least(-80.0).exp() for channel in tree.value(extinction, 0).parts()]
    x, y, _ = tree.add("ShaderNodeNewGeometry", output="Incoming").parts()
    sky = tree.node("ShaderNodeTexEnvironment", {"Vector": tree.vector(-x, -y, JUST_ABOVE)})
    sky.name = sky.label = AIR_SKY
    grey = lost[1].at_least(1e-6)
    glow = tree.add("ShaderNodeEmission", {"Color": tree.value(sky, "Color") * tree.vector(lost[0] / grey, 1.0, lost[2] / grey)})
    share = lost[1] * tree.add("ShaderNodeLightPath", output="Is Camera Ray")
    return lambda shader: tree.add("ShaderNodeMixShader", {0: share, 1: shader, 2: glow})


def put_air(obj, scene, sky):
    """Brings the air before the ocean to the scene, and the sky behind it. sky: the picture of the scene's sky, None: no air."""
    material = next((m for m in obj.data.materials if m and MARK in m), None)
    node = material and material.node_tree.nodes.get(AIR_SKY)
    if node is not None:
        if node.image != sky:
            node.image = sky
        _fill(material, AIR, dict(enumerate(extinction_per_m(scene) if sky else (0.0, 0.0, 0.0))))
        diving.put_sky(material, scene, sky)
