# SPDX-License-Identifier: GPL-3.0-or-later
"""The shadow of objects in the sea's light in the viewport preview: a map of their depth towards the sun (plugin/host/gpu/sun_shadow.glsl).

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import gpu
import numpy as np
from mathutils import Matrix

from . import compat
from .gpu_objects import drawing

SIDE = 1024  # texels of the map
VERTEX = "in vec3 place_in; uniform mat4 clip_from_object; void main() { gl_Position = clip_from_object * vec4(place_in, 1.0); }\n"
FRAGMENT = "out vec4 depth; void main() { depth = vec4(gl_FragCoord.z); }\n"


class Shadow:
    """The map, and what is in it."""

    def __init__(self):
        self._shader = self._map = self._framebuffer = self._drawn = None
        self.uniforms, self.textures = {}, {}

    def draw(self, bodies, origin_m, to_sun, sun_radius):
        """Brings map and uniforms up. bodies: Objects.seen(); origin_m: of the grid, in the sea's coordinates; to_sun: there, too."""
        if not to_sun[2] > 0.0:  # everything lies before the map
            self.uniforms, self.textures = {"shadow_from_grid": Matrix.Diagonal((0.0,) * 4)}, {}
            return
        to_grid = np.eye(4)
        to_grid[:2, 3] = -np.array(origin_m)
        placed = [(part.shape, to_grid @ part.matrix) for body in bodies for part in body.parts]
        ahead = -np.array(to_sun, float)
        side = np.cross(ahead, (0.0, 0.0, 1.0) if abs(ahead[2]) < 0.99 else (0.0, 1.0, 0.0))
        side /= np.linalg.norm(side)
        turn = np.array((side, np.cross(side, ahead), ahead))
        corners = np.concatenate([shape.corners_of_box @ matrix[:3, :3].T + matrix[:3, 3] for shape, matrix in placed]) @ turn.T
        room = np.maximum(np.ptp(corners, axis=0) * (4.0 / SIDE), 1e-3)
        least, reach = corners.min(0) - room, np.ptp(corners, axis=0) + 2.0 * room
        from_grid = np.eye(4)
        from_grid[:3, :3], from_grid[:3, 3] = turn / reach[:, None], -least / reach
        wanted = from_grid.tobytes(), *((shape, matrix.tobytes()) for shape, matrix in placed)
        if wanted != self._drawn:
            self._draw(placed, from_grid)
            self._drawn = wanted
        self.uniforms = {"shadow_from_grid": Matrix(from_grid.tolist()), "shadow_reach": (*reach, float(np.tan(sun_radius))),
                         "shadow_off": float(0.5 * reach[:2].max() / SIDE / reach[2]), "shadow_texel_m": float(1.5 * reach[:2].max() / SIDE)}
        self.textures = {"sun_blockers": self._map}

    def _draw(self, placed, from_grid):
        if self._shader is None:
            self._shader = compat.plain_shader(VERTEX, FRAGMENT)
            self._map = gpu.types.GPUTexture((SIDE, SIDE), format="R32F")
            self._depth = gpu.types.GPUTexture((SIDE, SIDE), format="DEPTH_COMPONENT32F")  # a framebuffer doesn't keep it
            self._framebuffer = gpu.types.GPUFrameBuffer(depth_slot=self._depth, color_slots=[self._map])
        to_clip = np.diag((2.0, 2.0, 2.0, 1.0))
        to_clip[:3, 3] = -1.0
        with drawing(self._framebuffer, (0, 0, SIDE, SIDE), True):
            self._framebuffer.clear(color=(1.0, 1.0, 1.0, 1.0), depth=1.0)
            for shape, matrix in placed:
                self._shader.bind()
                self._shader.uniform_float("clip_from_object", Matrix((to_clip @ from_grid @ matrix).tolist()))
                for _, batch in shape.batches:
                    batch.draw(self._shader)
