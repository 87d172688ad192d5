# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of Blender's as a shot's bodies: what a shot file can say of their shape and their materials, as Wavefront OBJ and MTL."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from . import compat

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}  # what has faces
_means = {}  # colours of pictures
GREY = ("grey", (0.8, 0.8, 0.8), 0.5, (0.0, 0.0, 0.0))  # of faces without a material: name, colour, roughness, light [kcd/m²]


@dataclass
class Shape:
    """Triangles: points (n, 3) [m], corners (t, 3) into them, normals of corners (t, 3, 3), material of each, into materials. Pictures are
    those of materials, by their names; places the corners' in them (t, 3, 2), NaN without UV coordinates."""

    points: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    material: np.ndarray
    materials: list = field(default_factory=list)
    places: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 2)))
    pictures: dict = field(default_factory=dict)


def members(obj, is_another):
    """What belongs to a body: the object and all that is parented to it, but what is a body of its own or isn't rendered."""
    found, left = [], [obj]
    while left:
        each = left.pop()
        found.append(each)
        left += [child for child in each.children if not (child.hide_render or is_another(child))]
    return found


def triangles_of(evaluated, layers=tuple):
    """(points, corners, normals, slot, places) of an evaluated object in its own coordinates: float32 (n, 3), int32 (t, 3) into them, the corners'
    normals float32 (t, 3, 3), which of its material slots each triangle has, int32 (t,), and the corners' places by UV coordinates float32
    (t, 3, 2), NaN without; None of what has no faces. layers: gives for each slot the name of the UV map, "" of the mesh's own, None of none."""
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.polygons:
            return None
        mesh.calc_loop_triangles()
        points, loops = np.empty((len(mesh.vertices), 3), np.float32), np.empty((len(mesh.loop_triangles), 3), np.int32)
        mesh.vertices.foreach_get("co", points.ravel())
        mesh.loop_triangles.foreach_get("loops", loops.ravel())
        slot, vertices = np.empty(len(loops), np.int32), np.empty(len(mesh.loops), np.int32)
        mesh.loop_triangles.foreach_get("material_index", slot)
        mesh.loops.foreach_get("vertex_index", vertices)
        normals = compat.corner_normals(mesh)[loops]
        slot = np.clip(slot, 0, max(len(evaluated.material_slots) - 1, 0))
        places = np.full((len(loops), 3, 2), np.nan, np.float32)
        for number, layer in enumerate(layers()):
            maps = mesh.uv_layers
            uv = None if layer is None else maps.get(layer) if layer else next((one for one in maps if one.active_render), maps.active)
            if uv is not None:
                at = np.empty((len(mesh.loops), 2), np.float32)
                uv.data.foreach_get("uv", at.ravel())
                places[slot == number] = at[loops[slot == number]]
    finally:
        evaluated.to_mesh_clear()
    return points, vertices[loops], normals, slot, places


def shape_of(parts, depsgraph, into):
    """The Shape of some objects, with their modifiers and the collections that they stand for, as evaluated; into: a matrix from the world
    to the shape's coordinates. And sentences about what of their materials it leaves out."""
    made, materials, remarks, pictures = [], {}, {}, {}
    for part in parts:
        if part.type in SHAPES:
            evaluated = part.evaluated_get(depsgraph)
            made.append(_arrays(evaluated, into @ evaluated.matrix_world, materials, remarks, pictures))
    names = {part.name_full for part in parts}
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent and instance.parent.original.name_full in names and instance.object.type in SHAPES:
            made.append(_arrays(instance.object, into @ instance.matrix_world, materials, remarks, pictures))
    made = [arrays for arrays in made if arrays is not None]
    if not made:
        return None, []
    starts = np.cumsum([0] + [len(arrays[0]) for arrays in made[:-1]])
    points, corners, normals, material, places = ([arrays[i] for arrays in made] for i in range(5))
    return Shape(np.concatenate(points), np.concatenate([each + start for each, start in zip(corners, starts)]), np.concatenate(normals),
                 np.concatenate(material), list(materials), np.concatenate(places),
                 {name: image for name, (image, _) in pictures.items()}), [f"{what}: {', '.join(sorted(names))}" for what, names in remarks.items()]


def _arrays(evaluated, matrix, materials, remarks, pictures):
    """(points, corners, normals, material, places) of an evaluated object; None where it has no faces."""
    slots, index = [each.material for each in evaluated.material_slots] or [None], []

    def layers():
        index.extend(materials.setdefault(material_of(each, remarks, pictures), len(materials)) for each in slots)
        return [pictures.get(_name(each), (None, None))[1] for each in slots]

    read = triangles_of(evaluated, layers)
    if read is None:
        return None
    points, corners, normals, slot, places = read
    linear = np.array(matrix, float)[:3, :3]
    points = points @ linear.T + np.array(matrix, float)[:3, 3]
    size = np.linalg.det(linear)
    if abs(size) < 1e-12:
        return None  # flat: it hasn't an inside
    normals = normals @ np.linalg.inv(linear)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    if size < 0.0:  # mirrored
        corners, normals, places = corners[:, ::-1], normals[:, ::-1], places[:, ::-1]
    return points, corners, normals, np.array(index)[slot], places


# ---- Materials


def _shader(material):
    """The node that the material's surface is."""
    if not material.use_nodes:
        return None
    outputs = [node for node in material.node_tree.nodes if node.type == "OUTPUT_MATERIAL"]
    output = next((node for node in outputs if node.is_active_output), None)
    links = output.inputs["Surface"].links if output else ()
    return links[0].from_node if links else None


def _input(node, *names):
    return next((node.inputs[name] for name in names if name in node.inputs), None)


def _name(material):
    return "" if material is None else " ".join(material.name.split())


def _decoded(display):
    """Linear numbers of sRGB's (IEC 61966-2-1)."""
    return np.where(display <= 0.04045, display / 12.92, ((np.maximum(display, 0.0) + 0.055) / 1.055) ** 2.4)


def _encoded(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0) ** (1.0 / 2.4) - 0.055)


def _display(image, most=1 << 30):
    """The picture's pixels as sRGB, 0 … 1, (height, width, 4) from the bottom, every n-th where a side has more than that; None of one that has none,
    or of a colour space that isn't known."""
    if image.source not in {"FILE", "GENERATED"} or not all(image.size) or image.channels < 3:
        return None
    space = image.colorspace_settings.name
    is_linear = image.is_float or space in {"Non-Color", "Raw", "Linear", "Linear Rec.709"}
    if not is_linear and space != "sRGB":
        return None
    pixels = np.empty((image.size[1], image.size[0], image.channels), np.float32)
    image.pixels.foreach_get(pixels.ravel())
    step = -(-max(image.size) // most)
    pixels = pixels[::step, ::step]
    out = np.ones((*pixels.shape[:2], 4), np.float32)
    out[..., :3] = np.clip(np.nan_to_num(_encoded(pixels[..., :3]) if is_linear else pixels[..., :3]), 0.0, 1.0)
    return out


def _picture(socket):
    """(image, name of its UV map, "" of the mesh's own) of a colour that is a plain image by UV coordinates; None of any other."""
    node = socket.links[0].from_node if socket.is_linked else None
    if node is None or node.type != "TEX_IMAGE" or socket.links[0].from_socket.name != "Color" or node.image is None:
        return None
    if node.projection != "FLAT" or node.extension != "REPEAT":
        return None
    at = node.inputs["Vector"]
    if not at.is_linked:
        return node.image, ""
    of = at.links[0].from_node
    if of.type == "UVMAP" and not of.from_instancer:
        return node.image, of.uv_map
    return (node.image, "") if of.type == "TEX_COORD" and at.links[0].from_socket.name == "UV" else None


def mean_colour(image):
    """Linear; None of a picture that doesn't come along. Kept until forget_pictures(): the viewport asks at every redraw."""
    key = image.as_pointer(), image.name_full, image.filepath, tuple(image.size), image.colorspace_settings.name
    if key not in _means:
        pixels = _display(image, 2048)
        _means[key] = None if pixels is None else tuple(_decoded(pixels[..., :3]).mean((0, 1), dtype=float).tolist())
    return _means[key]


def forget_pictures():
    _means.clear()


def material_of(material, remarks, pictures):
    """(name, colour, roughness, light in kcd/m²); remarks: what is left out → names of materials; pictures: those that come along."""
    if material is None:
        return GREY
    node = _shader(material)

    def leave(what):
        remarks.setdefault(what, set()).add(material.name)

    def value(socket, otherwise):
        if socket is None:
            return otherwise
        if socket.is_linked:
            leave("nodes of a material, but a plain image by UV coordinates as its base colour, stay behind: it has the plain value that is in the field")
        return socket.default_value

    glow, colour, roughness = (0.0, 0.0, 0.0), tuple(material.diffuse_color[:3]), material.roughness
    if node is not None and node.type == "BSDF_PRINCIPLED":
        base = _input(node, "Base Color")
        picture = _picture(base) if base is not None else None
        mean = None if picture is None else mean_colour(picture[0])
        if mean is not None:
            pictures[_name(material)] = picture
            colour = mean
        else:
            colour = tuple(value(base, colour)[:3])
        roughness = value(_input(node, "Roughness"), roughness)
        strength = value(_input(node, "Emission Strength"), 0.0)
        light = value(_input(node, "Emission Color", "Emission"), (0.0, 0.0, 0.0, 1.0))
        glow = tuple(max(0.0, strength * each) for each in light[:3])
        clear = _input(node, "Transmission Weight", "Transmission")
        alpha = _input(node, "Alpha")
        if clear is not None and (clear.is_linked or clear.default_value > 0.0) or alpha is not None and (alpha.is_linked or alpha.default_value < 1.0):
            leave("a shot's bodies are opaque")
        metal = _input(node, "Metallic")
        if metal is not None and (metal.is_linked or metal.default_value > 0.0):
            leave("a shot's bodies aren't of metal")
    elif node is not None and node.type == "BSDF_DIFFUSE":
        colour, roughness = tuple(value(node.inputs["Color"], colour)[:3]), 1.0
    elif node is not None and node.type == "EMISSION":
        strength = value(node.inputs["Strength"], 1.0)
        colour, roughness, glow = (0.0, 0.0, 0.0), 1.0, tuple(max(0.0, strength * each) for each in value(node.inputs["Color"], (1.0,) * 4)[:3])
    elif node is not None:
        leave("of materials a shot has Principled BSDF, Diffuse BSDF and Emission; of others their colour in the viewport")
    return (_name(material), tuple(min(max(float(each), 0.0), 1.0) for each in colour), min(max(float(roughness), 0.0), 1.0), tuple(map(float, glow)))


# ---- Fewer triangles


def proxy(context, shape, percent):
    """The Shape with this share of its triangles, by Blender's own Decimate; without normals (0, 3, 3): whoever reads it makes them smooth."""
    mesh = bpy.data.meshes.new("Pelagic Proxy")
    mesh.from_pydata(shape.points.tolist(), [], shape.corners.tolist())
    for _ in shape.materials:
        mesh.materials.append(None)
    mesh.polygons.foreach_set("material_index", shape.material.astype(np.int32))
    obj = bpy.data.objects.new(mesh.name, mesh)
    context.scene.collection.objects.link(obj)
    try:
        decimate = obj.modifiers.new("Decimate", "DECIMATE")
        decimate.ratio, decimate.use_collapse_triangulate = percent / 100.0, True
        evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
        few = evaluated.data
        few.calc_loop_triangles()
        points, corners = np.empty((len(few.vertices), 3), np.float32), np.empty((len(few.loop_triangles), 3), np.int32)
        few.vertices.foreach_get("co", points.ravel())
        few.loop_triangles.foreach_get("vertices", corners.ravel())
        material = np.empty(len(corners), np.int32)
        few.loop_triangles.foreach_get("material_index", material)
    finally:
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(mesh)
    return Shape(points.astype(float), corners, np.empty((0, 3, 3)), material, shape.materials)


# ---- Files


def _rows(start, numbers, decimals):
    return "".join(f"{start} " + " ".join(f"{number:.{decimals}g}" for number in row) + "\n" for row in numbers.tolist())


def write(shape, file):
    """OBJ and MTL, as the core reads them (plugin/format/obj): z up, metres. Returns the light of its brightest material [kcd/m²]."""
    light = max((max(glow) for *_, glow in shape.materials), default=0.0)
    file.parent.mkdir(parents=True, exist_ok=True)
    saved = {}
    for image in shape.pictures.values():
        if image not in saved:
            saved[image] = f"{file.stem}_{len(saved) + 1}.png"
            _save(image, file.with_name(saved[image]))
    lines = ["# Written by Pelagic's add-on for Blender: metres, z up, bow along +x.\n"]
    for name, colour, roughness, glow in shape.materials:
        lines.append(f"newmtl {name}\nKd " + " ".join(f"{each:.6g}" for each in colour) + f"\nPr {roughness:.6g}\n"
                     + ("Ke " + " ".join(f"{each / light:.6g}" for each in glow) + "\n" if max(glow) > 0.0 else "")
                     + (f"map_Kd {saved[shape.pictures[name]]}\n" if name in shape.pictures else ""))
    put_file(file.with_suffix(".mtl"), "".join(lines))
    out = [lines[0], f"mtllib {file.with_suffix('.mtl').name}\n", _rows("v", shape.points, 7)]
    order = np.argsort(shape.material, kind="stable")
    corners, material = shape.corners[order] + 1, shape.material[order]
    places = shape.places[order] if shape.pictures else np.empty((0, 3, 2))
    if len(places):
        is_there = np.isfinite(places).all((1, 2))
        at, which_at = np.unique(np.where(is_there[:, None, None], places, 0.0).reshape(-1, 2), axis=0, return_inverse=True)
        out.append(_rows("vt", at, 7))
        which_at = which_at.reshape(-1, 3) + 1
    if len(shape.normals):
        normals, which = np.unique(np.round(shape.normals[order].reshape(-1, 3), 5) + 0.0, axis=0, return_inverse=True)
        out.append(_rows("vn", normals, 5))
        pairs = np.stack((corners, which.reshape(-1, 3) + 1), 2).reshape(-1, 6)
    else:
        out.append("s 1\n")
        pairs = None
    for index, (name, *_) in enumerate(shape.materials):
        of = material == index
        if not of.any():
            continue
        out.append(f"usemtl {name}\n")
        if name in shape.pictures and len(places) and pairs is not None:
            has = of & is_there
            out += [f"f {a}/{r}/{i} {b}/{s}/{j} {c}/{t}/{k}\n" for (a, i, b, j, c, k), (r, s, t) in zip(pairs[has].tolist(), which_at[has].tolist())]
            of = of & ~is_there
        if pairs is None:
            out += [f"f {a} {b} {c}\n" for a, b, c in corners[of].tolist()]
        else:
            out += [f"f {a}//{i} {b}//{j} {c}//{k}\n" for a, i, b, j, c, k in pairs[of].tolist()]
    put_file(file, "".join(out))
    return light


def _save(image, file):
    """As a PNG of sRGB, whatever it is in Blender: packed, made there, of floats."""
    pixels = _display(image)
    made = bpy.data.images.new(file.name, width=pixels.shape[1], height=pixels.shape[0], alpha=False)
    try:
        made.colorspace_settings.name = "sRGB"
        made.pixels.foreach_set(pixels.ravel())
        beside = file.with_name(file.name + ".part")
        made.filepath_raw, made.file_format = str(beside), "PNG"
        made.save()
        beside.replace(file)
    finally:
        bpy.data.images.remove(made)


def put_file(file, text):
    """The file is the old one until the new one is whole."""
    beside = file.with_name(file.name + ".part")
    beside.write_text(text, encoding="utf-8", newline="\n")
    beside.replace(file)


# ---- Into Blender


def mesh_of(name, told, colour, glow_cd_m2):
    """A Blender mesh of Scene.object_mesh(), its materials times the body's own colour and light."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(told["points_m"].tolist(), [], told["triangles"].tolist())
    mesh.polygons.foreach_set("material_index", told["material"].astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(told["triangles"]), bool))
    images = [_image(f"{name} {number + 1}", pixels, colour) for number, pixels in enumerate(told["images"])]
    for each in told["materials"]:
        mesh.materials.append(_made(each, colour, glow_cd_m2, images))
    if images:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", told["image_at"].astype(np.float32).ravel())
    compat.set_corner_normals(mesh, told["normals"])
    mesh.update()
    return mesh


def _image(name, pixels, colour):
    """A packed image of linear numbers, times the body's own colour."""
    image = bpy.data.images.new(name, width=pixels.shape[1], height=pixels.shape[0], alpha=False, float_buffer=True)
    out = np.ones((*pixels.shape[:2], 4), np.float32)
    out[..., :3] = pixels * np.array(colour, np.float32)
    image.pixels.foreach_set(out.ravel())
    image.pack()
    return image


def _made(told, colour, glow_cd_m2, images):
    material = bpy.data.materials.new(told["name"])
    material.use_nodes = True
    node = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    seen = tuple(mine * times for mine, times in zip(told["colour"], colour))
    node.inputs["Base Color"].default_value = material.diffuse_color = (*seen, 1.0)
    if told["image"] >= 0:
        texture = material.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = images[told["image"]]
        material.node_tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
    node.inputs["Roughness"].default_value = material.roughness = told["roughness"]
    _input(node, "Emission Color", "Emission").default_value = (*told["glow"], 1.0)
    node.inputs["Emission Strength"].default_value = glow_cd_m2 / 1000.0 if any(told["glow"]) else 0.0
    return material
