# SPDX-License-Identifier: GPL-3.0-or-later
"""Where foam is in a material: the places where a pattern has its largest values, so many that they are the coverage. The
pattern stands at rest positions, so foam moves with the water. With distance it fades to its mean.
The core's own pattern (foam_structure.glsl) is another one, of the same kind and with the same means. As there, foam hides the water
where waves break now, and is thin in what they left. What this has not: the core's heaps and hollows, whiter and darker than the mean,
with the slopes of their relief, and films that grow softer with age."""

from .facets import along_wind

PICTURE = "Foam Picture"  # the node of an artist's pattern

COLOR = (0.94, 1.0, 1.0)  # of what it reflects: foam.glsl
OPACITY = 0.4  # the share of its area that foam hides, the mean over its lifetime: foam.glsl
# Measured over squares of 400 m, in three versions of Blender: of what isn't lace in foam_pattern(), mean and variance; of the distance
# to the nearest of a Voronoi texture's points, in cells, mean and deviation; and the whole's distribution's logit as A z + B z³.
PATCHES, PATCHES_VARIANCE = 1.3500, 0.0222
HOLES, HOLES_DEVIATION = 0.4295, 0.1897
A, B = 1.57, 0.0755
CLOUDS_DEVIATION = 0.118  # of a noise without detail, over squares of 2 km
LACE = 0.26  # how much of the pattern lace is, where it is old
SIZES = 5  # of holes, each twice the one before, from 1/8 m


def add_foam(tree, coverage, active, age_s, fresh, old, structure, streaks, picture_m, size, detail_distance_m, wind_angle):
    """Adds the group, and a picture for an artist's pattern, picture_m wide, 0: the own one. active: the coverage of what breaks now; fresh, old: (opacity, colour) of that, and of what is left of earlier
    breaking. structure: 0 shows smooth coverage, 1 the pattern. Foam: the share that foam hides here; Color: what that reflects;
    Hidden: the share that it hides round about, without a pattern."""
    tile = along_wind(tree, wind_angle) * (1.0 / picture_m.at_least(1e-3))
    picture = tree.node("ShaderNodeTexImage", {"Vector": tile})
    picture.name = picture.label = PICTURE
    return tree.call("Pelagic Foam", _foam, {"Picture": tree.value(picture, "Color").parts()[0], "Is Picture": picture_m.above(0.0),
                                             "Coverage": coverage, "Active": active, "Age": age_s, "Fresh Opacity": fresh[0],
                                             "Old Opacity": old[0], "Fresh Color": fresh[1], "Old Color": old[1], "Structure": structure,
                                             "Streaks": streaks, "Size": size, "Detail Distance": detail_distance_m,
                                             "Wind Angle": wind_angle})


def _foam(tree, asked):
    coverage = asked["Coverage"].at_least(1e-6).at_most(1 - 1e-6)
    place = along_wind(tree, asked["Wind Angle"]) * (1.0 / asked["Size"].at_least(1e-3))
    # A picture's tiles differ, as in foam_image_noise().
    clouds = (tree.add("ShaderNodeTexNoise", {"Vector": place, "Scale": 1.0 / 32.0, "Detail": 0.0}) - 0.5) / CLOUDS_DEVIATION
    picture = 0.85**0.5 * asked["Picture"] + 0.15**0.5 * clouds
    z = tree.mix(asked["Is Picture"], foam_pattern(tree, place, asked["Age"], asked["Streaks"]), picture)
    logit = z * (A + B * z * z)
    rank = 1.0 / (1.0 + (-logit.at_least(-60.0)).exp())  # the share of the sea where the pattern is lower
    beyond = rank - (1.0 - coverage)  # foam is where that is above 0
    fresh = (asked["Active"] / coverage).clamped()
    opacity = tree.mix(fresh, asked["Old Opacity"], asked["Fresh Opacity"]).at_least(1e-3)
    # Thickest in its middle, bubbles over water at its edge, x^(1/d − 1), whose mean over the foam is d. An opaque one has an edge, which
    # the mean over ± room softens; its own mean stays.
    room = 0.15 * coverage * (1.0 - coverage)

    def up_to(place):
        inside = tree.math("POWER", (place / coverage).clamped(), 1.0 / opacity)
        return coverage * opacity * inside + (place - coverage).at_least(0.0)
    thickness = (up_to(beyond + room) - up_to(beyond - room)) / (2.0 * room)

    away = tree.add("ShaderNodeCameraData", output="View Distance") / asked["Detail Distance"]
    detail = asked["Structure"] / (1.0 + away * away)
    there = asked["Coverage"].above(0.0)  # nothing where there is none
    hidden = there * opacity * coverage
    return {"Foam": tree.mix(detail, hidden, there * thickness), "Hidden": hidden,
            "Color": tree.mix(fresh * asked["Fresh Opacity"] / opacity, asked["Old Color"], asked["Fresh Color"])}


def foam_pattern(tree, place, age_s, streaks):
    """Mean 0, deviation 1, largest in the middle of foam. place: [m], x along the wind. Rough patches where foam is fresh, streaks along
    the wind, and lace: round holes of several sizes, bent by turbulence, which grow with age."""
    def noise(scale, detail, vector=place, output="Fac"):
        return tree.add("ShaderNodeTexNoise", {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": 0.6},
                        output=output)

    def drawn_out(most):
        return tree.vector(1.0 / (1.0 + most * streaks), 1.0, 1.0)

    age_s = age_s.at_least(0.0)
    bent = place * drawn_out(1.33) + (noise(0.6, 1.5, output="Color") - 0.5) * 1.3
    octave = (1.0 + 0.8 * tree.math("LOGARITHM", 1.0 + age_s, 2.0)).at_most(SIZES - 1.0)
    # Weight goes from one size to the next, with smaller holes between the larger; their deviation stays.
    holes, squares = 0.0, 0.0
    for k in range(SIZES):
        cells = tree.add("ShaderNodeTexVoronoi", {"Vector": bent, "Scale": 8.0 * 0.5**k}, output="Distance", voronoi_dimensions="2D")
        finer = octave - float(k)
        weight = sum((part * (1.0 - tree.math("ABSOLUTE", finer - float(j))).at_least(0.0) for j, part in enumerate((0.6, 0.42), 1)),
                     (1.0 - tree.math("ABSOLUTE", finer)).at_least(0.0))
        holes, squares = (cells - HOLES) * weight + holes, weight * weight + squares
    lace = LACE * (1.0 - 0.8 * (age_s / -1.2).exp())
    patches = 2.0 * noise(0.3, 3.0, place * drawn_out(3.7)) + 0.7 * noise(6.0, 4.0)
    shown = patches - PATCHES + lace / HOLES_DEVIATION * holes / squares.sqrt()
    return shown / (PATCHES_VARIANCE + lace * lace).sqrt()
