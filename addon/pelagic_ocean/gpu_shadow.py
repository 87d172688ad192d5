# SPDX-License-Identifier: GPL-3.0-or-later
"""The shadow of objects in the sea's light in the viewport preview: a map of their depth towards the sun (plugin/host/gpu/sun_shadow.glsl).

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import gpu
import numpy as np
from mathutils import Matrix

from . import bodies, compat, in_light

SIDE = 1024  # texels of the map
VERTEX = "in vec3 place; uniform mat4 clip_from_object; void main() { gl_Position = clip_from_object * vec4(place, 1.0); }\n"
FRAGMENT = "out vec4 depth; void main() { depth = vec4(gl_FragCoord.z); }\n"

_dirty = set()  # names of objects whose shape has changed since their batches were made


def changed(depsgraph):
    """Takes notice of an update of the scene's."""
    _dirty.update(update.id.name for update in depsgraph.updates if update.is_updated_geometry and hasattr(update.id, "type"))


class Shadow:
    """The map, and what is in it."""

    def __init__(self):
        self._batches = {}  # name → batch; None of what has no faces
        self._shader = self._map = self._framebuffer = self._drawn = None
        self.uniforms, self.texture = {}, None

    def parts(self, context):
        """What the view shows of the scene's bodies: (name, evaluated object, evaluated body) of each part."""
        chosen = [obj for obj in in_light.of_scene(context.scene) if obj.visible_get()]
        if not chosen:
            return []
        depsgraph = context.evaluated_depsgraph_get()
        return [(part.name, part.evaluated_get(depsgraph), obj.evaluated_get(depsgraph)) for obj in chosen for part in bodies.members(obj, in_light.is_body)
                if part.type in bodies.SHAPES and part.visible_get()]

    def draw(self, parts, sea_from_world, origin_m, to_sun, sun_radius):
        """Brings map and uniforms up. origin_m: of the grid, in the sea's coordinates; to_sun: there, too."""
        for name in _dirty:
            self._batches.pop(name, None)
        _dirty.clear()
        from_world = Matrix.Translation((-origin_m[0], -origin_m[1], 0.0)) @ sea_from_world
        placed = []
        for name, evaluated, _ in parts:
            if name not in self._batches:
                self._batches[name] = _batch(evaluated)
                self._drawn = None
            if self._batches[name] is not None:
                placed.append((self._batches[name], np.array(from_world @ evaluated.matrix_world, float), np.array(evaluated.bound_box, float)))
        ahead = -np.array(to_sun, float)
        side = np.cross(ahead, (0.0, 0.0, 1.0) if abs(ahead[2]) < 0.99 else (0.0, 1.0, 0.0))
        side /= np.linalg.norm(side)
        turn = np.array((side, np.cross(side, ahead), ahead))
        corners = np.concatenate([box @ matrix[:3, :3].T + matrix[:3, 3] for _, matrix, box in placed] or [np.zeros((1, 3))]) @ turn.T
        room = np.maximum(np.ptp(corners, axis=0) * (4.0 / SIDE), 1e-3)
        least, reach = corners.min(0) - room, np.ptp(corners, axis=0) + 2.0 * room
        from_grid = np.eye(4)
        from_grid[:3, :3], from_grid[:3, 3] = turn / reach[:, None], -least / reach
        wanted = from_grid.tobytes(), *(matrix.tobytes() for _, matrix, _ in placed)
        if wanted != self._drawn:
            self._draw(placed, from_grid)
            self._drawn = wanted
        if not placed:
            from_grid = np.zeros((4, 4))
            from_grid[2, 3] = -2.0  # everything lies before the map
        self.uniforms = {"shadow_from_grid": Matrix(from_grid.tolist()), "shadow_reach": (*reach, float(np.tan(sun_radius))),
                         "shadow_off": float(0.5 * reach[:2].max() / SIDE / reach[2])}
        self.texture = self._map

    def _draw(self, placed, from_grid):
        if self._shader is None:
            self._shader = compat.plain_shader(VERTEX, FRAGMENT)
            self._map = gpu.types.GPUTexture((SIDE, SIDE), format="R32F")
            depth = gpu.types.GPUTexture((SIDE, SIDE), format="DEPTH_COMPONENT32F")
            self._framebuffer = gpu.types.GPUFrameBuffer(depth_slot=depth, color_slots=[self._map])
        to_clip = np.diag((2.0, 2.0, 2.0, 1.0))
        to_clip[:3, 3] = -1.0
        before, viewport = gpu.state.depth_test_get(), gpu.state.viewport_get()
        mask, blend = gpu.state.depth_mask_get(), gpu.state.blend_get()
        with self._framebuffer.bind():
            gpu.state.depth_mask_set(True)
            gpu.state.blend_set("NONE")
            gpu.state.viewport_set(0, 0, SIDE, SIDE)
            self._framebuffer.clear(color=(1.0, 1.0, 1.0, 1.0), depth=1.0)
            gpu.state.depth_test_set("LESS")
            for batch, matrix, _ in placed:
                self._shader.bind()
                self._shader.uniform_float("clip_from_object", Matrix((to_clip @ from_grid @ matrix).tolist()))
                batch.draw(self._shader)
        gpu.state.depth_test_set(before)
        gpu.state.depth_mask_set(mask)
        gpu.state.blend_set(blend)
        gpu.state.viewport_set(*viewport)


def _batch(evaluated):
    triangles = bodies.triangles_of(evaluated)
    if triangles is None:
        return None
    points, corners = triangles
    form = gpu.types.GPUVertFormat()
    form.attr_add(id="place", comp_type="F32", len=3, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(format=form, len=len(points))
    vertices.attr_fill(id="place", data=points)
    return gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=gpu.types.GPUIndexBuf(type="TRIS", seq=corners))
