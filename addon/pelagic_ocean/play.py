# SPDX-License-Identifier: GPL-3.0-or-later
"""Oceans follow the timeline and their settings.

Everything happens in two handlers, after a frame change and after an evaluation of the scene; the others only say that
what is in a mesh may be old. How buffers reach a mesh, and why in this way: examples/blender-buffers.md.

A sea is built from what its settings say, and found again by them: nothing here holds an object of Blender's, so undo,
renaming and duplicates need no care, and oceans with the same settings share a sea. A new one is built in a thread
while the old one plays on; without a window, and during renders, whoever asks waits for it.
"""

import threading
import weakref

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import meshes, surfaces
from .module import pelagic
from .ocean import frame_rate, is_ocean, migrate, oceans, scene_of, settings_of
from .properties import FIELDS

# What a change of feeds means to the sea: another one has to be built. The rest only looks different.
SEA_FEEDS = {"waves", "foam", "quality", "surface", "grid"}
SEA_FIELDS = tuple(place for place, field in enumerate(FIELDS) if SEA_FEEDS & set(field.key["feeds"]))
PLACE = {field.path: place for place, field in enumerate(FIELDS)}

POLL_S = 0.02  # how often a window looks whether a sea is ready


class BuiltSea:
    """A sea on a surface, one frame of it, and that frame's buffers."""

    def __init__(self, scene, surface):
        self.surface = surface
        products = ["position", "velocity", "slope_variance"] + ["coverage"] * scene.effects.whitecaps
        self.sea = pelagic.Sea(scene, products, cell_m=surface.ladder_m, pixel_m=surface.ladder_m)
        self._frame = pelagic.Frame(self.sea)
        self._asked_frame = None
        self._lock = threading.RLock()
        self._time_s = None
        points = len(surface)
        self._arrays = {product: np.empty(points if product == "coverage" else (points, 3), np.float32)
                        for product in products}

    def buffers(self, time_s):
        """Each product's array at a time [s], until the next call."""
        with self._lock:
            if time_s != self._time_s:
                surface = self.surface
                self._frame.set(time_s)
                self._frame.evaluate(surface.rest, cell_m=surface.cell_m, pixel_m=surface.cell_m, **self._arrays)
                if surface.height_m is not None:
                    self._arrays["position"][:, 2] += surface.height_m
                self._time_s = time_s
            return self._arrays

    def frame_at(self, time_s):
        with self._lock:
            if time_s == self._time_s:
                return self._frame
            if self._asked_frame is None:
                self._asked_frame = pelagic.Frame(self.sea)
                self._asked_frame.set(time_s)
            elif self._asked_frame.time_s != time_s:
                self._asked_frame.set(time_s)
            return self._asked_frame


class Job(threading.Thread):
    """Builds a sea beside everything else."""

    def __init__(self, key, make):
        super().__init__(daemon=True)
        self.key, self._make = key, make
        self.made, self.problem = None, ""
        self.start()

    def run(self):
        try:
            self.made = self._make()
        except (ValueError, RuntimeError, MemoryError) as error:
            self.problem = str(error) or type(error).__name__


_built = weakref.WeakValueDictionary()  # what a sea is made of → the sea, as long as an ocean plays it


class Simulation:
    """The live simulation of an ocean."""

    def __init__(self):
        self.scene = None  # the pelagic.Scene of its settings
        self.problem = ""  # why there is no sea for them, in words
        self.shown = None  # what is in the mesh
        self._built = None
        self._key = None
        self._asked = None  # what scene was made from
        self._job = None

    @property
    def sea(self):
        """The pelagic.Sea that plays; None while the first one is being built."""
        return self._built and self._built.sea

    @property
    def surface(self):
        return self._built and self._built.surface

    @property
    def is_building(self):
        return self._job is not None

    def frame_at(self, time_s):
        """A pelagic.Frame at a time [s], for queries; the next call may set it to another. Any order, any thread."""
        return self._built.frame_at(time_s)

    def buffers(self, time_s):
        return self._built.buffers(time_s)

    def follow(self, obj, bpy_scene, depsgraph, wait):
        """Brings the sea to the object's settings, or begins to. obj: the original."""
        settings = settings_of(obj.evaluated_get(depsgraph))
        surface_key, make_surface = _surface_of(obj, settings, bpy_scene)
        asked = (settings, frame_rate(bpy_scene))
        key = (tuple(settings[place] for place in SEA_FIELDS), surface_key)
        if asked != self._asked:
            try:
                self.scene = scene_of(obj, bpy_scene, depsgraph, settings)
            except (ValueError, OSError) as error:
                self._refuse(key, str(error))
            self._asked = asked
        if key != self._key:
            self._seek(key, self.scene, make_surface, wait)

    def _seek(self, key, scene, make_surface, wait):
        known = _built.get(key)
        if known is not None:
            self._adopt(key, known)
        elif wait or self._job is None:
            self._job = Job(key, lambda: BuiltSea(scene, make_surface()))
            if wait:
                self._job.join()
                self.poll()
            elif not bpy.app.timers.is_registered(_poll):
                bpy.app.timers.register(_poll, first_interval=POLL_S)

    def poll(self):
        """Whether there is news from the thread."""
        job = self._job
        if job is None or job.is_alive():
            return False
        self._job = None
        if job.made is None:
            self._refuse(job.key, job.problem)
        else:
            _built[job.key] = job.made
            self._adopt(job.key, job.made)
        return True

    def _adopt(self, key, built):
        self._key, self._built, self.problem = key, built, ""

    def _refuse(self, key, problem):
        """The old sea plays on."""
        self._key, self.problem = key, problem


_simulations = {}  # by the names of their objects
_rendering = set()  # names of scenes


# ---- Which oceans, and what of them


def _surface_of(obj, settings, bpy_scene):
    """What identifies the surface, and a function that makes it, without Blender, in a thread."""
    mesh, setting = obj.data, obj.pelagic
    if setting.own_mesh:
        signature = mesh.get(meshes.SIGNATURE, "")
        if signature.split(" ")[:2] != ["own", str(len(mesh.vertices))]:
            signature = meshes.capture(mesh)
        rest, edges = meshes.rest_of(mesh), meshes.edges_of(mesh)
        return signature, lambda: surfaces.own_mesh(rest, edges, signature)
    resolution = settings[PLACE["surface.resolution"]]
    if bpy_scene.name not in _rendering:
        resolution = max(1, round(resolution * setting.viewport_percentage / 100))
    size_m, horizon = settings[PLACE["surface.size_m"]], setting.horizon
    return ("patch", size_m, resolution, horizon), lambda: surfaces.patch(size_m, resolution, horizon)


def _is_seen(obj, depsgraph):
    """Whether anything in this depsgraph shows it; during renders that is another question than in a window."""
    if not obj.evaluated_get(depsgraph).is_evaluated or obj.mode == "EDIT":
        return False
    return depsgraph.mode == "RENDER" or obj.visible_get(view_layer=depsgraph.view_layer)


def _driven(objects, depsgraph):
    """The oceans among the objects that are to be brought up to date: one for each mesh."""
    by_mesh = {}
    for obj in objects:
        if is_ocean(obj) and obj.data.name_full not in by_mesh and _is_seen(obj, depsgraph):
            by_mesh[obj.data.name_full] = obj
    return list(by_mesh.values())


def _simulation(obj):
    return _simulations.setdefault(obj.name_full, Simulation())


def simulation_of(obj):
    """The Simulation of an ocean, original or evaluated; of linked duplicates, the one that drives their mesh."""
    mesh = obj.original.data
    first = next(other for other in oceans() if other.data == mesh)
    return _simulation(first)


def brought_up(obj, bpy_scene, depsgraph):
    """The Simulation of an ocean, brought to its settings though nothing may show it; it has no sea while that is being
    built."""
    mesh = obj.original.data
    first = next(other for other in oceans() if other.data == mesh)
    simulation = _simulation(first)
    simulation.follow(first, bpy_scene, depsgraph, bpy.app.background or bool(_rendering))
    return simulation


def _show(obj, bpy_scene, depsgraph, again):
    """Brings the mesh of an ocean to the present. again: though it is there already."""
    simulation = _simulation(obj)
    simulation.follow(obj, bpy_scene, depsgraph, bpy.app.background or bool(_rendering))
    surface = simulation.surface
    if surface is None:
        return
    time_s = simulation.scene.shot.time_s(bpy_scene.frame_current_final)
    shown = (obj.data.name_full, surface.signature, id(simulation.sea), time_s)
    if shown == simulation.shown and not again:
        return
    if not meshes.holds(obj.data, surface):
        if surface.corners is None:
            return
        meshes.put_surface(obj.data, surface)
    meshes.put_frame(obj.data, simulation.buffers(time_s))
    simulation.shown = shown


def show(obj, bpy_scene, depsgraph):
    """Brings an ocean to the present, and waits for it."""
    simulation = _simulation(obj)
    simulation.follow(obj, bpy_scene, depsgraph, True)
    _show(obj, bpy_scene, depsgraph, True)


def _forget_deleted():
    for name in set(_simulations) - {obj.name_full for obj in oceans()}:
        del _simulations[name]


# ---- Handlers


@persistent
def _on_frame(bpy_scene, depsgraph):
    _forget_deleted()
    for obj in _driven(bpy.data.objects, depsgraph):
        _show(obj, bpy_scene, depsgraph, True)


@persistent
def _on_update(bpy_scene, depsgraph):
    """A setting, the frame rate, an ocean shown again: whatever evaluates an ocean or the scene."""
    if _rendering:
        return
    changed = {update.id.original for update in depsgraph.updates}
    if any(isinstance(each, bpy.types.Scene) for each in changed):
        _forget_deleted()
    elif not any(is_ocean(each) or each == bpy_scene.camera for each in changed if isinstance(each, bpy.types.Object)):
        return
    for obj in _driven(bpy.data.objects, depsgraph):
        _show(obj, bpy_scene, depsgraph, False)


@persistent
def _on_other_data(*_):
    """Undo, redo: meshes are of another moment now."""
    for simulation in _simulations.values():
        simulation.shown = None
    for obj in oceans():
        migrate(obj)
        obj.update_tag()


@persistent
def _on_load(*_):
    _simulations.clear()
    _rendering.clear()
    _on_other_data()


@persistent
def _on_render(bpy_scene, _depsgraph=None):
    _rendering.add(bpy_scene.name)


@persistent
def _on_render_end(bpy_scene, _depsgraph=None):
    _rendering.discard(bpy_scene.name)
    _on_other_data()


def _poll():
    """The timer while seas are being built: their objects are evaluated again once they are ready."""
    busy = False
    for name, simulation in _simulations.items():
        if simulation.poll():
            obj = next((obj for obj in oceans() if obj.name_full == name), None)
            if obj is not None:
                obj.update_tag()
        busy = busy or simulation.is_building
    return POLL_S if busy else None


HANDLERS = (("frame_change_post", _on_frame), ("depsgraph_update_post", _on_update), ("undo_post", _on_other_data),
            ("redo_post", _on_other_data), ("load_post", _on_load), ("render_init", _on_render),
            ("render_complete", _on_render_end), ("render_cancel", _on_render_end))


def register():
    if pelagic is None:
        return
    for where, handler in HANDLERS:
        getattr(bpy.app.handlers, where).append(handler)


def unregister():
    for where, handler in HANDLERS:
        handlers = getattr(bpy.app.handlers, where)
        if handler in handlers:
            handlers.remove(handler)
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
    _simulations.clear()
