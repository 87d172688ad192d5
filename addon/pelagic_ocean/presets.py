# SPDX-License-Identifier: GPL-3.0-or-later
"""Weathers and seas with a name: the core's, and the user's own, which are shot files in Blender's folder for them."""

from pathlib import Path

import bpy
import bpy.utils.previews
from bpy.props import StringProperty

from . import compat, ocean
from .module import pelagic
from .operators import NeedsOcean
from .properties import BY_PATH, OF_CAMERA
from .translations import say

THUMBNAILS = Path(__file__).parent / "thumbnails"  # examples/preset-thumbnails.py makes them

_icons = None

TABLES = ("sea", "waves", "effects", "light", "water")  # what a preset of the user's keeps


def folder(create=False):
    return compat.user_folder(__package__, "presets", create)


def own_presets():
    """Name → path."""
    return {path.stem: path for path in sorted(folder().glob("*.toml"))}


def icon_of(name):
    """The icon that shows a preset of the core's."""
    if name not in _icons:
        _icons.load(name, str(THUMBNAILS / f"{name}.jpg"), "IMAGE")
    return _icons[name].icon_id


def _with_tables_of(other, scene):
    for table in TABLES:
        setattr(scene, table, getattr(other, table))
    for path in OF_CAMERA:
        setattr(scene.camera, BY_PATH[path].name, getattr(other.camera, BY_PATH[path].name))
    return scene


def _says(preset):
    """What it looks like, and which settings or tables of settings it changes."""
    tables = dict.fromkeys(path.split(".")[0] for path in preset["values"] if path in BY_PATH)
    return say("{}. Sets {}", say(f"{preset['help'][:1].upper()}{preset['help'][1:]}"), ", ".join(say(table.title()) for table in tables))


class PELAGIC_OT_preset_apply(NeedsOcean, bpy.types.Operator):
    """Make this the ocean's sea"""

    bl_idname = "pelagic.preset_apply"
    bl_label = "Apply Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: StringProperty(description="One of pelagic.presets(), or of the user's own")

    @classmethod
    def description(cls, _context, properties):
        return next((_says(preset) for preset in pelagic.presets() if preset["name"] == properties.name),
                    say("Make this sea of your own the ocean's, with its waves, effects, light and water"))

    def execute(self, context):
        obj = context.object
        try:
            scene = ocean.scene_of(obj, context.scene)
            if self.name in own_presets():
                shot = pelagic.Scene.from_file(own_presets()[self.name])
                _with_tables_of(shot.at(shot.shot.frames[0]), scene)
            else:
                scene.apply_preset(self.name)
            ocean.set_from(obj, scene)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PELAGIC_OT_preset_save(NeedsOcean, bpy.types.Operator):
    """Keep the ocean's sea, light and water under a name, for all files"""

    bl_idname = "pelagic.preset_save"
    bl_label = "Save Preset"
    bl_options = {"REGISTER"}

    name: StringProperty(name="Name", default="My sea")

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        name = bpy.path.clean_name(self.name.strip()).strip("_")
        if not name:
            self.report({"ERROR"}, "A preset needs a name")
            return {"CANCELLED"}
        if any(name == preset["name"] for preset in pelagic.presets()):
            self.report({"ERROR"}, f"{name} is one of the presets that are always there: take another name")
            return {"CANCELLED"}
        try:
            scene = _with_tables_of(ocean.scene_of(context.object, context.scene), pelagic.Scene())
            scene.save(folder(create=True) / f"{name}.toml")
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PELAGIC_OT_preset_delete(bpy.types.Operator):
    """Delete a preset of your own"""

    bl_idname = "pelagic.preset_delete"
    bl_label = "Delete Preset"
    bl_options = {"REGISTER", "INTERNAL"}

    name: StringProperty()

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, _context):
        path = own_presets().get(self.name)
        if path is None:
            self.report({"ERROR"}, f"There is no preset {self.name} of your own")
            return {"CANCELLED"}
        try:
            path.unlink()
        except OSError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PELAGIC_MT_presets(bpy.types.Menu):
    bl_idname = "PELAGIC_MT_presets"
    bl_label = "Presets"
    bl_description = "Weathers and seas with a name, and your own: one makes itself the ocean's sea"

    def draw(self, _context):
        layout = self.layout
        for title, group in (("Wind", "beaufort"), ("Seas", "sea")):
            layout.label(text=title)
            for preset in pelagic.presets():
                if preset["group"] == group:
                    layout.operator(PELAGIC_OT_preset_apply.bl_idname, text=preset["label"],
                                    icon_value=icon_of(preset["name"])).name = preset["name"]
            layout.separator()
        own = own_presets()
        if own:
            layout.label(text="Your own")
        for name in own:
            layout.operator(PELAGIC_OT_preset_apply.bl_idname, text=name).name = name
        layout.operator(PELAGIC_OT_preset_save.bl_idname, text="Save…", icon="ADD")
        if own:
            layout.menu(PELAGIC_MT_presets_delete.bl_idname, icon="REMOVE")


class PELAGIC_MT_presets_delete(bpy.types.Menu):
    bl_idname = "PELAGIC_MT_presets_delete"
    bl_label = "Delete"

    def draw(self, _context):
        for name in own_presets():
            self.layout.operator(PELAGIC_OT_preset_delete.bl_idname, text=name).name = name


CLASSES = (PELAGIC_OT_preset_apply, PELAGIC_OT_preset_save, PELAGIC_OT_preset_delete, PELAGIC_MT_presets_delete,
           PELAGIC_MT_presets)


def register():
    global _icons
    _icons = bpy.utils.previews.new()
    for made in CLASSES:
        bpy.utils.register_class(made)


def unregister():
    global _icons
    bpy.utils.previews.remove(_icons)
    _icons = None
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
