# SPDX-License-Identifier: GPL-3.0-or-later
"""The height of the water at places: for drivers, and written down for objects and vertices."""

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.props import EnumProperty

from . import meshes
from .exchange import ocean_of
from .ocean import check_frames
from .operators import NeedsModule
from .query import Water, first_ocean

ATTRIBUTE = "sea_height"


def pelagic_height(x, y, frame=None, ocean=""):
    """For drivers: the z of the water at x, y [m] of the world, at a frame (write frame: drivers know it; default the
    scene's) of the ocean of this name or the scene's first. 0 without an ocean, while its sea is being built, and of
    one that is hidden while nothing floats in it."""
    bpy_scene = bpy.context.scene
    obj = bpy_scene.objects.get(ocean) if ocean else first_ocean(bpy_scene)
    if obj is None:
        return 0.0
    try:
        water = Water(obj, bpy_scene, frame=frame)
    except LookupError:
        return 0.0
    return float(water.world_heights([(x, y)])[0])


class PELAGIC_OT_sample_heights(NeedsModule, bpy.types.Operator):
    """Write down how high the water is where the selected objects or the active mesh's vertices are"""

    bl_idname = "pelagic.sample_heights"
    bl_label = "Sample Sea Heights"
    bl_options = {"REGISTER", "UNDO"}

    into: EnumProperty(name="Into", items=[
        ("KEYFRAMES", "Keyframes", "The selected objects' z over the scene's frames: they ride up and down"),
        ("ATTRIBUTE", "Attribute", f"{ATTRIBUTE} of the active mesh's vertices at this frame, in the world's z"),
        ("TEXT", "Text", "A table in the text editor: frame, object, x, y and the water's z over the scene's frames")])

    def execute(self, context):
        sea = ocean_of(context)
        objects = [obj for obj in context.selected_objects if obj != sea]
        if sea is None:
            self.report({"ERROR"}, "There is no ocean in this scene")
        elif self.into == "ATTRIBUTE" and not any(obj.type == "MESH" for obj in objects):
            self.report({"ERROR"}, "No mesh beside the ocean is selected")
        elif not objects:
            self.report({"ERROR"}, "Nothing is selected beside the ocean")
        else:
            try:
                return getattr(self, "_" + self.into.lower())(context, sea, objects)
            except (LookupError, ValueError) as error:
                self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _frames(self, context, sea, objects):
        """Of each frame its number, the objects as evaluated there, and the water's heights where they are."""
        bpy_scene = context.scene
        now = bpy_scene.frame_current, bpy_scene.frame_subframe
        try:
            for frame in range(bpy_scene.frame_start, bpy_scene.frame_end + 1):
                bpy_scene.frame_set(frame)
                depsgraph = context.evaluated_depsgraph_get()
                there = [obj.evaluated_get(depsgraph) for obj in objects]
                places = [obj.matrix_world.translation.xy for obj in there]
                yield frame, there, Water(sea, bpy_scene, depsgraph, wait=True).world_heights(places)
        finally:
            bpy_scene.frame_set(now[0], subframe=now[1])

    def _keyframes(self, context, sea, objects):
        check_frames(context.scene)
        keys = []
        for frame, there, heights in self._frames(context, sea, objects):
            for obj, evaluated, height in zip(objects, there, heights):
                place = evaluated.matrix_world.copy()
                place.translation.z = height
                own = evaluated.matrix_basis @ evaluated.matrix_world.inverted_safe() @ place
                keys.append((frame, obj, own.translation.z - obj.delta_location.z))
        for frame, obj, z in keys:
            obj.location.z = z
            obj.keyframe_insert("location", index=2, frame=frame)
        context.scene.frame_set(context.scene.frame_current)
        return {"FINISHED"}

    def _attribute(self, context, sea, objects):
        depsgraph = context.evaluated_depsgraph_get()
        water = Water(sea, context.scene, depsgraph, wait=True)
        for obj in objects:
            if obj.type != "MESH":
                continue
            places = np.empty((len(obj.data.vertices), 3), np.float32)
            obj.data.vertices.foreach_get("co", places.ravel())
            to_world = np.array(obj.evaluated_get(depsgraph).matrix_world)
            heights = water.world_heights(places @ to_world[:2, :3].T + to_world[:2, 3])
            meshes.attribute(obj.data, ATTRIBUTE, "FLOAT").data.foreach_set("value", heights.astype(np.float32))
            obj.data.update()
        return {"FINISHED"}

    def _text(self, context, sea, objects):
        lines = ["frame,object,x,y,z"]
        for frame, there, heights in self._frames(context, sea, objects):
            places = (obj.matrix_world.translation for obj in there)
            lines += [f"{frame},{obj.name},{place.x:.6g},{place.y:.6g},{z:.6g}"
                      for obj, place, z in zip(objects, places, heights)]
        text = bpy.data.texts.new(f"{sea.name} heights.csv")
        text.write("\n".join(lines) + "\n")
        self.report({"INFO"}, f"{len(lines) - 1} heights in the text {text.name}")
        return {"FINISHED"}


@persistent
def _offer(*_):
    """A file that is loaded empties the drivers' names."""
    bpy.app.driver_namespace[pelagic_height.__name__] = pelagic_height


def register():
    bpy.utils.register_class(PELAGIC_OT_sample_heights)
    bpy.app.handlers.load_post.append(_offer)
    _offer()


def unregister():
    bpy.app.handlers.load_post.remove(_offer)
    bpy.app.driver_namespace.pop(pelagic_height.__name__, None)
    bpy.utils.unregister_class(PELAGIC_OT_sample_heights)
