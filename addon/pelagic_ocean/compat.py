# SPDX-License-Identifier: GPL-3.0-or-later
"""What this Blender can do. The only file that asks: everything else calls these functions."""

from pathlib import Path

import bpy
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


def curves(owner):
    """The curves that animate an object or its data: a collection with remove(), or an empty list."""
    animation = owner.animation_data
    if animation is None or animation.action is None:
        return []
    if not hasattr(animation, "action_slot"):  # actions have slots since 4.4
        return animation.action.fcurves
    for layer in animation.action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(animation.action_slot)
            if bag:
                return bag.fcurves
    return []


def set_uv(layer, uv):
    """uv: float32 (corners, 2), contiguous."""
    if hasattr(layer, "uv"):  # since 3.5
        layer.uv.foreach_set("vector", uv.ravel())
    else:
        layer.data.foreach_set("uv", uv.ravel())


def user_folder(package, name, create):
    """A Path to a folder of the user's own, which stays when the add-on is updated: an extension's, since 4.2, or the
    one for scripts' presets."""
    if package.startswith("bl_ext."):
        return Path(bpy.utils.extension_path_user(package, path=name, create=create))
    return Path(bpy.utils.user_resource("SCRIPTS", path=f"{name}/pelagic", create=create))
