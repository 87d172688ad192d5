# `pelagic render --layers all --alpha --shutter 0.5` in Blender's compositor: its passes by their names, and what depth,
# position and the light's layers are to each other. Run by Blender: -- PELAGIC FOLDER
import os
import subprocess
import sys

import bpy
import numpy as np

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


def values(name):
    picture = bpy.data.images.load(os.path.join(folder, f"pass_{name}_0001.exr"))
    picture.colorspace_settings.name = "Non-Color"
    return np.array(picture.pixels[:], np.float64).reshape(40, 64, 4)


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
print(f"{len(expected)} passes as they were written, {int(sea.sum())} pixels of sea")
