# SPDX-License-Identifier: GPL-3.0-or-later
"""What this Blender can do. The only file that asks: everything else calls these functions."""

import threading
from pathlib import Path

import bpy
import gpu
import numpy as np


def set_positions(mesh, positions):
    """positions: float32 (n, 3), contiguous."""
    attribute = mesh.attributes.get("position")  # since 3.5; before, vertices have a structure of their own
    if attribute is not None and attribute.data_type == "FLOAT_VECTOR":
        attribute.data.foreach_set("vector", positions.ravel())
    else:
        mesh.vertices.foreach_set("co", positions.ravel())


def stored(group, name):
    """What a file has for a property of ours, a number for a word; None: nothing, so that the default counts."""
    if hasattr(group, "bl_system_properties_get"):  # since 5.0 apart from what scripts put there
        group = group.bl_system_properties_get() or {}
    return group.get(name)


def tell(mesh):
    """Says that a mesh's numbers are others. update() also leaves a note for the window, whose loop reads and frees such notes
    meanwhile, its interface locked or not: from a render's own thread that ended Blender 3.4 now and then. There the tag alone does.
    From 4.0 on update() also drops normals that the evaluated mesh shares, and hasn't been seen to end Blender."""
    if bpy.app.version >= (4, 0) or threading.get_ident() == threading.main_thread().ident:
        mesh.update()
    else:
        mesh.update_tag()


def set_faces(mesh, corners, starts):
    """The mesh's faces: their vertices one after another, and where each face begins. int32, contiguous."""
    mesh.loops.add(len(corners))
    mesh.polygons.add(len(starts))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.foreach_set("loop_start", starts)
    if not bpy.types.MeshPolygon.bl_rna.properties["loop_total"].is_readonly:  # since 3.6 it follows from the starts
        mesh.polygons.foreach_set("loop_total", np.diff(starts, append=np.int32(len(corners))))


def shade_smooth(mesh):
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))


def corner_normals(mesh):
    """Of a mesh's corners, as they are shaded: float32 (corners, 3)."""
    normals = np.empty((len(mesh.loops), 3), np.float32)
    if hasattr(mesh, "corner_normals"):  # since 4.1
        mesh.corner_normals.foreach_get("vector", normals.ravel())
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals.ravel())
    return normals


def set_corner_normals(mesh, normals):
    """normals: float32 (corners, 3), unit."""
    if hasattr(mesh, "use_auto_smooth"):  # before 4.1
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(normals.tolist())


def creases(mesh):
    """Blender's creases, 0 … 1, of edges and of vertices: float32 (edges,) and (vertices,)."""
    edges, vertices = np.zeros(len(mesh.edges), np.float32), np.zeros(len(mesh.vertices), np.float32)
    if "crease_edge" in mesh.attributes or "crease_vert" in mesh.attributes:  # since 4.0
        for name, out in (("crease_edge", edges), ("crease_vert", vertices)):
            if name in mesh.attributes:
                mesh.attributes[name].data.foreach_get("value", out)
    elif hasattr(mesh, "has_crease_edge"):  # in 3.4
        if mesh.has_crease_edge:
            mesh.edges.foreach_get("crease", edges)
        if mesh.has_crease_vertex:
            mesh.vertex_creases[0].data.foreach_get("value", vertices)
    return edges, vertices


def has_more(mesh, names):
    """Whether a mesh has attributes besides these, or creases, bevel weights or normals of its own."""
    built_in = {"sharp_face"}  # since 4.1: which faces aren't smooth. Names with a dot are Blender's own
    return (any(name[0] != "." and name not in names | built_in for name in mesh.attributes.keys())
            or any(getattr(mesh, f"has_{what}", False) for what in
                   ("crease_edge", "crease_vertex", "bevel_weight_edge", "bevel_weight_vertex", "custom_normals")))


def can_denoise():
    """Whether Cycles has a denoiser. Debian's has none, and refuses to render while one is asked for."""
    try:
        import _cycles
    except ImportError:
        return True
    return getattr(_cycles, "with_openimagedenoise", True)


def sharp_refraction(node=bpy.types.ShaderNodeBsdfRefraction):
    """The distribution by which a refraction node of no roughness bends light without spreading it."""
    known = node.bl_rna.properties["distribution"].enum_items.keys()
    return "SHARP" if "SHARP" in known else "BECKMANN"  # since 4.0 any does at a roughness of 0


def voxels_off(version=bpy.app.version):
    """How far this Blender shows a volume's voxels from where their file has them, along each axis, in voxels: OpenVDB's
    transform leads to the middle of a voxel, and Cycles and the Volume to Mesh modifier take it for the corner. That is
    measured in 3.4.1 and 4.3.2, and that 5.2.2 has it right; others are taken to be as the nearest of these."""
    return 0.5 if (3, 4) <= tuple(version[:2]) < (5, 0) else 0.0


def eevee_mirrors_in_facets():
    """Whether EEVEE mirrors the sky in facets whose normals change from sample to sample. The one since 4.2 loses nearly all of it:
    of a sea that is 25 kcd/m² bright 2 are left, and 13 with the mesh's own normal (measured in 4.3.2)."""
    return bpy.app.version < (4, 2)


def eevee_volumes_reach_far():
    """Whether a volume in EEVEE may be as wide as a sea. The one since 4.2 makes one tone of it, in 5.2.2 half as bright as it is, that
    doesn't know distances; of 400 m it has it right (measured in 4.3.2 and 5.2.2)."""
    return bpy.app.version < (4, 2)


def preview_shadings():
    """The kinds of a view's shading over which add-ons can draw behind objects. The EEVEE since 4.2 leaves them no depths: all 0 without
    overlays, all 1 with them (measured in 4.3.2)."""
    return {"SOLID", "MATERIAL"} if bpy.app.version < (4, 2) else {"SOLID"}


def dont_light_with(material):
    """Cycles doesn't look for a mesh of this material as for a lamp, though it glows a little."""
    if hasattr(material.cycles, "emission_sampling"):  # since 3.5
        material.cycles.emission_sampling = "NONE"
    else:
        material.cycles.sample_as_light = False


def blend_by_samples(material):
    """Lets EEVEE mix a material that is transparent in part by chance, in no order; without shadows. Since 4.2 it does."""
    if not hasattr(material, "surface_render_method"):
        material.blend_method, material.shadow_method = "HASHED", "NONE"


def blend_by_threshold(material):
    """Lets EEVEE leave out a material where it is transparent, and nowhere else. Since 4.2 it does."""
    if not hasattr(material, "surface_render_method"):
        material.blend_method = "CLIP"


def reads_volumes_once():
    """Whether a volume's file that was read shows as it was then until Blender ends, though it is written anew: measured so in
    4.3.2 and 5.2.2, and in 3.4.1 not."""
    return bpy.app.version >= (4, 0)


def curves(owner):
    """The curves that animate an object or its data: a collection with remove(), or an empty list."""
    animation = owner.animation_data
    if animation is None or animation.action is None:
        return []
    if not hasattr(animation, "action_slot"):  # actions have slots since 4.4
        return animation.action.fcurves
    if animation.action_slot is None:
        return []
    for layer in animation.action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(animation.action_slot)
            if bag:
                return bag.fcurves
    return []


def curves_of_actions():
    """Those of all actions of the file, whoever uses them."""
    for action in bpy.data.actions:
        if not hasattr(action, "slots"):
            yield from action.fcurves
            continue
        for layer in action.layers:
            for strip in layer.strips:
                for bag in strip.channelbags:
                    yield from bag.fcurves


def set_uv(layer, uv):
    """uv: float32 (corners, 2), contiguous."""
    if hasattr(layer, "uv"):  # since 3.5
        layer.uv.foreach_set("vector", uv.ravel())
    else:
        layer.data.foreach_set("uv", uv.ravel())


def user_folder(package, name, create):
    """A Path to a folder of the user's own, which stays when the add-on is updated: an extension's, since 4.2, or the
    one for scripts' presets."""
    if package.startswith("bl_ext."):
        return Path(bpy.utils.extension_path_user(package, path=name, create=create))
    return Path(bpy.utils.user_resource("SCRIPTS", path=f"{name}/pelagic", create=create))


# ---- Shaders of our own


def shader_problem():
    """Why this Blender can't draw with our own GLSL, in words; empty if it can."""
    if bpy.app.background:
        return "This Blender has no window to draw in"
    backend = getattr(gpu.platform, "backend_type_get", lambda: "OPENGL")()  # Blender 3.4 knows OpenGL alone
    if backend != "OPENGL":
        return (f"The viewport preview's shaders are for OpenGL, and this Blender draws with {backend.title()}. Where there "
                "is a choice it's in Preferences, System, Backend")
    return ""


def shader(vertex, fragment):
    """A gpu.types.GPUShader of GLSL 3.30 whose fragment shader calls host_colour(). RuntimeError, in words, if this Blender
    takes no such text."""
    free_names = "#undef select\n"  # one of Blender's macros, which our text has a function of
    # What a view stores depends on the framebuffer; Blender's own function knows.
    colour = "vec4 host_colour(vec4 display) { return blender_srgb_to_framebuffer_space(display); }\n"
    return plain_shader(free_names + vertex, free_names + colour + fragment)


def plain_shader(vertex, fragment):
    """The same of a fragment shader that calls nothing of Blender's."""
    try:
        return gpu.types.GPUShader(vertex, fragment)
    except TypeError as error:  # the constructor is gone
        raise RuntimeError("This Blender's gpu module takes no GLSL as it is, which the viewport preview is made of") from error
    except Exception as error:
        raise RuntimeError("The graphics driver doesn't compile the viewport preview's shaders. The console says "
                           "where") from error


def new_group_socket(group, name, kind, is_output=False, default=None):
    """A socket of a node group; kind: "Float", "Color", "Vector"."""
    idname = "NodeSocket" + kind
    if hasattr(group, "interface"):  # since 4.0
        socket = group.interface.new_socket(name, in_out="OUTPUT" if is_output else "INPUT", socket_type=idname)
    else:
        socket = (group.outputs if is_output else group.inputs).new(idname, name)
    if default is not None:
        socket.default_value = default
    return socket
