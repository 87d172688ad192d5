# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that change over the frames as a shot's keys, and back.

A sea that changes is planned for all of its keys, so what plays it has to know them beforehand: they are read from the F-curves of the
ocean's action. Light and look are those of each frame, and need no keys before a shot is written.
"""

import copy
import re
from dataclasses import dataclass

import bpy
import numpy as np

from . import compat
from .module import pelagic
from .properties import BY_PATH, FIELDS, PLACE, Field, entry_fields, shortest

# Of the range of a number's values: how far straight lines between its keys may leave its curve. Each key of the sea is a sea.
SEA_TOLERANCE, TOLERANCE = 0.02, 1e-3
MOST_FRAMES = 20000  # a longer curve is looked at so often
MOST_KEYS = 30  # of the sea: where a curve needs more, they leave it by more


@dataclass(frozen=True)
class Number:
    """A number that may have keys: a setting, or one of an entry in a list. Its F-curves' data path is "pelagic." + path."""

    path: str  # "sea.wind_speed_mps", "sea.swell[1].height_m"
    field: Field  # of the number
    setting: Field  # that, or the list
    row: int = 0
    column: int = -1  # -1: it is no entry's

    @property
    def is_of_sea(self):
        return self.setting.table in ("sea", "waves")

    def of(self, value):
        """The number in the setting's value."""
        return value if self.column < 0 else value[self.row][self.column]

    def group(self, obj):
        """The properties of an ocean that it is one of."""
        table = getattr(obj.pelagic, self.setting.table)
        return table if self.column < 0 else getattr(table, self.setting.name)[self.row]


SETTINGS = [field for field in FIELDS if field.key["may_have_keys"] or
            field.key["type"] == "entries" and any(inner.key["may_have_keys"] for inner in entry_fields(field))]


def numbers_in(field, value):
    """Those in a setting's value."""
    if field.key["type"] != "entries":
        return [Number(field.path, field, field)]
    return [Number(f"{field.path}[{row}].{inner.name}", inner, field, row, column) for row in range(len(value))
            for column, inner in enumerate(entry_fields(field)) if inner.key["may_have_keys"]]


def numbers_of(settings):
    return [number for field in SETTINGS for number in numbers_in(field, settings[PLACE[field.path]])]


def numbers_with_keys(shot):
    """[(a number, its keys)] of a pelagic.Scene."""
    found = []
    for field in SETTINGS:
        value = getattr(getattr(shot, field.table), field.name)
        found += [(number, number.of(value)) for number in numbers_in(field, value) if isinstance(number.of(value), dict)]
    return found


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
        numbers = numbers_in(field, values[0]) if field in SETTINGS and _are_alike(field, values) else []
        for number in numbers:
            frames, of_number, is_angle = list(settings), [number.of(value) for value in values], number.field.key["is_angle"]
            if any(value != of_number[0] for value in of_number):
                keys[number.path] = (keys_of_sea_through(frames, of_number, is_angle) if number.is_of_sea
                                     else keys_through(frames, of_number, TOLERANCE, is_angle))
        others += [field.path] if any(_without(numbers, value) != _without(numbers, values[0]) for value in values) else []
    return keys, others


def _are_alike(field, values):
    """Whether all have numbers where any has one: lists as many entries."""
    if field.key["type"] == "entries":
        return all(len(value) == len(values[0]) for value in values)
    return all(isinstance(value, float) for value in values)


def _without(numbers, value):
    if numbers and numbers[0].column < 0:
        return None
    columns = {number.column for number in numbers}
    return value if not numbers else [[each for column, each in enumerate(row) if column not in columns] for row in value]


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
    for number in numbers_of(settings):
        path, value = f"pelagic.{number.path}", number.of(settings[PLACE[number.setting.path]])
        curve = curves.get(path)
        if (not number.is_of_sea or curve is None or path in driven or curve.mute or curve.group and curve.group.mute
                or not isinstance(value, float) or np.isinf(value)):
            continue
        low, high = number.field.key["range"]  # that Blender keeps its properties in
        if not len(curve.keyframe_points) or abs(min(max(curve.evaluate(bpy_scene.frame_current_final), low), high) - value) > 1e-5 * abs(value):
            continue
        keys = _of_curve(curve, number, bpy_scene)
        if isinstance(keys, dict):
            found[number.path] = keys
    return found


def _of_curve(curve, number, bpy_scene):
    ends = [curve.keyframe_points[end].co.x for end in (0, -1)]
    if curve.modifiers or curve.extrapolation == "LINEAR":  # it goes on beyond them
        ends = min(ends[0], bpy_scene.frame_start), max(ends[1], bpy_scene.frame_end)
    first, last = int(np.floor(ends[0])), int(np.ceil(ends[1]))
    frames = np.unique(np.linspace(first, last, min(last - first + 1, MOST_FRAMES)).astype(int))
    values = np.clip([curve.evaluate(frame) for frame in frames.tolist()], *number.field.key["range"])
    made_of = number.path, first, last, values.tobytes()
    if made_of not in _read:
        if len(_read) > 64:
            _read.clear()
        _read[made_of] = keys_of_sea_through(frames, values, number.field.key["is_angle"])
    return _read[made_of]


ENTRY = re.compile(r"(.+)\[(\d+)\]\.(.+)")  # of a list: its path, the row, the number's name


def put(scene, keys):
    """A pelagic.Scene with these keys, {path: keys}; itself without any."""
    if not keys:
        return scene
    made = copy.copy(scene)
    for path, each in keys.items():
        entry = ENTRY.fullmatch(path)
        field = BY_PATH[entry[1] if entry else path]
        table = getattr(made, field.table)
        if entry:
            rows = list(getattr(table, field.name))
            rows[int(entry[2])] = rows[int(entry[2])]._replace(**{entry[3]: each})
            each = rows
        setattr(table, field.name, each)
    return made


def with_numbers(settings, numbers):
    """These settings with others of their numbers, {path: number}."""
    settings = list(settings)
    for number in numbers_of(settings):
        if number.path not in numbers:
            continue
        place = PLACE[number.setting.path]
        if number.column < 0:
            settings[place] = numbers[number.path]
        else:
            rows = [list(row) for row in settings[place]]
            rows[number.row][number.column] = numbers[number.path]
            settings[place] = tuple(map(tuple, rows))
    return tuple(settings)


def of_numbers(settings, paths):
    """{path: number} of settings."""
    return {number.path: number.of(settings[PLACE[number.setting.path]]) for number in numbers_of(settings) if number.path in paths}


def remove_row(obj, path, row):
    """Takes what animates an entry of a list away with it, and leaves the later ones theirs. path: the list's, "sea.swell"."""
    for curves in (compat.curves(obj), obj.animation_data.drivers if obj.animation_data else []):
        for curve in list(curves):
            entry = ENTRY.fullmatch(curve.data_path)
            if entry is None or entry[1] != f"pelagic.{path}" or int(entry[2]) < row:
                continue
            if int(entry[2]) == row:
                curves.remove(curve)
            else:
                curve.data_path = f"{entry[1]}[{int(entry[2]) - 1}].{entry[3]}"


def keyframe(obj, shot):
    """Gives an ocean the F-curves of a shot's numbers that have keys."""
    for number, of_shot in numbers_with_keys(shot):
        def at(frame):
            scene = shot.at(frame)
            return number.of(getattr(getattr(scene, number.setting.table), number.setting.name))

        keys = dict(of_shot["keys"])
        is_smooth = of_shot["interpolation"] == "smooth"
        if is_smooth and len(keys) > 2:  # the core's curves, which aren't Blender's
            keys = {frame: at(frame) for frame in range(min(keys), max(keys) + 1)}
            is_smooth = False
        if number.field.key["is_angle"]:
            keys = dict(zip(keys, np.degrees(np.unwrap(np.radians(list(keys.values()))))))
        group, path = number.group(obj), f"pelagic.{number.path}"
        for frame, value in keys.items():
            number.field.write(group, shortest(float(value)))
            obj.keyframe_insert(path, frame=frame)
        curve = next(curve for curve in compat.curves(obj) if curve.data_path == path)
        for point in curve.keyframe_points:
            point.interpolation = "BEZIER" if is_smooth else "LINEAR"
        number.field.write(group, at(bpy.context.scene.frame_current))
