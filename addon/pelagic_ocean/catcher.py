# SPDX-License-Identifier: GPL-3.0-or-later
"""The sea as what catches the scene's shadows and mirror images for a composite, in Cycles.

Its pass Shadow Catcher is the sea's light with the objects over that without them, shadows and mirror images alike; the picture itself has the
objects alone, with their alpha. Over a picture of the water: picture + (1 − alpha) · pass · water.
"""

import bpy
from bpy.props import BoolProperty

from .operators import NeedsOcean


class PELAGIC_OT_catcher(NeedsOcean, bpy.types.Operator):
    """Leave the sea out of Cycles' pictures but for what the scene's objects change on it, their shadow and their mirror image; or show it again"""

    bl_idname = "pelagic.catcher"
    bl_label = "Shadow and Reflection Catcher"
    bl_options = {"REGISTER", "UNDO"}

    enabled: BoolProperty(name="Catches", default=True)

    def execute(self, context):
        obj, render = context.object, context.scene.render
        obj.is_shadow_catcher = self.enabled
        others = any(other.is_shadow_catcher for other in context.scene.objects
                     if other.type == "MESH" and other != obj)  # lamps are, too
        if self.enabled or not others:
            render.film_transparent = self.enabled
            for layer in context.scene.view_layers:
                if hasattr(layer, "cycles"):
                    layer.cycles.use_pass_shadow_catcher = self.enabled
        if self.enabled and render.engine != "CYCLES":
            self.report({"WARNING"}, f"It is for Cycles, and the scene's engine is {render.engine.title()}")
        return {"FINISHED"}


def register():
    bpy.utils.register_class(PELAGIC_OT_catcher)


def unregister():
    bpy.utils.unregister_class(PELAGIC_OT_catcher)
