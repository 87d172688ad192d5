# SPDX-License-Identifier: GPL-3.0-or-later
"""The light from the water where it isn't the same everywhere, as the core has it, at the mesh's vertices: what bubbles under foam send
back beside the water's own colour. The material adds it (material.py)."""

import math

import numpy as np

from . import light
from .module import pelagic

ATTRIBUTE = "water_bubbles"  # of the mesh: what they add to the reflectance
BUBBLES = "Bubbles"  # the node that reads it, only where there are any
SUM = "Water and Bubbles"  # where it goes in opaque water
CLEAR_OUT, CLEAR_LIGHT, CLEAR_SUM = "Bubbles Out", "Bubbles Light", "Clear Water and Bubbles"  # and in clear water

# An eye that the constant colour of water is for: from 45°, as a camera over the sea sees most of it.
FROM = (math.sqrt(0.5), 0.0, math.sqrt(0.5))


def has_bubbles(scene):
    """Whether there is anything under foam."""
    return scene.water.body and scene.water.bubbles > 0.0 and scene.effects.whitecaps


def connect(material, scene):
    """Makes the material show what bubbles add, or not ask for it."""
    tree = material.node_tree
    node, wanted = tree.nodes.get(BUBBLES), has_bubbles(scene) and SUM in tree.nodes
    if node is not None and not wanted:
        tree.nodes.remove(node)
        for link in tree.nodes[CLEAR_SUM].inputs[1].links if CLEAR_SUM in tree.nodes else ():
            tree.links.remove(link)
    elif node is None and wanted:
        node = tree.nodes.new("ShaderNodeAttribute")
        node.name = node.label = BUBBLES
        node.attribute_name = ATTRIBUTE
        node.location = tree.nodes[SUM].location.x, tree.nodes[SUM].location.y - 150
        tree.links.new(node.outputs["Vector"], tree.nodes[SUM].inputs[1])
        if {CLEAR_SUM, CLEAR_OUT} <= set(tree.nodes.keys()):
            tree.links.new(node.outputs["Vector"], tree.nodes[CLEAR_OUT].inputs[0])
            tree.links.new(tree.nodes[CLEAR_LIGHT].outputs[0], tree.nodes[CLEAR_SUM].inputs[1])


def albedo(scene, water=None, **foam):
    """float32 (n, 3): the diffuse reflectance of the water under sun and sky, before the factor (1 − Fresnel) on the way out.
    foam: arguments of pelagic.water_albedo(), n numbers each; without them n is 1."""
    count = len(foam["coverage"]) if foam else 1
    to_eye = np.broadcast_to(np.array(FROM, np.float32), (count, 3))
    return pelagic.water_albedo(light.sky_of(scene), water or pelagic.WaterBody(scene), to_eye, **foam)


class Bubbles:
    """What they add in one scene: kept, because its light and its water take milliseconds to make. ValueError where there is no sky."""

    def __init__(self, scene):
        self.scene = scene
        self._water = pelagic.WaterBody(scene)
        self._level = albedo(scene, self._water)

    def added(self, arrays):
        """float32 (n, 3): the reflectance that is added at vertices with these products."""
        coverage = arrays["coverage"]
        made = np.zeros((len(coverage), 3), np.float32)
        there = np.flatnonzero(coverage > 0.0)
        if len(there):
            foam = {name: arrays[name][there] for name in ("coverage", "foam_active", "foam_age") if name in arrays}
            made[there] = albedo(self.scene, self._water, **foam) - self._level
        return made
