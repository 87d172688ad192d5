# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that change over the frames as a shot's keys, and back.

A sea that changes is planned for all of its keys, so what plays it has to know them beforehand: they are read from the F-curves of the
ocean's action. Light and look are those of each frame, and need no keys before a shot is written.
"""

import copy

import bpy
import numpy as np

from . import compat
from .module import pelagic
from .properties import BY_PATH, FIELDS, PLACE, shortest

# Of the range of a number's values: how far straight lines between its keys may leave its curve. Each key of the sea is a sea.
SEA_TOLERANCE, TOLERANCE = 0.02, 1e-3
MOST_FRAMES = 20000  # a longer curve is looked at so often
MOST_KEYS = 30  # of the sea: where a curve needs more, they leave it by more

MAY_HAVE_KEYS = [field for field in FIELDS if field.key["may_have_keys"]]
OF_SEA = [field for field in MAY_HAVE_KEYS if field.table in ("sea", "waves")]


def keys_of_sea_through(frames, values, is_angle):
    """keys_through() of a number of the sea: MOST_KEYS, but for an angle that turns so often that each half turn needs one."""
    tolerance = SEA_TOLERANCE
    while True:
        keys = keys_through(frames, values, tolerance, is_angle)
        if tolerance > 1.0 or not isinstance(keys, dict) or len(keys["keys"]) <= MOST_KEYS:
            return keys
        tolerance *= 1.5


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
    if (len(turns) > MOST_KEYS or np.abs(_gently(frames, values, turns) - values).max() > near
            or is_angle and np.abs(np.diff(values[turns])).max() >= 180.0):
        # From key to key the core turns an angle the short way: the long one has more of them.
        kept, how = sorted({turns[0], turns[-1], *_corners(frames, values, turns[0], turns[-1], near, 180.0 if is_angle else np.inf)}), "linear"
    return {"keys": tuple((int(frames[i]), _within(values[i], is_angle)) for i in kept), "interpolation": how}


def _within(value, is_angle):
    return shortest(float(value % 360.0 if is_angle else value))


def _gently(frames, values, turns):
    """Through these, standing still at each: as the core goes between keys where all of them are turns."""
    of = np.clip(np.searchsorted(turns, np.arange(len(frames)), "right") - 1, 0, len(turns) - 2)
    first, last = turns[of], turns[of + 1]
    t = np.clip((frames - frames[first]) / (frames[last] - frames[first]), 0.0, 1.0)
    return values[first] + t * t * (3.0 - 2.0 * t) * (values[last] - values[first])


def _corners(frames, values, first, last, near, most):
    """Indices between two at which straight lines have to turn, or which part them so that each changes by less than the most."""
    found, spans = [], [(first, last)]
    while spans:
        first, last = spans.pop()
        inside = slice(first + 1, last)
        line = np.interp(frames[inside], (frames[first], frames[last]), (values[first], values[last]))
        off = np.abs(values[inside] - line)
        is_off = off.size and off.max() > near
        if is_off or off.size and abs(values[last] - values[first]) >= most:
            middle = first + 1 + int(off.argmax()) if is_off else (first + last) // 2
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
            arguments = list(settings), values, field.key["is_angle"]
            keys[field.path] = keys_of_sea_through(*arguments) if field in OF_SEA else keys_through(*arguments[:2], TOLERANCE, arguments[2])
        else:
            others.append(field.path)
    return keys, others


_read = {}  # an F-curve's values → its keys


def keys_of_sea(obj, settings, bpy_scene):
    """{path: keys} of the sea's numbers that an original ocean's F-curves change. settings: as evaluated at the scene's frame. A
    number that something else has a say in (a driver, the NLA, who drags it) has none: the sea is then that of the frame."""
    animation = obj.animation_data
    if animation is None or animation.action is None or animation.use_nla and len(animation.nla_tracks):
        return {}
    curves = {curve.data_path: curve for curve in compat.curves(obj)}
    driven = {driver.data_path for driver in animation.drivers}
    found = {}
    for field in OF_SEA:
        path, value = f"pelagic.{field.table}.{field.name}", settings[PLACE[field.path]]
        curve = curves.get(path)
        if curve is None or path in driven or curve.mute or curve.group and curve.group.mute or not isinstance(value, float):
            continue
        low, high = field.key["range"]  # that Blender keeps its properties in
        if not len(curve.keyframe_points) or abs(min(max(curve.evaluate(bpy_scene.frame_current_final), low), high) - value) > 1e-5 * abs(value):
            continue
        keys = _of_curve(curve, field, bpy_scene)
        if isinstance(keys, dict):
            found[field.path] = keys
    return found


def _of_curve(curve, field, bpy_scene):
    ends = [curve.keyframe_points[end].co.x for end in (0, -1)]
    if curve.modifiers or curve.extrapolation == "LINEAR":  # it goes on beyond them
        ends = min(ends[0], bpy_scene.frame_start), max(ends[1], bpy_scene.frame_end)
    first, last = int(np.floor(ends[0])), int(np.ceil(ends[1]))
    frames = np.unique(np.linspace(first, last, min(last - first + 1, MOST_FRAMES)).astype(int))
    values = np.clip([curve.evaluate(frame) for frame in frames.tolist()], *field.key["range"])
    made_of = field.path, first, last, values.tobytes()
    if made_of not in _read:
        if len(_read) > 64:
            _read.clear()
        _read[made_of] = keys_of_sea_through(frames, values, field.key["is_angle"])
    return _read[made_of]


def put(scene, keys):
    """A pelagic.Scene with these keys, {path: keys}; itself without any."""
    if not keys:
        return scene
    made = copy.copy(scene)
    for path, each in keys.items():
        setattr(getattr(made, BY_PATH[path].table), BY_PATH[path].name, each)
    return made


def with_numbers(settings, numbers):
    """These settings with others of their numbers, {path: number}."""
    settings = list(settings)
    for path, number in numbers.items():
        settings[PLACE[path]] = number
    return tuple(settings)


def keyframe(obj, shot):
    """Gives an ocean the F-curves of a shot's numbers that have keys."""
    for field in MAY_HAVE_KEYS:
        number = getattr(getattr(shot, field.table), field.name)
        if not isinstance(number, dict):
            continue
        keys = dict(number["keys"])
        is_smooth = number["interpolation"] == "smooth"
        if is_smooth and len(keys) > 2:  # the core's curves, which aren't Blender's
            keys = {frame: getattr(getattr(shot.at(frame), field.table), field.name) for frame in range(min(keys), max(keys) + 1)}
            is_smooth = False
        if field.key["is_angle"]:
            keys = dict(zip(keys, np.degrees(np.unwrap(np.radians(list(keys.values()))))))
        group, path = getattr(obj.pelagic, field.table), f"pelagic.{field.table}.{field.name}"
        for frame, value in keys.items():
            field.write(group, shortest(float(value)))
            obj.keyframe_insert(path, frame=frame)
        curve = next(curve for curve in compat.curves(obj) if curve.data_path == path)
        for point in curve.keyframe_points:
            point.interpolation = "BEZIER" if is_smooth else "LINEAR"
        field.write(group, getattr(getattr(shot.at(bpy.context.scene.frame_current), field.table), field.name))
