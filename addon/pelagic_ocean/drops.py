# SPDX-License-Identifier: GPL-3.0-or-later
"""The large drops of the spray, `effects.spray_drops`: what is in the air round the scene's camera, as points below their ocean.

A mesh of vertices alone holds a frame's drops; a modifier makes points of them, which Cycles draws as spheres. A vertex is a parcel of
drops, as `pelagic render` shows it as a soft disc, and the material makes that of the sphere. The objects are the add-on's own: they come
and go with the key, and one that nobody wants any more is removed.
"""

from contextlib import suppress

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import compat, handlers, light, meshes, ocean, play
from .module import pelagic
from .nodes import Tree

MARK = "pelagic_drops"  # on objects, meshes, node groups and materials of the add-on
OWN_LIGHT, PICTURE = "Sky's Own Light", "Spray's Light"  # nodes
LIGHT_WIDTH = 256  # of the picture of that: 1.4° a pixel, where the light ahead of the sun is 3° wide
LAYERS = 256  # sides of spheres that one ray may go through: Blender's own 8 would leave a crest's drops dark


def are_on(obj):
    """Whether the settings of an ocean ask for drops, and it is where they can be added."""
    effects = obj.pelagic.effects
    return (effects.spray_drops and effects.spray and effects.whitecaps and effects.spray_law == "andreas-1998"
            and bool(obj.users_scene) and not obj.library)


def drops_of(obj):
    """The object of an ocean's drops, or None."""
    return next((each for each in bpy.data.objects if MARK in each and each.parent == obj), None)


# ---- Objects


def _tidy():
    """Makes the objects that are asked for, and removes the others. Returns those that it made."""
    having, made = set(), []
    for each in [each for each in bpy.data.objects if MARK in each and not each.library]:
        obj = each.parent
        if ocean.is_ocean(obj) and are_on(obj) and obj not in having and each.type == "MESH" and MARK in each.data:
            having.add(obj)
        else:
            _remove(each)
    for obj in ocean.oceans():
        if are_on(obj) and obj not in having:
            made.append(_make(obj))
    return made


def _is_tidy():
    objects = [each for each in bpy.data.objects if MARK in each and not each.library]
    wanting = [obj for obj in ocean.oceans() if are_on(obj)]
    return len(objects) == len(wanting) == len({each.parent for each in objects} & set(wanting))


def _tidy_soon():
    """In a window from a timer: handlers run where objects that are gone may still be looked at. Returns what was made at once."""
    if _is_tidy():
        return []
    if bpy.app.background:
        return _tidy()
    if not bpy.app.timers.is_registered(_tidy_later):
        bpy.app.timers.register(_tidy_later, first_interval=0.0)
    return []


def _tidy_later():
    if play.is_rendering() or play.is_saving:
        return 0.5
    for each in _tidy():
        each.parent.update_tag()  # its handlers fill them
    return None


def _make(obj):
    name = f"{obj.name} Drops"
    mesh = bpy.data.meshes.new(name)
    made = bpy.data.objects.new(name, mesh)
    made[MARK] = mesh[MARK] = True
    made.parent = obj
    made.hide_select = True  # a click is meant for what is behind it
    for kind in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):  # as before the program's own pictures
        setattr(made, f"visible_{kind}", False)
    places = [each for each in obj.users_collection if not each.library]
    for collection in places or [obj.users_scene[0].collection]:
        collection.objects.link(made)
    made.modifiers.new("Points", "NODES").node_group = _points_group(_new_material())
    for bpy_scene in obj.users_scene:
        if hasattr(bpy_scene, "cycles"):
            bpy_scene.cycles.transparent_max_bounces = max(bpy_scene.cycles.transparent_max_bounces, LAYERS)
        _light(obj, bpy_scene)
    return made


def _remove(each):
    material = _material_of(each)
    made = [each.data, *(modifier.node_group for modifier in each.modifiers if modifier.type == "NODES"), material]
    if material is not None and PICTURE in material.node_tree.nodes:
        made.append(material.node_tree.nodes[PICTURE].image)
    bpy.data.objects.remove(each)
    for data in made:
        if data is not None and MARK in data and not data.users:
            bpy.data.batch_remove([data])


def _points_group(material):
    group = bpy.data.node_groups.new("Pelagic Drops", "GeometryNodeTree")
    group[MARK] = True
    for is_output in (False, True):
        compat.new_group_socket(group, "Geometry", "Geometry", is_output)
    tree = Tree(group)
    radius = tree.node("GeometryNodeInputNamedAttribute", {"Name": "radius"}, data_type="FLOAT")
    points = tree.node("GeometryNodeMeshToPoints")
    look = tree.node("GeometryNodeSetMaterial", {"Material": material})
    sink = tree.node("NodeGroupOutput")
    group.links.new(tree.node("NodeGroupInput").outputs[0], points.inputs["Mesh"])
    group.links.new(next(socket for socket in radius.outputs if socket.type == "VALUE"), points.inputs["Radius"])
    group.links.new(points.outputs[0], look.inputs["Geometry"])
    group.links.new(look.outputs[0], sink.inputs[0])
    return group


# ---- The look


def _material_of(each):
    """The add-on's own of an object of drops; None where an artist has put another in its place."""
    for modifier in each.modifiers:
        for node in modifier.node_group.nodes if modifier.type == "NODES" and modifier.node_group else ():
            if node.bl_idname == "GeometryNodeSetMaterial":
                material = node.inputs["Material"].default_value
                return material if material is not None and MARK in material else None
    return None


def _new_material():
    """A sphere that hides what a parcel's soft disc does, (1 − ρ²)² of 3 times the mean thickness, and shows the light of spray. In a sky that
    isn't the add-on's it scatters what falls on it to all sides."""
    material = bpy.data.materials.new("Pelagic Drops")
    material[MARK] = ""
    material.use_nodes = True
    compat.blend_by_samples(material)
    tree = Tree(material.node_tree)
    cosine = tree.add("ShaderNodeNewGeometry", output="Normal").dot(tree.add("ShaderNodeNewGeometry", output="Incoming"))
    inner = cosine * cosine
    left = (1.0 - tree.attribute("opacity", "Fac")).at_least(1e-4)
    # Cycles of 3.4 meets the near side alone; of 4.3 and 5.2 the far one, too, where another sphere's is between.
    near = 1.0 - tree.add("ShaderNodeNewGeometry", output="Backfacing")
    hidden = near * (1.0 - tree.math("POWER", left, 3.0 * inner * inner))
    picture = tree.node("ShaderNodeTexEnvironment", {"Vector": -tree.add("ShaderNodeNewGeometry", output="Incoming")})
    picture.name = picture.label = PICTURE
    own = tree.node("ShaderNodeValue")
    own.name = own.label = OWN_LIGHT
    scattered = tree.add("ShaderNodeAddShader", {0: tree.add("ShaderNodeBsdfDiffuse", {"Color": (0.5, 0.5, 0.5, 1.0)}),
                                                 1: tree.add("ShaderNodeBsdfTranslucent", {"Color": (0.5, 0.5, 0.5, 1.0)})})
    shown = tree.add("ShaderNodeMixShader", {0: tree.value(own, 0), 1: scattered,
                                             2: tree.add("ShaderNodeEmission", {"Color": tree.value(picture, "Color")})})
    tree.node("ShaderNodeOutputMaterial", {"Surface": tree.add("ShaderNodeMixShader", {
        0: hidden, 1: tree.add("ShaderNodeBsdfTransparent"), 2: shown})})
    return material


def _light(obj, bpy_scene):
    """Brings the light of an ocean's drops to its scene's. Where that isn't known, or refused, look.py does once it is."""
    scene = play.simulation_of(obj).scene
    with suppress(ValueError, OSError):
        if scene is not None:
            put_light(obj, scene, light.sky_picture(bpy_scene))


def put_light(obj, scene, sky):
    """The light that drops of this scene send on. sky: the picture of the scene's sky, None where that isn't the add-on's."""
    each = drops_of(obj)
    material = each and _material_of(each)
    nodes = material.node_tree.nodes if material else {}
    if OWN_LIGHT not in nodes or PICTURE not in nodes:
        return
    asked = repr((scene.light, scene.water, scene.sea, scene.effects)) if sky else "none"
    if material[MARK] == asked:
        return
    material[MARK] = asked
    nodes[OWN_LIGHT].outputs[0].default_value = 1.0 if sky else 0.0
    if sky:
        made = light.sky_of(scene).spray_image(scene, LIGHT_WIDTH)
        image = nodes[PICTURE].image = light.packed_image("Pelagic Spray Light", made, nodes[PICTURE].image)
        image[MARK] = True


# ---- A frame's drops

_flying = {}  # the names of objects → the sea and the square of their pelagic.SprayDrops, that, and what is in the mesh


def _eye_of(obj, bpy_scene, depsgraph):
    """Where the scene's camera is in the ocean's own coordinates; None without one, and of one whose rays are parallel."""
    camera = bpy_scene.camera
    if camera is None or camera.type != "CAMERA" or camera.data.type == "ORTHO":
        return None
    to_sea = obj.evaluated_get(depsgraph).matrix_world.inverted_safe()
    return tuple(to_sea @ camera.evaluated_get(depsgraph).matrix_world.translation)


def _show(obj, each, bpy_scene, depsgraph):
    """Brings the mesh of an object of drops to the present."""
    simulation = play.simulation_of(obj)
    sea = simulation.sea if play.is_seen(obj, depsgraph) else None
    if sea is None:
        if len(each.data.vertices):
            _put(each.data, None)
        _flying.pop(each.name_full, None)
        return
    eye = _eye_of(obj, bpy_scene, depsgraph)
    of = sea, None if eye else simulation.scene.surface.size_m
    moment = simulation.moment_at(bpy_scene.frame_current_final)
    known, drops, shown = _flying.get(each.name_full, (None, None, None))
    if known == of and shown == (moment, eye):
        return
    if known != of:
        drops = pelagic.SprayDrops(*of)
    try:
        found = drops.in_air(moment.time_s, eye=eye)
    except ValueError:  # a camera out of this world
        found = None
    _put(each.data, found, moment.time_scale)
    _flying[each.name_full] = of, drops, (moment, eye)


def _put(mesh, found, time_scale=1.0):
    """found: of pelagic.SprayDrops.in_air(), None: no drops."""
    count = len(found["id"]) if found else 0
    if count != len(mesh.vertices):
        mesh.clear_geometry()
        mesh.vertices.add(count)
    if count:
        compat.set_positions(mesh, found["position"].astype(np.float32))
        for name, kind, numbers, values in (("radius", "FLOAT", "value", 0.5 * found["width_m"]), ("opacity", "FLOAT", "value", found["opacity"]),
                                            ("velocity", "FLOAT_VECTOR", "vector", found["velocity"] * np.float32(time_scale))):
            meshes.attribute(mesh, name, kind).data.foreach_set(numbers, values.ravel())
    compat.tell(mesh)


def _show_all(bpy_scene, depsgraph, new=()):
    """new: objects that aren't in the depsgraph yet."""
    objects = [each for each in bpy.data.objects if MARK in each]
    for each in objects:
        if ocean.is_ocean(each.parent) and each.type == "MESH" and not each.data.library and (each in new or play.is_seen(each, depsgraph)):
            _show(each.parent, each, bpy_scene, depsgraph)
    for name in set(_flying) - {each.name_full for each in objects}:
        del _flying[name]


# ---- Handlers: after those of play.py


@persistent
def _on_frame(bpy_scene, depsgraph):
    _show_all(bpy_scene, depsgraph, [] if play.is_rendering() else _tidy_soon())


@persistent
def _on_update(bpy_scene, depsgraph):
    if play.is_rendering():
        return
    if any(isinstance(update.id, bpy.types.Scene) or isinstance(update.id, bpy.types.Object)
           and (update.id.type == "CAMERA" or ocean.is_ocean(update.id) or MARK in update.id) for update in depsgraph.updates):
        _show_all(bpy_scene, depsgraph, _tidy_soon())


@persistent
def _on_other_data(*_):
    """Undo, redo, another file: meshes are of another moment now. The next update follows at once: play.py asks for it."""
    _flying.clear()


@persistent
def _on_load(*_):
    _on_other_data()
    if bpy.app.background:
        _on_frame(bpy.context.scene, bpy.context.evaluated_depsgraph_get())


HANDLERS = (("frame_change_post", _on_frame), ("depsgraph_update_post", _on_update), ("undo_post", _on_other_data),
            ("redo_post", _on_other_data), ("load_post", _on_load))


def register():
    if pelagic is not None:
        handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
    if bpy.app.timers.is_registered(_tidy_later):
        bpy.app.timers.unregister(_tidy_later)
    _flying.clear()
