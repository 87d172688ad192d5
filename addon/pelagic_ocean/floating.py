# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that float: they rise, tilt and drift with the water under them.

Place the object as it lies in calm water, animate it as you like, and mark it. What the sea adds goes to the object's
delta transforms, which come on top of its own: keyframes, drivers and parents stay what they are, and undo and saving
keep both. It is worked out anew for each frame from the surface at that frame alone, so that frames may come in any
order. That rules out a hull's own swinging. Its weight and size act as a filter instead: the surface is averaged over
the object's footprint, `damping` times as wide, and what the object lies on is the plane that fits best. Waves shorter
than that don't move it. It never turns about its own axis: the orbits of waves have no curl. An object in the sea's light (in_light.py)
floats as the shot's body does.
"""

import math

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, PointerProperty
from mathutils import Euler, Matrix, Vector

from . import bodies, handlers, ocean
from .module import pelagic
from .panels import PLACES, draw_words
from .properties import OVERRIDABLE, overridable
from .query import Water, first_ocean

LEAST_FOOTPRINT_M = 0.05  # narrower, and single precision shows in the tilt
SAMPLES = 9  # a side of the footprint
MOST_LEAN = 0.45  # the slope of what floats in a shot (core/evaluate/object_place.cpp)
GRID = np.stack(np.meshgrid(*2 * [np.linspace(-0.5, 0.5, SAMPLES)]), -1).reshape(-1, 2)


def _is_ocean(_settings, obj):
    return ocean.is_ocean(obj)


def _changed(settings, _context):
    settings.id_data.update_tag()  # follow_updates() sees it


def _switched(settings, context):
    if settings.enabled == settings.keeps_own:  # set to what it was: its delta transforms are the water's, or nobody's
        return
    settings.keeps_own = settings.enabled
    obj = settings.id_data
    for own, delta in OWN.items():
        if settings.enabled:
            setattr(settings, own, getattr(obj, delta))
        else:
            setattr(obj, delta, getattr(settings, own))
    _changed(settings, context)


# An object's own delta transforms, which come back when it floats no more.
OWN = {"own_location": "delta_location", "own_rotation": "delta_rotation_euler",
       "own_quaternion": "delta_rotation_quaternion"}


@overridable
class PELAGIC_PG_float(bpy.types.PropertyGroup):
    enabled: BoolProperty(name="Floating", update=_switched,
                          description="The object follows the water: place it as it lies in calm water")
    ocean: PointerProperty(type=bpy.types.Object, name="Ocean", poll=_is_ocean, update=_changed,
                           description="The ocean it floats in; empty: the scene's first")
    by_hand: BoolProperty(name="Size by Hand", update=_changed,
                          description="Length and width on the water instead of those of the object's box")
    length: FloatProperty(name="Length", default=1.0, min=0.0, soft_max=100.0, unit="LENGTH", update=_changed,
                          description="Along the object's x axis, on the water")
    width: FloatProperty(name="Width", default=1.0, min=0.0, soft_max=100.0, unit="LENGTH", update=_changed,
                         description="Along the object's y axis, on the water")
    damping: FloatProperty(name="Damping", default=1.0, min=0.0, soft_max=4.0, update=_changed,
                           description="How many times its own size the water is averaged over: 0 follows every "
                                       "ripple, 1 is a raft, more a heavy hull")
    tilt: FloatProperty(name="Tilt", default=1.0, min=0.0, soft_max=1.0, update=_changed,
                        description="How much of the water's slope it takes: 0 stays upright, 1 lies on the water")
    drift: FloatProperty(name="Drift", default=1.0, min=0.0, soft_max=1.0, update=_changed,
                         description="How much it goes to and fro with the water: 0 keeps its place on the map, 1 goes "
                                     "as a cork does")
    keeps_own: BoolProperty(options={"HIDDEN"})
    own_location: FloatVectorProperty(size=3, subtype="TRANSLATION", options={"HIDDEN"})
    own_rotation: FloatVectorProperty(size=3, subtype="EULER", options={"HIDDEN"})
    own_quaternion: FloatVectorProperty(size=4, subtype="QUATERNION", options={"HIDDEN"}, default=(1, 0, 0, 0))


# ---- What the water does to an object


def ride(water, rest, size, settings):
    """The movement from where the object is in calm water to where it is now: a 4 × 4 matrix. `rest`, the object's
    matrix in calm water, and the movement are in the ocean's coordinates; size: length and width [m]."""
    heading = np.array(rest.col[0].xy)
    length = np.linalg.norm(heading)
    heading = heading / length if length > 1e-9 else np.array((1.0, 0.0))  # else it stands on its end
    axes = np.array((heading, (-heading[1], heading[0])))
    offsets = GRID * np.maximum(np.array(size) * settings.damping, LEAST_FOOTPRINT_M)
    places = offsets @ axes + rest.translation.xy
    shift = np.zeros(2)
    if settings.drift > 0.0:
        shift = settings.drift * (water.carried(places)[:, :2] - places).mean(0)
    # The plane that fits best, by least squares: the offsets are symmetric and their products sum to nothing.
    heights = water.heights(places + shift)
    slopes = settings.tilt * (heights @ offsets / (offsets**2).sum(0)) @ axes
    tilt = Vector((0, 0, 1)).rotation_difference(Vector((-slopes[0], -slopes[1], 1.0))).to_matrix().to_4x4()
    place = rest.translation
    return (Matrix.Translation((place.x + shift[0], place.y + shift[1], place.z + heights.mean())) @ tilt
            @ Matrix.Translation(-place))


def ride_as_body(water, rest, box):
    """The same of an object in the sea's light, as a shot has it (core/evaluate/object_place.cpp): it lies on the plane through the water at 15
    places of its own box, in waves about as long as it is. box: the least and the most of it along its x axis, as seen from above, and to port."""
    heading = np.array(rest.col[0].xy)
    length = np.linalg.norm(heading)
    heading = heading / length if length > 1e-6 else np.array((1.0, 0.0))
    axes = np.array((heading, (-heading[1], heading[0])))
    least, size = box[0], box[1] - box[0]
    along, across = ((np.arange(count) + 0.5) / count for count in ((5, 3) if size[0] >= size[1] else (3, 5)))
    places = least + size * np.stack(np.meshgrid(along, across), -1).reshape(-1, 2)
    place = np.array(rest.translation, float)
    points = water.carried(places @ axes, tuple(place[:2]), float(size.max() / 3.0))
    rows = np.column_stack((np.ones(len(points)), points[:, :2] @ axes.T))
    sums = rows.T @ rows + np.diag((0.0, 1e-9, 1e-9))  # points in one line have no slope across it
    height, *slopes = np.linalg.solve(sums, rows.T @ points[:, 2])
    slopes = np.clip(slopes, -MOST_LEAN, MOST_LEAN) @ axes
    up = Vector((-slopes[0], -slopes[1], 1.0)).normalized()
    tilt = Vector((0, 0, 1)).rotation_difference(up).to_matrix().to_4x4()
    return Matrix.Translation(Vector((*place[:2], height)) + rest.translation.z * up) @ tilt @ Matrix.Translation(-rest.translation)


def _box(obj, rest, depsgraph):
    """Of ride_as_body(): of the object and what is parented to it, as the mesh that a shot has (in_light.py)."""
    heading = rest.col[0].xy
    turn = Matrix.Rotation(-math.atan2(heading.y, heading.x), 4, "Z") if heading.length > 1e-6 * rest.col[0].length else Matrix()
    from_world = turn @ rest.to_3x3().to_4x4() @ obj.evaluated_get(depsgraph).matrix_world.inverted_safe()
    parts = [part.evaluated_get(depsgraph) for part in bodies.members(obj, lambda other: other.pelagic_in_light.enabled)
             if part.type in bodies.SHAPES]
    corners = np.array([(from_world @ part.matrix_world @ Vector(corner)).xy[:] for part in parts for corner in part.bound_box] or [(0.0, 0.0)])
    return np.array((corners.min(0), corners.max(0)))


def footprint(obj, settings):
    """Length and width on the water in the object's own units, along its x and y axes."""
    corners = np.array(obj.bound_box)
    return (corners.max(0) - corners.min(0))[:2]


def _rotation(obj):
    if obj.rotation_mode == "QUATERNION":
        return obj.rotation_quaternion.to_matrix()
    if obj.rotation_mode == "AXIS_ANGLE":
        angle, *axis = obj.rotation_axis_angle
        return Matrix.Rotation(angle, 3, axis)
    return obj.rotation_euler.to_matrix()


def _euler_order(obj):
    return "XYZ" if obj.rotation_mode in ("QUATERNION", "AXIS_ANGLE") else obj.rotation_mode


def _frame_of(obj):
    """What leads from the object's own transforms to the world: its parent, and constraints that add to them."""
    if obj.constraints or (obj.parent and obj.parent_type != "OBJECT"):
        return obj.matrix_world @ obj.matrix_basis.inverted_safe()
    return obj.parent.matrix_world @ obj.matrix_parent_inverse if obj.parent else Matrix()


def _own_rotation(obj):
    """Of its own delta transforms."""
    settings = obj.pelagic_float
    return (settings.own_quaternion if obj.rotation_mode == "QUATERNION" else Euler(settings.own_rotation, _euler_order(obj))).to_matrix()


def _calm(evaluated):
    """A floating object's transform as it lies in calm water, in what _frame_of() leads from."""
    place = evaluated.location + Vector(evaluated.pelagic_float.own_location)
    return Matrix.LocRotScale(place, _own_rotation(evaluated) @ _rotation(evaluated), evaluated.scale * evaluated.delta_scale)


def calm_matrix(obj, depsgraph):
    """Where an object would be in calm water: its matrix in the world. Of one that doesn't float, nor what it is parented to, where it is."""
    evaluated = obj.evaluated_get(depsgraph)
    if obj.pelagic_float.enabled and not is_on_board(obj):
        return _frame_of(evaluated) @ _calm(evaluated)
    if is_on_board(obj):
        return calm_matrix(obj.parent, depsgraph) @ obj.parent.evaluated_get(depsgraph).matrix_world.inverted_safe() @ evaluated.matrix_world
    return evaluated.matrix_world.copy()


def is_afloat(obj):
    """Whether it floats, or what it is parented to does."""
    return obj.pelagic_float.enabled or is_on_board(obj)


def _follow(obj, water, depsgraph):
    """Sets the object's delta transforms. Only where they change: each change is another evaluation."""
    evaluated = obj.evaluated_get(depsgraph)
    settings, own_rotation, calm = evaluated.pelagic_float, _own_rotation(evaluated), _calm(evaluated)
    place = calm.translation
    parent_to_sea = water.matrix.inverted_safe() @ _frame_of(evaluated)
    rest = parent_to_sea @ calm
    if obj.pelagic_in_light.enabled:
        moved = ride_as_body(water, rest, _box(obj, rest, depsgraph))
    elif settings.by_hand:
        moved = ride(water, rest, np.array((settings.length, settings.width)) / water.matrix.median_scale, settings)
    else:
        moved = ride(water, rest, footprint(evaluated, settings) * [rest.col[0].length, rest.col[1].length], settings)
    moved = parent_to_sea.inverted_safe() @ moved @ parent_to_sea
    rotation = moved.to_3x3().normalized() @ own_rotation
    deltas = {"delta_location": moved @ place - evaluated.location}
    if obj.rotation_mode == "QUATERNION":
        deltas["delta_rotation_quaternion"] = rotation.to_quaternion()
    elif obj.rotation_mode != "AXIS_ANGLE":  # which Blender has no delta for
        deltas["delta_rotation_euler"] = rotation.to_euler(obj.rotation_mode)
    for name, value in deltas.items():
        if getattr(obj, name) != value:
            setattr(obj, name, value)


def floats(bpy_scene):
    """The scene's floating objects. What is parented to one goes with it, and doesn't float by itself."""
    return [obj for obj in bpy_scene.objects if obj.pelagic_float.enabled and not is_on_board(obj)]


def is_on_board(obj):
    while obj := obj.parent:
        if obj.pelagic_float.enabled:
            return True
    return False


def follow(bpy_scene, depsgraph):
    """Puts the scene's floating objects on the water of the depsgraph's frame."""
    waters = {}
    objects = floats(bpy_scene)
    first = first_ocean(bpy_scene) if objects else None
    for obj in objects:
        chosen = obj.pelagic_float.ocean
        sea = chosen if ocean.is_ocean(chosen) and chosen.users_scene else first  # released or deleted, it is none
        if sea is None:
            continue
        if sea not in waters:
            try:
                waters[sea] = Water(sea, bpy_scene, depsgraph)
            except LookupError:
                waters[sea] = None  # still being built: it stays where it is until then
        if waters[sea]:
            _follow(obj, waters[sea], depsgraph)


@persistent
def follow_frame(bpy_scene, depsgraph):
    follow(bpy_scene, depsgraph)


@persistent
def follow_updates(bpy_scene, depsgraph):
    """Somebody moved a floating object, or the water changed."""
    if any(isinstance(update.id, (bpy.types.Object, bpy.types.Mesh)) for update in depsgraph.updates):
        follow(bpy_scene, depsgraph)


@persistent
def follow_data(*_):
    """Another file, undo, redo."""
    follow(bpy.context.scene, bpy.context.evaluated_depsgraph_get())


HANDLERS = (("frame_change_post", follow_frame), ("depsgraph_update_post", follow_updates), ("undo_post", follow_data),
            ("redo_post", follow_data), ("load_post", follow_data))


# ---- Operators and panels


class PELAGIC_OT_float(bpy.types.Operator):
    """Let the selected objects float, or let them float no more"""

    bl_idname = "pelagic.float"
    bl_label = "Float"
    bl_options = {"REGISTER", "UNDO"}

    enabled: BoolProperty(name="Floating", default=True)

    @classmethod
    def poll(cls, context):
        return any(_can_float(obj) for obj in context.selected_objects)

    def execute(self, context):
        for obj in filter(_can_float, context.selected_objects):
            obj.pelagic_float.enabled = self.enabled
            if self.enabled and obj.rotation_mode == "AXIS_ANGLE":
                self.report({"WARNING"}, f"{obj.name}: with its rotation as axis and angle it rises and drifts, but "
                                         "can't tilt")
        return {"FINISHED"}


def _can_float(obj):
    return obj is not None and not ocean.is_ocean(obj) and obj.type not in {"LIGHT", "LIGHT_PROBE"}


class FloatPanel:
    bl_label = "Floating"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return _can_float(context.object)

    def draw_header(self, context):
        self.layout.prop(context.object.pelagic_float, "enabled", text="")

    def draw(self, context):
        settings, layout = context.object.pelagic_float, self.layout
        layout.use_property_split = True
        layout.active = settings.enabled
        if settings.enabled and not settings.ocean and first_ocean(context.scene) is None:
            layout.label(text="There is no ocean in this scene", icon="INFO")
        layout.prop(settings, "ocean")
        if context.object.pelagic_in_light.enabled:
            draw_words(layout, "In the sea's light it floats as in a shot: by its own size, in its place")
            return
        for name in ("damping", "tilt", "drift", "by_hand"):
            layout.prop(settings, name)
        if settings.by_hand:
            layout.prop(settings, "length")
            layout.prop(settings, "width")


CLASSES = (PELAGIC_PG_float, PELAGIC_OT_float,
           *(type(f"PELAGIC_PT_{where}_float", (FloatPanel, bpy.types.Panel), dict(place))
             for where, place in PLACES.items()))


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic_float = PointerProperty(type=PELAGIC_PG_float, name="Floating", override=OVERRIDABLE)
    if pelagic is not None:
        handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
    del bpy.types.Object.pelagic_float
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
