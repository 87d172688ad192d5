# SPDX-License-Identifier: GPL-3.0-or-later
"""The cage that an ocean's surface is the limit of: a mesh of the file, with its creases, or a Wavefront OBJ.

To read, check and hash a mesh costs as much as a frame. So an ocean's cage is kept until Blender says that the mesh was
evaluated to something else, or until it stands elsewhere: play.py passes on what was updated.
"""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np

from . import compat, links
from .module import pelagic

ACCEPTED = "accepted: a mesh as the Cage, or a Wavefront OBJ as the cage's file"
RAYS = ("visible_camera", "visible_diffuse", "visible_glossy", "visible_transmission", "visible_volume_scatter",
        "visible_shadow")
OTHER_ENGINES = ("for other engines set its Instancing to Vertices, and there Show Instancer in renders off, as long as "
                 "nothing is parented to it")


def can_be(obj):
    """Whether an object may be a cage. An ocean may not: it would be its own, or two each other's, and grow without end."""
    return obj.type == "MESH" and not obj.pelagic.is_ocean


def mesh_of(obj):
    """The mesh object that is an ocean's cage, or None."""
    return links.alive(obj.pelagic.cage)


def cage_of(obj, path, depsgraph=None):
    """The pelagic.Cage of an ocean: its mesh's, in the ocean's own coordinates, or that of the file at this path. With a
    depsgraph the mesh is as evaluated there. ValueError if there is none, or it is no cage."""
    if obj.pelagic.cage is not None:
        made = _kept_cage(obj, obj.pelagic.cage, depsgraph)
        if made is not None:
            return made
    file = Path(bpy.path.abspath(path))
    if not file.is_file():
        raise ValueError(f"surface.cage_file = {path!r}: is no file; {ACCEPTED}")
    return _of_file(file, file.stat().st_mtime_ns)


@lru_cache(4)
def _of_file(file, _changed_ns):
    return pelagic.Cage.from_file(file)


def hide_from_pictures(mesh_object):
    """A wire in views, and nothing for Cycles' rays. Hidden from renders altogether, Blender would leave its modifiers and
    its animation out of them."""
    mesh_object.display_type = "WIRE"
    for rays in RAYS:
        setattr(mesh_object, rays, False)


# ---- Kept cages


@dataclass
class _Kept:
    where: tuple  # the mesh object's name, the depsgraph's scene and view layer
    to_ocean: tuple  # rows of a matrix
    cage: object


_kept = {}  # an ocean's name → its _Kept
_asked = {}  # an ocean's name → the mesh object that was asked for last, by name, cage or not


def _kept_cage(obj, mesh_object, depsgraph):
    """None of a mesh object that was deleted."""
    _asked[obj.name_full] = mesh_object.name_full
    if depsgraph is None or depsgraph.mode == "RENDER":  # a render has a depsgraph of its own, from frame to frame
        return of_mesh(mesh_object, to_ocean(obj, mesh_object, depsgraph), depsgraph) if links.alive(mesh_object) else None
    where = (mesh_object.name_full, depsgraph.scene.name_full, depsgraph.view_layer.name)
    matrix = to_ocean(obj, mesh_object, depsgraph)
    rows = tuple(tuple(row) for row in matrix)
    kept = _kept.get(obj.name_full)
    if kept is None or (kept.where, kept.to_ocean) != (where, rows):
        _kept.pop(obj.name_full, None)
        if links.alive(mesh_object) is None:
            return None
        kept = _kept[obj.name_full] = _Kept(where, rows, of_mesh(mesh_object, matrix, depsgraph))
    return kept.cage


def is_asked_for(obj):
    """Whether an ocean has this object as its cage."""
    return obj.type == "MESH" and obj.name_full in _asked.values()


def let_go(depsgraph):
    """Of the kept cages those whose meshes the depsgraph has just evaluated to something else; all where its scene has
    changed, such as by an object that is hidden, deleted or put back."""
    if not _kept:
        return
    changed = set()
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Scene):
            _kept.clear()
            return
        if update.is_updated_geometry and isinstance(update.id, bpy.types.Object):
            changed.add(update.id.name_full)
    for name in [name for name, kept in list(_kept.items()) if kept.where[0] in changed]:
        _kept.pop(name, None)  # a render has a thread of its own


def forget(oceans=()):
    """All but those of the oceans of these names."""
    for table in (_kept, _asked):
        for name in set(table) - set(oceans):
            table.pop(name, None)


# ---- A mesh as a cage


def to_ocean(obj, mesh_object, depsgraph=None):
    """The matrix that leads from the mesh object's coordinates to the ocean's."""
    if depsgraph is not None:
        obj, mesh_object = obj.evaluated_get(depsgraph), mesh_object.evaluated_get(depsgraph)
    return obj.matrix_world.inverted_safe() @ mesh_object.matrix_world


def of_mesh(mesh_object, matrix, depsgraph=None):
    """The pelagic.Cage of a mesh object that this matrix leads to the ocean. ValueError if it is none."""
    if not can_be(mesh_object):
        raise ValueError(f"{mesh_object.name} is an ocean or no mesh, and no cage: {ACCEPTED}")
    for modifier in mesh_object.modifiers:
        if modifier.type in {"SUBSURF", "MULTIRES"} and (modifier.show_viewport or modifier.show_render):
            raise ValueError(f"{mesh_object.name} has the modifier {modifier.name}, which would subdivide it twice: turn it "
                             "off, the sea lies on the smooth surface by itself")
    if depsgraph is not None and not _is_evaluated(mesh_object, depsgraph):
        switch, where = (("Disable in Renders", "renders") if depsgraph.mode == "RENDER" else
                         ("Disable in Viewports", "views"))
        raise ValueError(f"{mesh_object.name} is left out of {where}, so Blender doesn't evaluate it there, and its modifiers and "
                         f"its animation would be lost: turn off {switch} of the object and its collections. Its Display "
                         "As Wire and its Ray Visibility hide it from pictures")
    try:
        points, counts, corners, ends, edges, vertices = arrays_of(mesh_object, matrix, depsgraph)
        sharp, points_sharp = np.flatnonzero(edges), np.flatnonzero(vertices)
        return pelagic.Cage(points, counts, corners, creases=ends[sharp], crease_sharpness=sharpness(edges[sharp]),
                            corners=points_sharp.astype(np.int32), corner_sharpness=sharpness(vertices[points_sharp]))
    except ValueError as error:
        raise ValueError(f"{mesh_object.name}: {error}") from None


def _is_evaluated(mesh_object, depsgraph):
    """An object that the view layer leaves out is in the depsgraph, since the ocean's settings name it, but as it is
    without its modifiers; and then it isn't among those that the depsgraph shows."""
    return any(each.original == mesh_object for each in depsgraph.ids if isinstance(each, bpy.types.Object))


def arrays_of(mesh_object, matrix, depsgraph=None):
    """What makes the cage: points, corners of each face, vertices of the corners, of the edges, creases of edges and of
    vertices."""
    mesh = (mesh_object.evaluated_get(depsgraph) if depsgraph is not None else mesh_object).data
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    counts, corners = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    mesh.loops.foreach_get("vertex_index", corners)
    if matrix.is_negative:
        corners = _turned_over(counts, corners)
    ends = np.empty((len(mesh.edges), 2), np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    matrix = np.array(matrix)
    return points @ matrix[:3, :3].T + matrix[:3, 3], counts, corners, ends, *compat.creases(mesh)


def _turned_over(counts, corners):
    """Each face the other way round: what a mirror makes of it is seen from the same side then."""
    ends = np.cumsum(counts)
    return corners[np.repeat(2 * ends - counts - 1, counts) - np.arange(len(corners))]


def sharpness(creases):
    """Of Blender's creases: its Subdivision modifier takes ten times their squares."""
    return 10.0 * np.asarray(creases, float)**2
