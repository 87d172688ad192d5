# SPDX-License-Identifier: GPL-3.0-or-later
"""Shot files in and out: what was imported comes out as it went in."""

import json
import math
from pathlib import Path

import bpy
import numpy as np
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper
from mathutils import Vector

from . import bodies, cages, camera, in_light, keyed, light, ocean
from .module import pelagic
from .operators import GivesLook, NeedsModule
from .properties import BY_PATH
from .query import first_ocean

OWN_MESH = ("a shot file can't say the object's own mesh as the surface yet; accepted: a patch or the camera's grid "
            "(Surface, Release Mesh)")

# ---- Out


def shot_of(context, obj, meshes=None):
    """The whole shot of an ocean: a pelagic.Scene, and sentences about what it can't say. ValueError for what a
    shot file can't say at all. meshes: a folder for those of objects in the sea's light; without one, as for a bake, which they don't
    change, the shot has none."""
    if obj.pelagic.own_mesh:
        raise ValueError(f"{obj.name}: {OWN_MESH}")
    bpy_scene = context.scene
    ocean.check_frames(bpy_scene)
    scene = ocean.scene_of(obj, bpy_scene, context.evaluated_depsgraph_get())
    remarks = list(filter(None, [ocean.unit_warning(obj, bpy_scene)]))
    _, rotation, scale = obj.matrix_world.decompose()
    if max(abs(each - 1.0) for each in scale) > 1e-6:
        remarks.append(f"{obj.name} is scaled: the shot's sea is in its own metres, without the scale")
    if rotation.angle > 1e-6 or obj.matrix_world.translation.length > 0.0:
        remarks.append(f"{obj.name} is moved or turned: the shot's camera is as seen from it, the sun stays")
    lamp = light.own_sun(bpy_scene)
    if lamp is not None and lamp.matrix_world.col[2].xyz.angle(
            Vector(pelagic.Sky(scene).sun_direction)) > camera.SAME_DIRECTION:
        remarks.append(f"{lamp.name} was turned: the shot's sun is where the ocean's settings have it")
    poses, keys, others, moving_cage = _animated(context, obj, scene)
    scene = keyed.put(scene, keys)
    if others:
        remarks.append(f"{', '.join(others)}: animated, and a shot has no keys of it: there it is as at frame {bpy_scene.frame_current}")
    if moving_cage:
        remarks.append(f"{moving_cage} is animated: the shot has the cage as it is at frame {bpy_scene.frame_current}")
    if ocean.pinhole_of(obj, bpy_scene) is None:
        remarks.append("the scene has no perspective camera: the shot has the default one")
    else:
        remarks.extend(filter(None, [camera.set_lens(scene.camera, bpy_scene.camera.data, bpy_scene.render)]))
        if bpy_scene.render.pixel_aspect_x != bpy_scene.render.pixel_aspect_y:
            remarks.append("a shot can't say that pixels aren't square")
        camera.set_poses(scene, poses)
    if meshes is not None:
        remarks += in_light.put(context, obj, scene, meshes)
    problems = scene.validate()
    if problems:
        raise ValueError("\n".join(problems))
    return scene, remarks


def _animated(context, obj, scene):
    """Over the scene's range {frame: Pose} of its camera, empty if it has none with perspective; {path: keys} of settings that
    change; the paths of others that do; and the name of the ocean's cage if that isn't everywhere what it is now, or ""."""
    has_camera = ocean.pinhole_of(obj, context.scene) is not None
    cage = cages.mesh_of(obj) if scene.surface.kind == "cage" else None
    poses, settings, moving_cage = {}, {}, ""
    if cage is None and not has_camera and obj.animation_data is None:
        return poses, {}, [], moving_cage

    def arrays(depsgraph):
        return cages.arrays_of(cage, cages.to_ocean(obj, cage, depsgraph), depsgraph)

    now = arrays(context.evaluated_depsgraph_get()) if cage else None
    for frame, depsgraph in camera.frames(context, has_camera and camera.is_carried(context.scene.camera) or cage is not None and camera.is_carried(cage)):
        if obj.animation_data is not None:
            settings[frame] = ocean.settings_of(obj.evaluated_get(depsgraph))
        if has_camera:
            poses[frame] = camera.pose_of(obj, context.scene, depsgraph)
        if cage and not moving_cage and not all(map(np.array_equal, arrays(depsgraph), now)):
            moving_cage = cage.name
    keys, others = keyed.keys_of(settings)
    if obj.animation_data is not None:  # a sea that plays has them beyond the scene's range, too
        keys |= keyed.keys_of_sea(obj, ocean.settings_of(obj.evaluated_get(context.evaluated_depsgraph_get())), context.scene)
    return poses, keys, others, moving_cage


def set_frame_rate(render, fps):
    """The whole number above and a base: Blender has no other rates."""
    render.fps = max(1, math.ceil(fps - 1e-9))
    render.fps_base = render.fps / fps


class PELAGIC_OT_export_shot(NeedsModule, ExportHelper, bpy.types.Operator):
    """Write the ocean with the scene's camera and frames as a shot file, for pelagic bake and pelagic render"""

    bl_idname = "pelagic.export_shot"
    bl_label = "Export Pelagic Shot"

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context, event):
        obj = ocean_of(context)
        if obj and not self.filepath:
            self.filepath = ocean.clean_name(obj.name) + self.filename_ext
        return super().invoke(context, event)

    def execute(self, context):
        obj = ocean_of(context)
        if obj is None:
            self.report({"ERROR"}, "There is no ocean in this scene")
            return {"CANCELLED"}
        path = Path(bpy.path.abspath(self.filepath)).absolute()
        try:
            scene, remarks = shot_of(context, obj, path.with_name(f"{path.stem}_objects"))
            save(scene, path)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        except OSError as error:
            self.report({"ERROR"}, f"{path}: can't be written ({error.strerror})")
            return {"CANCELLED"}
        for remark in remarks:
            self.report({"WARNING"}, remark)
        return {"FINISHED"}


def save(scene, path):
    """The shot's file. Meshes in folders beside it are named from there, so that both can go elsewhere together."""
    text = scene.shot_text()
    for file in {Path(each.file) for each in scene.objects}:
        if file.is_relative_to(path.parent):
            text = text.replace(json.dumps(str(file), ensure_ascii=False), json.dumps(file.relative_to(path.parent).as_posix(), ensure_ascii=False))
    bodies.put_file(path, text)


def ocean_of(context):
    """The active ocean, else the scene's first."""
    return context.object if ocean.is_ocean(context.object) else first_ocean(context.scene)


# ---- In


class PELAGIC_OT_import_shot(ImportHelper, GivesLook, bpy.types.Operator):
    """Add the ocean of a shot file with its camera, sun and sky, and give the scene its frames"""

    bl_idname = "pelagic.import_shot"
    bl_label = "Import Pelagic Shot"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})
    set_scene: BoolProperty(name="Camera and Frames", default=True,
                            description="Add the shot's camera, and give the scene its range, rate and resolution")

    def execute(self, context):
        path = Path(bpy.path.abspath(self.filepath)).absolute()
        try:
            shot = pelagic.Scene.from_file(path)
            scene = shot.at(shot.shot.frames[0])
            obj = ocean.make(scene.shot.name, context.collection)
            try:
                ocean.set_from(obj, scene)
                if self.set_scene:
                    _set_scene(context, scene)
            except ValueError:
                bpy.data.objects.remove(obj)
                raise
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if scene.sea.is_measured:
            obj.pelagic.sea.spectrum_file = str(Path(scene.sea.spectrum_file).absolute())
        if scene.light.sky != pelagic.Scene().light.sky:
            obj.pelagic.light.sky = str(Path(scene.light.sky).absolute())
        obj.pelagic.horizon = False  # the shot's surface and no more
        keyed.keyframe(obj, shot)
        if ocean.changing(shot, BY_PATH):
            self.report({"WARNING"}, ocean.changing(shot, BY_PATH))
        in_light.add(context, shot, scene.shot.name)
        ocean.select_only(context, obj)
        simulation = self.show(context, obj)
        if simulation.problem:
            self.report({"WARNING"}, simulation.problem)
        if obj.name != scene.shot.name:
            self.report({"WARNING"}, f"There is a {scene.shot.name} in this file already: this one is {obj.name}")
        return {"FINISHED"}


def _set_scene(context, scene):
    """ValueError for frames that Blender doesn't have."""
    first, last = scene.shot.frames
    if first < 0:
        raise ValueError(f"shot.frames = [{first}, {last}]: Blender's frames begin at 0; accepted: a later range, or "
                         "an import without Camera and Frames")
    bpy_scene = context.scene
    bpy_scene.frame_start, bpy_scene.frame_end = first, last
    bpy_scene.frame_set(min(max(bpy_scene.frame_current, first), last))
    render = bpy_scene.render
    set_frame_rate(render, scene.shot.fps)
    render.resolution_x, render.resolution_y = scene.camera.resolution
    render.resolution_percentage = 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    bpy_scene.camera = camera.make(context, scene, scene.shot.name)


CLASSES = (PELAGIC_OT_export_shot, PELAGIC_OT_import_shot)


def _export_menu(self, _context):
    self.layout.operator(PELAGIC_OT_export_shot.bl_idname, text="Pelagic Shot (.toml)")


def _import_menu(self, _context):
    self.layout.operator(PELAGIC_OT_import_shot.bl_idname, text="Pelagic Shot (.toml)")


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.TOPBAR_MT_file_export.append(_export_menu)
    bpy.types.TOPBAR_MT_file_import.append(_import_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_export_menu)
    bpy.types.TOPBAR_MT_file_import.remove(_import_menu)
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
