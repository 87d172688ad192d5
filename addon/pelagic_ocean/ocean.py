# SPDX-License-Identifier: GPL-3.0-or-later
"""An ocean: an object with settings, and the pelagic.Scene that they describe."""

import math
import re
from dataclasses import dataclass
from pathlib import Path

import bpy
from mathutils import Vector

from . import compat
from .cages import cage_of
from .module import pelagic
from .properties import BUDGETS, BY_PATH, FIELDS, TABLES, VERSION, counts, entry_fields, number_of, shortest_for, word_before

NO_MODULE = "Pelagic's compiled module isn't there"


def is_ocean(obj):
    return obj is not None and obj.type == "MESH" and obj.pelagic.is_ocean


def oceans():
    """Every ocean of the file; of those that share a mesh the first by name comes first, and drives it."""
    return [obj for obj in bpy.data.objects if is_ocean(obj)]


# ---- Settings


def settings_of(obj):
    """The values of all keys that an ocean has properties for, in the order of FIELDS. They can be compared."""
    settings = obj.pelagic
    groups = {table: getattr(settings, table) for table in TABLES}
    return tuple(field.read(groups[field.table]) if counts(field, settings) else field.key["default"] for field in FIELDS)


def clean_name(name):
    """A name that a shot may have: letters, digits, _ and -."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_")[:200] or "sea"


def frame_rate(bpy_scene):
    render = bpy_scene.render
    return shortest_for(render.fps / render.fps_base, lambda fps: render.fps / fps, render.fps_base)


def check_frames(bpy_scene):
    """ValueError where Blender stretches the scene's time: the sea that plays follows that, and a shot's frames can't."""
    old, new = bpy_scene.render.frame_map_old, bpy_scene.render.frame_map_new
    if old != new:
        raise ValueError(f"The scene's time is stretched from {old} to {new}, which frames of a shot and keyframes don't follow: set both alike "
                         "(Output, Frame Range, Time Stretching). The ocean's own Time scale makes the sea slower or faster")


def unit_warning(obj, bpy_scene):
    """What is wrong with the size of a sea where a Blender unit isn't a metre, in words; "" where it is right."""
    units = bpy_scene.unit_settings
    scale = 1.0 if units.system == "NONE" else units.scale_length
    if abs(obj.matrix_world.median_scale * scale - 1.0) < 1e-3 or abs(scale - 1.0) < 1e-6:
        return ""
    return (f"A metre of the sea is one Blender unit, and this scene's Unit Scale is {scale:g}: what should be 100 m long is "
            f"{100 * scale:g} m. Set the Unit Scale to 1 (Scene, Units), or the ocean's own scale to {1 / scale:g}: the camera and what "
            "floats fit then; See Through, volumes and the material's Detail Distance don't")


def _on_disk(path):
    """An absolute path of one that Blender shows, whose // is the .blend's folder. Words stay words."""
    return bpy.path.abspath(path) if path.startswith("//") else path


def _with_settings(settings, obj, depsgraph):
    scene = pelagic.Scene()
    values = {field.path: value for field, value in zip(FIELDS, settings)}
    if values["sea.spectrum"] == "file":
        scene.sea = _measured(values).sea
    if values["surface.kind"] == "cage":
        scene.surface.cage = cage_of(obj, values["surface.cage_file"] or "", depsgraph)
    for path in ("sea.spectrum_file", "sea.spectrum_time", "surface.cage_file"):
        del values[path]
    for path, value in values.items():
        key = BY_PATH[path].key
        if key["type"] == "entries":
            fields = entry_fields(BY_PATH[path])
            value = [getattr(pelagic, key["entry"])(*(_on_disk(each) if field.is_path and each else each
                                                      for field, each in zip(fields, entry))) for entry in value]
        elif BY_PATH[path].is_path:
            value = _on_disk(value)
        setattr(getattr(scene, BY_PATH[path].table), key["name"], value)
    return scene


def files_of(settings):
    """The files that settings name, as they are on disk: (path, time, bytes), None for those of one that isn't there."""
    named = []
    for field, value in zip(FIELDS, settings):
        if field.is_path:
            named.append(value if value != field.key["default"] else "")  # a word
        elif field.key["type"] == "entries":
            places = [place for place, inner in enumerate(entry_fields(field)) if inner.is_path]
            named += [entry[place] for entry in value for place in places]
    return tuple((path, *_state_of(path)) for path in map(_on_disk, filter(None, named)))


def _state_of(path):
    try:
        state = Path(path).stat()
    except (OSError, ValueError):
        return None, None
    return state.st_mtime_ns, state.st_size


_settled = {}  # settings, and what else counts, → settings, or the words that refuse them
NOT_CHOSEN = ("planet", "near-far")  # surfaces that are baked alone: their budget is the bake's


def settled(settings, obj, bpy_scene, depsgraph=None):
    """The settings that a budget among them asks for, and no budget any more; without one they stay. Of a camera's grid
    they are those of the camera as it is when they are first asked for. ValueError where nothing holds the budget."""
    values = {field.path: value for field, value in zip(FIELDS, settings)}
    if all(values[path] is None for path in BUDGETS):
        return settings
    kind = values["surface.kind"]
    if obj.pelagic.own_mesh or kind in NOT_CHOSEN or (kind, values["surface.cage_level"]) == ("cage", "adaptive"):
        return tuple(None if field.path in BUDGETS else value for field, value in zip(FIELDS, settings))
    cage = kind == "cage" and cage_of(obj, values["surface.cage_file"] or "", depsgraph)
    render = bpy_scene.render
    key = (settings, cage.content if cage else "", frame_rate(bpy_scene), render.resolution_x, render.resolution_y,
           render.resolution_percentage, files_of(settings))
    if key not in _settled:
        if len(_settled) > 64:
            _settled.clear()
        scene = scene_of(obj, bpy_scene, depsgraph, settings)
        try:
            scene = scene.settled()
        except ValueError as error:  # asked for once, not at every frame
            _settled[key] = str(error)
        else:
            for path in (*BUDGETS, "quality.level", "surface.resolution", "surface.cell_px", "surface.cage_level"):
                values[path] = getattr(getattr(scene, BY_PATH[path].table), BY_PATH[path].name)
            _settled[key] = tuple(values[field.path] for field in FIELDS)
    if isinstance(_settled[key], str):
        raise ValueError(_settled[key])
    return _settled[key]


HOUR = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?(Z|[+-]\d\d:\d\d)")


def _measured(values):
    """A scene with a buoy's hour in it. ShotError if the file or the hour isn't given, or isn't there."""
    file, hour = _on_disk(values["sea.spectrum_file"] or ""), values["sea.spectrum_time"]
    if hour and not HOUR.fullmatch(hour):
        raise ValueError(f"sea.spectrum_time = {hour}: accepted: {BY_PATH['sea.spectrum_time'].key['accepted']}")
    lines = ["[sea]", 'spectrum = "file"']
    lines += [f"spectrum_file = '{Path(file).name}'"] if file else []
    lines += [f"spectrum_time = {hour}"] if hour else []
    return pelagic.Scene.from_text("\n".join(lines), Path(file).absolute().parent)


def scene_of(obj, bpy_scene, depsgraph=None, settings=None):
    """What the object's settings and the Blender scene describe, as a pelagic.Scene; the camera is that of the current
    frame, in the ocean's own coordinates. With a depsgraph everything is as evaluated there. settings: those of
    settings_of(), if known. pelagic.ShotError for what the core refuses."""
    if pelagic is None:
        raise RuntimeError(NO_MODULE)
    settings = settings or settings_of(obj.evaluated_get(depsgraph) if depsgraph else obj)
    scene = _with_settings(settings, obj, depsgraph)
    scene.shot.name = clean_name(obj.name)
    scene.shot.frames = (bpy_scene.frame_start, bpy_scene.frame_end)
    scene.shot.fps = frame_rate(bpy_scene)
    pinhole = pinhole_of(obj, bpy_scene, depsgraph)
    if pinhole is not None:
        pinhole.put_in(scene)
    return scene


LOOK_AHEAD_M = 100.0  # where along its axis a camera's look_at_m is
FARTHEST_M = 1e8  # a camera from an ocean: points of the sea go to 1e9 m. Who scales an ocean to nothing is as far
FOV_DEG = (1.0, 179.0)
NARROWEST_TAN, WIDEST_TAN = (math.tan(math.radians(angle / 2)) for angle in FOV_DEG)


def changing(scene, but=()):
    """What isn't animated, in words, "" if nothing: the keys whose numbers change over the shot, without those paths that are."""
    def changes(value):
        return isinstance(value, dict) or isinstance(value, tuple) and any(map(changes, value))

    paths = [key["path"] for key in pelagic.keys() if "." in key["path"] and key["path"] not in but
             and changes(getattr(getattr(scene, key["path"].split(".")[0]), key["name"]))]
    return f"Stays as at frame {scene.shot.frames[0]}, without the shot's keys: {', '.join(paths)}" if paths else ""


@dataclass(frozen=True)
class Pinhole:
    """A Blender camera as the core's: metres and axes in the ocean's own coordinates."""

    position_m: Vector
    right: Vector
    up: Vector
    forward: Vector
    tan_half_width: float
    resolution: tuple
    shift: tuple = (0.0, 0.0)  # of the picture's centre to the right and up, in half pictures

    def numbers(self):
        """All but the shift, as from_numbers() takes them."""
        return tuple(map(float, (*self.position_m, *self.right, *self.up, *self.forward, self.tan_half_width, *self.resolution)))

    @classmethod
    def from_numbers(cls, numbers):
        position_m, right, up, forward = (Vector(numbers[i:i + 3]) for i in range(0, 12, 3))
        return cls(position_m, right, up, forward, numbers[12], tuple(map(int, numbers[13:])))

    def view(self):
        """A pelagic.View that shows all that is seen, with pixels as large, and its axis in the middle."""
        across, along = (1 + abs(each) for each in self.shift)
        columns, rows = self.resolution
        return pelagic.View(position_m=tuple(self.position_m), right=tuple(self.right), up=tuple(self.up),
                            forward=tuple(self.forward), tan_half_width=min(self.tan_half_width * across, WIDEST_TAN),
                            resolution=(round(columns * across), round(rows * along)))

    def put_in(self, scene):
        """Makes it the scene's camera. A camera that is rolled is one key, because only keys can be."""
        table, frame = scene.camera, scene.shot.frames[0]
        table.position_m = tuple(self.position_m)
        table.look_at_m = tuple(self.position_m + LOOK_AHEAD_M * self.forward)
        table.fov_deg = math.degrees(2 * math.atan(self.tan_half_width))
        table.focal_length_mm, table.resolution = None, self.resolution
        columns, rows = self.resolution
        table.shift_x, table.shift_y = self.shift[0] / 2, self.shift[1] / 2 * rows / columns  # in widths
        roll_deg = self.roll_deg()
        if abs(roll_deg) > 1e-3:
            table.keys = [pelagic.CameraKey(frame, table.position_m, table.look_at_m, table.fov_deg, roll_deg)]

    def roll_deg(self):
        """About the line of sight; above 0 the right side goes down."""
        level = self.forward.cross(Vector((0, 0, 1)))
        if level.length < 1e-6:  # straight up or down: +y is up
            level = self.forward.cross(Vector((0, 1, 0)))
        level.normalize()
        return math.degrees(math.atan2(-self.right.dot(level.cross(self.forward)), self.right.dot(level)))


def pinhole_of(obj, bpy_scene, depsgraph=None):
    """The scene's camera as an ocean sees it, or None, as where the ocean is scaled to nothing. With a depsgraph as evaluated there."""
    camera = bpy_scene.camera
    if camera is None or camera.type != "CAMERA" or camera.data.type != "PERSP":
        return None
    if depsgraph is not None:
        camera, obj = camera.evaluated_get(depsgraph), obj.evaluated_get(depsgraph)
    pose = obj.matrix_world.inverted_safe() @ camera.matrix_world
    if not pose.translation.length < FARTHEST_M:
        return None
    forward = -pose.col[2].xyz.normalized()
    right = (pose.col[0].xyz - pose.col[0].xyz.dot(forward) * forward).normalized()
    corners = camera.data.view_frame(scene=bpy_scene)
    (left, lower), (right_end, upper) = ([end(corner[axis] for corner in corners) for axis in (0, 1)] for end in (min, max))
    tangent = (right_end - left) / (-2 * corners[0].z)
    shift = (right_end + left) / (right_end - left), (upper + lower) / (upper - lower)
    render = bpy_scene.render
    resolution = tuple(max(1, int(side * render.resolution_percentage / 100))
                       for side in (render.resolution_x, render.resolution_y))
    tangent = min(max(tangent, NARROWEST_TAN), WIDEST_TAN)
    return Pinhole(pose.translation, right, right.cross(forward), forward, tangent, resolution, shift)


def set_from(obj, scene):
    """The object's settings become the scene's. ValueError if a property can't hold a value, and nothing is changed."""
    values = [(field, getattr(getattr(scene, field.table), field.name)) for field in FIELDS]
    for field, value in values:
        field.check(value)
    for field, value in values:
        if field.is_path and value and value != field.key["default"]:
            value = str(Path(value).absolute())
        field.write(getattr(obj.pelagic, field.table), value)


# ---- Objects


def mark(obj):
    """Makes a mesh object an ocean."""
    obj.pelagic.version = VERSION
    obj.pelagic.is_ocean = True


def make(name, collection):
    """A new ocean with the default settings, its mesh still empty."""
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    mark(obj)
    collection.objects.link(obj)
    return obj


def select_only(context, obj):
    """The object is the only one that is selected, and active."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


def wants_velocity(obj, bpy_scene):
    """Whether the mesh has the attribute, of which motion blur is made."""
    return obj.pelagic.velocity or bpy_scene.render.use_motion_blur


def migrate(obj):
    """Brings settings of an older file to today's. A file without a number is of version 1."""
    if obj.pelagic.version >= VERSION:
        return
    if obj.pelagic.version < 2:  # each mesh had these, and somebody may use them
        for name in ("uv_map", "velocity"):
            if not obj.pelagic.is_property_set(name):
                setattr(obj.pelagic, name, True)
    # What nobody changed keeps the value of its time: before version 3 there were no editions, version 3 is the second one's.
    edition = 1 if obj.pelagic.version < 3 else 2
    for field in FIELDS if obj.pelagic.version < 4 else ():
        group = getattr(obj.pelagic, field.table)
        before = next((value for until, value in field.key["defaults_before"] if until > edition), None)
        if before is not None and not group.is_property_set(field.name):
            field.write(group, before)
    if obj.pelagic.version < 5:  # nobody's water became a volume by itself
        obj.pelagic.see_through_by_hand = True
    for field, group, path in _drop_downs(obj) if obj.pelagic.version < 7 else ():
        word = word_before(field, compat.stored(group, field.name))
        if word is not None:
            field.write(group, word)
        _migrate_drivers(obj, field, path)
    for field in FIELDS if obj.pelagic.version < 7 else ():  # names, as add_row() gives
        for number, row in enumerate(getattr(getattr(obj.pelagic, field.table), field.name) if field.key["type"] == "entries" else (), 1):
            row.name = str(number)
    if obj.pelagic.version < 7:
        _migrate_curves({path: field for field, _, path in _drop_downs(obj)})
    obj.pelagic.version = VERSION


def _drop_downs(obj):
    """Each that chooses a word of the core's: the field, the group of properties, the data path."""
    for field in FIELDS:
        group, path = getattr(obj.pelagic, field.table), f"pelagic.{field.path}"
        if field.key["type"] == "word":
            yield field, group, path
        for row, entry in enumerate(getattr(group, field.name) if field.key["type"] == "entries" else ()):
            yield from ((inner, entry, f"{path}[{row}].{inner.name}") for inner in entry_fields(field) if inner.key["type"] == "word")


def _migrate_curves(drop_downs):
    """Gives drop-downs' keyframes the words' numbers of today, in all actions: one may be in a track, or wait for an ocean. Those that have
    them stay. drop_downs: by data path."""
    for curve in compat.curves_of_actions():
        field = drop_downs.get(curve.data_path)
        for point in curve.keyframe_points if field else ():
            word = word_before(field, point.co.y)
            if word is not None:
                point.handle_left.y = point.handle_right.y = point.co.y = number_of(word)


def _migrate_drivers(obj, field, path):
    """Gives the numbers in the expression of a drop-down's driver the same way."""
    def today(found):
        word = word_before(field, int(found[0]))
        return found[0] if word is None else str(number_of(word))

    for curve in obj.animation_data.drivers if obj.animation_data else ():
        if curve.data_path == path:
            curve.driver.expression = re.sub(r"\b\d{5,}\b", today, curve.driver.expression)
