# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport preview: the sea in solid views (before 4.2 in material ones, too), lit in real time, with the scene's objects in it.

One ocean is drawn at a time, by a handler that exists only while the preview is on. Its mesh is hidden meanwhile, and so
isn't updated either; it is shown again for saving, and while some view needs it. Where the handler draws, and why:
after the scene (POST_VIEW) Blender binds its overlay, whose colours are display values, with the scene's depth.
"""

import math

import bpy
import gpu
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, PointerProperty

from . import bodies, compat, gpu_objects, handlers, keyed, light, ocean, play
from .gpu_sea import Camera, Drawing
from .module import pelagic
from .panels import draw_words
from .presets import PELAGIC_MT_presets
from .sea import Job

SHADINGS = compat.preview_shadings()  # views that draw the preview; the others need the mesh
# How fine a view's pixels count as: waves that only finer ones could show roughen the surface, so that a frame is cheap
# to make and to upload. How coarse: there, hardly anything is left to save.
FINEST_M, COARSEST_M = 1 / 32, 2.0
HIDDEN = "pelagic_hidden"  # on an ocean whose mesh is hidden by the preview: undo steps and autosaves keep both
STILL_S = 0.25  # a view that hasn't moved for so long gets the fine grid
POLL_S = 0.02


class Preview:
    """The preview while it is on. A draw handler may not change data: it leaves that to _tend(), a timer's function."""

    def __init__(self, obj):
        self.name = obj.name_full
        self._obj = obj
        bodies.forget_pictures()  # nobody saw whether they changed while there was no preview
        self.drawing, self.objects = Drawing(), gpu_objects.Objects()
        self.hidden_in = {}  # (names of scene and view layer): whether it was selected there
        self.problem = ""
        self.is_broken = False  # it can't draw; problem says why
        self.seen = False  # whether a view has drawn since _tend()
        self._settings = self._scene = None
        self._keys = {}  # of the sea's numbers
        self._job = None
        self._refused = None  # settings that give no sea
        self._handler = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_VIEW")

    def close(self):
        bpy.types.SpaceView3D.draw_handler_remove(self._handler, "WINDOW")

    def obj(self):
        """The ocean, also after undo; None if it is gone. Follows renaming."""
        try:
            self.name = self._obj.name_full
        except (ReferenceError, AttributeError):  # not of this undo step, or gone
            self._obj = bpy.data.objects.get(self.name)
        return self._obj if ocean.is_ocean(self._obj) else None

    @property
    def is_building(self):
        return self._job is not None

    def scene(self, obj, bpy_scene):
        """The pelagic.Scene of the ocean as it is set now, or the last one that the core accepts; None before that."""
        turned = obj.matrix_world.to_euler().z
        settings = (ocean.settings_of(obj), ocean.frame_rate(bpy_scene), turned, light.kept_view(bpy_scene))
        keys = keyed.keys_of_sea(obj, settings[0], bpy_scene)
        if (settings, keys) != (self._settings, self._keys):
            self._settings, self._keys = settings, keys
            try:
                self._scene = ocean.scene_of(obj, bpy_scene, settings=settings[0])
                light.see_by(settings[3], self._scene)
                self._scene.light.sun_azimuth_deg -= math.degrees(turned)  # the sun stays where it is in the world
            except (ValueError, OSError) as error:
                self.problem, self._refused = str(error), settings
        return self._scene

    def build(self, scene):
        """Begins to make whatever the scene and the views need that isn't there. Whether there is something to draw."""
        drawing, of_shot = self.drawing, keyed.put(scene, self._keys)
        sea, lit = drawing.sea, drawing.light
        if self._job is None and self._settings != self._refused:
            finest_m = FINEST_M if sea is None else drawing.finest_m() or sea.finest_m
            finest_m = min(max(finest_m, FINEST_M), COARSEST_M)
            # A coarser one would save work, but not so much that every step of a zoom is worth a new sea.
            keeps_sea = sea is not None and sea.serves(of_shot) and sea.finest_m <= finest_m <= 4 * sea.finest_m and drawing.knows_hulls()
            keeps_light = lit is not None and lit.serves(scene)
            if keeps_sea and keeps_light:
                self.problem = ""
            else:
                self._job = _job(self._settings, scene, of_shot, sea if keeps_sea else None, lit if keeps_light else None, finest_m,
                                 drawing.hulls.footprints_m)
        return sea is not None

    def poll(self):
        """Whether there is news of what is being built."""
        job = self._job
        if job is None or not job.is_done:
            return False
        self._job = None
        job.finish()
        if job.made is None:
            self.problem, self._refused = job.problem, job.key
        else:
            self.problem = ""
            self.drawing.take(*job.made)
        return True

    def _draw(self):
        try:
            if not self.is_broken:
                self._draw_view(bpy.context)
        except Exception as error:  # once, in words, rather than at every redraw
            self.problem, self.is_broken = str(error) or type(error).__name__, True
            _tend_soon()

    def _draw_view(self, context):
        obj = self.obj()
        self.seen = True
        if obj is None or context.scene.objects.get(obj.name) != obj or self.wants_mesh():
            _tend_soon()
            return
        scene = self.scene(obj, context.scene)
        is_hidden = obj.hide_get(view_layer=context.view_layer)
        if scene is not None and self.build(scene) and is_hidden and context.space_data.shading.type in SHADINGS:
            camera = Camera(gpu.matrix.get_projection_matrix(), gpu.matrix.get_model_view_matrix(),
                            gpu.state.viewport_get()[2:], obj.matrix_world)
            self.drawing.draw(context.region.as_pointer(), camera, scene, scene.shot.time_s(context.scene.frame_current_final),
                              self.drawing.light.exposure(scene, light.stops_by_hand(context.scene)),
                              context.window_manager.pelagic_preview.show_sky,
                              self.objects.seen(context, obj.matrix_world.inverted_safe(), scene.shot.time_s(2.0) - scene.shot.time_s(1.0)))
            if not self.drawing.knows_hulls():
                self.build(scene)
        if self.is_building or not is_hidden or self.drawing.is_coarse() or self.drawing.awaits_foam:
            _tend_soon()

    def wants_mesh(self):
        """Whether some view shows the mesh itself."""
        return any(space.shading.type not in SHADINGS for space in _spaces())

    def hide(self):
        """Hides the mesh in the windows' view layers. Whether it was to be seen in one."""
        obj, hidden = self.obj(), False
        for key, layer in _layers():
            if layer.objects.get(obj.name) == obj and not obj.hide_get(view_layer=layer):
                self.hidden_in.setdefault(key, obj.select_get(view_layer=layer))
                obj.hide_set(True, view_layer=layer)
                obj[HIDDEN] = True
                hidden = True
        return hidden

    def show(self):
        """Undoes hide()."""
        obj = self.obj()
        for (scene_name, layer_name), selected in self.hidden_in.items():
            bpy_scene = bpy.data.scenes.get(scene_name)
            layer = bpy_scene.view_layers.get(layer_name) if bpy_scene else None
            if obj is not None and layer is not None and layer.objects.get(obj.name) == obj:
                obj.hide_set(False, view_layer=layer)
                obj.select_set(selected, view_layer=layer)
                obj.pop(HIDDEN, None)
        self.hidden_in.clear()

    def is_shown_again(self):
        """Whether somebody has made the mesh visible that hide() hid."""
        obj = self.obj()
        return any(key in self.hidden_in and layer.objects.get(obj.name) == obj and not obj.hide_get(view_layer=layer)
                   for key, layer in _layers())


def _job(key, scene, of_shot, sea, lit, finest_m, footprints_m):
    """Makes a pelagic.GpuSea and a pelagic.GpuLight of a scene, the sea with its keys and what hulls want to know, those that aren't there."""
    def begin():
        makers = [] if sea else [lambda: pelagic.GpuSea.begin(of_shot, finest_m, footprints_m)]
        makers += [] if lit else [lambda: pelagic.GpuLight.begin(scene)]
        return [make() for make in makers]

    def together(*made):
        rest = iter(made)
        return sea or next(rest), lit or next(rest)

    return Job(key, begin, together)


_preview = None
_problem = ""  # why the last one went off by itself


def _layers():
    """The view layers that windows show, by the names of their scenes and their own."""
    for window in bpy.context.window_manager.windows:
        yield (window.scene.name, window.view_layer.name), window.view_layer


def _spaces():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                yield area.spaces.active


def is_on():
    return _preview is not None


def turn_on(obj):
    """Draws an ocean from now on. RuntimeError, in words, where this Blender can't."""
    global _preview, _problem
    turn_off()
    _problem = compat.shader_problem()
    if _problem:
        raise RuntimeError(_problem)
    _preview = Preview(obj)
    play.redraw()


def turn_off(problem=""):
    global _preview, _problem
    if _preview is None:
        return
    gone, _preview, _problem = _preview, None, problem
    gone.close()
    gone.show()
    play.redraw()


# ---- What a draw handler leaves to do


def _tend_soon():
    if not bpy.app.timers.is_registered(_tend):
        bpy.app.timers.register(_tend, first_interval=POLL_S)


def _tend():
    """A timer: hides and shows the mesh, takes what was built, draws a view again that has come to rest."""
    preview = _preview
    if preview is None:
        return None
    if preview.is_broken or preview.obj() is None:
        turn_off(preview.problem)
        return None
    if preview.hidden_in and preview.is_shown_again():
        turn_off()
        return None
    if preview.poll() or preview.drawing.has_foam():
        preview.drawing.awaits_foam = False  # the next picture takes it, whenever a view shows the sea
        play.redraw()
    if preview.wants_mesh():
        if preview.hidden_in:
            preview.show()
    elif preview.drawing.sea is not None and preview.hide():
        play.redraw()
    if preview.is_building or preview.drawing.awaits_foam:
        return POLL_S
    if preview.drawing.is_coarse():
        # Views that were drawn since the last look are moving.
        if not preview.seen:
            play.redraw()
            return None
        preview.seen = False
        return STILL_S
    return None


# ---- The file's data


@persistent
def _see_changes(_bpy_scene, depsgraph):
    if _preview is not None:
        gpu_objects.changed(depsgraph)


@persistent
def _before_save(*_):
    if _preview is not None:
        _preview.show()


@persistent
def _after_save(*_):
    if _preview is not None:
        _tend_soon()


@persistent
def _after_undo(*_):
    """The mesh is as it was at that step, or in an autosave: perhaps shown, perhaps hidden by a preview that is off."""
    if _preview is not None:
        if _preview.obj() is not None and _preview.hidden_in:
            _preview.hide()
        return
    for obj in ocean.oceans():
        if HIDDEN in obj:
            for _, layer in _layers():
                if layer.objects.get(obj.name) == obj:
                    obj.hide_set(False, view_layer=layer)
            del obj[HIDDEN]


@persistent
def _before_load(*_):
    global _preview
    if _preview is not None:
        gone, _preview = _preview, None
        gone.close()


HANDLERS = (("depsgraph_update_post", _see_changes), ("frame_change_post", _see_changes), ("save_pre", _before_save), ("save_post", _after_save), ("undo_post", _after_undo),
            ("redo_post", _after_undo), ("load_pre", _before_load), ("load_post", _after_undo))


# ---- For the artist


class PELAGIC_OT_viewport_preview(bpy.types.Operator):
    """Draw the sea in solid views as it is lit, to the horizon, and hide its mesh; or stop that"""

    bl_idname = "pelagic.viewport_preview"
    bl_label = "Viewport Preview"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return is_on() or _ocean_of(context) is not None

    def execute(self, context):
        if is_on():
            turn_off()
            return {"FINISHED"}
        try:
            turn_on(_ocean_of(context))
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def _ocean_of(context):
    """The active object, or else the first ocean that is seen; None without one."""
    if pelagic is None:
        return None
    if ocean.is_ocean(context.object):
        return context.object
    return next((obj for obj in ocean.oceans() if obj.visible_get(view_layer=context.view_layer)), None)


class PELAGIC_PG_preview(bpy.types.PropertyGroup):
    show_sky: BoolProperty(name="Sky", default=False, update=lambda _group, _context: play.redraw(),
                           description="Draw the sky and the sun behind everything, too")


class PELAGIC_PT_preview(bpy.types.Panel):
    bl_label = "Viewport Preview"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Pelagic"

    @classmethod
    def poll(cls, context):
        return is_on() or _ocean_of(context) is not None

    def draw(self, context):
        layout = self.layout
        layout.operator(PELAGIC_OT_viewport_preview.bl_idname, icon="MOD_OCEAN", depress=is_on())
        layout.prop(context.window_manager.pelagic_preview, "show_sky")
        problem = _preview.problem if is_on() else _problem
        if problem:
            draw_words(layout.box(), problem)
        elif is_on() and _preview.wants_mesh():
            draw_words(layout.box(), "Waiting: a view in Rendered or Wireframe shows the mesh")
        elif is_on() and _preview.drawing.is_under_water:
            draw_words(layout.box(), "The view is under water, which can't be drawn: raise it")
        elif is_on() and _preview.is_building:
            layout.label(text="Building the sea…", icon="SORTTIME")


def _header(self, context):
    row = self.layout.row(align=True)
    if PELAGIC_OT_viewport_preview.poll(context):
        row.operator(PELAGIC_OT_viewport_preview.bl_idname, text="", icon="MOD_OCEAN", depress=is_on())
    if pelagic is not None and ocean.is_ocean(context.object):
        row.menu(PELAGIC_MT_presets.bl_idname, text="", icon="PRESET")


CLASSES = (PELAGIC_OT_viewport_preview, PELAGIC_PG_preview, PELAGIC_PT_preview)


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.WindowManager.pelagic_preview = PointerProperty(type=PELAGIC_PG_preview)
    bpy.types.VIEW3D_HT_header.append(_header)
    handlers.add(HANDLERS)


def unregister():
    turn_off()
    if bpy.app.timers.is_registered(_tend):
        bpy.app.timers.unregister(_tend)
    handlers.remove(HANDLERS)
    bpy.types.VIEW3D_HT_header.remove(_header)
    del bpy.types.WindowManager.pelagic_preview
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
