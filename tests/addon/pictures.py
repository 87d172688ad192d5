"""A shot as a picture of the core and of the add-on, for the tests and benches that compare them."""

import math
from contextlib import nullcontext
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

import pelagic
from pelagic_ocean import ocean

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def core_layers(shot, size):
    """The core's picture of the shot's first frame: float32 (height, width, 3) from the bottom, by layer."""
    scene = pelagic.Scene.from_file(str(shot))
    layers = pelagic.render(scene, scene.shot.frames[0], size, 2)
    return {layer: layers[layer][::-1] for layer in ("sun", "sky", "sea", "foam", "air")}


def read_exr(file):
    """float32 (height, width, 4), from the bottom."""
    image = bpy.data.images.load(str(file))
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return pixels


def shot_in_blender(shot, size):
    """The shot's first frame in an empty file, its sea on the grid of its camera. Returns the ocean."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy_scene = bpy.context.scene
    scene = pelagic.Scene.from_file(str(shot))
    bpy_scene.frame_start, bpy_scene.frame_end = scene.shot.frames
    bpy_scene.render.fps = round(scene.shot.fps)
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = size
    data = bpy.data.cameras.new("Camera")
    data.sensor_fit, data.angle, data.clip_end = "HORIZONTAL", math.radians(scene.camera.fov_deg), 100e3
    bpy_scene.camera = bpy.data.objects.new("Camera", data)
    bpy_scene.collection.objects.link(bpy_scene.camera)
    back = (Vector(scene.camera.position_m) - Vector(scene.camera.look_at_m)).normalized()
    bpy_scene.camera.matrix_world = (Matrix.Translation(scene.camera.position_m)
                                     @ back.to_track_quat("Z", "Y").to_matrix().to_4x4())
    # A timer, from which tests in a window run, has no window of its own.
    with nullcontext() if bpy.app.background else bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.pelagic.add_ocean()
        sea = bpy.context.object
    scene.surface.kind, scene.surface.cell_px = "projected-grid", 1.0  # the core's pictures have normals for each pixel
    ocean.set_from(sea, scene)
    bpy_scene.frame_set(bpy_scene.frame_start)
    return sea


def cycles_exr(file, size, samples):
    """Renders the file's scene; float32 (height, width, 4) from the bottom."""
    bpy_scene = bpy.context.scene
    bpy_scene.render.engine = "CYCLES"
    bpy_scene.cycles.samples, bpy_scene.cycles.use_denoising = samples, False
    bpy_scene.cycles.use_adaptive_sampling = False
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = size
    bpy_scene.render.resolution_percentage = 100
    bpy_scene.render.image_settings.file_format = "OPEN_EXR"
    bpy_scene.render.image_settings.color_depth = "32"
    bpy_scene.render.filepath = str(file)
    bpy.ops.render.render(write_still=True)
    return read_exr(file)


def glitter_exr(file, size, samples):
    """The reflected sun alone; alpha is 1 where there is sea."""
    bpy_scene = bpy.context.scene
    for name in ("Water Color", "Foam Color"):
        bpy.data.materials["Pelagic Water"].node_tree.nodes[name].outputs[0].default_value = (0, 0, 0, 1)
    for node in bpy_scene.world.node_tree.nodes:
        if node.bl_idname == "ShaderNodeBackground":
            node.inputs["Strength"].default_value = 0
    bpy_scene.render.film_transparent = True
    return cycles_exr(file, size, samples)
