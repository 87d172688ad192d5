# SPDX-License-Identifier: GPL-3.0-or-later
"""An ocean: an object with settings, and the pelagic.Scene that they describe."""

import math
import re
from pathlib import Path

import bpy
from mathutils import Vector

from .module import pelagic
from .properties import BY_PATH, FIELDS, VERSION

NO_MODULE = "Pelagic's compiled module isn't there"


def is_ocean(obj):
    return obj is not None and obj.type == "MESH" and obj.pelagic.is_ocean


def oceans():
    """Every ocean of the file; of those that share a mesh the first by name comes first, and drives it."""
    return [obj for obj in bpy.data.objects if is_ocean(obj)]


# ---- Settings


def settings_of(obj):
    """The values of all keys that an ocean has properties for, in the order of FIELDS. They can be compared."""
    groups = {}
    return tuple(field.read(groups.get(field.table) or groups.setdefault(field.table, getattr(obj.pelagic, field.table)))
                 for field in FIELDS)


def clean_name(name):
    """A name that a shot may have: letters, digits, _ and -."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_")[:200] or "sea"


def frame_rate(bpy_scene):
    return bpy_scene.render.fps / bpy_scene.render.fps_base


def _on_disk(path):
    """An absolute path of one that Blender shows, whose // is the .blend's folder. Words stay words."""
    return bpy.path.abspath(path) if path.startswith("//") else path


def _with_settings(settings):
    scene = pelagic.Scene()
    values = {field.path: value for field, value in zip(FIELDS, settings)}
    if values["sea.spectrum"] == "file":
        scene.sea = _measured(values).sea
    for path in ("sea.spectrum_file", "sea.spectrum_time"):
        del values[path]
    for path, value in values.items():
        key = BY_PATH[path].key
        if key["type"] == "entries":
            value = [getattr(pelagic, key["entry"])(*entry) for entry in value]
        elif key["type"] == "text":
            value = _on_disk(value)
        setattr(getattr(scene, BY_PATH[path].table), key["name"], value)
    return scene


def _measured(values):
    """A scene with a buoy's hour in it. ShotError if the file or the hour isn't given, or isn't there."""
    file, hour = _on_disk(values["sea.spectrum_file"] or ""), values["sea.spectrum_time"]
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
    if depsgraph is not None:
        obj = obj.evaluated_get(depsgraph)
    scene = _with_settings(settings or settings_of(obj))
    scene.shot.name = clean_name(obj.name)
    scene.shot.frames = (bpy_scene.frame_start, bpy_scene.frame_end)
    scene.shot.fps = frame_rate(bpy_scene)
    camera = bpy_scene.camera
    if camera is not None and camera.type == "CAMERA":
        set_camera(scene, camera.evaluated_get(depsgraph) if depsgraph else camera, obj, bpy_scene)
    return scene


LOOK_AHEAD_M = 100.0  # where along its axis a camera's look_at_m is


def set_camera(scene, camera, obj, bpy_scene):
    """The Blender camera's pose and angle of view in the scene, as seen by the ocean."""
    pose = obj.matrix_world.inverted_safe() @ camera.matrix_world
    ahead = (pose.to_3x3() @ Vector((0, 0, -1))).normalized()
    scene.camera.position_m = tuple(pose.translation)
    scene.camera.look_at_m = tuple(pose.translation + LOOK_AHEAD_M * ahead)
    if camera.data.type == "PERSP":
        corners = camera.data.view_frame(scene=bpy_scene)
        width = max(corner.x for corner in corners) - min(corner.x for corner in corners)
        angle = math.degrees(2 * math.atan2(0.5 * width, -corners[0].z))
        low, high = 1.0, 179.0
        scene.camera.fov_deg = min(max(angle, low), high)
    render = bpy_scene.render
    scale = render.resolution_percentage / 100
    scene.camera.resolution = (max(1, int(render.resolution_x * scale)), max(1, int(render.resolution_y * scale)))


def set_from(obj, scene):
    """The object's settings become the scene's. ValueError if a property can't hold a value, and nothing is changed."""
    values = [(field, getattr(getattr(scene, field.table), field.name)) for field in FIELDS]
    for field, value in values:
        field.check(value)
    for field, value in values:
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


def migrate(obj):
    """Brings settings of an older file to today's. There is one version so far: a file without a number is of it."""
    if obj.pelagic.version < VERSION:
        obj.pelagic.version = VERSION
