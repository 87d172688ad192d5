# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender camera as a shot's, and back: where it is, what it looks at, its angle of view and its roll.

Blender keeps single precision. What goes into a shot is the shortest decimal that gives the same number, so that a shot
that was imported comes out as it went in.
"""

import math
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from . import cages, compat, ocean
from .module import pelagic
from .operators import CLIP_END_M
from .properties import shortest, shortest_for

WIDEST_F_STOP = 0.5  # of a shot's lens
ROLL_DIGITS = 4  # of degrees: 1e-4 is a fiftieth of a pixel at the edge of an 8K picture
SAME_DIRECTION = 1e-3  # radians
# What a straight line between two keys may miss, in a pose's numbers: 10 µm, 1e-5° of view, 2e-4° of roll.
TOLERANCE = np.array([1e-5] * 6 + [1e-5, 2e-4])


@dataclass(frozen=True)
class Pose:
    position_m: tuple
    look_at_m: tuple
    fov_deg: float
    roll_deg: float

    def numbers(self):
        return (*self.position_m, *self.look_at_m, self.fov_deg, self.roll_deg)


# ---- Out of Blender


def half_film_mm(data, render):
    """Half of what the picture's width is on the film."""
    width = render.resolution_x * render.pixel_aspect_x
    height = render.resolution_y * render.pixel_aspect_y
    fit = data.sensor_fit
    if fit == "VERTICAL":
        return 0.5 * data.sensor_height * width / height
    return 0.5 * data.sensor_width * (width / height if fit == "AUTO" and height > width else 1.0)


def set_lens(table, data, render):
    """The keys of a shot's camera that its poses don't have: shift, aperture and focus. Returns what those can't say, or ""."""
    width = render.resolution_x * render.pixel_aspect_x
    height = render.resolution_y * render.pixel_aspect_y
    is_upright = data.sensor_fit == "VERTICAL" or (data.sensor_fit == "AUTO" and height > width)
    side = height / width if is_upright else 1.0  # of the shift's unit, in widths
    table.shift_x, table.shift_y = (shortest(each) if side == 1.0 else each * side for each in (data.shift_x, data.shift_y))
    if not data.dof.use_dof:
        return ""
    table.sensor_width_mm = 2.0 * half_film_mm(data, render)
    table.f_stop = max(shortest(data.dof.aperture_fstop), WIDEST_F_STOP)
    table.focus_distance_m = shortest(data.dof.focus_distance)
    return f"{data.name} is focused on an object: the shot is on the distance beside it" if data.dof.focus_object else ""


def fov_deg(data, render):
    half = half_film_mm(data, render)
    angle = math.degrees(2.0 * math.atan(half / data.lens))
    angle = shortest_for(angle, lambda deg: half / math.tan(math.radians(deg) / 2.0), data.lens)
    low, high = ocean.FOV_DEG
    return min(max(angle, low), high)


def _target(camera):
    """What the camera, or what carries it, tracks."""
    for obj in (camera, camera.parent):
        for constraint in obj.constraints if obj else ():
            if constraint.type == "TRACK_TO" and constraint.target and not constraint.mute:
                return constraint.target
    return None


def pose_of(obj, bpy_scene, depsgraph=None):
    """The pose of the scene's camera as the ocean object sees it."""
    camera, target = bpy_scene.camera, _target(bpy_scene.camera)
    pinhole = ocean.pinhole_of(obj, bpy_scene, depsgraph)
    look_at = pinhole.position_m + ocean.LOOK_AHEAD_M * pinhole.forward
    if depsgraph:
        camera, obj = camera.evaluated_get(depsgraph), obj.evaluated_get(depsgraph)
    if target:
        place = (target.evaluated_get(depsgraph) if depsgraph else target).matrix_world.translation
        place = obj.matrix_world.inverted_safe() @ place
        if (place - pinhole.position_m).angle(pinhole.forward, math.pi) < SAME_DIRECTION:
            look_at = place
    return Pose(tuple(map(shortest, pinhole.position_m)), tuple(map(shortest, look_at)),
                fov_deg(camera.data, bpy_scene.render), round(pinhole.roll_deg(), ROLL_DIGITS) + 0.0)


def needed_keys(poses):
    """The frames of {frame: Pose} that have to be keys."""
    return bends({frame: pose.numbers() for frame, pose in poses.items()}, TOLERANCE)


def bends(rows, tolerance):
    """The frames of {frame: numbers} that have to be keys: the others lie on the straight lines between them, as nearly as `tolerance`."""
    frames = np.array(sorted(rows))
    numbers = np.array([rows[frame] for frame in frames.tolist()])
    kept, at = [0], 0
    while at < len(frames) - 1:
        to = at + 1  # always possible; then as far as one line goes
        while to + 1 < len(frames):
            share = ((frames[at + 1:to + 1] - frames[at]) / (frames[to + 1] - frames[at]))[:, None]
            line = numbers[at] + share * (numbers[to + 1] - numbers[at])
            if (np.abs(line - numbers[at + 1:to + 1]) > tolerance).any():
                break
            to += 1
        kept.append(to)
        at = to
    if len(kept) == 2 and (numbers[kept[0]] == numbers[kept[1]]).all():
        kept = kept[:1]
    return [int(frames[index]) for index in kept]


def set_poses(scene, poses):
    """A camera of {frame: Pose}: still, or a key where its way bends or it rolls."""
    kept = needed_keys(poses)
    first = poses[kept[0]]
    zooms = any(poses[frame].fov_deg != first.fov_deg for frame in kept)
    default = pelagic.Scene().camera
    scene.camera.fov_deg = default.fov_deg if zooms else first.fov_deg
    if len(kept) == 1 and not first.roll_deg:
        scene.camera.position_m, scene.camera.look_at_m, scene.camera.keys = first.position_m, first.look_at_m, ()
        return
    scene.camera.position_m, scene.camera.look_at_m = default.position_m, default.look_at_m
    scene.camera.keys = tuple(
        pelagic.CameraKey(frame, pose.position_m, pose.look_at_m, pose.fov_deg if zooms else None, pose.roll_deg)
        for frame, pose in ((frame, poses[frame]) for frame in kept))


def is_carried(obj, known=()):
    """Whether what floats has a say in where an object is, as far as its parents and its constraints go."""
    others = [obj.parent] + [getattr(each, "target", None) for each in obj.constraints]
    return obj.pelagic_float.enabled or any(is_carried(each, (*known, obj)) for each in others if each and each not in known)


@contextmanager
def _oceans_at_rest(afloat):
    """Frames change without the seas', and without what floats unless that matters."""
    handlers = bpy.app.handlers.frame_change_post
    before = list(handlers)
    costly = {f"{__package__}.{name}" for name in ("play", "look", "drops", "viewport", "baked") + (() if afloat else ("floating",))}
    handlers[:] = [each for each in before if each.__module__ not in costly]
    try:
        yield
    finally:
        handlers[:] = before
        cages.forget()  # nobody has said which of them have changed meanwhile


def frames(context, afloat):
    """Goes through the scene's range: of every frame its number and the depsgraph there. Then the frame is as before. afloat: whether what
    floats goes along, which takes a sea a frame."""
    bpy_scene = context.scene
    now = bpy_scene.frame_current, bpy_scene.frame_subframe
    try:
        with _oceans_at_rest(afloat):
            for frame in range(bpy_scene.frame_start, bpy_scene.frame_end + 1):
                bpy_scene.frame_set(frame)
                yield frame, context.evaluated_depsgraph_get()
    finally:
        bpy_scene.frame_set(now[0], subframe=now[1])


# ---- Into Blender


def _lens_mm(angle_deg, film_mm):
    return 0.5 * film_mm / math.tan(math.radians(angle_deg) / 2.0)


def _keyframe(owner, path, values):
    """Straight lines between these values of a property, {frame: value}."""
    for frame, value in values.items():
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    for curve in compat.curves(owner):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def _seen(scene, frame):
    """The pose of a shot's camera at a frame."""
    view = pelagic.View.of_scene(scene, frame)
    pinhole = ocean.Pinhole(*map(Vector, (view.position_m, view.right, view.up, view.forward)), view.tan_half_width,
                            view.resolution)
    look_at = pinhole.position_m + ocean.LOOK_AHEAD_M * pinhole.forward
    return Pose(view.position_m, tuple(look_at), math.degrees(2 * math.atan(view.tan_half_width)), pinhole.roll_deg())


def make(context, scene, name):
    """The shot's camera: it tracks an empty where it looks, and hangs in another if it rolls. Returns the camera."""
    film_mm = scene.camera.sensor_width_mm
    lens_deg = scene.camera.fov_deg
    if scene.camera.focal_length_mm:
        lens_deg = math.degrees(2 * math.atan(0.5 * film_mm / scene.camera.focal_length_mm))
    poses = {key.frame: Pose(key.position_m, key.look_at_m, key.fov_deg or lens_deg, key.roll_deg)
             for key in scene.camera.keys}
    if scene.camera.interpolation == "smooth" and len(poses) > 2:  # the core's curves, which aren't Blender's
        poses = {frame: _seen(scene, frame) for frame in range(min(poses), max(poses) + 1)}
    poses = poses or {1: Pose(scene.camera.position_m, scene.camera.look_at_m, lens_deg, 0.0)}
    first = poses[min(poses)]
    data = bpy.data.cameras.new(f"{name} Camera")
    data.sensor_fit, data.sensor_width, data.lens = "HORIZONTAL", film_mm, _lens_mm(first.fov_deg, film_mm)
    data.shift_x, data.shift_y = scene.camera.shift_x, scene.camera.shift_y
    if scene.camera.f_stop:
        data.dof.use_dof, data.dof.aperture_fstop = True, scene.camera.f_stop
        data.dof.focus_distance = scene.camera.focus_distance_m
    data.clip_end = CLIP_END_M
    camera = bpy.data.objects.new(data.name, data)
    target = bpy.data.objects.new(f"{name} Target", None)
    made = [camera, target]
    carrier = camera
    if any(pose.roll_deg for pose in poses.values()):
        carrier = camera.parent = bpy.data.objects.new(f"{name} Rig", None)
        made.append(carrier)
        camera.rotation_euler.z = -math.radians(first.roll_deg)
    for each in made:
        context.collection.objects.link(each)
    carrier.location, target.location = first.position_m, first.look_at_m
    track = carrier.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = target, "TRACK_NEGATIVE_Z", "UP_Y"
    if len(poses) > 1:
        _keyframe(carrier, "location", {frame: pose.position_m for frame, pose in poses.items()})
        _keyframe(target, "location", {frame: pose.look_at_m for frame, pose in poses.items()})
        if carrier != camera:
            _keyframe(camera, "rotation_euler",
                      {frame: (0, 0, -math.radians(pose.roll_deg)) for frame, pose in poses.items()})
        if any(pose.fov_deg != first.fov_deg for pose in poses.values()):
            every = range(min(poses), max(poses) + 1)  # angles go straight, focal lengths don't
            angles = np.interp(every, list(poses), [pose.fov_deg for pose in poses.values()])
            _keyframe(data, "lens", {frame: _lens_mm(angle, film_mm) for frame, angle in zip(every, angles)})
    return camera
