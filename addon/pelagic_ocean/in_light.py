# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects in the light of the sea: which of the scene's are a shot's bodies ([[objects]]), where they go, and their meshes' files.

A shot knows one mesh a body, which moves as a whole: along a way over the sea, its bow ahead, and with the waves if it floats. So its coordinates
have the bow along +x, and all else that the artist did to the object, turns, scales by axes, parents, is in the mesh. What of its movement
no such body can follow is said.
"""

import copy
import math

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty
from mathutils import Matrix

from . import bodies, camera, catcher, compat, courses, floating, ocean
from .module import pelagic
from .panels import PLACES, draw_words
from .properties import OVERRIDABLE, overridable, shortest

TITLE = "In the Sea's Light"
# What a body may be off where a shot has it, before it is said: metres, and a share of its size.
ERROR_M, ERROR = 0.02, 0.005
MOST_BYTES = 100  # of a body's name


def is_body(obj):
    return obj.pelagic_in_light.enabled and can_be(obj)


def can_be(obj):
    return obj is not None and not ocean.is_ocean(obj) and obj.type in bodies.SHAPES | {"EMPTY"}


def of_scene(bpy_scene):
    """The scene's bodies by name, rendered or not."""
    return sorted(filter(is_body, bpy_scene.objects), key=lambda obj: obj.name_full)


def _changed(settings, _context):
    settings.id_data.update_tag()  # what floats floats otherwise


@overridable
class PELAGIC_PG_in_light(bpy.types.PropertyGroup):
    enabled: BoolProperty(name=TITLE, update=_changed, description="A shot that is exported has this object, with what is parented to it: pelagic render "
                                                  "draws it, its shadow and its mirror image")
    proxy: IntProperty(name="Triangles", default=100, min=1, max=100, subtype="PERCENTAGE",
                       description="How many of its triangles a shot has, by Blender's Decimate: all, or a share where the object is far")
    buoyancy: EnumProperty(name="Buoyancy", description="How it floats in the pictures of a shot; in Blender it lies on the water", items=(
        ("plane", "On the Water", "It lies on the water under it"),
        ("response", "By Its Mass", "It answers late, and rolls on, as a ship as long, wide and deep does")))
    roll_damping: FloatProperty(name="Roll damping", default=0.1, min=0.01, max=10.0, soft_max=1.0,
                                description="By its mass: a bare hull has 0.05, one with bilge keels 0.1, a yacht under sail 0.4")
    caustics: FloatProperty(name="Caustics", default=0.0, min=0.0, max=10.0, soft_max=3.0,
                            description="How much waves gather the sun's light that they mirror onto it, 1 as it is. Pictures of a shot have it; Cycles and "
                                        "the viewport don't")


# ---- Out


def put(context, sea, scene, folder):
    """Gives a pelagic.Scene the bodies of Blender's scene as an ocean sees them, their meshes' files in a folder. Returns sentences about
    what a shot can't say of them. ValueError, OSError."""
    bpy_scene, remarks, made = context.scene, [], []
    chosen = [obj for obj in of_scene(bpy_scene) if not obj.hide_render]
    if not chosen:
        return remarks
    bodies.forget_pictures()
    ways, shapes = {obj: {} for obj in chosen}, {obj: [] for obj in chosen}
    looked_at = {bpy_scene.frame_start, (bpy_scene.frame_start + bpy_scene.frame_end) // 2, bpy_scene.frame_end}
    for frame, depsgraph in camera.frames(context, False):
        into_sea = sea.evaluated_get(depsgraph).matrix_world.inverted_safe()
        for obj in chosen:
            ways[obj][frame] = np.array(into_sea @ floating.calm_matrix(obj, depsgraph), float)
            if frame in looked_at:
                shapes[obj].append(_shape(obj, depsgraph)[0])
    names, files = set(), set()
    depsgraph = context.evaluated_depsgraph_get()
    for obj in chosen:
        shape, said = _shape(obj, depsgraph)
        if shape is None:
            remarks.append(f"{obj.name} has no faces, nor has what is parented to it: the shot is without it")
            continue
        remarks += [f"{obj.name}: {sentence}" for sentence in said]
        if not all(other is not None and _is_same(shape, other) for other in shapes[obj]):
            remarks.append(f"{obj.name} changes its shape: the shot has it as at frame {bpy_scene.frame_current}")
        remarks += _of_float(obj)
        now = np.array(sea.evaluated_get(depsgraph).matrix_world.inverted_safe() @ floating.calm_matrix(obj, depsgraph), float)
        entry, linear, off_m = _followed(scene, ways[obj], now, shape)
        if off_m is not None:
            remarks.append(f"{obj.name} moves as no body of a shot can (it rises, sinks, turns beside its way, or grows): there it is up to "
                           f"{off_m:.2g} m from where it is here, and as at frame {bpy_scene.frame_current}")
        shape.points = shape.points @ linear.T
        normals = shape.normals @ np.linalg.inv(linear)
        shape.normals = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
        if np.linalg.det(linear) < 0.0:
            shape.corners, shape.normals, shape.places = shape.corners[:, ::-1], shape.normals[:, ::-1], shape.places[:, ::-1]
        if obj.pelagic_in_light.proxy < 100:
            if shape.pictures:
                remarks.append(f"{obj.name}: a proxy has the mean colours of its pictures")
            shape = bodies.proxy(context, shape, obj.pelagic_in_light.proxy)
        file = folder / f"{_free(ocean.clean_name(obj.name), files)}.obj"
        light = bodies.write(shape, file)
        made.append(entry | {"file": str(file.absolute()), "name": _free(_name(obj.name), names), "floats": floating.is_afloat(obj),
                             "buoyancy": obj.pelagic_in_light.buoyancy,
                             "roll_damping": shortest(obj.pelagic_in_light.roll_damping), "caustics": shortest(obj.pelagic_in_light.caustics),
                             "holdout": obj.is_holdout, "glow_cd_m2": float(f"{1000.0 * light:.6g}")})
    scene.objects = [pelagic.SceneObject(**each) for each in made]
    return remarks


def _shape(obj, depsgraph):
    """In the object's own coordinates."""
    return bodies.shape_of(bodies.members(obj, is_body), depsgraph, obj.evaluated_get(depsgraph).matrix_world.inverted_safe())


def _is_same(shape, other):
    return shape.points.shape == other.points.shape and np.abs(shape.points - other.points).max() <= 1e-3 * np.ptp(shape.points, axis=0).max()


def _of_float(obj):
    if floating.is_afloat(obj) and not (obj.pelagic_float.enabled and not floating.is_on_board(obj)):
        yield f"{obj.name} goes with what it is parented to, which floats: in the shot it floats by itself"


def _name(name):
    """One that mattes may have."""
    name = "".join("_" if each in '"\\' or ord(each) < 32 or ord(each) == 127 else each for each in name)
    return name.encode()[:MOST_BYTES - 4].decode(errors="ignore")


def _free(name, taken):
    """The name, or one with a number that isn't taken; it is taken then. The water is called sea."""
    free, number = name, 1
    while free.lower() in taken or free == "sea":
        number += 1
        free = f"{name}-{number}"
    taken.add(free.lower())
    return free


def _followed(scene, way, now, shape):
    """How a shot's body goes: the keys of its entry; the part of its matrix that the mesh has (3, 3), as it is `now`, at the current frame; how far
    from its way, {frame: matrix}, it is at most [m], or None where that is too little to say."""
    size = np.linalg.norm(np.ptp(shape.points, axis=0)) * np.linalg.norm(now[:3, :3], 2)
    corners = np.array([[shape.points[:, axis].min(), shape.points[:, axis].max()] for axis in range(3)])
    corners = np.array([(*(corners[axis, side >> axis & 1] for axis in range(3)), 1.0) for side in range(8)])
    frame_now, most_m = bpy.context.scene.frame_current_final, max(ERROR_M, ERROR * size)

    def of(entry):
        probe = copy.copy(scene)
        probe.objects = [pelagic.SceneObject(file="", **entry)]
        poses = {frame: probe.object_pose(0, frame) for frame in way}

        def as_at(frame, matrix):
            from_body = np.linalg.inv(probe.object_pose(0, frame)) @ matrix
            return max(np.linalg.norm(((pose @ from_body - way[each]) @ corners.T)[:3], axis=0).max() for each, pose in poses.items()), from_body

        # At a path's ends its course is its first or last chord's: the frame in the middle may fit all of them better.
        middle = list(way)[len(way) // 2]
        here, there = as_at(frame_now, now), as_at(middle, way[middle])
        return there if there[0] < 0.8 * here[0] and there[0] <= most_m else here

    rows = [(frame, *matrix[:2, 3]) for frame, matrix in way.items()]
    found = []
    if np.ptp(np.array(rows)[:, 1:], axis=0).max() > 1e-3:
        for index in range(len(scene.waves.vessels)):
            off, from_body = of({"vessel": index + 1})
            if off <= max(0.1, most_m) and np.hypot(*from_body[:2, 3]) < size:
                found.append((np.hypot(*from_body[:2, 3]), index + 1, off, from_body))
        if found:
            _, vessel, off, from_body = min(found, key=lambda each: each[0])
            entry = {"vessel": vessel}
        else:
            entry = {"path": courses.text(courses.keys_through(rows))}
            off, from_body = of(entry)
        turn, heading_deg = np.eye(3), 0.0
    else:
        entry, heading_deg = {}, 0.0
        off, from_body = of(entry)
        ahead = from_body[:2, 0]
        if np.hypot(*ahead) > 1e-3 * np.linalg.norm(from_body[:3, 0]):
            heading_deg = math.degrees(math.atan2(ahead[1], ahead[0]))
        turn = np.array(Matrix.Rotation(-math.radians(heading_deg), 3, "Z"), float)
    for key, value in zip(("east_m", "north_m", "up_m"), from_body[:3, 3]):
        near = abs(value) < 1e-3 and key != "up_m" and bool(entry.keys() & {"vessel", "path"})  # of its way, which is as near
        entry[key] = 0.0 if near else shortest(round(value, 6)) + 0.0
    entry["heading_deg"] = shortest(round(heading_deg, 6)) + 0.0
    return entry, turn @ from_body[:3, :3], off if off > most_m else None


# ---- In


def add(context, shot, name):
    """Adds the bodies of a shot to Blender's scene, with their materials, where they go in its frames. Returns the objects."""
    first, last = shot.shot.frames
    bpy_scene, made = context.scene, []
    for index, entry in enumerate(shot.objects):
        label = entry.name or bpy.path.display_name_from_filepath(entry.file) or name
        obj = bpy.data.objects.new(label, bodies.mesh_of(label, shot.object_mesh(index), entry.colour, entry.glow_cd_m2))
        context.collection.objects.link(obj)
        moves = entry.vessel > 0 or bool(entry.path)
        poses, turn = {}, None
        for frame in range(first, last + 1) if moves else (bpy_scene.frame_current,):
            pose = Matrix(shot.object_pose(index, frame).tolist())
            turn = pose.to_euler("XYZ", turn) if turn else pose.to_euler("XYZ")
            poses[frame] = (*pose.translation, *turn)
        obj.scale = 3 * (entry.scale,)
        kept = camera.bends(poses, (1e-3,) * 3 + (1e-4,) * 3)
        for frame in kept:
            obj.location, obj.rotation_euler = poses[frame][:3], poses[frame][3:]
            if len(kept) > 1:
                obj.keyframe_insert("location", frame=frame)
                obj.keyframe_insert("rotation_euler", frame=frame)
        for curve in compat.curves(obj):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        obj.is_holdout = entry.holdout
        obj.pelagic_in_light.enabled = True
        obj.pelagic_in_light.buoyancy, obj.pelagic_in_light.roll_damping = entry.buoyancy, entry.roll_damping
        obj.pelagic_in_light.caustics = entry.caustics
        if entry.floats:
            obj.pelagic_float.enabled = True
        made.append(obj)
    return made


# ---- For the artist


class PELAGIC_OT_add_to_sea(bpy.types.Operator):
    """Put the selected objects into the sea's light, or take them out: an exported shot has them, with all that is parented to them, and pelagic render draws their shadow and mirror image"""

    bl_idname = "pelagic.add_to_sea"
    bl_label = "Add to Sea"
    bl_options = {"REGISTER", "UNDO"}

    enabled: BoolProperty(name=TITLE, default=True)
    name: StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # of one object, instead of those that are selected

    @classmethod
    def poll(cls, context):
        return pelagic is not None and context.mode == "OBJECT"

    def execute(self, context):
        asked = [context.scene.objects.get(self.name)] if self.name else context.selected_objects
        chosen = list(filter(can_be, asked))
        for obj in chosen:
            obj.pelagic_in_light.enabled = self.enabled
        if not chosen:
            self.report({"WARNING"}, "None of the selected objects has faces")
            return {"CANCELLED"}
        return {"FINISHED"}


class InLightPanel:
    bl_label = TITLE
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return pelagic is not None and (can_be(context.object) or ocean.is_ocean(context.object))

    def draw_header(self, context):
        if can_be(context.object):
            self.layout.prop(context.object.pelagic_in_light, "enabled", text="")

    def draw(self, context):
        layout = self.layout
        if can_be(context.object):
            layout.use_property_split = True
            layout.active = context.object.pelagic_in_light.enabled
            layout.prop(context.object.pelagic_in_light, "proxy")
            layout.prop(context.object.pelagic_in_light, "caustics")
            if floating.is_afloat(context.object):
                layout.prop(context.object.pelagic_in_light, "buoyancy")
                if context.object.pelagic_in_light.buoyancy == "response":
                    layout.prop(context.object.pelagic_in_light, "roll_damping")
            return
        chosen = of_scene(context.scene)
        for obj in chosen:
            row = layout.row()
            row.label(text=obj.name, icon="HIDE_ON" if obj.hide_render else "OBJECT_DATA", translate=False)
            remove = row.operator(PELAGIC_OT_add_to_sea.bl_idname, text="", icon="X")
            remove.name, remove.enabled = obj.name, False
        row = layout.row(align=True)
        catches = row.operator(catcher.PELAGIC_OT_catcher.bl_idname, depress=context.object.is_shadow_catcher)
        catches.enabled = not context.object.is_shadow_catcher
        if not chosen:
            draw_words(layout, "Shots have no objects: select some, and choose Object, Pelagic, Add to Sea")


CLASSES = (PELAGIC_PG_in_light, PELAGIC_OT_add_to_sea,
           *(type(f"PELAGIC_PT_{where}_in_light", (InLightPanel, bpy.types.Panel), dict(place)) for where, place in PLACES.items()))


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic_in_light = PointerProperty(type=PELAGIC_PG_in_light, name=TITLE, override=OVERRIDABLE)


def unregister():
    del bpy.types.Object.pelagic_in_light
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
