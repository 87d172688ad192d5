# SPDX-License-Identifier: GPL-3.0-or-later
"""The cage that an ocean's surface is the limit of: a mesh of the file, with its creases, or a Wavefront OBJ."""

from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np

from . import compat
from .module import pelagic

ACCEPTED = "accepted: a mesh as the Cage, or a Wavefront OBJ as the cage's file"


def cage_of(obj, path, depsgraph=None):
    """The pelagic.Cage of an ocean: its mesh's, in the ocean's own coordinates, or that of the file at this path. With a
    depsgraph the mesh is as evaluated there. ValueError if there is none, or it is no cage."""
    if obj.pelagic.cage is not None:
        return _of_mesh(obj, obj.pelagic.cage, depsgraph)
    file = Path(bpy.path.abspath(path))
    if not file.is_file():
        raise ValueError(f"surface.cage_file = {path!r}: is no file; {ACCEPTED}")
    return _of_file(file, file.stat().st_mtime_ns)


@lru_cache(4)
def _of_file(file, _changed_ns):
    return pelagic.Cage.from_file(file)


def _of_mesh(obj, mesh_object, depsgraph):
    for modifier in mesh_object.modifiers:
        if modifier.type in {"SUBSURF", "MULTIRES"} and (modifier.show_viewport or modifier.show_render):
            raise ValueError(f"{mesh_object.name} has the modifier {modifier.name}, which would subdivide it twice: turn it "
                             "off, the sea lies on the smooth surface by itself")
    if depsgraph is not None:
        obj, mesh_object = obj.evaluated_get(depsgraph), mesh_object.evaluated_get(depsgraph)
    try:
        return _cage(mesh_object.data, np.array(obj.matrix_world.inverted_safe() @ mesh_object.matrix_world))
    except ValueError as error:
        raise ValueError(f"{mesh_object.name}: {error}") from None


def _cage(mesh, matrix):
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    counts, corners = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    mesh.loops.foreach_get("vertex_index", corners)
    ends = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    edges, vertices = compat.creases(mesh)
    sharp, points_sharp = np.flatnonzero(edges), np.flatnonzero(vertices)
    return pelagic.Cage(points @ matrix[:3, :3].T + matrix[:3, 3], counts, corners,
                        creases=ends[sharp], crease_sharpness=sharpness(edges[sharp]),
                        corners=points_sharp.astype(np.int32), corner_sharpness=sharpness(vertices[points_sharp]))


def sharpness(creases):
    """Of Blender's creases: its Subdivision modifier takes ten times their squares."""
    return 10.0 * np.asarray(creases, float)**2
