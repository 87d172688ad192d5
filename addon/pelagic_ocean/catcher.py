# SPDX-License-Identifier: GPL-3.0-or-later
"""The sea as what catches the scene's shadows and mirror images for a composite (Cycles), and a plane that mirrors the scene (EEVEE)."""

import bpy
from bpy.props import BoolProperty

from . import compat, ocean
from .operators import NeedsOcean

MARK = "pelagic_mirror"  # on a probe of the add-on's


class PELAGIC_OT_catcher(NeedsOcean, bpy.types.Operator):
    """Leave the sea out of Cycles' pictures but for what the scene's objects change on it, their shadow and their mirror image; or show it again"""

    bl_idname = "pelagic.catcher"
    bl_label = "Shadow and Reflection Catcher"
    bl_options = {"REGISTER", "UNDO"}

    enabled: BoolProperty(name="Catches", default=True)

    def execute(self, context):
        obj, render = context.object, context.scene.render
        obj.is_shadow_catcher = self.enabled
        others = any(other.is_shadow_catcher for other in context.scene.objects if other != obj)
        if self.enabled or not others:
            render.film_transparent = self.enabled
            for layer in context.scene.view_layers:
                if hasattr(layer, "cycles"):
                    layer.cycles.use_pass_shadow_catcher = self.enabled
        if self.enabled and render.engine != "CYCLES":
            self.report({"WARNING"}, f"It is for Cycles, and the scene's engine is {render.engine.title()}")
        return {"FINISHED"}


def mirror_of(obj):
    return next((child for child in obj.children if MARK in child), None)


class PELAGIC_OT_mirror(NeedsOcean, bpy.types.Operator):
    """Let EEVEE mirror the scene in a plane at the level of the sea: for a calm one. Or take the plane away"""

    bl_idname = "pelagic.mirror"
    bl_label = "Planar Reflection"
    bl_options = {"REGISTER", "UNDO"}

    enabled: BoolProperty(name="Mirrors", default=True)

    def execute(self, context):
        obj = context.object
        mirror = mirror_of(obj)
        if not self.enabled:
            if mirror is not None:
                bpy.data.lightprobes.remove(mirror.data)
            return {"FINISHED"}
        if not compat.has_planar_probes():
            self.report({"ERROR"}, "Planar Reflection is for EEVEE before 4.2. This one mirrors what it traces on the screen: Render, Raytracing")
            return {"CANCELLED"}
        if mirror is None:
            mirror = bpy.data.objects.new(f"{obj.name} Mirror", bpy.data.lightprobes.new(f"{obj.name} Mirror", "PLANAR"))
            mirror[MARK] = True
            for collection in obj.users_collection:
                collection.objects.link(mirror)
            mirror.parent = obj
        reach_m = max(obj.dimensions[:2]) if obj.pelagic.surface.kind == "patch" and not obj.pelagic.horizon else 1000.0
        mirror.scale = (reach_m, reach_m, 1.0)
        # Waves are within some metres of the plane, and their facets turned from it.
        mirror.data.influence_distance, mirror.data.falloff = 10.0, 0.0
        mirror.data.clip_start = 0.05
        return {"FINISHED"}


CLASSES = (PELAGIC_OT_catcher, PELAGIC_OT_mirror)


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)


def unregister():
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
