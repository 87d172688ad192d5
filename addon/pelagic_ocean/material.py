# SPDX-License-Identifier: GPL-3.0-or-later
"""The ocean's material, one tree for Cycles and EEVEE.

What a mesh is too coarse to show it carries as slope variances S, and the material draws it facet by facet: each sample
of a pixel takes a slope from the distribution of those that the eye sees (core/lighting/slopes.glsl), and with it the
Fresnel term of that facet and the part of it that no wave blocks (sun.glsl, sky.glsl). So a pixel's mean has the
effective Fresnel term, and the sun its own one, which differ at grazing angles by factors.

The facet isn't a mirror, whose image of the sun would be noise, but a small Beckmann lobe: SPREAD of the variance is the
lobe's roughness, the rest is drawn. Beckmann's α is √2 σ, and Blender's roughness √α. (The same by Blender's anisotropic
lobe alone would be: α₁ and α₂ from the principal variances, roughness (α₁ α₂)^¼, anisotropy 1 − √(α₁/α₂) for α₁ < α₂,
tangent along α₁. It has one Fresnel term for the whole lobe, EEVEE ignores the anisotropy, and Cycles 3.4 draws its
samples with α₁ for both axes.)
"""

import math

import bpy

from . import compat
from .module import pelagic
from .nodes import Tree, Value

MARK = "pelagic_water"  # on a material of the add-on: the version of its trees
VERSION = 1
WATER_INDEX = 1.34
SPREAD = 0.2
LEAST_VARIANCE = 1e-7  # of a glassy sea
LEAST_ALPHA = 5e-4  # a third of what the sun's own width adds; below, Cycles takes a lobe for a mirror, which no lamp lights


# ---- The hidden waves, facet by facet


def facets_group():
    group = bpy.data.node_groups.new("Pelagic Facets", "ShaderNodeTree")
    for name, default in (("Ripples", 0.8), ("Ripple Length", 0.7), ("Detail Distance", 150.0), ("Wind Angle", 0.0),
                          ("Time", 0.0)):
        compat.new_group_socket(group, name, "Float", default=default)
    for name, kind in (("Normal", "Vector"), ("Roughness", "Float"), ("Fresnel", "Float"), ("Reflection", "Float"),
                       ("Foam Ratio", "Float")):
        compat.new_group_socket(group, name, kind, is_output=True)
    tree = Tree(group)
    inputs = tree.node("NodeGroupInput").outputs
    asked = {socket.name: Value(tree, socket) for socket in inputs if socket.name}

    geometry = tree.node("ShaderNodeNewGeometry").outputs
    to_eye = _transformed(tree, Value(tree, geometry["Incoming"]), "VECTOR", "WORLD", "OBJECT").normalized()
    up = to_eye.parts()[2]
    normal = _facing(_transformed(tree, Value(tree, geometry["Normal"]), "NORMAL", "WORLD", "OBJECT"), to_eye, up)
    axes, variance = _slope_frame(tree, normal)
    x_axis, y_axis = axes
    v_x, v_y, cosine = to_eye.dot(x_axis), to_eye.dot(y_axis), to_eye.dot(normal).at_least(1e-4)

    # S = s I + L Lᵀ: a lobe's variance s along any axis, and the places of lobes, L = (a 0; b c) times two independent
    # normal numbers.
    v_xx, v_yy, v_xy = variance
    half, difference = 0.5 * (v_xx + v_yy), 0.5 * (v_xx - v_yy)
    least = half - (difference * difference).plus_product(v_xy, v_xy).sqrt()
    lobe = SPREAD * least.at_least(0.0)
    a = (v_xx - lobe).at_least(LEAST_VARIANCE).sqrt()
    b = v_xy / a
    c = (v_yy - lobe - b * b).at_least(0.01 * LEAST_VARIANCE).sqrt()

    def placed(x, y):
        """Lᵀ (x, y) as a vector: its length is the places' deviation along the direction, times sin θ."""
        return tree.vector((a * x).plus_product(b, y), c * y)

    def deviation(x, y):
        """That of all facets."""
        return (v_xx * x * x + v_yy * y * y).plus_product(2.0 * v_xy, x * y).at_least(1e-12).sqrt()

    sigma = deviation(v_x, v_y)
    towards = placed(v_x, v_y)
    places = towards.length().at_least(1e-6)
    w_x, w_y, _ = towards._scaled(1.0 / places).parts()
    k = (cosine / sigma).at_most(1e3)

    # The eye sees slopes −x σ along and y across the line of sight: y is normal, and x has the density (k + x)₊ φ(x). The
    # places of lobes have the part `rest` of that variance, weighted by how much the eye sees of a whole lobe (moments by
    # Stein's lemma). k + x is drawn as the square of a normal number: its mean and variance are right.
    mills = 0.797885 * (-(k * (0.79875 + k * (0.17595 + k * 0.04591)))).at_least(-80.0).exp()  # φ(k)/Φ(k), to 1.2e-4
    mean = 1.0 / (k + mills)
    own = (lobe * (1.0 - cosine * cosine)).at_least(0.0).sqrt() / sigma  # a lobe's deviation, in units of σ
    rest = 1.0 - own * own
    wide = rest * (1.0 + rest * mean * (mills - mean))
    middle = k + rest * mean
    part = 0.5 * wide / (middle + (middle * middle - 0.5 * wide).sqrt())
    root, step = (middle - part).sqrt(), part.sqrt()
    z_x, z_y, _ = _normal_numbers(tree, asked).parts()
    along = -(z_x * w_x).plus_product(z_y, w_y)
    x = rest * mean - part + step * along * (2.0 * root + step * along)
    across = (z_y * w_x) - z_x * w_y

    def slope(x):
        """The slope in the frame: L (−x ŵ + y ŵ⊥)."""
        along = x * (sigma / places)
        first, second = -(along * w_x).plus_product(across, w_y), (across * w_x) - along * w_y
        return a * first, (b * first).plus_product(c, second)

    # Fresnel's term of a lobe: two facets, a deviation to either side, each with what the eye sees of it. The one with
    # more of it moves the lobe its way.
    s_x, s_y = slope(x)
    upright = 1.0 / (1.0 + s_x * s_x).plus_product(s_y, s_y).sqrt()
    steep, flat = (k + x - own).at_least(0.0), (k + x + own).at_least(1e-3)
    steep_part = steep * _fresnel((sigma * steep * upright).at_most(1.0))
    flat_part = flat * _fresnel((sigma * flat * upright).at_most(1.0))
    fresnel = (steep_part + flat_part) / (steep + flat)
    x = x + own * ((flat_part - steep_part) / (flat_part + steep_part) - (flat - steep) / (flat + steep))

    # The part that no wave blocks on the way of the mirrored light l: (1 + Λv)/(1 + Λv + Λl). Cycles itself leaves out
    # what a lobe mirrors below the horizon, hence the mean height of the rest of it, and takes away what the lobe's facets
    # hide of each other, which is in Λ already.
    s_x, s_y = slope(x)
    upright = 1.0 / (1.0 + s_x * s_x).plus_product(s_y, s_y).sqrt()
    tilted = (k + x).at_least(0.0)
    twice = 2.0 * sigma * tilted * upright * upright
    l_x, l_y, l_z = -1.0 * twice * s_x - v_x, -1.0 * twice * s_y - v_y, twice - cosine
    blur = 2.0 * sigma * own
    l_z = 0.5 * (l_z + (l_z * l_z).plus_product(2.5 * blur, blur).sqrt())
    seen = 1.0 + _smith_lambda(k)
    open_part = seen / (seen + _smith_lambda(l_z / deviation(l_x, l_y)))
    open_part = open_part * (1.0 + _smith_lambda(tilted / own.at_least(1e-3))).at_most(1.5)
    facet = (normal + x_axis * -s_x + y_axis * -s_y).normalized()

    foam_variance = 0.1  # of the foam's own roughness: foam.glsl
    foam_sigma = (sigma * sigma).plus_product(foam_variance, 1.0 - cosine * cosine).sqrt()
    foam_ratio = (1.0 + _smith_lambda(cosine / foam_sigma)) / seen

    tree.node("NodeGroupOutput", {
        "Normal": _transformed(tree, facet, "NORMAL", "OBJECT", "WORLD").normalized(),
        "Roughness": (2.0 * lobe).sqrt().at_least(LEAST_ALPHA).sqrt(),
        "Fresnel": fresnel, "Reflection": fresnel * open_part, "Foam Ratio": foam_ratio})
    tree.arrange()
    return group


def _transformed(tree, vector, kind, before, after):
    return tree.add("ShaderNodeVectorTransform", {0: vector}, vector_type=kind, convert_from=before, convert_to=after)


def _facing(normal, to_eye, up):
    """facing_normal() of slopes.glsl: bent so that the eye sees it and it mirrors the eye's ray upwards."""
    seen = normal - to_eye._scaled(2.0 * normal.dot(to_eye).at_most(0.0))
    seen_up = seen.parts()[2]
    below = (up - 2.0 * seen.dot(to_eye) * seen_up).at_least(0.0) * up.above(0.0)
    root = (seen_up * seen_up).plus_product(up, below).sqrt()
    return (seen + to_eye._scaled(below / (seen_up + root).at_least(1e-6))).normalized()


def _slope_frame(tree, normal):
    """slope_frame() of slopes.glsl: the axes beside the normal, and (xx, yy, xy) of the variance in them."""
    n_x, n_y, n_z = normal.parts()
    height = n_z.at_least(0.0)
    q = 1.0 / (1.0 + height)
    xx, xy, yy = 1.0 - n_x * n_x * q, -(n_x * n_y * q), 1.0 - n_y * n_y * q
    s_x, s_y, s_xy = tree.attribute("slope_variance")._scaled(height * height).parts()

    def between(first, second):
        (a, b), (c, d) = first, second
        return s_x * a * c + s_y * b * d + s_xy * (a * d + b * c)

    axes = tree.vector(xx, xy, -n_x), tree.vector(xy, yy, -n_y)
    return axes, (between((xx, xy), (xx, xy)), between((xy, yy), (xy, yy)), between((xx, xy), (xy, yy)))


def _fresnel(cosine):
    """fresnel_exact() of fresnel.glsl."""
    g = (cosine * cosine + (WATER_INDEX**2 - 1)).sqrt()
    across = (g - cosine) / (g + cosine)
    along = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return 0.5 * across * across * (1.0 + along * along)


def _smith_lambda(k):
    """smith_lambda() of slopes.glsl at a = k/√2, by the rational function of Walter et al. 2007; 0.003 off in 1/(1 + Λ)."""
    a = (k * math.sqrt(0.5)).at_least(1e-4).at_most(1.6)
    return ((1.0 - a * (1.259 - 0.396 * a)) / (a * (3.535 + 2.181 * a))).at_least(0.0)


def _normal_numbers(tree, asked):
    """A vector of two independent normal numbers, other ones in each sample. Near the eye they hang together from place
    to place as ripples do, which changes nothing in their distribution."""
    place = tree.add("ShaderNodeNewGeometry", output="Position")
    dice = tree.add("ShaderNodeTexWhiteNoise", {"Vector": place}, output="Color", noise_dimensions="3D")
    first, second, _ = dice.parts()
    radius = (-2.0 * tree.math("LOGARITHM", first.at_least(1e-7), math.e)).sqrt()
    angle = 2.0 * math.pi * second
    random = tree.vector(radius * tree.math("COSINE", angle), radius * tree.math("SINE", angle))

    rest = tree.add("ShaderNodeVectorRotate", {"Vector": tree.attribute("rest_position"), "Angle": -asked["Wind Angle"]})
    # Half as frequent across the wind, as crests are.
    stretched = rest * (1.0, 0.5, 1.0)
    noise = tree.add("ShaderNodeTexNoise", {"Vector": stretched, "W": asked["Time"],
                                            "Scale": 1.0 / asked["Ripple Length"].at_least(1e-3), **NOISE},
                     output="Color", noise_dimensions="4D")
    ripples = (noise - NOISE_MEAN) / NOISE_DEVIATION
    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    share = asked["Ripples"].clamped() / (1.0 + away * away)
    return random._scaled((1.0 - share).sqrt()) + ripples._scaled(share.sqrt())


# Blender's noise, its mean and deviation measured over 512² points. Between its 0.1 % and 99.9 % quantiles it
# is as good as normally distributed.
NOISE = {"Detail": 6.0, "Roughness": 0.65}
NOISE_MEAN, NOISE_DEVIATION = 0.5, 0.0602


# ---- Foam


def foam_group():
    """Where the foam is: the places where a pattern has its largest values, so many that they are the coverage. The
    pattern stands at rest positions, so foam moves with the water."""
    group = bpy.data.node_groups.new("Pelagic Foam", "ShaderNodeTree")
    for name, default in (("Coverage", 0.0), ("Ratio", 1.0), ("Size", 1.0), ("Detail Distance", 400.0),
                          ("Wind Angle", 0.0)):
        compat.new_group_socket(group, name, "Float", default=default)
    for name in ("Foam", "Density"):
        compat.new_group_socket(group, name, "Float", is_output=True)
    tree = Tree(group)
    inputs = tree.node("NodeGroupInput").outputs
    asked = {socket.name: Value(tree, socket) for socket in inputs if socket.name}

    coverage = asked["Coverage"].at_least(1e-6).at_most(1 - 1e-6)
    rank = _foam_rank(tree, asked)
    # Foam covers rank > 1 − coverage, with an edge as soft as there is room for: its mean stays.
    room = 0.5 * coverage * (1.0 - coverage)
    beyond = rank - (1.0 - coverage)
    mask = tree.map_range(beyond, -room, room)
    # Dense in its middle, bubbles over water at its edge: DENSE on average over the covered places.
    density = (beyond / coverage).clamped()
    density = tree.math("POWER", density, 1.0 / DENSE - 1.0)

    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    detail = 1.0 / (1.0 + away * away)
    mask, density = tree.mix(detail, coverage, mask), tree.mix(detail, DENSE, density)
    # visible_coverage() of foam.glsl; nothing where there is none.
    mask = asked["Coverage"].above(0.0) * mask * asked["Ratio"] / (mask * (asked["Ratio"] - 1.0) + 1.0)
    tree.node("NodeGroupOutput", {"Foam": mask, "Density": density})
    tree.arrange()
    return group


DENSE = 0.4  # the mean over the foam's lifetime: foam.glsl


def _foam_rank(tree, asked):
    """The share of the sea where the pattern is lower, 0 … 1, equally distributed."""
    rest = tree.add("ShaderNodeVectorRotate", {"Vector": tree.attribute("rest_position"), "Angle": -asked["Wind Angle"]})
    place = rest._scaled(1.0 / asked["Size"].at_least(1e-3))
    pattern = foam_pattern(tree, place)
    z = (pattern - PATTERN_MEAN) / PATTERN_DEVIATION
    # The logit of the pattern's distribution, nearly a normal one.
    return 1.0 / (1.0 + (-(z * (1.5438 + 0.0912 * z * z))).at_least(-60.0).at_most(60.0).exp())


def foam_pattern(tree, place):
    """place: [m], x along the wind. Streaks along the wind, in them a net as of bursting bubbles, and fine grain."""
    def noise(scale, detail, vector=place, output="Fac"):
        return tree.add("ShaderNodeTexNoise", {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": 0.6},
                        output=output)

    streaks = noise(0.3, 3.0, place * (0.35, 1.0, 1.0))
    bent = place * (0.6, 1.0, 1.0) + (noise(1.2, 4.0, output="Color") - 0.5) * 1.2
    net = tree.add("ShaderNodeTexVoronoi", {"Vector": bent, "Scale": 1.1}, feature="DISTANCE_TO_EDGE")
    return 2.0 * streaks - 1.0 * net.sqrt() + 0.7 * noise(6.0, 4.0)


# Measured over a square of 400 m, with the logit in _foam_rank().
PATTERN_MEAN, PATTERN_DEVIATION = 1.0319, 0.2058


# ---- The material


def ensure_material(obj, scene):
    """Gives an object without a material the ocean's; somebody else's stays. Returns the ocean's material, or None."""
    if not any(obj.data.materials):
        obj.data.materials.clear()
        obj.data.materials.append(new_material())
    return update_material(obj, scene)


def update_material(obj, scene):
    """Brings the ocean's material to the scene's water, light and wind; returns it, or None where there is none. What an
    artist changed stays until the scene's own value changes."""
    material = next((m for m in obj.data.materials if m and MARK in m), None)
    if material is not None:
        _set(material, "Water Color", tuple(upwelling_albedo(scene)) + (1.0,))
        _set(material, "Wind Angle", math.radians(scene.sea.wind_direction_deg))
    return material


def _set(material, name, value):
    """Writes a node's value where the value that was last written isn't the same."""
    key = f"{MARK} {name}"
    if material.get(key) == repr(value):
        return
    material[key] = repr(value)
    node = material.node_tree.nodes.get(name)
    if node is not None:
        node.outputs[0].default_value = value


def new_material():
    material = bpy.data.materials.new("Pelagic Water")
    material[MARK] = VERSION
    material.use_nodes = True
    tree = Tree(material.node_tree)

    def labelled(kind, name, value):
        node = tree.node(kind)
        node.name = node.label = name
        node.outputs[0].default_value = value
        return Value(tree, node.outputs[0])

    water = labelled("ShaderNodeRGB", "Water Color", (0.0, 0.03, 0.05, 1.0))
    dense = labelled("ShaderNodeRGB", "Foam Color", (0.55, 0.55, 0.55, 1.0))
    wind = labelled("ShaderNodeValue", "Wind Angle", 0.0)
    time = labelled("ShaderNodeValue", "Time", 0.0)
    # Ripples change over about a second.
    time.socket.driver_add("default_value").driver.expression = "frame / 24"

    facets = tree.node("ShaderNodeGroup", node_tree=_shared_group("Pelagic Facets", facets_group))
    foam = tree.node("ShaderNodeGroup", node_tree=_shared_group("Pelagic Foam", foam_group))
    for node in (facets, foam):
        node.width = 200
        tree.tree.links.new(wind.socket, node.inputs["Wind Angle"])
    tree.tree.links.new(time.socket, facets.inputs["Time"])
    tree.tree.links.new(facets.outputs["Foam Ratio"], foam.inputs["Ratio"])
    tree.tree.links.new(tree.attribute("whitecap_coverage", "Fac").socket, foam.inputs["Coverage"])
    part = {name: Value(tree, facets.outputs[name]) for name in ("Normal", "Roughness", "Fresnel", "Reflection")}

    # Light from the water has been through the level surface, whatever its facets do: the normal is up.
    upwards = _transformed(tree, tree.vector(0.0, 0.0, 1.0), "NORMAL", "OBJECT", "WORLD")
    mirror = tree.add("ShaderNodeBsdfAnisotropic", {"Color": part["Reflection"], "Roughness": part["Roughness"],
                                                    "Anisotropy": 0.0, "Normal": part["Normal"]},
                      distribution="BECKMANN")
    body = tree.add("ShaderNodeBsdfDiffuse", {"Color": water._scaled(1.0 - part["Fresnel"]), "Normal": upwards})
    white = tree.mix(Value(tree, foam.outputs["Density"]), water, dense)
    surface = tree.add("ShaderNodeMixShader", {
        0: Value(tree, foam.outputs["Foam"]),
        1: tree.add("ShaderNodeAddShader", {0: mirror, 1: body}),
        2: tree.add("ShaderNodeBsdfDiffuse", {"Color": white})})
    tree.node("ShaderNodeOutputMaterial", {"Surface": surface})
    tree.arrange()
    return material


def _shared_group(name, make):
    for group in bpy.data.node_groups:
        if group.get(MARK) == f"{name} {VERSION}":
            return group
    group = make()
    group[MARK] = f"{name} {VERSION}"
    return group


def upwelling_albedo(scene):
    """(r, g, b): the diffuse reflectance of the sea for light that comes from below its surface, without the factor
    (1 − Fresnel) on the way out: water_radiance() of water.glsl over the irradiance of the scene's own light, / π."""
    sky, reflectance = pelagic.Sky(scene), pelagic.WaterBody(scene).reflectance
    diffuse, underside = 0.06751, 0.48
    into_water = 1.0 - fresnel(sky.sun_direction[2])
    albedo = []
    for sun, dome, r in zip(sky.sun_irradiance, sky.sky_irradiance, reflectance):
        down = (sun * into_water + dome * (1.0 - diffuse)) / max(sun + dome, 1e-12)
        albedo.append(down * r / (1.0 - underside * r) / WATER_INDEX**2)
    return albedo


def fresnel(cosine):
    """The unpolarised reflectance of water."""
    cosine = min(max(cosine, 0.0), 1.0)
    g = math.sqrt(WATER_INDEX**2 - 1 + cosine * cosine)
    along = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)
    return 0.5 * ((g - cosine) / (g + cosine))**2 * (1 + along * along)
