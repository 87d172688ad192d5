# SPDX-License-Identifier: GPL-3.0-or-later
"""The sea drawn into a 3D view by the preview's own shaders, through Blender's gpu module.

Nothing here changes the file's data. Only a draw handler may call Drawing.draw(): it needs the view's OpenGL context.
"""

import gpu
import numpy as np
from mathutils import Matrix, Vector

from . import compat
from .gpu_hulls import Hulls
from .gpu_objects import full_triangle
from .gpu_pictures import Pictures
from .gpu_shadow import Shadow
from .module import pelagic

COARSE = 3  # cells are as many times larger while the view moves
KEPT_GRIDS = 8  # views whose grids are kept
NEAREST_TAN, WIDEST_TAN = 0.01, 50.0  # half widths that a pelagic.View may have
# An orthographic view is drawn through a perspective one from so many half widths behind it, a bit wider: its grid then
# covers what is seen. The projection itself, and the light's directions, are Blender's own.
BEHIND, WIDER = 50.0, 1.1


class Camera:
    """What a region shows, in the ocean's own coordinates [m]."""

    def __init__(self, projection, view, size, sea_to_world):
        """projection, view: Blender's matrices; size: pixels of the region; sea_to_world: the ocean's."""
        self.size = size
        self.clip_from_sea = np.array(projection) @ np.array(view) @ np.array(sea_to_world)
        # The sea's units are Blender's: a scaled ocean is drawn scaled, and looked at from as much nearer.
        pose = (view @ sea_to_world).inverted_safe()
        scale = pose.median_scale
        self.position = pose.translation
        self.right, self.up, back = ((pose.to_3x3() @ Vector(axis)).normalized() for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
        self.up = back.cross(self.right).normalized()  # right angles, to the last bit
        self.forward = self.up.cross(self.right).normalized()
        self.is_perspective = projection[3][3] == 0
        column = 2 if self.is_perspective else 3
        self.half = Vector((1 / projection[0][0], 1 / projection[1][1]))  # tangents, or lengths
        self.shift = Vector((-projection[0][column], -projection[1][column]))  # of the axis, in half pictures
        if not self.is_perspective:
            self.half *= scale
            self.shift = -self.shift

    def view(self):
        """A pelagic.View that shows all that is seen, with pixels as large."""
        across, along = (1 + abs(self.shift.x)), (1 + abs(self.shift.y))
        resolution = (max(1, round(self.size[0] * across)), max(1, round(self.size[1] * along)))
        tangent, position = self.half.x * across, self.position
        if not self.is_perspective:
            position = position - self.forward * (BEHIND * max(self.half))
            tangent *= WIDER / (BEHIND * max(self.half))
        return pelagic.View(position_m=position, right=self.right, up=self.up, forward=self.forward,
                            tan_half_width=min(max(tangent, NEAREST_TAN), WIDEST_TAN), resolution=resolution)

    def clip_from_grid(self, origin_m):
        """The host's projection of points relative to the grid's origin, rounded last."""
        clip = self.clip_from_sea.copy()
        clip[:, 3] += clip[:, 0] * origin_m[0] + clip[:, 1] * origin_m[1]
        return Matrix(clip.tolist())

    def uniforms(self):
        """The pixels' rays."""
        across, along = 2 * self.half.x / self.size[0], 2 * self.half.y / self.size[1]
        if not self.is_perspective:  # all rays are parallel
            across = along = 0.0
        return {"view_forward": tuple(self.forward), "view_right": tuple(self.right * across),
                "view_up": tuple(self.up * along),
                "view_centre": tuple(0.5 * self.size[axis] * (1 + self.shift[axis]) for axis in (0, 1)),
                "view_pixel_tangent": max(across, 1e-6)}


def _texture(pixels):
    """pixels: float32 (height, width, 1, 2 or 4)."""
    height, width, channels = pixels.shape
    return gpu.types.GPUTexture((width, height), format={1: "R32F", 2: "RG32F", 4: "RGBA32F"}[channels],
                                data=gpu.types.Buffer("FLOAT", pixels.size, pixels.reshape(-1)))


def _set(shader, uniforms):
    """Those that the shader has: a compiler leaves out what it doesn't use."""
    for name, value in uniforms.items():
        try:
            if isinstance(value, int):
                shader.uniform_int(name, value)
            else:
                shader.uniform_float(name, value)
        except ValueError:
            pass


def _bind(shader, textures):
    for name, texture in textures.items():
        try:
            shader.uniform_sampler(name, texture)
        except ValueError:
            pass


def _put(shader, uniforms, textures):
    _set(shader, uniforms)
    _bind(shader, textures)


class Grid:
    """A region's projected grid on the GPU."""

    def __init__(self, sea, view, cell_px, on_earth, before):
        """on_earth: False for views that no eye sees, which are of a flat sea. before: the region's last Grid, whose triangles may serve again, or None."""
        grid = sea.grid(view, cell_px, on_earth)
        self.curvature_per_m, self.grid = grid.curvature_per_m, grid
        self.key, self.size, self.origin_m = (view, cell_px, on_earth), grid.size, grid.origin_m
        form = gpu.types.GPUVertFormat()
        for name, length in (("rest_in", 2), ("cell_in", 3), ("pixel_in", 3)):
            form.attr_add(id=name, comp_type="F32", len=length, fetch_mode="FLOAT")
        vertices = gpu.types.GPUVertBuf(format=form, len=len(grid.vertices))
        for name, part in (("rest_in", grid.vertices[:, :2]), ("cell_in", grid.vertices[:, 2:5]),
                           ("pixel_in", grid.vertices[:, 5:])):
            vertices.attr_fill(id=name, data=np.ascontiguousarray(part))
        self.triangles = (before.triangles if before is not None and before.size == grid.size
                          else gpu.types.GPUIndexBuf(type="TRIS", seq=grid.triangles))
        self.batch = gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=self.triangles)


class Drawing:
    """A sea and its light on the GPU, and the grids of the views that show them."""

    def __init__(self):
        self.sea = self.light = None
        self._texts, self._textures, self._grids = {}, {}, {}
        self._compiled = {}  # text → shader: a sea that is a bit different needs no new one
        self._time_s = None
        self._air, self._air_height_m = {}, ()
        self._sky_batch = None
        self.shadow, self.hulls, self.pictures = Shadow(), Hulls(), Pictures()
        self._has_bodies = False
        self._foam_asked = None  # for what, and whether it hasn't come yet
        self.awaits_foam = False
        self.is_under_water = False  # the view that was drawn last, which then stayed empty

    def take(self, sea, light):
        """Another pelagic.GpuSea or GpuLight, or both, from the next picture on."""
        if sea is not self.sea:
            self._grids.clear()
            self._textures.clear()
            self._time_s = self._foam_asked = None
            self.awaits_foam = False
        self._texts.clear()
        self._air_height_m = ()
        self.sea, self.light = sea, light

    def finest_m(self):
        """How fine a sea the views would use that were drawn lately [m]; None before the first."""
        return min((self.sea.finest_for(grid.key[0]) for grid in self._grids.values()), default=None)

    def knows_hulls(self):
        """Whether the sea has the footprints that the hulls want that were drawn last, and none if there are no hulls."""
        wanted, known = self.hulls.footprints_m, self.sea.hull_footprints_m
        return set(wanted) <= set(known) and bool(wanted) == bool(known)

    def is_coarse(self):
        """Whether a view's last picture was of its coarse grid."""
        return any(grid.key[1] != self._cell_px for grid in self._grids.values())

    def has_foam(self):
        """Whether foam has come that no picture shows yet."""
        return self.awaits_foam and not self.sea.is_foam_busy

    def draw(self, region, camera, scene, time_s, exposure, with_sky, bodies=()):
        """The sea at a time [s] into the bound framebuffer, where it is nearer than what is there; the sky where nothing
        is. region: what tells views apart. scene: one that sea and light serve; cells are larger while the view moves. bodies: Objects.seen()."""
        cell_px = scene.surface.cell_px
        self._cell_px = cell_px
        if bool(bodies) != self._has_bodies:
            self._has_bodies = bool(bodies)
            self._texts.clear()
        if not bodies:
            self.hulls.footprints_m = []
        self._prepare(time_s)
        self.is_under_water = camera.is_perspective and self.sea.water_over(camera.view()) is not None
        if self.is_under_water:
            return
        self._see_air(camera)
        light = {**self.light.uniforms, **camera.uniforms(), **self._air, "exposure": exposure}
        depth_test, blend = gpu.state.depth_test_get(), gpu.state.blend_get()
        depth_mask = gpu.state.depth_mask_get()
        gpu.state.blend_set("NONE")
        gpu.state.depth_mask_set(True)
        try:
            gpu.state.depth_test_set("LESS")
            self._draw_sea(region, camera, scene, light, bodies)
            if with_sky:
                gpu.state.depth_test_set("LESS_EQUAL")
                self._draw_sky(light)
        finally:
            gpu.state.depth_test_set(depth_test)
            gpu.state.depth_mask_set(depth_mask)
            gpu.state.blend_set(blend)

    def _prepare(self, time_s):
        if not self._texts:
            self._texts = self.sea.shaders(self.light, self._has_bodies)
            self._textures["sky_map"] = _texture(self.light.sky_map)
            self._textures["foam_image"] = _texture(self.light.foam_image)
        if time_s != self._time_s:
            self.sea.set(time_s)
            for name, pixels in self.sea.textures.items():
                if self.sea.changes or name not in ("train_table", "ellipse_table", "mask_cells", "coast_cells", "coast_trains") or name not in self._textures:
                    self._textures[name] = _texture(pixels)
            self._time_s = time_s

    def _shader(self, name):
        text = self._texts[name]
        if text not in self._compiled:
            self._compiled[text] = compat.shader(*text)
        return self._compiled[text]

    def _see_air(self, camera):
        """The air before the camera's eye, where it has one."""
        height_m = camera.position.z if camera.is_perspective else None
        if height_m != self._air_height_m:
            self._air, table = self.light.air(height_m)
            self._textures["air_table"] = _texture(table)
            self._air_height_m = height_m

    def _grid(self, region, camera):
        """The region's grid: coarse where the view isn't that of its last picture."""
        view, before = camera.view(), self._grids.pop(region, None)
        moved = before is not None and before.key[0] != view
        key = (view, self._cell_px * (COARSE if moved else 1), camera.is_perspective)
        grid = before if before is not None and before.key == key else Grid(self.sea, *key, before)
        self._grids[region] = grid  # the last one now
        while len(self._grids) > KEPT_GRIDS:
            del self._grids[next(iter(self._grids))]
        return grid

    def _follow_foam(self):
        """Living foam comes when it is ready: until then a picture has what there is."""
        # By region, whichever was drawn last: or two views would ask for ever.
        asked = self._time_s, {region: grid.key for region, grid in self._grids.items()}
        if asked != self._foam_asked:
            self._foam_asked, self.awaits_foam = asked, True
            self.sea.ask_foam(self._time_s, [grid.grid for grid in self._grids.values()])
        is_done = not self.sea.is_foam_busy
        for name, pixels in self.sea.take_foam().items():
            self._textures[name] = _texture(pixels)
        self.awaits_foam = self.awaits_foam and not is_done

    def _draw_sea(self, region, camera, scene, light, bodies):
        shader, water = self._shader("sea"), self.sea.water(scene)
        grid, drawn = self._grid(region, camera), {}
        if bodies:
            self.shadow.draw(bodies, grid.origin_m, light["sun_direction"], light["sun_angular_radius"])
            light = {**light, **self.shadow.uniforms}
            self.hulls.draw(bodies, grid.origin_m, self.sea, _texture)
            self.pictures.draw(bodies, grid.grid, grid.key[0], self._shader, _put, {**light, **water, **self.sea.surroundings(scene, self.light)},
                               {"sky_map": self._textures["sky_map"], **self.shadow.textures}, water["water_body_look"][0] > 0.0)
            light = {**light, **self.pictures.uniforms, "view_height_m": light["eye_height_m"]}
            drawn = {"hull_maps": self.hulls.map, "hull_places": self.hulls.places, **self.shadow.textures, **self.pictures.textures}
        if self.sea.has_living_foam:
            self._follow_foam()
        tables, cycles = self.sea.at_origin(grid.origin_m)
        tables = gpu.types.GPUUniformBuf(tables)
        shader.bind()
        shader.uniform_block("SeaTables", tables)
        _set(shader, {**self.sea.uniforms, **light, **water,
                      **self.sea.foam(scene, grid.origin_m, self.light), "clip_from_grid": camera.clip_from_grid(grid.origin_m),
                      "curvature_per_m": grid.curvature_per_m})
        if bodies:
            self.pictures.put_boxes(shader)
        textures = {**self._textures, **drawn}
        if self.sea.has_living_foam:
            textures["foam_levels"] = _texture(self.sea.foam_levels(grid.origin_m))
        if cycles is not None:
            textures["train_cycles"] = _texture(cycles)
        _bind(shader, textures)
        grid.batch.draw(shader)

    def _draw_sky(self, light):
        shader = self._shader("sky")
        if self._sky_batch is None:
            self._sky_batch = full_triangle()
        shader.bind()
        _set(shader, {**light, "farthest": 1.0})
        _bind(shader, {name: self._textures[name] for name in ("sky_map", "air_table")})
        self._sky_batch.draw(shader)
