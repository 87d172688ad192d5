# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways over the sea as a shot has them, "frame east north, frame east north, …": as few keys as hold a way that Blender animates."""

import bpy
import numpy as np

from . import camera, floating, ocean, query
from .operators import NeedsModule
from .properties import add_row

ERROR_M, ERROR_DEG = 0.01, 0.3  # what a smooth path may be off between its keys
LEAST_STEP_M = 1e-4  # in a frame, or in a tenth of one: what is slower has no course
MOST_KEYS = 900  # of the core's 1000


def smooth(keys, frames):
    """Where a smooth path of the core's (core/scene/course.h) is: keys (k, 3) of frame and place, frames (n,) within; (n, 2)."""
    times, places = keys[:, 0], keys[:, 1:]
    if len(keys) == 1:
        return np.repeat(places, len(frames), 0)
    steps = np.diff(times)
    chords = np.diff(places, axis=0) / steps[:, None]
    speeds = np.concatenate((chords[:1], chords[:-1], chords[-1:]))
    share = (steps[:-1] / (steps[:-1] + steps[1:]))[:, None]
    speeds[1:-1] += share * (chords[1:] - chords[:-1])  # the parabola's through three keys
    at = np.clip(np.searchsorted(times, frames, "right") - 1, 0, len(keys) - 2)
    step = steps[at, None]
    t = ((frames - times[at]) / steps[at])[:, None]
    u = 1.0 - t
    return (u * u * ((1 + 2 * t) * places[at] + t * step * speeds[at])
            + t * t * ((3 - 2 * t) * places[at + 1] - u * step * speeds[at + 1]))


def _headings(places):
    """Of steps (n, 2) as complex numbers of length 1; 0 where there is none to speak of."""
    steps = places[:, 0] + 1j * places[:, 1]
    lengths = np.abs(steps)
    return np.where(lengths > LEAST_STEP_M, steps / np.maximum(lengths, LEAST_STEP_M), 0.0)


def keys_through(way):
    """Of a way, rows of frame, east and north by rising frames, those that a smooth path needs that leaves it by ERROR_M, and its course by
    ERROR_DEG, at most; as many as it may have where it takes more."""
    way = np.asarray(way, float)
    frames = way[:, 0]
    if np.abs(way[:, 1:] - way[0, 1:]).max() == 0.0:
        return way[:1]
    middles = 0.5 * (frames[1:] + frames[:-1])
    wanted = _headings(np.diff(way[:, 1:], axis=0))
    kept = {0, len(way) - 1}
    while True:
        keys = sorted(kept)
        off = np.hypot(*(smooth(way[keys], frames) - way[:, 1:]).T)
        goes = _headings(smooth(way[keys], middles + 0.05) - smooth(way[keys], middles - 0.05))
        turned = np.abs(np.angle(goes * np.conj(wanted))) > np.radians(ERROR_DEG)
        worse = set()
        for first, last in zip(keys, keys[1:]):
            if last - first < 2:
                continue
            if off[first + 1:last].max() > ERROR_M:
                worse.add(first + 1 + int(off[first + 1:last].argmax()))
            elif turned[first:last].any():
                worse.add((first + last) // 2)
        if not worse or len(kept) + len(worse) > MOST_KEYS:
            return way[keys]
        kept |= worse


def text(keys):
    return ", ".join(f"{frame:.9g} {east:.9g} {north:.9g}" for frame, east, north in keys)


class PELAGIC_OT_make_wake(NeedsModule, bpy.types.Operator):
    """Let the active object leave a wake: its movement in the scene's frames becomes the path of a vessel of the ocean"""

    bl_idname = "pelagic.make_wake"
    bl_label = "Make Wake"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object is not None and not ocean.is_ocean(context.object) \
            and query.first_ocean(context.scene) is not None

    def execute(self, context):
        vessel, sea = context.object, query.first_ocean(context.scene)
        try:
            ocean.check_frames(context.scene)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        into_sea = sea.matrix_world.inverted_safe()
        way = [(frame, *(into_sea @ floating.calm_matrix(vessel, depsgraph).translation)[:2]) for frame, depsgraph in camera.frames(context, False)]
        keys = keys_through(way)
        if len(keys) < 2:
            self.report({"ERROR"}, "The active object doesn't move in the scene's frames")
            return {"CANCELLED"}
        row = add_row(sea.pelagic.waves.vessels)
        row.path = text(keys)
        length, beam = sorted(vessel.dimensions[:2], reverse=True)
        if beam > 0.0:  # of a mesh, whose sides may lie along either axis
            row.length_m, row.beam_m, row.draught_m = length, beam, 0.4 * beam
        sea.update_tag()
        return {"FINISHED"}


def register():
    bpy.utils.register_class(PELAGIC_OT_make_wake)


def unregister():
    bpy.utils.unregister_class(PELAGIC_OT_make_wake)
