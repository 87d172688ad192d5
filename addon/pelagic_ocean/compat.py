# SPDX-License-Identifier: GPL-3.0-or-later
"""What this Blender can do. The only file that asks: everything else calls these functions."""

import numpy as np


def set_positions(mesh, positions):
    """positions: float32 (n, 3), contiguous."""
    attribute = mesh.attributes.get("position")  # since 3.5; before, vertices have a structure of their own
    if attribute is not None and attribute.data_type == "FLOAT_VECTOR":
        attribute.data.foreach_set("vector", positions.ravel())
    else:
        mesh.vertices.foreach_set("co", positions.ravel())


def shade_smooth(mesh):
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))


def new_group_socket(group, name, kind, is_output=False, default=None):
    """A socket of a node group; kind: "Float", "Color", "Vector"."""
    idname = "NodeSocket" + kind
    if hasattr(group, "interface"):  # since 4.0
        socket = group.interface.new_socket(name, in_out="OUTPUT" if is_output else "INPUT", socket_type=idname)
    else:
        socket = (group.outputs if is_output else group.inputs).new(idname, name)
    if default is not None:
        socket.default_value = default
    return socket


def set_uv(layer, uv):
    """uv: float32 (corners, 2), contiguous."""
    if hasattr(layer, "uv"):  # since 3.5
        layer.uv.foreach_set("vector", uv.ravel())
    else:
        layer.data.foreach_set("uv", uv.ravel())
