# SPDX-License-Identifier: GPL-3.0-or-later
"""The hidden waves in a material, facet by facet.

What a mesh is too coarse to show it carries as slope variances S. Each sample of a pixel takes a slope from the
distribution of those that the eye sees (core/lighting/slopes.glsl), and with it the Fresnel term of that facet and the
part of it that no wave blocks (sun.glsl, sky.glsl). So a pixel's mean has the effective Fresnel term, and the sun its
own one; they differ at grazing angles by factors.

A facet isn't a mirror, whose image of the sun would be noise, but a small isotropic Beckmann lobe. It has SPREAD of the
least variance; the rest is drawn. Beckmann's α is √2 σ, and Blender's roughness √α.

One anisotropic lobe of Blender's would be: α₁ and α₂ from the principal variances, roughness (α₁ α₂)^¼, anisotropy
1 − √(α₁/α₂) for α₁ < α₂, tangent along α₁. It isn't used: it has one Fresnel term for sun and sky, EEVEE ignores the
anisotropy, and Cycles 3.4 draws Beckmann's samples with α₁ for both axes.
"""

import math

WATER_INDEX = 1.34
SPREAD = 0.2
NESTED = 0.75  # kNested of special.glsl
LEAST_VARIANCE = 1e-7  # of a glassy sea
LEAST_ALPHA = 5e-4  # a third of what the sun's own width adds; below, Cycles takes a lobe for a mirror, which no lamp lights

# Blender's noise. Each octave has nearly as much slope as the one before, as the hidden waves have; with less roughness
# ripples are blotches of one size. Mean and deviation: measured over 512² points of a square of 198 lattice cells, at nine
# times between and on its lattice, red and green: 0.0459 … 0.0481 where z is off the lattice; on it, red falls by a
# tenth at whole times. Its quantiles from 0.1 % to 99.9 % are a normal distribution's within 0.1 deviations.
NOISE = {"Detail": 6.0, "Roughness": 0.9}
NOISE_MEAN, NOISE_DEVIATION = 0.5, 0.0472


def add_facets(tree, ripples, ripple_length_m, detail_distance_m, wind_angle, time):
    """Adds the group. time: a vector, the ripples' places along z and w of their noise [s]. Normal and Roughness of a
    sample's lobe; Fresnel: what it reflects, of light from the water too; Reflection: that of it which no wave blocks; Again, with a lobe of
    its own: what meets hidden waves twice. Facing a sun 30° high, for slopes of 0.14, that is to what meets
    them once as 0.02 at 45° off the zenith, 0.08 at 70°, 0.11 at 80°, 0.06 at 86°; the sky's as 0.08 at 80°."""
    return tree.call("Pelagic Facets", _facets, {"Ripples": ripples, "Ripple Length": ripple_length_m,
                                                 "Detail Distance": detail_distance_m, "Wind Angle": wind_angle,
                                                 "Time": time})


def transformed(tree, vector, kind, before, after):
    return tree.add("ShaderNodeVectorTransform", {0: vector}, vector_type=kind, convert_from=before, convert_to=after)


def _facets(tree, asked):
    frame = tree.call("Pelagic Slope Frame", _slope_frame, {})
    normal, x_axis, y_axis = frame["Normal"], frame["X"], frame["Y"]
    v_x, v_y, cosine = frame["To Eye"].parts()
    v_xx, v_yy, v_xy = frame["Variance"].parts()
    z_x, z_y, _ = tree.call("Pelagic Dice", _dice, asked)["Normal Numbers"].parts()

    # S = s I + L Lᵀ: a lobe's variance s along any axis, and the places of lobes, L = (a 0; b c) times two independent
    # normal numbers.
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

    sigma = deviation(v_x, v_y).at_least(1e-3 * cosine)
    towards = placed(v_x, v_y)
    places = towards.length().at_least(1e-6)
    w_x, w_y, _ = towards._scaled(1.0 / places).parts()
    k = cosine / sigma

    # The eye sees slopes −x σ along and y across the line of sight: y is normal, and x has the density (k + x)₊ φ(x). The
    # places of lobes have the part `rest` of that variance, weighted by how much the eye sees of a whole lobe (moments by
    # Stein's lemma; the logarithm of the generating function is ½ rest t² + ln N(k + rest t), N = kΦ + φ). x is drawn as a
    # quadratic of a normal number: mean and variance are right, and the skewness within 1 %.
    mills = _mills(tree, k)
    mean = 1.0 / (k + mills)
    own = (lobe * (1.0 - cosine * cosine)).at_least(0.0).sqrt() / sigma  # a lobe's deviation, in units of σ
    rest = 1.0 - own * own
    wide = rest * (1.0 + rest * mean * (mills - mean))
    third = rest * rest * rest * (mean * (mills - mean) * (mills - mean) - mills - mean * mean * (mills - mean))
    bend = third / (6.0 * wide)
    step = (wide - 2.0 * bend * bend).sqrt()
    along = -(z_x * w_x).plus_product(z_y, w_y)
    x = rest * mean - bend + along * step.plus_product(bend, along)
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
    steep_part = steep * add_fresnel(tree, (sigma * steep * upright).at_most(1.0))
    flat_part = flat * add_fresnel(tree, (sigma * flat * upright).at_most(1.0))
    fresnel = (steep_part + flat_part) / (steep + flat)
    x = x + own * ((flat_part - steep_part) / (flat_part + steep_part) - (flat - steep) / (flat + steep))

    # What the eye sees of the facet and the mirrored light l reaches, over what Smith's masking, by which facets are drawn,
    # shows of it: lit_part() of slopes.glsl. Cycles itself leaves out what a lobe mirrors below the horizon, hence the
    # mean height of the rest of it, and takes away what the lobe's facets hide of each other, which is in Λ already.
    s_x, s_y = slope(x)
    upright = 1.0 / (1.0 + s_x * s_x).plus_product(s_y, s_y).sqrt()
    tilted = (k + x).at_least(0.0)
    twice = 2.0 * sigma * tilted * upright * upright
    l_x, l_y, l_z = -1.0 * twice * s_x - v_x, -1.0 * twice * s_y - v_y, twice - cosine
    blur = 2.0 * sigma * own
    l_z = 0.5 * (l_z + (l_z * l_z).plus_product(2.5 * blur, blur).sqrt())
    seen = 1.0 + _smith_lambda(tree, k)
    l_deviation = deviation(l_x, l_y)
    nested = NESTED * seen * (1.0 - (-2.0 * k * tilted).at_least(-80.0).exp())
    reached = 1.0 - (-2.0 * sigma * tilted * l_z / (l_deviation * l_deviation)).at_least(-80.0).exp()
    open_part = ((1.0 - NESTED) * seen / (seen + _smith_lambda(tree, l_z / l_deviation))).plus_product(nested, reached)
    fresnel_seen = fresnel * (1.0 - NESTED + nested)  # weighted by visible_part() over Smith's

    # What a wave keeps from the mirrored light the eye sees of that wave, along its mean plane: sky and sun by a second reflection,
    # and the water (grazing_view(), sky_seen_again() of sky.glsl). The eye's ray leaves it as from a lobe about the vector half way.
    sine = (1.0 - cosine * cosine).sqrt().at_least(1e-4)
    again = (fresnel_seen - fresnel * open_part).at_least(0.0)
    towards_eye = (sigma / sine).at_most(0.5)  # the slopes' deviation
    mirrored = add_fresnel(tree, towards_eye * 1.2533 / (1.0 + 1.15 * towards_eye))  # the effective term of a level view
    lean = 1.2 * towards_eye
    upright = 1.0 / (1.0 + lean * lean)
    level = upright * (lean * lean - 1.0) / sine
    again_facet = (normal * (2.0 * lean).plus_product(cosine, 1.0 + lean * lean) + x_axis * (v_x * (1.0 + level) / upright)
                   + y_axis * (v_y * (1.0 + level) / upright)).normalized()

    open_part = open_part * (1.0 + _smith_lambda(tree, tilted / own.at_least(1e-3))).at_most(1.5)
    facet = (normal + x_axis * -s_x + y_axis * -s_y).normalized()

    # Foam's facets are rougher by 0.1 along any axis, and those that the eye sees lean its way: foam.glsl.
    foam_sigma = (sigma * sigma).plus_product(0.1 * sine, sine).sqrt()
    foam_k = cosine / foam_sigma
    foam_deviation = foam_sigma / sine
    lean = foam_deviation / (foam_k + _mills(tree, foam_k)) / sine
    spread = 0.8 * foam_deviation  # between √0.43 at grazing angles and 1
    foam_facet = (normal + x_axis * (v_x * lean).plus_product(spread, z_x)
                  + y_axis * (v_y * lean).plus_product(spread, z_y)).normalized()

    def in_world(facet):
        return transformed(tree, facet * tree.vector(1.0, 1.0, frame["Side"]), "NORMAL", "OBJECT", "WORLD").normalized()

    return {"Normal": in_world(facet),
            "Roughness": (2.0 * lobe).sqrt().at_least(LEAST_ALPHA).sqrt(),
            "Fresnel": fresnel_seen - again * (1.0 - mirrored), "Reflection": fresnel * open_part, "Again": again * mirrored,
            "Again Normal": in_world(again_facet),
            "Again Roughness": (0.85 * towards_eye).at_least(LEAST_ALPHA).sqrt(),
            "Foam Normal": in_world(foam_facet),
            "Facet Cosine": facet.dot(x_axis * v_x + y_axis * v_y + normal * cosine)}


def _slope_frame(tree, _):
    """slope_frame() and facing_normal() of slopes.glsl, in the object's axes: the normal and the axes beside it, the
    direction to the eye in them, and (xx, yy, xy) of the slope variance. Side: 1, or -1 for an eye below the surface, where all is upside
    down (upside_down() of below.glsl)."""
    geometry = tree.node("ShaderNodeNewGeometry")
    side = 1.0 - 2.0 * tree.value(geometry, "Backfacing")
    upright = tree.vector(1.0, 1.0, side)
    to_eye = transformed(tree, tree.value(geometry, "Incoming"), "VECTOR", "WORLD", "OBJECT").normalized() * upright
    normal = transformed(tree, tree.value(geometry, "Normal"), "NORMAL", "WORLD", "OBJECT") * upright

    # Bent so that the eye sees it and it mirrors the eye's ray upwards.
    up = to_eye.parts()[2]
    seen = normal - to_eye * (2.0 * normal.dot(to_eye).at_most(0.0))
    seen_up = seen.parts()[2]
    below = (up - 2.0 * seen.dot(to_eye) * seen_up).at_least(0.0) * up.above(0.0)
    root = (seen_up * seen_up).plus_product(up, below).sqrt()
    normal = (seen + to_eye * (below / (seen_up + root).at_least(1e-6))).normalized()

    n_x, n_y, n_z = normal.parts()
    height = n_z.at_least(0.0)
    q = 1.0 / (1.0 + height)
    xx, xy, yy = 1.0 - n_x * n_x * q, -(n_x * n_y * q), 1.0 - n_y * n_y * q
    s_xx, s_yy, s_xy = (tree.attribute("slope_variance") * (height * height)).parts()

    def between(a, b, c, d):
        """(a, b) S (c, d)"""
        return s_xx * a * c + s_yy * b * d + s_xy * (a * d + b * c)

    x_axis, y_axis = tree.vector(xx, xy, -n_x), tree.vector(xy, yy, -n_y)
    return {"Normal": normal, "X": x_axis, "Y": y_axis, "Side": side,
            "To Eye": tree.vector(to_eye.dot(x_axis), to_eye.dot(y_axis), to_eye.dot(normal).at_least(1e-4)),
            "Variance": tree.vector(between(xx, xy, xx, xy), between(xy, yy, xy, yy), between(xx, xy, xy, yy))}


def _dice(tree, asked):
    """Two independent normal numbers, other ones in each sample. Near the eye they hang together from place to place as
    ripples do, which changes nothing in their distribution."""
    place = tree.add("ShaderNodeNewGeometry", output="Position")
    first, second, _ = tree.add("ShaderNodeTexWhiteNoise", {"Vector": place}, "Color", noise_dimensions="3D").parts()
    radius = (-2.0 * tree.math("LOGARITHM", first.at_least(1e-7), math.e)).sqrt()
    angle = 2.0 * math.pi * second
    random = tree.vector(radius * tree.math("COSINE", angle), radius * tree.math("SINE", angle))

    rest = along_wind(tree, asked["Wind Angle"]) * (1.0, 0.5, 1.0)  # half as frequent across the wind, as crests are
    scale = 1.0 / asked["Ripple Length"].at_least(1e-3)
    aside, time, _ = asked["Time"].parts()
    noise = tree.add("ShaderNodeTexNoise", {"Vector": rest + tree.vector(0.0, 0.0, aside), "W": time, "Scale": scale, **NOISE},
                     "Color", noise_dimensions="4D")
    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    share = asked["Ripples"].clamped() / (1.0 + away * away)
    ripples = (noise - NOISE_MEAN) / NOISE_DEVIATION
    return {"Normal Numbers": random * (1.0 - share).sqrt() + ripples * share.sqrt()}


def along_wind(tree, wind_angle):
    """The place at rest [m], x along the wind."""
    return tree.add("ShaderNodeVectorRotate", {"Vector": tree.attribute("rest_position"), "Angle": -wind_angle})


def add_fresnel(tree, cosine):
    """fresnel_exact() of fresnel.glsl."""
    def build(_, asked):
        c = asked["Cosine"]
        g = (c * c + (WATER_INDEX**2 - 1)).sqrt()
        across = (g - c) / (g + c)
        along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
        return {"Fresnel": 0.5 * across * across * (1.0 + along * along)}

    return tree.call("Pelagic Fresnel", build, {"Cosine": cosine})["Fresnel"]


def _mills(tree, k):
    """φ(k)/Φ(k) for k ≥ 0, of the normal distribution; 1.2e-4 off."""
    def build(_, asked):
        k = asked["k"]
        return {"Ratio": 0.797885 * (-(k * (0.79875 + k * (0.17595 + k * 0.04591)))).at_least(-80.0).exp()}

    return tree.call("Pelagic Mills", build, {"k": k})["Ratio"]


def _smith_lambda(tree, k):
    """smith_lambda() of slopes.glsl at a = k/√2, by the rational function of Walter et al. 2007; 0.003 off in 1/(1 + Λ)."""
    def build(_, asked):
        a = (asked["k"] * math.sqrt(0.5)).at_least(1e-4).at_most(1.6)
        return {"Lambda": ((1.0 - a * (1.259 - 0.396 * a)) / (a * (3.535 + 2.181 * a))).at_least(0.0)}

    return tree.call("Pelagic Smith", build, {"k": k})["Lambda"]
