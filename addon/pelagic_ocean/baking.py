# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes an ocean to disk: the same code as `pelagic bake`, beside Blender's other work, and the same bits.

What is whole on disk already is kept, so that a bake that was stopped goes on the next time.
"""

from pathlib import Path

import bpy
from bpy.app.handlers import persistent
from bpy.props import PointerProperty, StringProperty

from . import ocean, play
from .exchange import PELAGIC_OT_export_shot, shot_of
from .module import pelagic
from .operators import NeedsOcean
from .properties import OVERRIDABLE, overridable

TIMER_S = 0.1


def folder_of(obj):
    """The folder of an ocean's bake. ValueError while // has no place."""
    folder = obj.pelagic_bake.folder
    if folder.startswith("//") and not bpy.data.filepath:
        raise ValueError(f"{folder}: // is beside the .blend, which isn't saved yet; "
                         "accepted: a saved file, or a whole path")
    return Path(bpy.path.abspath(folder)) / ocean.clean_name(obj.name)


class Baking:
    """One bake, which begins at once."""

    def __init__(self, obj, scene, out):
        """obj: the ocean. Its name is kept, since undo may make another object of it meanwhile."""
        self.ocean, self.scene, self.folder, self.report = obj.name, scene, out, None
        self.task = pelagic.begin_bake(scene, out)

    @property
    def text(self):
        """How far it is."""
        stage, _frame, done, kept, total, share = self.task.progress or ("planning", 0, 0, 0, 0, 0.0)
        if stage == "frames":
            past = f", the foam's past: {100 * share:.0f} %" if share else ""
            return f"Bake: {done + kept} of {total} frames{past}"
        if stage == "building":
            return f"Bake: the sea, {100 * share:.0f} %"
        if stage == "checking":
            return f"Bake: reading what is there, {100 * share:.0f} %"
        if stage == "waiting":
            return "Bake: waiting for another one in this folder"
        return "Bake: planning"

    def outcome(self):
        """The kind of a report, and its words, once it has ended; what it did is in `report` then, None after an error."""
        try:
            report = self.report = self.task.result()
        except (ValueError, OSError, MemoryError, RuntimeError) as error:
            return "ERROR", str(error) or type(error).__name__
        text = f"{report.done} frames baked" + (f", {report.kept} were there" if report.kept else "")
        if report.cancelled:
            return "WARNING", f"Stopped: {text}, of {report.total}. The next bake goes on from there"
        return "INFO", f"{text}, in {report.seconds:.1f} s: {report.record.parent}"


_baking = None  # the one that runs


class Bakes(NeedsOcean):
    """An operator that bakes: at once in the background, and beside Blender's other work in a window. Esc stops it."""

    _timer = None

    @classmethod
    def poll(cls, context):
        return _baking is None and super().poll(context)

    def order(self, context, obj):
        """A pelagic.Scene to bake, the folder for it, and sentences about what it leaves out. ValueError, OSError."""
        raise NotImplementedError

    def take(self, context, baking):
        """What is done with a bake that has ended without an error: more words for the report."""
        return ""

    def fail(self, context, baking):
        """What is done after an error, which may have come in the middle."""

    def _begin(self, context):
        try:
            scene, folder, remarks = self.order(context, context.object)
            baking = Baking(context.object, scene, folder)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return None
        for remark in remarks:
            self.report({"WARNING"}, remark)
        return baking

    def _end(self, context, baking):
        kind, text = baking.outcome()
        if kind != "ERROR":
            text += self.take(context, baking)
        else:
            self.fail(context, baking)
        self.report({kind}, text)
        return {"CANCELLED"} if kind == "ERROR" else {"FINISHED"}

    def execute(self, context):
        baking = self._begin(context)
        return {"CANCELLED"} if baking is None else self._end(context, baking)

    def invoke(self, context, _event):
        global _baking
        if bpy.app.background:
            return self.execute(context)
        _baking = self._begin(context)
        if _baking is None:
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(TIMER_S, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Its window was closed, or the add-on goes: nobody would look after the bake any more."""
        _stop()
        if context.workspace:
            context.workspace.status_text_set(None)

    def modal(self, context, event):
        global _baking
        if event.type == "ESC" and event.value == "PRESS":
            _baking.task.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        context.workspace.status_text_set(f"{_baking.text}   Esc: stop")
        play.redraw()
        if not _baking.task.is_done:
            return {"PASS_THROUGH"}
        ended, _baking = _baking, None
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        play.redraw()
        return self._end(context, ended)


class PELAGIC_OT_bake(Bakes, bpy.types.Operator):
    """Bake the scene's frames of the ocean to disk, as USD and maps. Esc stops it; the next bake goes on from there"""

    bl_idname = "pelagic.bake"
    bl_label = "Bake"

    def order(self, context, obj):
        scene, remarks = shot_of(context, obj)
        return scene, folder_of(obj), remarks


class PELAGIC_OT_stop_bake(bpy.types.Operator):
    """Stop the bake; the next one goes on from there"""

    bl_idname = "pelagic.stop_bake"
    bl_label = "Stop"

    @classmethod
    def poll(cls, _context):
        return _baking is not None

    def execute(self, _context):
        _baking.task.cancel()
        return {"FINISHED"}


@persistent
def _stop(*_):
    """Another file is coming, or the add-on goes: nobody would look after the bake any more."""
    global _baking
    if _baking is not None:
        _baking.task.cancel()
        _baking.task.wait()
        _baking = None


def draw_progress(layout):
    """How far the bake that runs is, and its end. Returns whether one runs."""
    if _baking is None:
        return False
    row = layout.row(align=True)
    row.label(text=_baking.text, icon="SORTTIME")
    row.operator(PELAGIC_OT_stop_bake.bl_idname, icon="X")
    return True


def _draw(self, context):
    """The end of the Output panels."""
    layout, settings = self.layout, context.object.pelagic_bake
    layout.prop(settings, "folder")
    if not draw_progress(layout):
        layout.operator(PELAGIC_OT_bake.bl_idname, icon="RENDER_ANIMATION")
    layout.operator(PELAGIC_OT_export_shot.bl_idname, icon="EXPORT")


@overridable
class PELAGIC_PG_bake(bpy.types.PropertyGroup):
    folder: StringProperty(name="Folder", default="//bakes", subtype="DIR_PATH",
                           description="Where bakes go, each into a folder of its name; // is beside the .blend")


CLASSES = (PELAGIC_PG_bake, PELAGIC_OT_bake, PELAGIC_OT_stop_bake)
PANELS = ("PELAGIC_PT_object_output", "PELAGIC_PT_view_output")


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic_bake = PointerProperty(type=PELAGIC_PG_bake, name="Bake", override=OVERRIDABLE)
    bpy.app.handlers.load_pre.append(_stop)
    for name in PANELS:
        getattr(bpy.types, name).append(_draw)


def unregister():
    _stop()
    for name in PANELS:
        getattr(bpy.types, name).remove(_draw)
    bpy.app.handlers.load_pre.remove(_stop)
    del bpy.types.Object.pelagic_bake
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
