# SPDX-License-Identifier: GPL-3.0-or-later
"""The light from the water where it isn't the same everywhere, as the core has it, at the mesh's vertices: what bubbles under foam add to
the water's own colour, and what waves make of the sun's light in it. The material adds it (material.py).

It is a reflectance, of what the host's lamps bring: an object's shadow lies on crests, too, and on a face that is turned from the sun by
more than its height Cycles lets no sunlight fall, though the core has it shine through there.
"""

import math

import numpy as np

from . import light
from .module import pelagic

ATTRIBUTE = "water_light"  # of the mesh: what is added to the reflectance; in places less than 0
NODE = "Water Light"  # that reads it, only where there is any
SUM = "Water and Its Light"  # where it goes in opaque water
CLEAR_OUT, CLEAR_LIGHT, CLEAR_SUM = "Bubbles Out", "Bubbles Light", "Clear Water and Bubbles"  # and in clear water

LEAST_COVERAGE = 2e-3  # of foam that shows bubbles: a hundredth of the water's own light
CREST_M = 1.0  # footprint of the waves that shape the light: kCrestFootprint_m
# An eye that the constant colour of water is for: from 45°, as a camera over the sea sees most of it.
FROM = (math.sqrt(0.5), 0.0, math.sqrt(0.5))


def has_bubbles(scene):
    """Whether there is anything under foam."""
    return scene.water.body and scene.water.bubbles > 0.0 and scene.effects.whitecaps


def has_crests(scene):
    """Whether waves shape the light in the water."""
    return scene.water.body and scene.water.crest_light > 0.0


def connect(material, scene):
    """Makes the material show what is added, or not ask for it."""
    tree = material.node_tree
    node, wanted = tree.nodes.get(NODE), (has_bubbles(scene) or has_crests(scene)) and SUM in tree.nodes
    if node is not None and not wanted:
        tree.nodes.remove(node)
        for link in tree.nodes[CLEAR_SUM].inputs[1].links if CLEAR_SUM in tree.nodes else ():
            tree.links.remove(link)
    elif node is None and wanted:
        node = tree.nodes.new("ShaderNodeAttribute")
        node.name = node.label = NODE
        node.attribute_name = ATTRIBUTE
        node.location = tree.nodes[SUM].location.x, tree.nodes[SUM].location.y - 150
        tree.links.new(node.outputs["Vector"], tree.nodes[SUM].inputs[1])
        if {CLEAR_SUM, CLEAR_LIGHT, CLEAR_OUT} <= set(tree.nodes.keys()):
            tree.links.new(node.outputs["Vector"], tree.nodes[CLEAR_OUT].inputs[0])
            tree.links.new(tree.nodes[CLEAR_LIGHT].outputs[0], tree.nodes[CLEAR_SUM].inputs[1])


def albedo(scene, water=None, to_eye=None, sky=None, **points):
    """float32 (n, 3): the diffuse reflectance of the water under sun and sky, before the factor (1 − Fresnel) on the way out.
    water, sky: the scene's, where they are known. to_eye: float32 (n, 3), default FROM. points: arguments of pelagic.water_albedo(), n of each; without them n is 1."""
    if to_eye is None:
        count = len(next(iter(points.values()))) if points else 1
        to_eye = np.broadcast_to(np.array(FROM, np.float32), (count, 3))
    return pelagic.water_albedo(sky or light.sky_of(scene), water or pelagic.WaterBody(scene), to_eye, **points)


class Upwelling:
    """What is added in one scene: kept, because its light and its water take milliseconds to make. ValueError where there is no sky."""

    def __init__(self, scene):
        self.scene = scene
        self._water = pelagic.WaterBody(scene)
        self._sky = light.sky_of(scene)
        self._level = albedo(scene, self._water, sky=self._sky)
        self._frame, self._widest_m = None, None  # of the waves that shape the light, and the largest footprint that it can be asked for
        self._asked, self._waves = (None, None), None  # of which surface and time

    def added(self, arrays, surface, time_s, eye=None):
        """float32 (n, 3): the reflectance that is added at the surface's vertices with these products; of bubbles alone without an
        eye, which sees the light in the waves: (its place [m] in the object's coordinates, 3 numbers, the object's axes in the world, rows of a
        matrix, 9). None: nothing anywhere."""
        foam = {}
        if has_bubbles(self.scene) and "coverage" in arrays:
            foam = {name: arrays[name] for name in ("coverage", "foam_active", "foam_age") if name in arrays}
        if eye is not None:
            towards = np.asarray(eye[0], np.float32) - arrays["position"]
            towards /= np.maximum(np.linalg.norm(towards, axis=1), 1e-6)[:, None]
            normal, crest = self._crests(surface, time_s)
            if eye[1] != (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0):  # the sun is the world's
                turn = np.reshape(np.asarray(eye[1], np.float32), (3, 3)).T
                towards, normal = towards @ turn, normal @ turn
                crest = np.column_stack([crest[:, :2] @ turn[:2, :2], crest[:, 2]])
            return albedo(self.scene, self._water, towards, self._sky, normal=normal, crest=crest, **foam) - self._level
        if not foam:
            return None
        made = np.zeros((len(surface), 3), np.float32)
        there = np.flatnonzero(foam["coverage"] > LEAST_COVERAGE)
        if len(there):
            made[there] = albedo(self.scene, self._water, sky=self._sky, **{name: each[there] for name, each in foam.items()}) - self._level
        return made

    def _crests(self, surface, time_s):
        """Of the waves above 2 m: normals, and slopes and height [m], float32 (n, 3) each."""
        if self._asked[0] is surface and self._asked[1] == time_s:
            return self._waves
        cell_m = np.broadcast_to(np.maximum(surface.cell_m, CREST_M).astype(np.float32), (len(surface),))
        widest = float(cell_m.max())
        if self._widest_m is None or widest > self._widest_m:
            levels = [CREST_M * 2**level for level in range(math.ceil(math.log2(widest / CREST_M) - 1e-6) + 1)]
            self._frame = pelagic.Frame(pelagic.Sea(self.scene, ("position", "normal"), cell_m=levels, pixel_m=levels))
            self._widest_m = levels[-1]
        self._frame.set(time_s)
        axis = {} if surface.cell_axis_m is None else {"cell_axis_m": surface.cell_axis_m, "pixel_axis_m": surface.cell_axis_m}
        waves = self._frame.evaluate(surface.rest, surface.origin_m, cell_m=cell_m, pixel_m=cell_m, **axis)
        normal = waves["normal"]
        crest = np.empty_like(normal)
        crest[:, :2] = -normal[:, :2] / np.maximum(normal[:, 2:], 0.1)
        crest[:, 2] = waves["position"][:, 2]
        self._asked, self._waves = (surface, time_s), (normal, crest)
        return self._waves
