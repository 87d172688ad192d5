"""Maps of a bake, as Blender's images and Cycles see them: the numbers of the sea.

    maps.py -- PELAGIC_PROGRAM
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

import pelagic

program = sys.argv[-1]
folder = Path(tempfile.mkdtemp())
SIZE = 64
KINDS = [word for key in pelagic.keys() if key["path"] == "output.maps" for word in key["choices"]]
# What a map shows in red, green and blue, and how far the file may round it: halves have 11 significant bits.
SHOWS = {"displacement": ("displacement", 0.0), "normal": ("normal", 2.0**-11), "slope-variance": ("slope_variance", 0.0),
         "whitecaps": ("coverage", 2.0**-11), "floor": ("floor_light", 2.0**-11)}


def bake():
    path = folder / "maps.toml"
    maps = ", ".join(f'"{kind}"' for kind in KINDS)
    path.write_text(f"""[shot]
name = "maps"
frames = [3, 3]
[sea]
wind_speed_mps = 16.0
depth_m = 60.0
[waves]
cascades = [ {{ size_m = 120.0, resolution = {SIZE} }}, {{ size_m = 41.0, resolution = {SIZE} }} ]
[effects]
whitecap_amount = 5.0
[surface]
size_m = 90.0
[output]
mesh = "none"
maps = [{maps}]
map_resolution = {SIZE}
cascade_tiles = true
""", encoding="utf-8")
    subprocess.run([program, "bake", str(path), "--out", str(folder)], check=True, capture_output=True)
    return pelagic.Scene.from_file(str(path))


def through_cycles(socket, image):
    """(n, n, 3) of what an Image Texture's socket gives Cycles in the middle of each texel. The film cuts off what is
    negative, so numbers go out as 0.5 + x/64."""
    tree = MATERIAL.node_tree
    tree.nodes["Image Texture"].image = image
    tree.links.new(tree.nodes["Image Texture"].outputs[socket], tree.nodes["Vector Math"].inputs[0])
    bpy.context.scene.render.filepath = str(folder / "cycles.exr")
    bpy.ops.render.render(write_still=True)
    shown = bpy.data.images.load(bpy.context.scene.render.filepath)
    shown.colorspace_settings.name = "Non-Color"
    values = pixels(shown)[..., :3]
    bpy.data.images.remove(shown)
    return (values - 0.5) * 64.0


def pixels(image):
    """(n, n, channels) of an image's buffer, rows from the bottom."""
    assert image.type == "IMAGE", f"Blender takes {image.filepath} for {image.type}"
    out = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(out)
    return out.reshape(image.size[1], image.size[0], -1)


def set_up_cycles():
    """A plane under an orthographic camera, a pixel a texel, emitting an image."""
    scene = bpy.context.scene
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.view_settings.view_transform = "Raw"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    bpy.context.object.data.materials.append(MATERIAL)
    camera = bpy.data.cameras.new("above")
    camera.type, camera.ortho_scale = "ORTHO", 2.0
    scene.camera = bpy.data.objects.new("above", camera)
    scene.camera.location = (0.0, 0.0, 3.0)
    scene.collection.objects.link(scene.camera)
    MATERIAL.use_nodes = True
    tree = MATERIAL.node_tree
    tree.nodes.clear()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.interpolation = "Closest"
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = (1.0 / 64.0,) * 3, (0.5,) * 3
    light, out = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(scaled.outputs[0], light.inputs["Color"])
    tree.links.new(light.outputs[0], out.inputs["Surface"])


scene = bake()
patch, tiles = pelagic.Maps(scene, KINDS, tiles=True).at(scene.shot.time_s(3))
files = json.loads((folder / "maps.json").read_text(encoding="utf-8"))["frames"]["3"]["files"]
MATERIAL = bpy.data.materials.new("map")
set_up_cycles()
assert set(SHOWS) == set(KINDS), f"maps that this test doesn't know: {KINDS}"

for kind in KINDS:
    product, rounding = SHOWS[kind]
    for path, arrays in [(f"maps/maps.{kind}.0003.exr", patch),
                         *((f"tiles/maps.{kind}.{i}.0003.exr", tile) for i, tile in enumerate(tiles) if kind != "floor")]:  # of the sea as a whole
        with checking(f"{path} is {product} to Blender's images and to Cycles"):
            values = arrays[product if product in arrays else f"{product}_at_rest"]  # a tile's are
            expected = values if values.ndim == 3 else np.repeat(values[..., None], 3, axis=-1)
            assert np.abs(expected).max() > 1e-4 or product == "slope_variance"  # a tile may show all of its own waves
            image = bpy.data.images.load(str(folder / path))
            image.colorspace_settings.name = "Non-Color"
            seen = pixels(image)
            assert seen.shape == (SIZE, SIZE, 4), seen.shape
            np.testing.assert_allclose(seen[..., :3], expected, rtol=rounding, atol=1e-7)
            assert (seen[..., 3] == 1.0).all()
            if bpy.app.version >= (5, 0) and kind == "whitecaps":
                image.pack()  # from disk Cycles 5.2.2 takes neighbours for the channels of a map of one
            in_cycles = through_cycles("Color", image)
            # 0.5 + x/64 rounds x to some 2^-18. Where all channels are halves, Cycles adds 2^-15 to those below that.
            np.testing.assert_allclose(in_cycles, seen[..., :3], rtol=0.0, atol=4e-5 if kind == "normal" else 1e-5)
            np.testing.assert_allclose(through_cycles("Alpha", image), 1.0, atol=1e-5)
            if product == "coverage":
                recorded = files[path]["whitecap_coverage"]
                # The record counts by the area of sea, which is less than that at rest where there is foam.
                assert recorded < in_cycles.mean() < 2.5 * recorded
