"""How many vertices the same picture takes: normals per pixel of the mesh that the Ocean modifier makes and of ours, each
rendered by Cycles, against those of 4096² points; and the frame change of each.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 --python tests/bench/blender_picture.py

The camera stands 4 m above the sea and looks at the horizon, 1280 × 720, 50° wide. Because the modifier has a spectrum of
its own, all meshes are of one sea of ours: 4096² waves in a square of 400 m.

  reference: every node of a 4096² grid as a vertex up to 200 m, 2048² in the same square beyond
  modifier:  1024² waves and quads in the square, as it makes them, nothing filtered; repeated at no cost as far as the
             picture goes (the modifier's own repetition multiplies its vertices and its time)
  ours:      the add-on's mesh: the projected grid as it is by default, and a fan, a mesh of the user's own that is dense
             where the camera sees much. Its rows are as far apart as some pixels show of a slope of SLOPE.

The picture is the smooth normal, averaged over each pixel's samples, at the same places in every picture. Error: rms of
the difference of two normals over the pixels of the sea nearer than a kilometre, which is all but its six upper rows.
Times: frame_set() until the evaluated mesh is there, in turn, with foam and normals; the modifier's of one square of 1024²;
ours with the default sea, whose waves reach from hundreds of metres to centimetres as well.
"""

import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
import pelagic

sys.path.insert(0, str(Path(__file__).parent))
import blender_sides  # noqa: E402
from blender_sides import SIZE_M, Modifier, Side, interleaved_ms  # noqa: E402
from pelagic_ocean import compat, meshes, ocean  # noqa: E402

WIDTH, HEIGHT, FOV, EYE_M = 1280, 720, math.radians(50), 4.0
TAN, PIXEL = math.tan(FOV / 2), 2 * math.tan(FOV / 2) / WIDTH
MODIFIER, REFERENCE, FAR_REFERENCE = 1024, 4096, 2048
FINE_M, SEEN_M, FAR_M = 200.0, 1000.0, 1200.0  # the reference's fine part, the pixels compared, the meshes
FRAME = 25
SAMPLES, TURNS = 16, 5
FASTER = 20.0  # at least
# The fan: pixels between rows and between columns, and the slope that the rows are spaced for.
ROW_PX, COLUMN_PX, SLOPE = 4.0, 9.5, 0.4
MARGIN, MARGIN_M = 1.06, 3.0  # of a view's sides, where waves move points into it
NEAREST_M = 8.0


# ---- Meshes


def shot_of(n):
    shot = pelagic.Scene()
    shot.waves.cascades = [pelagic.CascadeSize(size_m=SIZE_M, resolution=n)]
    return shot


def positions(n, rest):
    """Of n × n waves at their own nodes, nothing filtered."""
    shot = shot_of(n)
    frame = pelagic.Frame(pelagic.Sea(shot, ("position",), cell_m=0.0, pixel_m=0.0, lattice=(-SIZE_M / 2, SIZE_M / n)))
    frame.set(shot.shot.time_s(FRAME))
    return frame.evaluate(rest)["position"]


def smooth_mesh(name, places, quads):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(places))
    compat.set_faces(mesh, np.ascontiguousarray(quads, np.int32).ravel(), np.arange(0, quads.size, 4, dtype=np.int32))
    compat.set_positions(mesh, np.ascontiguousarray(places, np.float32))
    compat.shade_smooth(mesh)
    mesh.update(calc_edges=True)
    return mesh


def square(n):
    rest, quads = pelagic.patch(SIZE_M, n)
    return smooth_mesh(f"{n}²", positions(n, rest), quads)


def fine_part():
    """The reference's vertices in view up to FINE_M."""
    spacing = SIZE_M / REFERENCE
    side = math.ceil((TAN * FINE_M * MARGIN + MARGIN_M) / spacing)
    x, y = np.arange(-side, side + 1) * spacing, np.arange(1, round(FINE_M / spacing) + 1) * spacing
    rest = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2).astype(np.float32)
    quads = pelagic.grid_quads(len(x) - 1, len(y) - 1)
    in_view = np.abs(rest[:, 0]) <= TAN * rest[:, 1] * MARGIN + 4 * MARGIN_M
    return smooth_mesh("fine", positions(REFERENCE, rest), quads[in_view[quads].all(axis=1)])


def fan():
    """A mesh at rest before the camera. A pixel at distance d shows PIXEL · d of height: of a slope s towards it, seen
    from EYE_M above, that is PIXEL · d / (s + EYE_M / d) along the sea."""
    distance = [NEAREST_M]
    while distance[-1] < FAR_M:
        distance.append(distance[-1] + ROW_PX * PIXEL * distance[-1] / (SLOPE + EYE_M / distance[-1]))
    distance = np.array(distance)
    columns = math.ceil(WIDTH * MARGIN / COLUMN_PX)
    x = (TAN * distance * MARGIN + MARGIN_M)[:, None] * np.linspace(-1, 1, columns + 1)
    rest = np.stack([x, np.broadcast_to(distance[:, None], x.shape), np.zeros_like(x)], axis=-1)
    return smooth_mesh("fan", rest.reshape(-1, 3), pelagic.grid_quads(columns, len(distance) - 1))


# ---- Sides


class View(Side):
    """A scene with the camera, which draws normals."""

    def __init__(self, name):
        super().__init__(name)
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.data.angle, camera.data.clip_end = FOV, 1e5
        camera.location, camera.rotation_euler = (0, 0, EYE_M), (math.pi / 2, 0, 0)
        self.scene.collection.objects.link(camera)
        self.scene.camera = camera
        render, cycles = self.scene.render, self.scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
        render.use_border = render.use_crop_to_border = render.film_transparent = True
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0, 1, 0, 0.5
        cycles.samples, cycles.seed, cycles.max_bounces, cycles.pixel_filter_type = SAMPLES, 1, 0, "BOX"
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        self.scene.view_settings.view_transform = "Raw"
        image = render.image_settings
        image.file_format, image.color_depth, image.color_mode = "OPEN_EXR", "32", "RGBA"

    def add_squares(self, mesh, first_m):
        """A square of the sea again and again, the first from y = first_m on, over the view."""
        places = []
        for row in range(math.ceil((FAR_M - first_m) / SIZE_M)):
            half_m = TAN * (first_m + (row + 1) * SIZE_M) * MARGIN + MARGIN_M
            beside = math.ceil(half_m / SIZE_M - 0.5)
            places += [(column * SIZE_M, first_m + (row + 0.5) * SIZE_M, 0) for column in range(-beside, beside + 1)]
        points = bpy.data.meshes.new("places")
        points.from_pydata(places, [], [])
        parent = bpy.data.objects.new("places", points)
        self.scene.collection.objects.link(parent)
        parent.instance_type = "VERTS"  # shares one evaluated mesh; linked duplicates would each have normals of their own
        self.add(mesh)
        self.object.parent = parent

    def normals(self):
        """Unit-sized float32 (height / 2, WIDTH, 3), the lowest row first, and which pixels are sea."""
        material = normal_material()
        for obj in self.scene.objects:
            if obj.type == "MESH" and obj.data.polygons:
                obj.data.materials.clear()
                obj.data.materials.append(material)
        handle, path = tempfile.mkstemp(suffix=".exr")
        os.close(handle)
        self.scene.render.filepath = path
        bpy.context.window.scene = self.scene  # a render takes its frame from there, whatever its scene
        self.scene.frame_set(FRAME)
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(path)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(4 * image.size[0] * image.size[1], np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(image.size[1], image.size[0], 4)
        bpy.data.images.remove(image)
        os.remove(path)
        return 2 * pixels[..., :3] - 1, pixels[..., 3] > 0.999


class Ours(View):
    """The add-on's ocean: on the fan, or the projected grid of the camera."""

    def __init__(self, shot, on_the_fan):
        super().__init__("ours")
        if on_the_fan:
            self.add(fan())
            ocean.mark(self.object)
            self.object.pelagic.own_mesh = True
            meshes.forget_rest(self.object.data)
        else:
            self.object = ocean.make("grid", self.scene.collection)
            shot.surface.kind = "projected-grid"
        ocean.set_from(self.object, shot)
        self.object.pelagic.uv_map = False
        self.frame = FRAME - 1
        self.step()


def normal_material():
    """Shows the normal, 0 … 1 for -1 … 1, as light of its own."""
    material = bpy.data.materials.get("normal")
    if material is None:
        material = bpy.data.materials.new("normal")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        normal, scaled, light, out = (tree.nodes.new(kind) for kind in (
            "ShaderNodeNewGeometry", "ShaderNodeVectorMath", "ShaderNodeEmission", "ShaderNodeOutputMaterial"))
        scaled.operation = "MULTIPLY_ADD"
        scaled.inputs[1].default_value = scaled.inputs[2].default_value = (0.5, 0.5, 0.5)
        tree.links.new(normal.outputs["Normal"], scaled.inputs[0])
        tree.links.new(scaled.outputs["Vector"], light.inputs["Color"])
        tree.links.new(light.outputs["Emission"], out.inputs["Surface"])
    return material


def picture_of(side):
    made = side.normals()
    side.remove()
    return made


def reference():
    side = View("reference")
    side.add(fine_part())
    side.add_squares(square(FAR_REFERENCE), FINE_M)
    return picture_of(side)


def modifier_picture():
    side = View("squares")
    side.add_squares(square(MODIFIER), -SIZE_M / 2)
    return picture_of(side)


# ---- The comparison


def errors(picture, wanted):
    """rms over all compared pixels; the median; the rms in the lower half of the sea and in the upper."""
    (normals, sea), (true_normals, true_sea) = picture, wanted
    rows = np.arange(len(sea))[:, None]
    nearer = rows < len(sea) - EYE_M / SEEN_M / PIXEL
    compared = sea & true_sea & nearer
    distance = np.linalg.norm(normals - true_normals, axis=-1)
    half = rows < len(sea) // 2
    return [math.sqrt((distance[compared] ** 2).mean()), float(np.median(distance[compared])),
            math.sqrt((distance[compared & half] ** 2).mean()), math.sqrt((distance[compared & ~half] ** 2).mean())]


def main():
    blender_sides.pelagic_ocean.register()
    wanted = reference()
    found = {"modifier": errors(modifier_picture(), wanted)}
    flat = np.zeros_like(wanted[0])
    flat[..., 2] = 1
    found["flat"] = errors((flat, wanted[1]), wanted)
    for name, on_the_fan in (("fan", True), ("grid", False)):
        found[name] = errors(picture_of(Ours(shot_of(REFERENCE), on_the_fan)), wanted)

    sides = {"modifier": Modifier(MODIFIER), "fan": Ours(pelagic.Scene(), True), "grid": Ours(pelagic.Scene(), False)}
    times = dict(zip(sides, interleaved_ms([side.step for side in sides.values()], TURNS)))
    print(f"Normals per pixel against {REFERENCE}², camera {EYE_M:g} m above the sea, {WIDTH} × {HEIGHT}, Cycles, {SAMPLES} "
          f"samples; a frame change in Blender {bpy.app.version_string}, medians of {TURNS} turns")
    print(f"  {'':26s} {'vertices':>9s} {'rms':>7s} {'median':>7s} {'near':>7s} {'far':>7s} {'ms':>8s} {'× faster':>9s}")
    for name, words in (("modifier", f"the modifier, {MODIFIER}²"), ("fan", "ours, a fan"),
                        ("grid", "ours, projected grid"), ("flat", "a flat sea")):
        line = f"  {words:26s} "
        line += f"{len(sides[name].evaluated().vertices):9d} " if name in sides else f"{'':9s} "
        line += " ".join(f"{number:7.4f}" for number in found[name])
        if name in times:
            line += f" {times[name]:8.1f}"
        if name in ("fan", "grid"):
            faster, as_true = times["modifier"] / times[name], found[name][0] <= found["modifier"][0]
            line += f" {faster:9.1f}  "
            if name == "fan":
                line += f"≥ {FASTER:g} with an error no larger: {'met' if as_true and faster >= FASTER else 'missed'}"
            elif not as_true:
                line += "its error is larger"
        print(line, flush=True)


main()
