# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's bodies in the viewport preview: the shapes of their parts on the GPU, and where they are. Their shadow (gpu_shadow.py), their hulls
(gpu_hulls.py), their mirror image and what of them is in the water (gpu_pictures.py) are drawn from these.

Only a draw handler may call seen(): it needs the view's OpenGL context.
"""

from contextlib import contextmanager
from dataclasses import dataclass, field

import bpy
import gpu
import numpy as np
from mathutils import Euler, Matrix, Quaternion, Vector

from . import bodies, compat, floating, in_light

_dirty = set()  # names of objects whose shape has changed since it was read


def changed(depsgraph):
    """Takes notice of an update of the scene's."""
    _dirty.update(update.id.name for update in depsgraph.updates if update.is_updated_geometry and hasattr(update.id, "type"))
    if any(isinstance(update.id, bpy.types.Image) for update in depsgraph.updates):
        bodies.forget_pictures()


@contextmanager
def drawing(framebuffer, place, depth):
    """Into a part of a framebuffer, (x, y, width, height), what is drawn as it is, the nearest where it has a depth; then all is as before."""
    depth_test, viewport = gpu.state.depth_test_get(), gpu.state.viewport_get()
    mask, blend = gpu.state.depth_mask_get(), gpu.state.blend_get()
    try:
        with framebuffer.bind():
            gpu.state.viewport_set(*place)
            gpu.state.blend_set("NONE")
            gpu.state.depth_mask_set(depth)
            gpu.state.depth_test_set("LESS" if depth else "NONE")
            yield
    finally:
        gpu.state.depth_test_set(depth_test)
        gpu.state.depth_mask_set(mask)
        gpu.state.blend_set(blend)
        gpu.state.viewport_set(*viewport)


def full_triangle():
    """For shaders that cover all by one, of three vertices without attributes."""
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="unused", comp_type="F32", len=1, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(format=form, len=3)
    vertices.attr_fill(id="unused", data=np.zeros(3, np.float32))
    return gpu.types.GPUBatch(type="TRIS", buf=vertices)


def _looks(slots):
    """Of each of a part's slots, one at least: colour, roughness and light; its picture, and the UV map's name, or None and None."""
    found = []
    for slot in slots:
        pictures = {}
        look = bodies.material_of(slot.material, {}, pictures)[1:]
        found.append((look, *next(iter(pictures.values()), (None, None))))
    return found or [(bodies.GREY[1:], None, None)]


class Shape:
    """Of a part: points (n, 3), corners (t, 3) into them, and its box's corners (8, 3), in its own coordinates; and the GPU's batches of it, each
    with the slot whose picture it has places in, or None."""

    def __init__(self, layers, points, corners, normals, slot, places):
        """layers: its slots' UV maps, as bodies.triangles_of() has them."""
        self.points, self.corners, self.layers = points, corners, layers
        box = points.min(0), points.max(0)
        self.corners_of_box = np.array([[box[side >> axis & 1][axis] for axis in range(3)] for side in range(8)], float)
        has_place = np.isfinite(places).all((1, 2))
        attributes = (("place_in", points[corners]), ("normal_in", normals), ("material_in", np.repeat(slot, 3).reshape(-1, 3, 1)),
                      ("image_at_in", np.where(has_place[:, None, None], places, 0.0)))
        form = gpu.types.GPUVertFormat()
        for name, values in attributes:
            form.attr_add(id=name, comp_type="F32", len=values.shape[2], fetch_mode="FLOAT")
        picture, self.batches = np.where(has_place, slot, -1), []
        for which in np.unique(picture):
            of = picture == which
            vertices = gpu.types.GPUVertBuf(format=form, len=3 * int(of.sum()))
            for name, values in attributes:
                vertices.attr_fill(id=name, data=np.ascontiguousarray(values[of].reshape(-1, values.shape[2]), np.float32))
            self.batches.append((None if which < 0 else which, gpu.types.GPUBatch(type="TRIS", buf=vertices)))
        self._told = self._materials = None

    def materials(self, told):
        """The texture object_materials. told: colour, roughness and light of each slot."""
        if told != self._told:
            texels = np.array([(*colour, roughness, *glow, 0.0) for colour, roughness, glow in told], np.float32)
            self._materials = gpu.types.GPUTexture((2, len(told)), format="RGBA32F", data=gpu.types.Buffer("FLOAT", texels.size, texels.ravel()))
            self._told = told
        return self._materials


@dataclass
class Part:
    name: str
    shape: Shape
    matrix: np.ndarray  # from its own coordinates to the sea's (4, 4)
    materials: gpu.types.GPUTexture
    images: tuple  # of its slots, Blender's, or None


@dataclass
class Body:
    matrix: np.ndarray  # from the body's own axes to the sea's coordinates (4, 4)
    water_m: float  # height of the water at it, in the sea's coordinates
    floats: bool
    per_s: np.ndarray  # how the matrix changes in a second of the sea, but for the waves (4, 4)
    parts: list = field(default_factory=list)

    def in_body(self, part):
        """From the part's coordinates to the body's."""
        return np.linalg.pinv(self.matrix) @ part.matrix

    def box(self):
        """The least and the most of it in its own axes (2, 3)."""
        corners = []
        for part in self.parts:
            matrix = self.in_body(part)
            corners.append(part.shape.corners_of_box @ matrix[:3, :3].T + matrix[:3, 3])
        corners = np.concatenate(corners)
        return np.array((corners.min(0), corners.max(0)))


class Objects:
    """The shapes that were read."""

    def __init__(self):
        self._shapes = {}  # name of a part → Shape; None of what has no faces

    def seen(self, context, sea_from_world, frame_s):
        """The Body of each of the scene's bodies that the view shows something of. frame_s: seconds of the sea a frame."""
        for name in _dirty:
            self._shapes.pop(name, None)
        _dirty.clear()
        chosen = [obj for obj in in_light.of_scene(context.scene) if obj.visible_get()]
        if not chosen:
            return []
        depsgraph, found = context.evaluated_depsgraph_get(), []
        for obj in chosen:
            world = obj.evaluated_get(depsgraph).matrix_world
            matrix = np.array(sea_from_world @ world, float)
            # As exported: what a scale does to the shape is the parts'.
            stiff = np.array(sea_from_world @ Matrix.LocRotScale(world.to_translation(), world.to_quaternion(), None), float)
            calm = np.array(sea_from_world @ floating.calm_matrix(obj, depsgraph), float)
            change = np.array(sea_from_world @ _change(obj, context.scene.frame_current_final) @ sea_from_world.inverted_safe(), float)
            body = Body(stiff, _water_m(matrix, calm), floating.is_afloat(obj), change @ stiff / frame_s if frame_s else np.zeros((4, 4)))
            for part in bodies.members(obj, in_light.is_body):
                if part.type not in bodies.SHAPES or not part.visible_get():
                    continue
                evaluated = part.evaluated_get(depsgraph)
                looks, images, layers = zip(*_looks(evaluated.material_slots))
                shape = self._shapes.get(part.name)
                if part.name not in self._shapes or (shape is not None and shape.layers != layers):
                    read = bodies.triangles_of(evaluated, lambda: layers)
                    shape = self._shapes[part.name] = Shape(layers, *read) if read else None
                if shape is not None:
                    body.parts.append(Part(part.name, shape, np.array(sea_from_world @ evaluated.matrix_world, float), shape.materials(looks), images))
            if body.parts:
                found.append(body)
        return found


def _water_m(matrix, calm):
    """What the water's movement makes of the calm sea's place under a body."""
    return float((matrix @ np.linalg.pinv(calm) @ (*calm[:2, 3], 0.0, 1.0))[2])


def _change(obj, frame):
    """How an object's matrix in calm water changes each frame, times its inverse, by the keyframes of its own and of what it is parented to: what
    constraints and drivers do at another frame isn't known while a view is drawn."""
    chain = [obj]
    while chain[-1].parent is not None and chain[-1].parent_type == "OBJECT":
        chain.append(chain[-1].parent)
    if not any(compat.curves(each) for each in chain):
        return Matrix.Diagonal((0.0,) * 4)
    before, behind = (_keyed(chain, frame + beside) for beside in (-0.25, 0.25))
    return 2.0 * (behind @ before.inverted_safe() - Matrix())


def _keyed(chain, frame):
    """The matrix of the first of a chain of parents."""
    made = Matrix()
    for obj in chain:
        curves = {(curve.data_path, curve.array_index): curve for curve in compat.curves(obj)}

        def at(name):
            return [curves[name, i].evaluate(frame) if (name, i) in curves else value for i, value in enumerate(getattr(obj, name))]

        if obj.rotation_mode == "QUATERNION":
            turn = Quaternion(at("rotation_quaternion"))
        elif obj.rotation_mode == "AXIS_ANGLE":
            angle, *axis = at("rotation_axis_angle")
            turn = Quaternion(axis, angle)
        else:
            turn = Euler(at("rotation_euler"), obj.rotation_mode)
        made = Matrix.LocRotScale(Vector(at("location")), turn, Vector(at("scale"))) @ made
        if obj is not chain[-1]:
            made = obj.matrix_parent_inverse @ made
    return made
