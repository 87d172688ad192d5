# SPDX-License-Identifier: GPL-3.0-or-later
"""A calm or rough place painted on a mesh: its colours, or a float attribute, become the picture of a mask of the sea."""

import math
import re
import zlib
from pathlib import Path

import bpy
import numpy as np
from bpy.props import StringProperty

from . import ocean, query
from .light import openexr
from .operators import NeedsModule
from .properties import add_row

MOST_PIXELS = 1024  # a side
FOLDER = "//masks"  # of the pictures: beside the .blend
VALUES = {"FLOAT": ("value", 1), "FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4)}


def attribute_of(mesh, name):
    """The attribute of that name; of "" the active colours, or else the active attribute if that is a float's. ValueError
    where there is none, or it isn't of points, corners or faces."""
    attribute = mesh.attributes.get(name) if name else mesh.color_attributes.active_color or mesh.attributes.active
    accepted = "accepted: colours, as Vertex Paint makes them, or an attribute of floats, of vertices, face corners or faces"
    if attribute is None:
        raise ValueError(f"{mesh.name} has no attribute {name}: {accepted}" if name else f"{mesh.name} isn't painted: {accepted}")
    if attribute.data_type not in VALUES or attribute.domain not in ("POINT", "CORNER", "FACE"):
        raise ValueError(f"{mesh.name}'s attribute {attribute.name} is no such thing: {accepted}")
    return attribute


def triangles_of(mesh, attribute):
    """Points of a mesh's triangles in its own coordinates, (n, 3, 3), and the shares there, 0 … 1, (n, 3)."""
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles

    def numbers(of, name, width, kind):
        made = np.empty(len(of) * width, kind)
        of.foreach_get(name, made)
        return made.reshape(-1, width)

    vertices = numbers(triangles, "vertices", 3, np.int32)
    member, width = VALUES[attribute.data_type]
    shares = numbers(attribute.data, member, width, np.float32)[:, :3].mean(1)  # of red, green and blue
    at = {"POINT": lambda: vertices, "CORNER": lambda: numbers(triangles, "loops", 3, np.int32),
          "FACE": lambda: np.repeat(numbers(triangles, "polygon_index", 1, np.int32), 3, 1)}[attribute.domain]()
    points = numbers(mesh.vertices, "co", 3, np.float32).astype(float)
    return points[vertices], np.clip(np.nan_to_num(shares), 0.0, 1.0).astype(float)[at]


def rasterised(corners, shares, width, height):
    """The shares at the pixels' middles, float32 (height, width), rows by rising y; 0 beside all triangles, and where they
    overlap any one's. corners: (n, 3, 2) in pixels."""
    picture = np.zeros(width * height, np.float32)
    size = np.array((width, height))
    low = np.clip(np.ceil(corners.min(1) - 0.5), 0, size).astype(int)
    end = np.clip(np.floor(corners.max(1) - 0.5) + 1, 0, size).astype(int)
    sides = (end - low).max(1)
    to_b, to_c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = to_b[:, 0] * to_c[:, 1] - to_b[:, 1] * to_c[:, 0]
    # Triangles whose bounds are about as large, so many at once: each is a square of pixels.
    side = 1
    while side // 2 < max(width, height):
        group = np.flatnonzero((sides > side // 2) & (sides <= side) & (area != 0))
        for part in np.array_split(group, max(1, len(group) * side**2 >> 20)):
            x, y = (low[part, axis, None, None] + np.arange(side).reshape((1, -1) if axis == 0 else (-1, 1)) for axis in (0, 1))
            from_a = [pixel + 0.5 - corners[part, 0, axis, None, None] for axis, pixel in enumerate((x, y))]
            (bx, by), (cx, cy) = ([of[part, axis, None, None] for axis in (0, 1)] for of in (to_b, to_c))
            b = (from_a[0] * cy - from_a[1] * cx) / area[part, None, None]
            c = (bx * from_a[1] - by * from_a[0]) / area[part, None, None]
            rounding = 1e-9
            inside = ((b >= -rounding) & (c >= -rounding) & (b + c <= 1 + rounding)
                      & (x < end[part, 0, None, None]) & (y < end[part, 1, None, None]))
            at_a, at_b, at_c = (shares[part, corner, None, None] for corner in range(3))
            picture[(y * width + x)[inside]] = (at_a + b * (at_b - at_a) + c * (at_c - at_a))[inside]
        side *= 2
    return np.clip(picture, 0.0, 1.0).reshape(height, width)


class Painted:
    """A mesh's picture: where it lies in the sea's coordinates [m], its pixels' side, and shares, rows by rising y."""

    def __init__(self, mesh, attribute, into_sea):
        """into_sea: a matrix from the mesh's coordinates to the sea's."""
        points, shares = triangles_of(mesh, attribute_of(mesh, attribute))
        if not len(points):
            raise ValueError(f"{mesh.name} has no faces, and nothing to paint")
        matrix = np.array(into_sea)
        points = points @ matrix[:3, :3].T + matrix[:3, 3]
        self.turn = math.atan2(matrix[1, 0], matrix[0, 0])  # of its own x
        along = np.array((math.cos(self.turn), math.sin(self.turn)))
        across = np.array((-along[1], along[0]))
        flat = points[..., :2] @ np.stack((along, across), 1)
        low, high = flat.min((0, 1)), flat.max((0, 1))
        self.size_m = high - low
        if self.size_m.min() < 1.0:
            raise ValueError(f"{mesh.name} is less than a metre wide as seen from above")
        self.middle_m = 0.5 * (low + high) @ np.stack((along, across))
        # Two pixels along an edge of a face.
        face_m = math.sqrt(self.size_m.prod() / max(1.0, 0.5 * len(points)))
        self.pixel_m = max(0.5 * face_m, self.size_m.max() / MOST_PIXELS)
        count = np.clip(np.ceil(self.size_m / self.pixel_m), 2, MOST_PIXELS).astype(int)
        self.shares = rasterised((flat - low) * (count / self.size_m), shares, *count)

    def put_into(self, row):
        """Where a mask of the picture lies; an existing one's gains and edge stay."""
        row.east_m, row.north_m = self.middle_m
        row.length_m, row.width_m = self.size_m
        row.direction_deg = math.degrees(self.turn)


class PELAGIC_OT_paint_mask(NeedsModule, bpy.types.Operator):
    """Calm the ocean where the active mesh is painted, or make it rough: its colours become the picture of a mask. Done again, the mask has the new picture"""

    bl_idname = "pelagic.paint_mask"
    bl_label = "Mask from Painted Mesh"
    bl_options = {"REGISTER", "UNDO"}

    attribute: StringProperty(name="Attribute", description="Whose numbers or colours count; without a name the active colours do")

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object is not None and context.object.type == "MESH" \
            and not ocean.is_ocean(context.object) and query.first_ocean(context.scene) is not None

    def execute(self, context):
        obj, sea = context.object, query.first_ocean(context.scene)
        if not bpy.data.filepath:
            self.report({"ERROR"}, f"The picture goes to {FOLDER}, beside the .blend, which isn't saved yet: save it first")
            return {"CANCELLED"}
        evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
        try:
            painted = Painted(evaluated.data, self.attribute, sea.matrix_world.inverted_safe() @ evaluated.matrix_world)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        file = openexr(np.repeat(painted.shares[::-1, :, None], 3, 2))
        # A name of its own for each content: settings that name another picture are another sea's, and undo finds the old one.
        start = ocean.clean_name(obj.name) + "-"
        name = f"{start}{zlib.crc32(file):08x}.exr"
        folder = Path(bpy.path.abspath(FOLDER))
        try:
            folder.mkdir(exist_ok=True)
            (folder / name).write_bytes(file)
        except OSError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        masks = sea.pelagic.waves.masks
        of_mesh = re.compile(re.escape(start) + r"[0-9a-f]{8}\.exr")
        row = next((each for each in masks if of_mesh.fullmatch(Path(each.picture.replace("\\", "/")).name)), None)
        if row is None:
            row = add_row(masks)
            row.waves, row.edge_m = 0.5, max(2.0 * painted.pixel_m, 0.05 * painted.size_m.min())
        painted.put_into(row)
        row.picture = f"{FOLDER}/{name}"
        sea.update_tag()
        return {"FINISHED"}


def register():
    bpy.utils.register_class(PELAGIC_OT_paint_mask)


def unregister():
    bpy.utils.unregister_class(PELAGIC_OT_paint_mask)
