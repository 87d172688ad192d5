# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that change over the frames as a shot's keys, and back.

A sea that changes is planned for all of its keys, so what plays it has to know them beforehand: they are read from the F-curves of the
ocean's action. Light and look are those of each frame, and need no keys before a shot is written.
"""

import bpy
import numpy as np

from . import compat
from .module import pelagic
from .properties import BY_PATH, FIELDS, PLACE, shortest

# Of the range of a number's values: how far straight lines between its keys may leave its curve. Each key of the sea is a sea.
SEA_TOLERANCE, TOLERANCE = 0.02, 1e-3
MOST_FRAMES = 20000  # a longer curve is looked at so often


def may_have_keys():
    return [field for field in FIELDS if field.key["may_have_keys"]]


def of_sea():
    return [field for field in may_have_keys() if field.table in ("sea", "waves")]


def keys_through(frames, values, tolerance, is_angle=False):
    """As few keys as leave the values, a number a frame, by no more than that share of their range: what a scene's key takes, or
    the number, where it is one."""
    frames, values = np.asarray(frames), np.asarray(values, float)
    if is_angle:
        values = np.degrees(np.unwrap(np.radians(values)))
    near = tolerance * np.ptp(values)
    if near == 0.0:
        return shortest(float(values[0]))
    rises = np.diff(values)
    rises = np.where(np.abs(rises) > 1e-6 * np.ptp(values), np.sign(rises), 0.0)
    turns = np.flatnonzero(np.diff(rises, prepend=0.0, append=0.0))  # where it begins to rise, to fall or to stay
    kept, how = turns, "smooth"
    if np.abs(_gently(frames, values, turns) - values).max() > near:
        kept, how = sorted({turns[0], turns[-1], *_corners(frames, values, turns[0], turns[-1], near)}), "linear"
    return {"keys": tuple((int(frames[i]), _within(values[i], is_angle)) for i in kept), "interpolation": how}


def _within(value, is_angle):
    return shortest(float(value % 360.0 if is_angle else value))


def _gently(frames, values, turns):
    """Through these, standing still at each: as the core goes between keys where all of them are turns."""
    of = np.clip(np.searchsorted(turns, np.arange(len(frames)), "right") - 1, 0, len(turns) - 2)
    first, last = turns[of], turns[of + 1]
    t = np.clip((frames - frames[first]) / (frames[last] - frames[first]), 0.0, 1.0)
    return values[first] + t * t * (3.0 - 2.0 * t) * (values[last] - values[first])


def _corners(frames, values, first, last, near):
    """Indices between two at which straight lines have to turn."""
    found, spans = [], [(first, last)]
    while spans:
        first, last = spans.pop()
        inside = slice(first + 1, last)
        line = np.interp(frames[inside], (frames[first], frames[last]), (values[first], values[last]))
        off = np.abs(values[inside] - line)
        if off.size and off.max() > near:
            middle = first + 1 + int(off.argmax())
            found.append(middle)
            spans += [(first, middle), (middle, last)]
    return found


def keys_of(settings):
    """Of settings by frame: {path: keys} of numbers that change and may have keys, and the paths of what else changes."""
    keys, others = {}, []
    for field, *values in zip(FIELDS, *settings.values()):
        if all(value == values[0] for value in values):
            continue
        if field.key["may_have_keys"] and all(isinstance(value, float) for value in values):
            tolerance = SEA_TOLERANCE if field in of_sea() else TOLERANCE
            keys[field.path] = keys_through(list(settings), values, tolerance, field.key["is_angle"])
        else:
            others.append(field.path)
    return keys, others


_read = {}  # what an F-curve is made of → its keys


def keys_of_sea(obj, settings, frame):
    """{path: keys} of the sea's numbers that an original ocean's F-curves change. settings: as evaluated at the frame. A number whose value isn't its curve's just now (a
    driver's, another action's, one that is being dragged) has none: the sea is then that of the frame."""
    if obj.animation_data is None or obj.animation_data.action is None:
        return {}
    curves = {curve.data_path: curve for curve in compat.curves(obj)}
    found = {}
    for field in of_sea():
        curve, value = curves.get(f"pelagic.{field.table}.{field.name}"), settings[PLACE[field.path]]
        if curve is None or curve.mute or not isinstance(value, float) or not len(curve.keyframe_points):
            continue
        if abs(curve.evaluate(frame) - value) <= 1e-5 * abs(value):
            keys = _of_curve(curve, field.key["is_angle"])
            if isinstance(keys, dict):
                found[field.path] = keys
    return found


def _of_curve(curve, is_angle):
    points = curve.keyframe_points
    numbers = np.empty((3, 2 * len(points)), np.float32)
    words = np.empty(len(points), np.int32)
    for row, name in zip(numbers, ("co", "handle_left", "handle_right")):
        points.foreach_get(name, row)
    points.foreach_get("interpolation", words)
    made_of = is_angle, numbers.tobytes(), words.tobytes(), curve.extrapolation, repr([modifier.type for modifier in curve.modifiers])
    if made_of not in _read or curve.modifiers:
        if len(_read) > 64:
            _read.clear()
        first, last = int(np.floor(numbers[0, 0])), int(np.ceil(numbers[0, -2]))
        if curve.modifiers or curve.extrapolation == "LINEAR":
            scene = bpy.context.scene
            first, last = min(first, scene.frame_start), max(last, scene.frame_end)
        frames = np.unique(np.linspace(first, last, min(last - first + 1, MOST_FRAMES)).astype(int))
        _read[made_of] = keys_through(frames, [curve.evaluate(frame) for frame in frames.tolist()], SEA_TOLERANCE, is_angle)
    return _read[made_of]


def put(scene, keys):
    """A pelagic.Scene with these keys, {path: keys}; itself without any."""
    if not keys:
        return scene
    made = scene.at(scene.shot.frames[0])
    for path, each in keys.items():
        setattr(getattr(made, BY_PATH[path].table), BY_PATH[path].name, each)
    return made


def with_first(settings, keys):
    """The settings at the first keys: the same at each frame."""
    settings = list(settings)
    for path, each in keys.items():
        settings[PLACE[path]] = each["keys"][0][1]
    return tuple(settings)


def with_numbers(settings, read, keys):
    """These settings with the numbers of a frame, as read there, in the keys' place."""
    settings = list(settings)
    for path in keys:
        settings[PLACE[path]] = read[PLACE[path]]
    return tuple(settings)


def keyframe(obj, shot):
    """Gives an ocean the F-curves of a shot's numbers that have keys."""
    for field in may_have_keys():
        number = getattr(getattr(shot, field.table), field.name)
        if not isinstance(number, dict):
            continue
        keys = dict(number["keys"])
        is_smooth = number["interpolation"] == "smooth"
        if len(keys) > 1 and (field.key["is_angle"] or is_smooth and len(keys) > 2):  # the core's curves, which aren't Blender's
            keys = {frame: getattr(getattr(shot.at(frame), field.table), field.name) for frame in range(min(keys), max(keys) + 1)}
            is_smooth = False
        group, path = getattr(obj.pelagic, field.table), f"pelagic.{field.table}.{field.name}"
        for frame, value in keys.items():
            field.write(group, value)
            obj.keyframe_insert(path, frame=frame)
        curve = next(curve for curve in compat.curves(obj) if curve.data_path == path)
        for point in curve.keyframe_points:
            point.interpolation = "BEZIER" if is_smooth else "LINEAR"
        field.write(group, getattr(getattr(shot.at(bpy.context.scene.frame_current), field.table), field.name))
