# SPDX-License-Identifier: GPL-3.0-or-later
"""Object → Pelagic: what is done to objects, in one place, so that Blender's search finds it too."""

import bpy

from .catcher import PELAGIC_OT_catcher
from .courses import PELAGIC_OT_make_wake
from .farm import PELAGIC_OT_check_farm
from .floating import PELAGIC_OT_float
from .in_light import PELAGIC_OT_add_to_sea
from .native import PELAGIC_OT_replace_ocean_modifier
from .operators import PELAGIC_OT_use_cage, PELAGIC_OT_use_mesh
from .painted import PELAGIC_OT_paint_mask
from .sampling import PELAGIC_OT_sample_heights


class PELAGIC_MT_object(bpy.types.Menu):
    bl_label = "Pelagic"

    def draw(self, _context):
        layout = self.layout
        layout.operator(PELAGIC_OT_float.bl_idname)
        layout.operator(PELAGIC_OT_float.bl_idname, text="Float No More").enabled = False
        layout.operator(PELAGIC_OT_make_wake.bl_idname)
        layout.operator(PELAGIC_OT_add_to_sea.bl_idname)
        layout.operator(PELAGIC_OT_add_to_sea.bl_idname, text="Take from Sea").enabled = False
        layout.operator(PELAGIC_OT_paint_mask.bl_idname)
        layout.operator(PELAGIC_OT_catcher.bl_idname)
        layout.operator_menu_enum(PELAGIC_OT_sample_heights.bl_idname, "into")
        layout.separator()
        layout.operator(PELAGIC_OT_use_mesh.bl_idname)
        layout.operator(PELAGIC_OT_use_cage.bl_idname)
        layout.operator(PELAGIC_OT_replace_ocean_modifier.bl_idname)
        layout.separator()
        layout.operator(PELAGIC_OT_check_farm.bl_idname)


def _menu(self, _context):
    self.layout.menu(PELAGIC_MT_object.__name__)


def register():
    bpy.utils.register_class(PELAGIC_MT_object)
    bpy.types.VIEW3D_MT_object.append(_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(_menu)
    bpy.utils.unregister_class(PELAGIC_MT_object)
