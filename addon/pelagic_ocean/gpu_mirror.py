# SPDX-License-Identifier: GPL-3.0-or-later
"""The mirror image of objects in the sea's light in the viewport preview: a picture of them as the eye's mirror image sees them
(plugin/host/gpu/sky_with_objects.glsl), with the coarser levels that waves blur it by beside it, since Blender's textures have none
(mirror_atlas.glsl).

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import gpu
import numpy as np
from mathutils import Matrix

from . import compat
from .gpu_objects import drawing, full_triangle

NEAR_M = 0.05  # what is nearer to the mirrored eye isn't in the picture
VERTEX = "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n"
# A part of a picture, or the mean of each four of its texels, to where this one's part begins.
FRAGMENT = """
uniform sampler2D finer;
uniform ivec2 finer_first;
uniform ivec2 finer_size;
uniform ivec2 first;
uniform int apart;  // 1: of four; 0: as it is
out vec4 mean;

void main() {
    ivec2 at = (1 + apart) * (ivec2(gl_FragCoord.xy) - first);
    mean = vec4(0.0);
    for (int i = 0; i < 4; ++i)
        mean += 0.25 * texelFetch(finer, finer_first + min(at + apart * ivec2(i & 1, i >> 1), finer_size - 1), 0);
}
"""


class Mirror:
    """The picture, and what the sea's shader wants with it."""

    def __init__(self):
        self._size = self._shader = self._triangle = None
        self.texture, self.uniforms, self.boxes = None, {}, None

    def draw(self, bodies, grid, view, shader, put, uniforms, textures):
        """Brings texture and uniforms up. bodies: Objects.seen(), one at least; grid: the view's pelagic.GpuGrid; shader: of objects; put: sets
        uniforms and textures of a shader, those that it has; uniforms, textures: of the light, and of the shadow, if there is one."""
        to_grid = np.eye(4)
        to_grid[:2, 3] = -np.array(grid.origin_m)
        told = grid.mirror(view, [to_grid @ body.matrix for body in bodies], [body.box().tolist() for body in bodies], [body.water_m for body in bodies])
        clip, size = told["clip_from_grid"], told["size"]
        self._make(size)
        uniforms = {**uniforms, "object_eye": told["eye_m"], "object_colour": (1.0, 1.0, 1.0), "object_glow": 1.0, "depth_of_distance": (1.0, -2.0 * NEAR_M)}
        with drawing(self._framebuffer, (0, 0, *size), True):
            self._framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            for body in bodies:
                for part in body.parts:
                    matrix = to_grid @ part.matrix
                    shader.bind()
                    put(shader, {**uniforms, "object_water_m": body.water_m,
                                 "clip_from_object": Matrix((clip @ matrix).tolist()), "grid_from_object": Matrix(matrix.tolist())},
                        {**textures, "object_materials": part.materials})
                    part.shape.batch.draw(shader)
        self._fill(size)
        self.boxes = told["boxes"]
        self.uniforms = {"mirrored_from_grid": Matrix(clip.tolist()), "mirrored_texels": told["texels"], "object_count": len(self.boxes)}

    def put_boxes(self, shader):
        """For the sea's shader, which is bound."""
        try:
            location = shader.uniform_from_name("object_boxes")
        except ValueError:  # a sea that mirrors nothing
            return
        shader.uniform_vector_float(location, self.boxes, 16, len(self.boxes))

    def _make(self, size):
        if self._shader is None:
            self._shader = compat.plain_shader(VERTEX, FRAGMENT)
            self._triangle = full_triangle()
        if size == self._size:
            return
        self._size = size
        self.texture = gpu.types.GPUTexture((2 * size[0], size[1]), format="RGBA32F")
        self._depth = gpu.types.GPUTexture((2 * size[0], size[1]), format="DEPTH_COMPONENT32F")  # a framebuffer doesn't keep it
        self._framebuffer = gpu.types.GPUFrameBuffer(depth_slot=self._depth, color_slots=[self.texture])
        self._levels = gpu.types.GPUFrameBuffer(color_slots=[self.texture])
        # A picture can't be read where it is drawn into: each level is made in another, and taken over.
        self._half = gpu.types.GPUTexture((size[0] // 2, size[1] // 2), format="RGBA32F")
        self._half_framebuffer = gpu.types.GPUFrameBuffer(color_slots=[self._half])

    def _fill(self, size):
        """The levels from the first coarser one on."""
        finer, finer_first = size, (0, 0)
        while max(finer) > 1:
            coarser = tuple(max(side // 2, 1) for side in finer)
            first = size[0] + coarser[0], coarser[1]
            self._pass(self._half_framebuffer, (0, 0), coarser, self.texture, finer_first, finer, 1)
            self._pass(self._levels, first, coarser, self._half, (0, 0), coarser, 0)
            finer, finer_first = coarser, first

    def _pass(self, framebuffer, first, size, texture, finer_first, finer_size, apart):
        with drawing(framebuffer, (*first, *size), False):
            shader = self._shader
            shader.bind()
            shader.uniform_sampler("finer", texture)
            for name, value in (("finer_first", finer_first), ("finer_size", finer_size), ("first", first), ("apart", apart)):
                shader.uniform_int(name, value)
            self._triangle.draw(shader)

