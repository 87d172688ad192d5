"""What the benchmarks in Blender compare, each in a scene of its own of one file: Blender's Ocean modifier, the add-on's
ocean, and a plain mesh that is copied; and medians of their frames, in turn."""

import statistics
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pelagic

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
import pelagic_ocean  # noqa: E402
from pelagic_ocean import compat, meshes, ocean, surfaces  # noqa: E402

FPS, SIZE_M = 24, 400.0
FRAMES = 3  # of each side in a turn


class Side:
    """An object in a scene of its own, so that a frame change evaluates nothing else."""

    def __init__(self, name):
        self.scene = bpy.data.scenes.new(name)
        self.scene.frame_end = 10**5
        self.layer = self.scene.view_layers[0]
        self.frame = 0

    def add(self, mesh):
        self.object = bpy.data.objects.new(mesh.name, mesh)
        self.scene.collection.objects.link(self.object)

    def evaluated(self):
        return self.object.evaluated_get(self.layer.depsgraph).data

    def step(self):
        self.frame += 1
        self.scene.frame_set(self.frame)
        return self.evaluated()

    def remove(self):
        bpy.data.scenes.remove(self.scene)
        bpy.data.batch_remove([self.object])
        bpy.data.orphans_purge()


def heights(mesh):
    values = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", values)
    return values[2::3]


def check(side, n, foam):
    """That it is what it says: that many vertices, moving, with foam. foam: the names of a mesh's layers or attributes."""
    mesh = side.step()
    if len(mesh.vertices) != (n + 1) ** 2 or not foam(mesh):
        sys.exit(f"{side.scene.name}: {len(mesh.vertices)} vertices, foam: {foam(mesh)}")
    first, second = heights(mesh).copy(), heights(side.step())
    if np.array_equal(first, second) or not np.any(first):
        sys.exit(f"{side.scene.name}: the sea doesn't move")


class Modifier(Side):
    """An Ocean modifier that generates its geometry, played by keyframes: set from Python its time would start the
    simulation over at each frame. n: waves and quads a side; its resolution r stands for r²."""

    def __init__(self, n):
        super().__init__("modifier")
        self.add(bpy.data.meshes.new("Ocean"))
        modifier = self.object.modifiers.new("Ocean", "OCEAN")
        modifier.geometry_mode = "GENERATE"
        modifier.resolution = modifier.viewport_resolution = round(n**0.5)
        modifier.spatial_size = round(SIZE_M)
        modifier.use_normals = modifier.use_foam = True
        modifier.foam_layer_name = "foam"
        for frame, seconds in ((0, 0.0), (FPS * 100, 100.0)):
            modifier.time = seconds
            self.object.keyframe_insert('modifiers["Ocean"].time', frame=frame)
        for curve in compat.curves(self.object):
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
        check(self, n, lambda mesh: "foam" in mesh.vertex_colors)


class AddOn(Side):
    """The add-on's ocean, as Add Ocean makes it; with n its patch alone, SIZE_M wide, of n × n quads. as_the_modifier: one
    square of n × n waves on the patch's own grid; otherwise four cascades that repeat nowhere in the patch."""

    def __init__(self, n=None, as_the_modifier=False, all_attributes=False):
        super().__init__("pelagic")
        self.object = ocean.make("Pelagic", self.scene.collection)
        if n is None:
            self.step()
            return
        settings = self.object.pelagic
        settings.horizon, settings.viewport_vertices = False, 0
        settings.uv_map = settings.velocity = all_attributes
        shot = pelagic.Scene()
        shot.surface.size_m, shot.surface.resolution = SIZE_M, n
        if as_the_modifier:
            shot.waves.cascades = [pelagic.CascadeSize(size_m=SIZE_M, resolution=n)]
        ocean.set_from(self.object, shot)
        check(self, n, lambda mesh: "whitecap_coverage" in mesh.attributes)


class Copy(Side):
    """A plain mesh, tagged: Blender copies it, edges and faces too, and computes its normals."""

    def __init__(self, mesh):
        super().__init__("copy")
        self.add(mesh)
        self.step()

    @classmethod
    def bare(cls, n):
        """A grid of n × n smooth quads, positions alone."""
        mesh = bpy.data.meshes.new("grid")
        meshes.put_surface(mesh, surfaces.patch(SIZE_M, n, False))
        for layer in list(mesh.uv_layers):
            mesh.uv_layers.remove(layer)
        mesh.attributes.remove(mesh.attributes[meshes.REST])
        return cls(mesh)

    def step(self):
        self.object.data.update_tag()
        self.layer.update()
        return self.evaluated()


def interleaved_ms(works, turns):
    """Medians of each work's calls: FRAMES in a row in each of the turns, as a timeline plays them; frame by frame in turn
    each would find the caches and the threads as the other left them. The first of a row isn't counted: while it runs,
    what the side before it computes ahead comes to its end."""
    spent = [[] for _ in works]
    for _ in range(turns):
        for column, work in zip(spent, works):
            for frame in range(FRAMES + 1):
                start = time.perf_counter()
                work()
                if frame > 0:
                    column.append(1e3 * (time.perf_counter() - start))
    return [statistics.median(column) for column in spent]
