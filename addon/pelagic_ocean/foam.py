# SPDX-License-Identifier: GPL-3.0-or-later
"""Where foam is in a material: the places where a pattern has its largest values, so many that they are the coverage. The
pattern stands at rest positions, so foam moves with the water. With distance it fades to its mean."""

from .facets import along_wind

DENSE = 0.4  # the share of dense foam, the mean over the foam's lifetime: foam.glsl
# Of foam_pattern(), measured over a square of 400 m: mean, deviation, and its distribution's logit as A z + B z³.
MEAN, DEVIATION, A, B = 1.0319, 0.2058, 1.5438, 0.0912


def add_foam(tree, coverage, size, detail_distance_m, wind_angle):
    """Adds the group. Foam: the share of it that the eye sees; Density: of what is there, 0 … 1."""
    return tree.call("Pelagic Foam", _foam, {"Coverage": coverage, "Size": size,
                                             "Detail Distance": detail_distance_m, "Wind Angle": wind_angle})


def _foam(tree, asked):
    coverage = asked["Coverage"].at_least(1e-6).at_most(1 - 1e-6)
    place = along_wind(tree, asked["Wind Angle"]) * (1.0 / asked["Size"].at_least(1e-3))
    z = (foam_pattern(tree, place) - MEAN) / DEVIATION
    logit = z * (A + B * z * z)
    rank = 1.0 / (1.0 + (-logit.at_least(-60.0)).exp())  # the share of the sea where the pattern is lower
    # Foam is where rank > 1 − coverage, with an edge as soft as there is room for: its mean stays.
    room = 0.5 * coverage * (1.0 - coverage)
    beyond = rank - (1.0 - coverage)
    mask = tree.map_range(beyond, -room, room)
    # Dense in its middle, bubbles over water at its edge.
    density = tree.math("POWER", (beyond / coverage).clamped(), 1.0 / DENSE - 1.0)

    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    detail = 1.0 / (1.0 + away * away)
    # Dense foam fades as foam does. (If density faded by itself, where it is 0 between the foam would count: half way at a
    # coverage of a half an eighth of the dense foam would be lost.)
    dense = tree.mix(detail, DENSE * coverage, mask * density)
    mask = tree.mix(detail, coverage, mask)
    seen = asked["Coverage"].above(0.0) * mask  # nothing where there is none
    return {"Foam": seen, "Density": dense / mask.at_least(1e-6)}


def foam_pattern(tree, place):
    """place: [m], x along the wind. Streaks along the wind, in them a net as of bursting bubbles, and fine grain."""
    def noise(scale, detail, vector=place, output="Fac"):
        return tree.add("ShaderNodeTexNoise", {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": 0.6},
                        output=output)

    streaks = noise(0.3, 3.0, place * (0.35, 1.0, 1.0))
    bent = place * (0.6, 1.0, 1.0) + (noise(1.2, 4.0, output="Color") - 0.5) * 1.2
    net = tree.add("ShaderNodeTexVoronoi", {"Vector": bent, "Scale": 1.1}, feature="DISTANCE_TO_EDGE")
    return 2.0 * streaks - 1.0 * net.sqrt() + 0.7 * noise(6.0, 4.0)
