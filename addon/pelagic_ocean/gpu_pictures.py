# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of objects in the sea's light that the sea shows in the viewport preview: one of them as the eye's mirror image sees them
(plugin/host/gpu/sky_with_objects.glsl), with the coarser levels that waves blur it by beside it, since Blender's textures have none
(mirror_atlas.glsl); and one of what of them is in the water (objects_in_water.glsl), with its depth.

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import gpu
import numpy as np
from mathutils import Matrix

from . import compat
from .gpu_objects import drawing, full_triangle

NEAR_M = 0.05  # what is nearer to who sees a picture isn't in it
FULL = "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n"
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


class Pictures:
    """Both, and what the sea's shader wants with them."""

    def __init__(self):
        self._mirrored, self._in_water = _Mirrored(), _Picture()
        self.textures, self.uniforms, self._boxes = {}, {}, None

    def draw(self, bodies, grid, view, shader, put, uniforms, textures, is_clear):
        """Brings textures and uniforms up. bodies: Objects.seen(), one at least; grid: the view's pelagic.GpuGrid; shader: gives that of a name;
        put: sets uniforms and textures of a shader, those that it has; uniforms, textures: of the light, the water, and the shadow, if there is
        one; is_clear: whether what is in the water is seen."""
        to_grid = np.eye(4)
        to_grid[:2, 3] = -np.array(grid.origin_m)
        told = grid.objects(view, [to_grid @ body.matrix for body in bodies], [body.box().tolist() for body in bodies], [body.water_m for body in bodies])
        uniforms = {**uniforms, "object_colour": (1.0, 1.0, 1.0), "object_glow": 1.0}
        self._mirrored.draw(bodies, to_grid, told["mirrored"], shader("object_mirrored"), put, uniforms, textures)
        self._boxes = told["boxes"]
        self.textures = {"mirrored_objects": self._mirrored.texture}
        self.uniforms = {"mirrored_from_grid": Matrix(told["mirrored"]["clip_from_grid"].tolist()), "mirrored_texels": told["mirrored"]["texels"],
                         "object_count": len(self._boxes), "in_water_ahead": (0.0, 0.0, 0.0)}
        if is_clear and "in_water" in told:
            near_m = self._in_water.draw(bodies, to_grid, told["in_water"], shader("object_in_water"), put, uniforms, textures)
            self.textures |= {"objects_in_water": self._in_water.texture, "objects_in_water_depth": self._in_water.depth}
            self.uniforms |= {"in_water_from_grid": Matrix(told["in_water"]["clip_from_grid"].tolist()), "in_water_ahead": (1.0, -1.0, near_m)}

    def put_boxes(self, shader):
        """For the sea's shader, which is bound."""
        try:
            location = shader.uniform_from_name("object_boxes")
        except ValueError:  # a sea that shows nothing of them
            return
        shader.uniform_vector_float(location, self._boxes, 16, len(self._boxes))


class _Picture:
    """One that is seen from a place."""

    def __init__(self):
        self._size = self.texture = self.depth = None

    def draw(self, bodies, to_grid, told, shader, put, uniforms, textures):
        """told: of GpuGrid.objects(). Returns how far away what is nearest to the eye may be [m]."""
        if told["size"] != self._size:
            self._size = told["size"]
            self._make(self._size)
        clip = told["clip_from_grid"]
        placed = [(body, part, to_grid @ part.matrix) for body in bodies for part in body.parts]
        # As far as the boxes let it be: distances far away are the finer in the depth.
        ahead = np.concatenate([part.shape.corners_of_box @ (clip[3] @ matrix)[:3] + (clip[3] @ matrix)[3] for _, part, matrix in placed])
        near_m = max(NEAR_M, 0.5 * float(ahead.min()))
        # Asked for each time: Blender makes another where the picture has changed; before the shader has its textures, for that may bind it.
        images = {image: gpu.texture.from_image(image) for _, part, _ in placed for image in part.images if image is not None}
        with drawing(self._framebuffer, (0, 0, *self._size), True):
            self._framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            shader.bind()
            put(shader, {**uniforms, "object_eye": told["eye_m"], "depth_of_distance": (1.0, -2.0 * near_m)}, textures)
            for body, part, matrix in placed:
                put(shader, {"object_water_m": body.water_m, "clip_from_object": Matrix((clip @ matrix).tolist()), "grid_from_object": Matrix(matrix.tolist())},
                    {"object_materials": part.materials})
                for slot, batch in part.shape.batches:
                    image = None if slot is None else part.images[slot]
                    put(shader, {"object_has_image": int(image is not None)}, {} if image is None else {"object_image": images[image]})
                    batch.draw(shader)
        return near_m

    def _make(self, size):
        self.texture = gpu.types.GPUTexture(size, format="RGBA32F")
        self.depth = gpu.types.GPUTexture(size, format="DEPTH_COMPONENT32F")  # a framebuffer doesn't keep it
        self._framebuffer = gpu.types.GPUFrameBuffer(depth_slot=self.depth, color_slots=[self.texture])


class _Mirrored(_Picture):
    """With its levels."""

    def __init__(self):
        super().__init__()
        self._shader = self._triangle = None

    def draw(self, *drawn):
        super().draw(*drawn)
        self._fill()

    def _make(self, size):
        if self._shader is None:
            self._shader = compat.plain_shader(FULL, FRAGMENT)
            self._triangle = full_triangle()
        super()._make((2 * size[0], size[1]))
        self._levels = gpu.types.GPUFrameBuffer(color_slots=[self.texture])
        # A picture can't be read where it is drawn into: each level is made in another, and taken over.
        self._half = gpu.types.GPUTexture((size[0] // 2, size[1] // 2), format="RGBA32F")
        self._half_framebuffer = gpu.types.GPUFrameBuffer(color_slots=[self._half])

    def _fill(self):
        """The levels from the first coarser one on."""
        size = finer = self._size
        finer_first = 0, 0
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
