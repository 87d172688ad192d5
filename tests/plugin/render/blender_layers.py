# `pelagic render --layers all --alpha --shutter 0.5` in Blender's compositor: its passes by their names, and what depth,
# position and the light's layers are to each other. Then depth, position, normal and vector of a calm under a moving
# camera against those that Cycles renders of a plane. Run by Blender: -- PELAGIC FOLDER
import os
import subprocess
import sys

import bpy
import numpy as np
from mathutils import Vector

program, folder = sys.argv[sys.argv.index("--") + 1:]
os.makedirs(folder, exist_ok=True)
shot = os.path.join(folder, "shot.toml")
with open(shot, "w") as file:
    file.write("[quality]\nlevel = \"draft\"\n[waves]\ncascades = [{ size_m = 250.0, resolution = 64 }]\n"
               "[camera]\nposition_m = [0.0, -60.0, 12.0]\nlook_at_m = [0.0, 0.0, 4.0]\nresolution = [64, 40]\n")
subprocess.run([program, "render", shot, "--frames", "3", "--samples", "2", "--layers", "all", "--alpha", "--shutter",
                "0.5", "--out", folder], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 40, 100
scene.use_nodes = True
nodes, links = scene.node_tree.nodes, scene.node_tree.links
nodes.clear()
image = nodes.new("CompositorNodeImage")
image.image = bpy.data.images.load(os.path.join(folder, "sea.0003.exr"))
passes = {socket.name for socket in image.outputs if socket.enabled}
expected = {"Combined", "Alpha", "Depth", "P", "N", "forward", "backward", "Vector", "coverage", "slope_variance", "sun",
            "sky", "sea", "foam", "air"}
assert passes >= expected, f"passes {sorted(passes)}"
assert image.outputs["Depth"].type == "VALUE" and image.outputs["Vector"].type == "RGBA"

out = nodes.new("CompositorNodeOutputFile")
out.base_path = folder
out.format.file_format, out.format.color_depth, out.format.color_mode = "OPEN_EXR", "32", "RGBA"
out.file_slots.clear()
# Nuke's vectors have two channels, which Blender lists and doesn't compute with.
for name in expected - {"Alpha", "forward", "backward"}:
    out.file_slots.new("pass_" + name + "_")
    links.new(image.outputs[name], out.inputs["pass_" + name + "_"])
nodes.new("CompositorNodeComposite")
scene.frame_set(1)
bpy.ops.render.render()


def pixels_of(file):
    picture = bpy.data.images.load(os.path.join(folder, file))
    picture.colorspace_settings.name = "Non-Color"
    return np.array(picture.pixels[:], np.float64).reshape(40, 64, 4)


def values(name):
    return pixels_of(f"pass_{name}_0001.exr")


combined, depth, position = values("Combined"), values("Depth")[..., 0], values("P")[..., :3]
layers = sum(values(name)[..., :3] for name in ("sun", "sky", "sea", "foam", "air"))
assert np.allclose(layers, combined[..., :3], rtol=5e-3, atol=1e-3), "the layers add up"
sea = depth < 1e9
assert 0.3 < sea.mean() < 0.9, sea.mean()
assert np.allclose(depth[~sea], 1e10)
forward = np.array([0.0, 60.0, -8.0]) / np.hypot(60.0, 8.0)
along = (position - np.array([0.0, -60.0, 12.0])) @ forward
assert np.allclose(along[sea], depth[sea], rtol=1e-4), "depth is along the axis"
assert np.allclose(np.linalg.norm(values("N")[..., :3][sea], axis=-1), 1.0, atol=2e-3)
vector = values("Vector")
assert np.isfinite(vector).all() and 0.02 < np.abs(vector[sea]).max() < 10.0, "pixels a frame"
assert np.abs(vector[sea][:, :2] - vector[sea][:, 2:]).max() < 0.05, "both have the sign of one motion"
assert combined[0, 0, 3] == 1.0 and combined[-1, 0, 3] == 0.0, "rows from the bottom: sea below"
assert np.abs(combined[..., :3][combined[..., 3] == 0.0]).max() == 0.0, "no sky"

# Of a picture with overscan Blender has the whole data window; inside it is the picture without.
shown = []
for name, more in (("plain", []), ("wide", ["--overscan", "8"])):
    subprocess.run([program, "render", shot, "--frames", "3", "--samples", "1", "--layers", "none", "--out", os.path.join(folder, name), *more],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    picture = bpy.data.images.load(os.path.join(folder, name, "sea.0003.exr"))
    shown.append(np.array(picture.pixels[:]).reshape(picture.size[1], picture.size[0], 4))
assert shown[1].shape == (56, 80, 4), shown[1].shape
assert np.array_equal(shown[1][8:-8, 8:-8], shown[0]) and shown[0].std() > 0.0

# Cycles's own passes of the same moment: a still plane, and a camera that moves, turns and comes nearer.
KEYS = {2: ((0.0, -60.0, 12.0), (0.0, 0.0, 4.0)), 3: ((1.5, -58.0, 11.5), (2.0, 0.0, 4.0)),
        4: ((3.0, -56.0, 11.0), (4.0, 0.0, 4.0))}
PASSES = {"Depth": "Depth", "P": "Position", "N": "Normal", "Vector": "Vector"}  # ours, and what Cycles calls them
with open(shot, "w") as file:
    file.write("[shot]\nname = \"calm\"\nframes = [2, 4]\n[sea]\nwind_speed_mps = 0.0\n[surface]\nearth_curvature = false\n"
               "[quality]\nlevel = \"draft\"\n[camera]\nresolution = [64, 40]\nfov_deg = 50.0\nkeys = [\n" +
               "".join(f"{{ frame = {frame}, position_m = {list(at)}, look_at_m = {list(to)} }},\n"
                       for frame, (at, to) in KEYS.items()) + "]\n")
subprocess.run([program, "render", shot, "--frames", "3", "--samples", "1", "--layers", "depth,position,normal,vector",
                "--out", folder], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

for thing in list(scene.objects):
    bpy.data.objects.remove(thing)
bpy.ops.mesh.primitive_plane_add(size=4e4)
lens = bpy.data.cameras.new("lens")
lens.sensor_fit, lens.angle, lens.clip_end = "HORIZONTAL", np.radians(50.0), 1e5
camera = bpy.data.objects.new("camera", lens)
scene.collection.objects.link(camera)
scene.camera = camera
for frame, (at, to) in KEYS.items():
    camera.location = at
    camera.rotation_euler = (Vector(to) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    camera.keyframe_insert("location", frame=frame)
    camera.keyframe_insert("rotation_euler", frame=frame)
scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 1
scene.cycles.use_denoising, scene.cycles.pixel_filter_type, scene.render.filter_size = False, "BOX", 0.01
view = scene.view_layers[0]
view.use_pass_z = view.use_pass_position = view.use_pass_normal = view.use_pass_vector = True
nodes.clear()
cycles = nodes.new("CompositorNodeRLayers")
calm = nodes.new("CompositorNodeImage")
calm.image = bpy.data.images.load(os.path.join(folder, "calm.0003.exr"))
out = nodes.new("CompositorNodeOutputFile")
out.base_path = folder
out.format.file_format, out.format.color_depth, out.format.color_mode = "OPEN_EXR", "32", "RGBA"
out.file_slots.clear()
for ours, theirs in PASSES.items():
    for who, sockets, name in (("ours", calm.outputs, ours), ("theirs", cycles.outputs, theirs)):
        out.file_slots.new(f"{who}_{ours}_")
        links.new(sockets[name], out.inputs[f"{who}_{ours}_"])
nodes.new("CompositorNodeComposite")
scene.frame_set(3)
bpy.ops.render.render()
depth = pixels_of("ours_Depth_0003.exr")[..., 0]
sea = depth < 2e3
assert sea.mean() > 0.3, sea.mean()
# A vector of Cycles comes out of the compositor without its fourth number.
for name, components, near in (("Depth", 1, 1e-3), ("P", 3, 1e-3), ("N", 3, 1e-3), ("Vector", 3, 1e-2)):
    ours, theirs = (pixels_of(f"{who}_{name}_0003.exr")[sea][:, :components] for who in ("ours", "theirs"))
    scale = depth[sea][:, None] if name in ("Depth", "P") else 1.0
    off = np.abs((ours - theirs) / scale).max()
    print(f"{name}: at most {off:.2g} from Cycles's, of {np.abs(theirs).max():.3g}")
    assert off < near, f"{name} isn't Cycles's: {off}"
vectors = np.abs(pixels_of("ours_Vector_0003.exr")[sea])
assert vectors.max(axis=0).min() > 0.5, "all four components move"
print(f"{len(expected)} passes as they were written, {int(sea.sum())} pixels of sea")
