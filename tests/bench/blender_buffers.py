"""How a frame's buffers best reach a mesh that Blender shows and renders: what is correct, and what it costs.

    blender -b --factory-startup --python tests/bench/blender_buffers.py -- PART …

with the parts layout, update, render, blur, settings and time; without names, all of them. What they found is in
examples/blender-buffers.md. What needs a window (the viewport, undo, a render beside a live viewport) has to be
asked for, on any display or a virtual one:

    xvfb-run blender --factory-startup --python tests/bench/blender_buffers.py -- window

The test sea is a plane z = 0.01·f − 0.02·f·x at frame f with whitecap_coverage = 0.02·f, so that a picture taken
from straight above says by itself which frame's positions, attributes and normals the renderer saw: red is z (its
mean over the symmetric picture is 0.01·f), green the attribute, blue the x component of the unit normal.
"""

import ctypes
import math
import os
import statistics
import sys
import tempfile
import threading
import time
import traceback

import bpy
import numpy as np

HEIGHT_PER_FRAME_M = 0.01
SLOPE_PER_FRAME = 0.02
COVERAGE_PER_FRAME = 0.02
FPS = 24
REPEATS = 21
PICTURE = os.path.join(tempfile.gettempdir(), f"blender_buffers_{os.getpid()}_")


# --- meshes and the ways to write them ----------------------------------------------------------------------


def grid_mesh(name, quads, size_m=2.0):
    """A square grid of quads × quads, z up, centred, x fastest, with the attributes that a sea carries."""
    side = quads + 1
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(side * side)
    mesh.loops.add(4 * quads * quads)
    mesh.polygons.add(quads * quads)
    corner = (np.arange(quads)[:, None] * side + np.arange(quads)[None, :]).ravel()
    loops = np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1).astype(np.int32)
    mesh.loops.foreach_set("vertex_index", loops.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, 4 * quads * quads, 4, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(quads * quads, 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(quads * quads, dtype=bool))
    mesh.vertices.foreach_set("co", rest_positions(side, size_m).ravel())
    mesh.update(calc_edges=True)
    for attribute, kind in (("velocity", "FLOAT_VECTOR"), ("slope_variance", "FLOAT_VECTOR"),
                            ("whitecap_coverage", "FLOAT")):
        mesh.attributes.new(attribute, kind, "POINT")
    return mesh


def rest_positions(side, size_m=2.0):
    axis = np.linspace(-size_m / 2, size_m / 2, side, dtype=np.float32)
    positions = np.zeros((side * side, 3), np.float32)
    positions[:, 0] = np.tile(axis, side)
    positions[:, 1] = np.repeat(axis, side)
    return positions


def plane_at(frame, side):
    positions = rest_positions(side)
    positions[:, 2] = HEIGHT_PER_FRAME_M * frame - SLOPE_PER_FRAME * frame * positions[:, 0]
    return positions, np.full(side * side, COVERAGE_PER_FRAME * frame, np.float32)


def strided_view(collection, components):
    """Blender's own memory as an array (n, components); valid only until the mesh's arrays are reallocated."""
    first = collection[0].as_pointer()
    stride = collection[1].as_pointer() - first
    count = len(collection)
    memory = (ctypes.c_byte * (stride * (count - 1) + 4 * components)).from_address(first)
    return np.ndarray((count, components), np.float32, memory, 0, (stride, 4))


def write_foreach(mesh, positions, coverage):
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.attributes["whitecap_coverage"].data.foreach_set("value", coverage)


def write_raw(mesh, positions, coverage):
    strided_view(mesh.vertices, 3)[:] = positions
    strided_view(mesh.attributes["whitecap_coverage"].data, 1)[:, 0] = coverage


def write_raw_and_normals(mesh, positions, coverage):
    """Also the unit normals, into Blender's own cache; with twice the plane's slope, to tell them from Blender's."""
    write_raw(mesh, positions, coverage)
    normals = strided_view(mesh.vertex_normals, 3)
    slope = 2 * SLOPE_PER_FRAME * coverage[0] / COVERAGE_PER_FRAME
    normals[:] = np.float32([slope, 0, 1]) / math.sqrt(1 + slope * slope)


class Writer:
    """One of the ways compared: which mesh (original or evaluated), in which handler, how, what is tagged after."""

    def __init__(self, name, target, handler, write, tag):
        self.name, self.target, self.handler, self.write, self.tag = name, target, handler, write, tag
        self.threads = []  # the thread of each call

    def attach(self, sea, buffers_at=plane_at):
        name = sea.name  # looked up at each call: undo replaces objects
        self.threads = []

        def on_frame(scene, depsgraph):
            frame = scene.frame_current_final
            self.threads.append(threading.get_ident())
            sea = bpy.data.objects[name]
            mesh = sea.data if self.target == "original" else sea.evaluated_get(depsgraph).data
            side = math.isqrt(len(sea.data.vertices))
            if len(mesh.vertices) != side * side:  # a modifier changed the number of vertices: nowhere to write to
                return
            self.write(mesh, *buffers_at(frame, side))
            if self.tag == "update":
                mesh.update()
            elif self.tag == "update_tag":
                mesh.update_tag()
            elif self.tag == "update, update_gpu_tag":
                mesh.update()
                mesh.update_gpu_tag()

        detach()
        getattr(bpy.app.handlers, "frame_change_" + self.handler).append(on_frame)


def detach():
    bpy.app.handlers.frame_change_pre.clear()
    bpy.app.handlers.frame_change_post.clear()


WRITERS = [
    Writer("original, pre, foreach_set + update()", "original", "pre", write_foreach, "update"),
    Writer("original, post, foreach_set + update()", "original", "post", write_foreach, "update"),
    Writer("original, post, raw + update()", "original", "post", write_raw, "update"),
    Writer("original, post, raw + update_tag()", "original", "post", write_raw, "update_tag"),
    Writer("original, post, raw, no tag", "original", "post", write_raw, None),
    Writer("evaluated, post, foreach_set, no tag", "evaluated", "post", write_foreach, None),
    Writer("evaluated, post, foreach_set + update()", "evaluated", "post", write_foreach, "update"),
    Writer("evaluated, post, raw, no tag", "evaluated", "post", write_raw, None),
    Writer("own normals (seen as 2 f if used): original", "original", "post", write_raw_and_normals, "update_tag"),
    Writer("own normals (seen as 2 f if used): evaluated", "evaluated", "post", write_raw_and_normals, None),
]


# --- scenes and pictures ------------------------------------------------------------------------------------


def new_scene(quads=16):
    """An empty file with the sea, a camera straight above it and a material that shows what the renderer saw."""
    detach()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
    scene.render.fps = FPS
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = PICTURE
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 1.0
    camera.location = (0, 0, 10)
    scene.collection.objects.link(camera)
    scene.camera = camera
    sea = bpy.data.objects.new("sea", grid_mesh("sea", quads))
    scene.collection.objects.link(sea)
    sea.data.materials.append(telltale_material())
    return scene, sea


def telltale_material():
    material = bpy.data.materials.new("telltale")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    geometry = nodes.new("ShaderNodeNewGeometry")
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "whitecap_coverage"
    position, normal = nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeSeparateXYZ")
    colour, emission, output = (nodes.new("ShaderNodeCombineXYZ"), nodes.new("ShaderNodeEmission"),
                                nodes.new("ShaderNodeOutputMaterial"))
    links.new(geometry.outputs["Position"], position.inputs[0])
    links.new(geometry.outputs["Normal"], normal.inputs[0])
    links.new(position.outputs["Z"], colour.inputs["X"])
    links.new(attribute.outputs["Fac"], colour.inputs["Y"])
    links.new(normal.outputs["X"], colour.inputs["Z"])
    links.new(colour.outputs[0], emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def picture(path):
    image = bpy.data.images.load(path, check_existing=False)
    image.colorspace_settings.is_data = True
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    os.remove(path)
    return pixels.reshape(height, width, 4)


def frames_seen(path):
    """The frames whose positions, attribute and normals are in a picture, to a hundredth of a frame."""
    red, green, blue = picture(path).mean(axis=(0, 1))[:3]
    slope = blue / math.sqrt(max(1 - blue * blue, 1e-12))
    return tuple(round(float(v), 2) for v in
                 (red / HEIGHT_PER_FRAME_M, green / COVERAGE_PER_FRAME, slope / SLOPE_PER_FRAME))


def render_still(scene, frame):
    scene.frame_set(frame)
    scene.render.filepath = PICTURE + "still.exr"
    bpy.ops.render.render(write_still=True, scene=scene.name)
    return [(frame, frames_seen(PICTURE + "still.exr"))]


def render_animation(scene, first, last):
    scene.frame_start, scene.frame_end = first, last
    scene.render.filepath = PICTURE + "####.exr"
    bpy.ops.render.render(animation=True, scene=scene.name)
    return [(frame, frames_seen(f"{PICTURE}{frame:04d}.exr")) for frame in range(first, last + 1)]


def case_still(scene, sea):
    return render_still(scene, 7)


def case_animation(scene, sea):
    return render_animation(scene, 5, 7)


def case_persistent(scene, sea):
    scene.render.use_persistent_data = True
    return render_animation(scene, 5, 7)


def case_motion_blur(scene, sea):
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 1.0
    return render_animation(scene, 5, 7)


def case_second_view_layer(scene, sea):
    layer = scene.view_layers.new("second")
    scene.use_nodes = True
    nodes = scene.node_tree.nodes
    nodes.clear()
    layers, composite = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeComposite")
    layers.layer = layer.name
    scene.node_tree.links.new(layers.outputs["Image"], composite.inputs["Image"])
    return render_animation(scene, 5, 7)


def case_second_scene(scene, sea):
    """The scene rendered is not the window's, and stands at another frame."""
    second = scene.copy()
    scene.frame_set(2)
    return render_animation(second, 5, 7)


def case_subsurf(scene, sea):
    sea.modifiers.new("subsurf", "SUBSURF").subdivision_type = "SIMPLE"
    return render_animation(scene, 5, 7)


def case_displace_zero(scene, sea):
    """A modifier that keeps the vertex count: strength 0, so that the right answer is unchanged."""
    sea.modifiers.new("displace", "DISPLACE").strength = 0.0
    return render_animation(scene, 5, 7)


def case_displace_offset(scene, sea):
    """A displacement by 0.5 along z (texture none: strength · (1 − midlevel)); seen as +50 frames in red if applied."""
    modifier = sea.modifiers.new("displace", "DISPLACE")
    modifier.direction, modifier.strength, modifier.mid_level = "Z", 0.5, 0.0
    return [(frame, (round(red - 50, 2), green, blue))
            for frame, (red, green, blue) in render_animation(scene, 5, 7)]


def case_geometry_nodes(scene, sea):
    group = bpy.data.node_groups.new("pass through", "GeometryNodeTree")
    group.inputs.new("NodeSocketGeometry", "Geometry")
    group.outputs.new("NodeSocketGeometry", "Geometry")
    into, out = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    transform = group.nodes.new("GeometryNodeTransform")
    group.links.new(into.outputs[0], transform.inputs[0])
    group.links.new(transform.outputs[0], out.inputs[0])
    sea.modifiers.new("nodes", "NODES").node_group = group
    return render_animation(scene, 5, 7)


def case_dependant(scene, sea):
    """Another object takes the sea's geometry through Object Info: what a floating boat or a shrinkwrap sees."""
    group = bpy.data.node_groups.new("fetch", "GeometryNodeTree")
    group.outputs.new("NodeSocketGeometry", "Geometry")
    info, out = group.nodes.new("GeometryNodeObjectInfo"), group.nodes.new("NodeGroupOutput")
    info.inputs["Object"].default_value = sea
    group.links.new(info.outputs["Geometry"], out.inputs[0])
    other = bpy.data.objects.new("other", bpy.data.meshes.new("other"))
    scene.collection.objects.link(other)
    other.modifiers.new("nodes", "NODES").node_group = group
    sea.hide_render = True
    return render_animation(scene, 5, 7)


def case_instance(scene, sea):
    """A second object with the same mesh, the sea itself hidden."""
    other = bpy.data.objects.new("other", sea.data)
    scene.collection.objects.link(other)
    sea.hide_render = True
    return render_animation(scene, 5, 7)


RENDER_CASES = [case_still, case_animation, case_persistent, case_motion_blur, case_second_view_layer,
                case_second_scene, case_subsurf, case_displace_zero, case_displace_offset, case_geometry_nodes,
                case_dependant, case_instance]


def quietly(function, *arguments):
    """Runs with Blender's own progress lines, which C prints past sys.stdout, sent away."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        return function(*arguments)
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def part_render():
    print("\nWhat Cycles renders: 'right', or frame → frames seen in (positions, attribute, normals)")
    for writer in WRITERS:
        print(f"  {writer.name}")
        for case in RENDER_CASES:
            scene, sea = quietly(new_scene)
            writer.attach(sea)
            seen = quietly(case, scene, sea)
            wrong = [(f, s) for f, s in seen if max(abs(v - f) for v in s) > 0.02]
            verdict = "right" if not wrong else "WRONG " + "; ".join(f"{f} → {s}" for f, s in wrong)
            print(f"    {case.__name__[5:]:20s} {verdict}   [{len(writer.threads)} handler calls]")
    detach()


# --- parts --------------------------------------------------------------------------------------------------


def part_layout():
    scene, sea = quietly(new_scene)
    mesh = sea.data
    mesh.uv_layers.new(name="UVMap")

    def stride(collection):
        return collection[1].as_pointer() - collection[0].as_pointer()

    print(f"\nBlender {bpy.app.version_string}: bytes between elements")
    print(f"  vertices {stride(mesh.vertices)}, vertex_normals {stride(mesh.vertex_normals)}, "
          f"uv {stride(mesh.uv_layers[0].data)}")
    for attribute in ("velocity", "slope_variance", "whitecap_coverage"):
        print(f"  {attribute} {stride(mesh.attributes[attribute].data)}")
    evaluated = sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    print(f"  evaluated mesh shares the original's vertices: "
          f"{evaluated.vertices[0].as_pointer() == mesh.vertices[0].as_pointer()}, attributes: "
          f"{evaluated.attributes[0].data[0].as_pointer() == mesh.attributes[0].data[0].as_pointer()}")
    before = mesh.vertices[0].as_pointer(), mesh.attributes["velocity"].data[0].as_pointer()
    mesh.attributes.new("one_more", "FLOAT", "POINT")
    mesh.update()
    after = mesh.vertices[0].as_pointer(), mesh.attributes["velocity"].data[0].as_pointer()
    print(f"  arrays stay where they are when an attribute is added: vertices {before[0] == after[0]}, "
          f"velocity {before[1] == after[1]}")
    copies = set()
    for frame in range(1, 9):
        mesh.update()
        scene.frame_set(frame)
        copies.add(sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices[0].as_pointer())
    print(f"  evaluated vertices over 8 tagged updates: {len(copies)} addresses")


def part_update():
    """What it takes for a write to be seen, and what later events do to a write into the evaluated mesh."""
    print("\nz that the dependency graph shows after writing 1 into a mesh of 0")

    def shown(sea):
        return sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices[0].co.z

    ones = rest_positions(17) + np.float32([0, 0, 1])
    none = np.zeros(17 * 17, np.float32)
    for write in (write_foreach, write_raw):
        for tag in ("nothing", "view_layer.update()", "mesh.update_tag()", "mesh.update()", "object.update_tag()"):
            scene, sea = quietly(new_scene)
            shown(sea)
            write(sea.data, ones, none)
            {"nothing": lambda: None, "view_layer.update()": bpy.context.view_layer.update,
             "mesh.update_tag()": sea.data.update_tag, "mesh.update()": sea.data.update,
             "object.update_tag()": sea.update_tag}[tag]()
            print(f"  original, {write.__name__}, then {tag:22s} {shown(sea):g}")

    def event_move(scene, sea):
        sea.location.x = 1

    def event_material(scene, sea):
        sea.data.materials[0].diffuse_color = (1, 0, 0, 1)

    def event_mesh_setting(scene, sea):
        sea.data.use_auto_smooth = True

    def event_tag(scene, sea):
        sea.data.update_tag()

    def event_modifier(scene, sea):
        sea.modifiers.new("displace", "DISPLACE").strength = 0

    def event_new_object(scene, sea):
        scene.collection.objects.link(bpy.data.objects.new("empty", None))

    def event_frame(scene, sea):
        scene.frame_set(9)

    def event_hide_show(scene, sea):
        sea.hide_viewport = True
        bpy.context.view_layer.update()
        sea.hide_viewport = False

    def event_edit_mode(scene, sea):
        bpy.context.view_layer.objects.active = sea
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.object.mode_set(mode="OBJECT")

    def event_undo_push(scene, sea):
        bpy.ops.ed.undo_push()

    def event_save(scene, sea):
        bpy.ops.wm.save_as_mainfile(filepath=PICTURE + "save.blend", copy=True)
        os.remove(PICTURE + "save.blend")

    print("z = 1 written into the evaluated mesh; what is shown after")
    for event in (event_move, event_material, event_mesh_setting, event_tag, event_modifier, event_new_object,
                  event_frame, event_hide_show, event_edit_mode, event_undo_push, event_save):
        scene, sea = quietly(new_scene)
        shown(sea)
        write_raw(sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data, ones, none)
        try:
            quietly(event, scene, sea)
            print(f"  {event.__name__[6:]:14s} {shown(sea):g}")
        except RuntimeError as error:
            print(f"  {event.__name__[6:]:14s} can't be done here: {error}")


def part_settings():
    """Which value of a keyframed setting a handler reads, from the original and from the evaluated object."""
    print("\nA custom property keyframed to equal the frame: what handlers read")
    scene, sea = quietly(new_scene)
    sea["swell"] = 0.0
    for frame in (0, 20):
        sea["swell"] = float(frame)
        sea.keyframe_insert('["swell"]', frame=frame)
    for curve in sea.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    read = []

    def on_pre(scene, depsgraph):
        read.append(("pre ", scene.frame_current_final, sea["swell"], None))

    def on_post(scene, depsgraph):
        read.append(("post", scene.frame_current_final, sea["swell"], sea.evaluated_get(depsgraph)["swell"]))

    bpy.app.handlers.frame_change_pre.append(on_pre)
    bpy.app.handlers.frame_change_post.append(on_post)
    scene.frame_set(3)
    scene.frame_set(7)
    print("  frame_set(3), frame_set(7):")
    report_settings(read)
    scene.render.use_motion_blur = True
    quietly(render_animation, scene, 11, 12)
    print("  render 11–12 with motion blur:")
    report_settings(read)
    detach()


def report_settings(read):
    for handler, frame, original, evaluated in read:
        at = "" if evaluated is None else f", evaluated {evaluated:g}"
        print(f"    {handler} frame {frame:g}: original {original:g}{at}")
    read.clear()


def part_blur():
    """A strip that runs to the right at 0.25 m a frame, shutter 1 frame: does its edge blur, how wide, where to?"""
    speed = 0.25  # m per frame
    cases = [
        ("no velocity", "original", None, None),
        ("velocity in m/s", "original", speed * FPS, None),
        ("velocity in m/frame", "original", speed, None),
        ("velocity in m/s, evaluated mesh", "evaluated", speed * FPS, None),
        ("displace of 1 nm, no velocity", "original", None, "DISPLACE"),
        ("displace of 1 nm, velocity in m/s", "original", speed * FPS, "DISPLACE"),
        ("displace of 1 nm, no velocity, evaluated mesh", "evaluated", None, "DISPLACE"),
        ("subsurf, velocity in m/s", "original", speed * FPS, "SUBSURF"),
    ]
    print("\nMotion blur of a moving edge: its true width is 0.25 m, its true middle 0")
    for name, target, velocity, modifier in cases:
        scene, sea = quietly(new_scene)
        mesh = sea.data
        if velocity is None:
            mesh.attributes.remove(mesh.attributes["velocity"])
        if modifier:
            added = sea.modifiers.new("modifier", modifier)
            if modifier == "DISPLACE":  # at exactly 0 Blender takes it as switched off
                added.direction, added.strength = "Z", 1e-9
            else:
                added.subdivision_type = "SIMPLE"
        scene.render.use_motion_blur = True
        scene.render.motion_blur_shutter = 1.0
        scene.cycles.samples = 256
        scene.render.resolution_x, scene.render.resolution_y = 128, 4
        nodes = mesh.materials[0].node_tree
        emission = nodes.nodes["Emission"]
        nodes.links.remove(emission.inputs["Color"].links[0])
        emission.inputs["Color"].default_value = (1, 1, 1, 1)
        times = []

        def on_frame(scene, depsgraph):
            frame = scene.frame_current_final
            times.append(frame)
            into = mesh if target == "original" else sea.evaluated_get(depsgraph).data
            positions = rest_positions(17)
            positions[:, 0] += speed * (frame - 5) - 1.0  # the right edge is in the middle at frame 5
            into.vertices.foreach_set("co", positions.ravel())
            if velocity is not None:
                into.attributes["velocity"].data.foreach_set(
                    "vector", np.tile(np.float32([velocity, 0, 0]), 17 * 17))
            if target == "original":
                into.update()

        bpy.app.handlers.frame_change_post.append(on_frame)
        scene.frame_set(5)
        times.clear()
        scene.render.filepath = PICTURE + "blur.exr"
        quietly(lambda: bpy.ops.render.render(write_still=True))
        profile = picture(PICTURE + "blur.exr")[:, :, 0].mean(axis=0)
        pixel = scene.camera.data.ortho_scale / 128
        width = np.count_nonzero((profile > 0.001) & (profile < 0.999)) * pixel
        middle = profile.sum() * pixel - 0.5
        after = sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices[16].co.x
        print(f"  {name:46s} width {width:.3f} m, off by {middle:+.3f} m, handler at {times}, "
              f"frame after {scene.frame_current_final:g}, edge after {after:+.3f}")
    detach()


def median_ms(function):
    function()
    spent = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        function()
        spent.append(1e3 * (time.perf_counter() - start))
    return statistics.median(spent)


def part_time():
    for quads in (256, 1024):
        scene, sea = quietly(new_scene, quads)
        mesh, side = sea.data, quads + 1
        count = side * side
        positions = rest_positions(side)
        flat, vector, scalar = positions.ravel(), np.zeros(3 * count, np.float32), np.zeros(count, np.float32)
        flat64 = flat.astype(np.float64)
        view_layer = bpy.context.view_layer
        view_layer.update()
        frame = [1]

        def to_vertices():
            mesh.vertices.foreach_set("co", flat)

        def attributes_of(mesh):
            mesh.attributes["velocity"].data.foreach_set("vector", vector)
            mesh.attributes["slope_variance"].data.foreach_set("vector", vector)
            mesh.attributes["whitecap_coverage"].data.foreach_set("value", scalar)

        def raw_of(mesh):
            strided_view(mesh.vertices, 3)[:] = positions

        def raw_attributes_of(mesh):
            strided_view(mesh.attributes["velocity"].data, 3)[:] = vector.reshape(-1, 3)
            strided_view(mesh.attributes["slope_variance"].data, 3)[:] = vector.reshape(-1, 3)
            strided_view(mesh.attributes["whitecap_coverage"].data, 1)[:, 0] = scalar

        def tagged_update():
            mesh.update_tag()
            view_layer.update()

        def evaluated():
            return sea.evaluated_get(bpy.context.evaluated_depsgraph_get()).data

        def whole(write, write_attributes, target):
            def run():
                into = mesh if target == "original" else evaluated()
                write(into)
                write_attributes(into)
                if target == "original":
                    tagged_update()
            return run

        def frame_step():
            frame[0] += 1
            scene.frame_set(frame[0])

        def normals_after_write(into, tag):
            into.vertices.foreach_set("co", flat)
            tag()
            return into.vertex_normals[0].vector

        rows = [
            ("write: foreach_set co, float32", to_vertices),
            ("write: foreach_set co, float64", lambda: mesh.vertices.foreach_set("co", flat64)),
            ("write: raw strided co", lambda: raw_of(mesh)),
            ("write: foreach_set of 3 attributes", lambda: attributes_of(mesh)),
            ("write: raw strided, 3 attributes", lambda: raw_attributes_of(mesh)),
            ("update: mesh.update()", mesh.update),
            ("update: update_tag + view_layer.update()", tagged_update),
            ("normals: update() + first vertex normal", lambda: normals_after_write(mesh, mesh.update)),
            ("frame_set, nothing written", frame_step),
            ("ed.undo_push after a changed position array", lambda: (to_vertices(), bpy.ops.ed.undo_push())),
        ]
        print(f"\n{side}² vertices, medians of {REPEATS}, ms and × (foreach_set co on the original + tagged update)")
        base = median_ms(lambda: (to_vertices(), tagged_update()))
        for name, function in rows:
            report_time(name, median_ms(function), base)
        report_time("original: foreach_set co + tagged update (= 1)", base, base)

        def foreach_co(into):
            into.vertices.foreach_set("co", flat)

        for name, write, write_attributes, target in (
                ("original: foreach_set co, 3 attributes, tagged update", foreach_co, attributes_of, "original"),
                ("original: raw co, 3 attributes, tagged update", raw_of, raw_attributes_of, "original"),
                ("evaluated: foreach_set co, 3 attributes", foreach_co, attributes_of, "evaluated"),
                ("evaluated: raw co, 3 attributes", raw_of, raw_attributes_of, "evaluated")):
            report_time(name, median_ms(whole(write, write_attributes, target)), base)
        report_time("original: foreach_set co, tagged update, an evaluated normal",
                    median_ms(lambda: (to_vertices(), tagged_update(), evaluated().vertex_normals[0].vector)), base)
        report_time("evaluated: foreach_set co, update(), a normal",
                    median_ms(lambda: normals_after_write(evaluated(), evaluated().update)), base)

        def handler_of(target, handler, tag):
            def on_frame(scene, depsgraph):
                into = mesh if target == "original" else sea.evaluated_get(depsgraph).data
                foreach_co(into)
                attributes_of(into)
                if tag:
                    into.update()
            detach()
            getattr(bpy.app.handlers, "frame_change_" + handler).append(on_frame)

        for target, handler, tag in (("original", "pre", True), ("original", "post", True),
                                     ("evaluated", "post", False)):
            handler_of(target, handler, tag)
            report_time(f"frame_set, handler {handler}, {target}, all buffers", median_ms(frame_step), base)
        detach()

        unit = np.tile(np.float32([0, 0, 1]), (count, 1))
        mesh.use_auto_smooth = True
        report_time("normals: normals_split_custom_set_from_vertices",
                    median_ms(lambda: mesh.normals_split_custom_set_from_vertices(unit)), base)
        report_time("then: tagged update", median_ms(tagged_update), base)
        report_time("then: tagged update, evaluated split normals",
                    median_ms(lambda: (mesh.update_tag(), view_layer.update(), evaluated().calc_normals_split())), base)


def report_time(name, spent_ms, base_ms):
    print(f"  {name:62s} {spent_ms:8.2f} ms   × {spent_ms / base_ms:.3f}")


# --- what needs a window ------------------------------------------------------------------------------------

EDGE_PER_FRAME_M = 0.05
WINDOW_WRITERS = [
    Writer("original, post, foreach_set + update()", "original", "post", write_foreach, "update"),
    Writer("evaluated, post, foreach_set, no tag", "evaluated", "post", write_foreach, None),
    Writer("evaluated, post, foreach_set + update()", "evaluated", "post", write_foreach, "update"),
    Writer("evaluated, post, + update() + update_gpu_tag()", "evaluated", "post", write_foreach,
           "update, update_gpu_tag"),
]


def edge_at(frame, side):
    """The grid, its right edge 0.05 m further to the right of the picture's left edge at each frame."""
    positions = rest_positions(side)
    positions[:, 0] += EDGE_PER_FRAME_M * frame - 1.5
    return positions, np.zeros(side * side, np.float32)


def view_3d():
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region}


def window_scene(quads=16):
    detach()
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.frame_set(0)
    scene.view_settings.view_transform = "Standard"
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 1.0, (0, 0, 10)
    scene.collection.objects.link(camera)
    scene.camera = camera
    sea = bpy.data.objects.new("sea", grid_mesh("sea", quads))
    sea.color = (1, 0, 0, 1)
    scene.collection.objects.link(sea)
    space = view_3d()["area"].spaces[0]
    space.shading.type, space.shading.light, space.shading.color_type = "SOLID", "FLAT", "OBJECT"
    space.overlay.show_overlays, space.show_gizmo = False, False
    space.region_3d.view_perspective = "CAMERA"
    redraw()
    return scene, sea


def redraw():
    with bpy.context.temp_override(**view_3d()):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)


def red_pixels():
    with bpy.context.temp_override(**view_3d()):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=2)
        bpy.ops.screen.screenshot(filepath=PICTURE + "screen.png")
    shot = picture(PICTURE + "screen.png")
    return int(np.count_nonzero((shot[..., 0] > shot[..., 1] + 0.2) & (shot[..., 0] > shot[..., 2] + 0.2)))


def window_viewport():
    print("The viewport after frame_set: red pixels, which must grow with the frame", flush=True)
    for writer in WINDOW_WRITERS:
        scene, sea = quietly(window_scene)
        seen = [("rest", quietly(red_pixels))]
        writer.attach(sea, edge_at)
        for frame in (4, 8, 12):
            scene.frame_set(frame)
            seen.append((frame, quietly(red_pixels)))
        sea.location.z = 0.1
        seen.append(("moved", quietly(red_pixels)))
        sea.data.update_tag()
        seen.append(("tagged", quietly(red_pixels)))
        print(f"  {writer.name:48s} " + ", ".join(f"{name}: {count}" for name, count in seen), flush=True)


def window_undo():
    """Undo across a frame change: do the frame and the mesh agree afterwards?"""
    print("Undo: frame, frame in the original mesh, frame in the evaluated mesh", flush=True)
    for writer in (WINDOW_WRITERS[0], WINDOW_WRITERS[2]):
        for repair in (False, True):
            scene, sea = quietly(window_scene)
            writer.attach(sea, edge_at)

            def state():
                current = bpy.context.scene
                now = bpy.data.objects["sea"]
                shown = now.evaluated_get(bpy.context.evaluated_depsgraph_get())
                edges = [(o.data.vertices[16].co.x + 0.5) / EDGE_PER_FRAME_M for o in (now, shown)]
                return f"{current.frame_current}/{edges[0]:.0f}/{edges[1]:.0f}"

            def on_undo(scene, _=None):
                current = bpy.context.scene
                current.frame_set(current.frame_current)

            if repair:
                bpy.app.handlers.undo_post.append(on_undo)
                bpy.app.handlers.redo_post.append(on_undo)
            states = []
            with bpy.context.temp_override(**view_3d()):
                scene.frame_set(2)
                bpy.ops.ed.undo_push(message="first")
                scene.frame_set(4)
                bpy.ops.ed.undo_push(message="second")
                sea.location.z = 0.2
                bpy.ops.ed.undo_push(message="third")
                scene.frame_set(8)
                states.append(state())
                for step in (bpy.ops.ed.undo, bpy.ops.ed.undo, bpy.ops.ed.redo):
                    step()
                    states.append(state())
            bpy.app.handlers.undo_post.clear()
            bpy.app.handlers.redo_post.clear()
            done = "undo_post sets the frame again" if repair else "nothing done on undo"
            print(f"  {writer.name:48s} {done:32s} {states}", flush=True)


def window_time():
    print("frame_set and redraw, medians, ms (a software rasteriser's, on a virtual display)", flush=True)
    for quads in (256, 1024):
        for writer in (None, *WINDOW_WRITERS):
            scene, sea = quietly(window_scene, quads)
            buffers = edge_at(1, quads + 1)
            if writer:
                writer.attach(sea, lambda frame, side: buffers)
            spent = []
            for frame in range(1, 12):
                start = time.perf_counter()
                scene.frame_set(frame)
                between = time.perf_counter()
                quietly(redraw)
                spent.append((1e3 * (between - start), 1e3 * (time.perf_counter() - between)))
            step, draw = (statistics.median(column) for column in zip(*spent))
            print(f"  {quads + 1}² {writer.name if writer else 'nothing written':48s} frame_set {step:8.2f}, "
                  f"redraw {draw:8.1f}", flush=True)


def window_render_job(lock, finished):
    """A render started as the menu starts it, on its own thread, while the viewport goes on."""
    scene, sea = quietly(window_scene, 64)
    sea.data.materials.append(telltale_material())
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.use_lock_interface = lock
    scene.frame_start, scene.frame_end = 5, 12
    scene.render.filepath = PICTURE + "####.exr"
    writer = WRITERS[1]
    writer.attach(sea)
    with bpy.context.temp_override(**view_3d()):
        bpy.ops.render.render("INVOKE_DEFAULT", animation=True)
    threads = writer.threads

    def wait():
        if bpy.app.is_job_running("RENDER"):
            return 0.1
        names = [f"{PICTURE}{frame:04d}.exr" for frame in range(5, 13)]
        seen = [(frame, frames_seen(name)) for frame, name in zip(range(5, 13), names)]
        wrong = [(frame, s) for frame, s in seen if max(abs(v - frame) for v in s) > 0.02]
        print(f"  lock interface {lock}: wrong frames {wrong}, handler on other threads than the main one: "
              f"{sum(t != threading.main_thread().ident for t in threads)} of {len(threads)} calls", flush=True)
        finished()
        return None

    bpy.app.timers.register(wait, first_interval=0.5)


def part_window():
    if bpy.app.background:
        print("window: needs a display; run without -b")
        return
    bpy.context.preferences.view.show_splash = False

    def run():
        try:
            window_viewport()
            window_undo()
            window_time()
            print("A render beside a live viewport", flush=True)
            window_render_job(True, lambda: window_render_job(False, bpy.ops.wm.quit_blender))
        except Exception:
            traceback.print_exc()
            bpy.ops.wm.quit_blender()

    bpy.app.timers.register(run, first_interval=1.0)


PARTS = {"layout": part_layout, "update": part_update, "render": part_render, "blur": part_blur,
         "settings": part_settings, "time": part_time, "window": part_window}

if __name__ == "__main__":
    wanted = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [p for p in PARTS if p != "window"]
    for part in wanted:
        PARTS[part]()
