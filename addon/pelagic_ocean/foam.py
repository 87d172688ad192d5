# SPDX-License-Identifier: GPL-3.0-or-later
"""Where foam is in a material: the places where a pattern has its largest values, so many that they are the coverage. The
pattern stands at rest positions, so foam moves with the water. With distance it fades to its mean.
The core's own pattern (foam_structure.glsl) is another one, of the same kind and with the same means. As there, foam is dense
where waves break now, and thin in what they left."""

from .facets import along_wind

DENSE = 0.4  # the dense part of foam, the mean over its lifetime: foam.glsl
# Of foam_pattern(), measured over a square of 400 m: mean, deviation, and its distribution's logit as A z + B z³.
MEAN, DEVIATION, A, B = 1.0319, 0.2058, 1.5438, 0.0912
NET_MEAN = 0.327  # of the root of the distance to a Voronoi cell's edge, in cells
NETS = 3  # sizes of cells, each twice the one before


def add_foam(tree, coverage, active, age_s, dense_active, dense_left, structure, streaks, size, detail_distance_m, wind_angle):
    """Adds the group. active: the coverage of what breaks now; dense_active, dense_left: the dense part of that, and of what is
    left of earlier breaking. structure: 0 shows smooth coverage, 1 the pattern. Foam: the share of it that the eye sees;
    Density: of what is there, 0 … 1."""
    return tree.call("Pelagic Foam", _foam, {"Coverage": coverage, "Active": active, "Age": age_s, "Dense Active": dense_active,
                                             "Dense Left": dense_left, "Structure": structure, "Streaks": streaks, "Size": size,
                                             "Detail Distance": detail_distance_m, "Wind Angle": wind_angle})


def _foam(tree, asked):
    coverage = asked["Coverage"].at_least(1e-6).at_most(1 - 1e-6)
    place = along_wind(tree, asked["Wind Angle"]) * (1.0 / asked["Size"].at_least(1e-3))
    z = (foam_pattern(tree, place, asked["Age"], asked["Streaks"]) - MEAN) / DEVIATION
    logit = z * (A + B * z * z)
    rank = 1.0 / (1.0 + (-logit.at_least(-60.0)).exp())  # the share of the sea where the pattern is lower
    # Foam is where rank > 1 − coverage, with an edge as soft as there is room for: its mean stays.
    room = 0.5 * coverage * (1.0 - coverage)
    beyond = rank - (1.0 - coverage)
    mask = tree.map_range(beyond, -room, room)
    fresh = (asked["Active"] / coverage).clamped()
    dense_part = tree.mix(fresh, asked["Dense Left"], asked["Dense Active"]).at_least(1e-3)
    # Dense in its middle, bubbles over water at its edge: ∫ x^(1/d − 1) dx = d.
    density = tree.math("POWER", (beyond / coverage).clamped(), 1.0 / dense_part - 1.0)

    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    detail = asked["Structure"] / (1.0 + away * away)
    # Dense foam fades as foam does. (If density faded by itself, where it is 0 between the foam would count: half way at a
    # coverage of a half an eighth of the dense foam would be lost.)
    dense = tree.mix(detail, dense_part * coverage, mask * density)
    mask = tree.mix(detail, coverage, mask)
    seen = asked["Coverage"].above(0.0) * mask  # nothing where there is none
    return {"Foam": seen, "Density": dense / mask.at_least(1e-6)}


def foam_pattern(tree, place, age_s, streaks):
    """place: [m], x along the wind. Streaks along the wind, in them a net as of bursting bubbles, whose cells grow with its age,
    and fine grain."""
    def noise(scale, detail, vector=place, output="Fac"):
        return tree.add("ShaderNodeTexNoise", {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": 0.6},
                        output=output)

    def drawn_out(most):
        return tree.vector(1.0 / (1.0 + most * streaks), 1.0, 1.0)

    patches = noise(0.3, 3.0, place * drawn_out(3.7))
    bent = place * drawn_out(1.33) + (noise(1.2, 4.0, output="Color") - 0.5) * 1.2
    # Nets stand still; weight goes from one to the next, and their deviation stays.
    octave = (0.75 * tree.math("LOGARITHM", 1.0 + age_s.at_least(0.0), 2.0)).at_most(NETS - 1.0)
    net, squares = 0.0, 0.0
    for k in range(NETS):
        cells = tree.add("ShaderNodeTexVoronoi", {"Vector": bent, "Scale": 1.1 * 0.5**k}, feature="DISTANCE_TO_EDGE")
        weight = (1.0 - tree.math("ABSOLUTE", octave - float(k))).at_least(0.0)
        net, squares = (cells.sqrt() - NET_MEAN) * weight + net, weight * weight + squares
    return 2.0 * patches - 1.0 * (NET_MEAN + net / squares.sqrt()) + 0.7 * noise(6.0, 4.0)
