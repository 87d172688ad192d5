# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as a Blender mesh, and a frame's buffers in it."""

import zlib

import bmesh
import bpy
import numpy as np

from . import compat, upwelling

SIGNATURE = "pelagic_surface"  # the mesh's own property: which surface its vertices are, and how many
MARKER = "marker"  # instead of that: what saving.py puts into files
REST = "rest_position"
UV_MAP = "UVMap"

# The mesh's attributes: name, type, the property for foreach_set, the module's product.
ATTRIBUTES = (("velocity", "FLOAT_VECTOR", "vector", "velocity"),
              ("slope_variance", "FLOAT_VECTOR", "vector", "slope_variance"),
              ("whitecap_coverage", "FLOAT", "value", "coverage"),
              ("foam_active", "FLOAT", "value", "foam_active"),
              ("foam_age", "FLOAT", "value", "foam_age"),
              ("dry", "FLOAT", "value", "dry"),  # of bakes with hulls alone: baked.py
              (upwelling.ATTRIBUTE, "FLOAT_VECTOR", "vector", upwelling.ATTRIBUTE))  # not the core's: upwelling.py


def _signature(surface):
    return f"{surface.signature} of {len(surface)}" if surface.faces else surface.signature


def _sign(mesh, signature):
    """Says which surface the mesh is. While Blender draws a window no script may write properties, in whatever thread it
    runs; then nobody knows, and the surface is put there again at the next frame."""
    try:
        mesh[SIGNATURE] = signature
    except AttributeError:
        pass


def holds(mesh, surface):
    return mesh.get(SIGNATURE) == _signature(surface) and len(mesh.vertices) == len(surface)


def is_generated(mesh):
    """Whether all that a mesh holds is put_surface()'s and put_frame()'s: nobody took vertices away, or added an attribute."""
    ours = {"position", UV_MAP, REST, *(row[0] for row in ATTRIBUTES)}
    return (mesh.get(SIGNATURE, "").endswith(f" of {len(mesh.vertices)}") and not mesh.shape_keys
            and set(mesh.uv_layers.keys()) <= {UV_MAP} and not compat.has_more(mesh, ours))


def put_surface(mesh, surface, uv_map=True):
    """Makes the mesh's vertices and faces the surface's, at rest, with a UV map if wanted."""
    corners, starts = surface.faces()
    mesh.clear_geometry()
    mesh.vertices.add(len(surface))
    compat.set_faces(mesh, corners, starts)
    compat.shade_smooth(mesh)
    rest = surface.rest_3d()
    compat.set_positions(mesh, rest)
    mesh.update(calc_edges=True)
    if uv_map:
        mesh.uv_layers.new(name=UV_MAP)
    move_rest(mesh, surface, rest)
    _sign(mesh, _signature(surface))


def move_rest(mesh, surface, rest=None):
    """Where the points are at rest, as attribute and as UV map if there is one. rest: of the surface, if known."""
    put_rest(mesh, surface.rest_3d() if rest is None else rest)
    layer = mesh.uv_layers.get(UV_MAP)
    if layer is not None:
        _fill_uv(mesh, layer, surface)


def keep_uv(mesh, surface, wanted):
    """Makes the UV map of a mesh that holds the surface, or takes it away."""
    layer = mesh.uv_layers.get(UV_MAP)
    if wanted and layer is None:
        _fill_uv(mesh, mesh.uv_layers.new(name=UV_MAP), surface)
    elif layer is not None and not wanted:
        mesh.uv_layers.remove(layer)


def _fill_uv(mesh, layer, surface):
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    compat.set_uv(layer, surface.uv(corners))


def put_rest(mesh, rest):
    """rest: float32 (n, 3)."""
    attribute(mesh, REST, "FLOAT_VECTOR").data.foreach_set("vector", rest.ravel())


def rest_of(mesh):
    """float32 (n, 3) of put_rest(), or None."""
    stored = mesh.attributes.get(REST)
    if stored is None:
        return None
    rest = np.empty((len(mesh.vertices), 3), np.float32)
    stored.data.foreach_get("vector", rest.ravel())
    return rest


def edges_of(mesh):
    """int32 (m, 2)."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    return edges.reshape(-1, 2)


def capture(mesh):
    """Makes the mesh's own vertices a surface: its rest is what rest_position says, or where they are now. Returns the
    signature."""
    rest = rest_of(mesh)
    if rest is None:
        rest = np.empty((len(mesh.vertices), 3), np.float32)
        mesh.vertices.foreach_get("co", rest.ravel())
        put_rest(mesh, rest)
    mesh[SIGNATURE] = f"own {len(rest)} {zlib.crc32(rest):08x} {zlib.crc32(edges_of(mesh)):08x}"
    return mesh[SIGNATURE]


def forget_rest(mesh):
    """Lets rest_position go: where the vertices are now counts from here on."""
    if REST in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[REST])


STANDS_FOR = "pelagic_stands_for"  # a mesh's own property: the name of the linked mesh that it is filled for


def fillable(mesh):
    """The mesh itself; of a linked one, whose arrays Blender lets nobody fill, a copy that no file holds."""
    if not mesh.library:
        return mesh
    made = next((each for each in bpy.data.meshes if each.get(STANDS_FOR) == mesh.name_full and not each.library), None)
    if made is None:
        made = mesh.copy()
        made[STANDS_FOR] = mesh.name_full
    return made


def hand_over(filled, mesh):
    """Puts into a mesh what was filled for it; in memory alone where it is linked."""
    if filled == mesh:
        return
    made = bmesh.new()  # the one way into a linked mesh; as long as 50 frames of a mesh that isn't
    try:
        made.from_mesh(filled, face_normals=False, vertex_normals=False)
        made.to_mesh(mesh)
    finally:
        made.free()
    _sign(mesh, filled.get(SIGNATURE, ""))


def restore(mesh):
    """What capture() and put_frame() changed is as before; without rest_position the vertices stay where they are."""
    rest = rest_of(mesh)
    if rest is not None:
        compat.set_positions(mesh, rest)
    for name in (REST, *(row[0] for row in ATTRIBUTES)):
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    del mesh[SIGNATURE]
    mesh.update()


def attribute(mesh, name, kind):
    """The point attribute, made where it is missing or of another kind."""
    found = mesh.attributes.get(name)
    if found is not None and (found.data_type, found.domain) != (kind, "POINT"):
        mesh.attributes.remove(found)
        found = None
    return found or mesh.attributes.new(name, kind, "POINT")


def put_frame(mesh, arrays):
    """arrays: each product's, contiguous float32. Attributes whose products aren't there are taken away."""
    for name, kind, numbers, product in ATTRIBUTES:
        if product in arrays:
            attribute(mesh, name, kind).data.foreach_set(numbers, arrays[product].ravel())
        elif name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    compat.set_positions(mesh, arrays["position"])
    compat.tell(mesh)
