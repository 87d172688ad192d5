# SPDX-License-Identifier: GPL-3.0-or-later
"""Oceans follow the timeline and their settings.

Everything happens in two handlers, after a frame change and after an evaluation of the scene; the others only say that
what is in a mesh may be old. How buffers reach a mesh, and why in this way: README.md, "How buffers reach a mesh".

A sea is built from what its settings say, and found again by them: nothing here holds an object of Blender's, so undo,
renaming and duplicates need no care, and oceans with the same settings share a sea. A new one is built beside
while the old one plays on; without a window, and during renders, whoever asks waits for it.
"""

import math
import threading
import weakref

import bpy
from bpy.app.handlers import persistent

from . import cages, depths, handlers, keyed, meshes, surfaces, upwelling
from .module import pelagic, without_place, words_of
from .ocean import files_of, frame_rate, is_ocean, migrate, oceans, pinhole_of, scene_of, settings_of, settled, wants_velocity
from .properties import FIELDS, PLACE
from .sea import BuiltSea, Moment

# A change of a key that feeds these is another sea. The rest only looks different; the clock matters to loops.
SEA_FEEDS = {"waves", "gusts", "foam", "quality", "surface", "grid"}
SEA_FIELDS = tuple(place for place, field in enumerate(FIELDS) if SEA_FEEDS & set(field.key["feeds"]))
DROPS_FIELDS = tuple(place for place, field in enumerate(FIELDS) if "spray" in field.key["feeds"])
CLOCK_FIELDS = tuple(place for place, field in enumerate(FIELDS) if "clock" in field.key["feeds"])
BAKED_ALONE = {"planet": "A planet", "near-far": "A mesh from near to far"}  # kinds of surfaces that nobody plays

POLL_S = 0.02  # how often a window looks whether a sea is ready
PATIENCE_S = 0.3  # how long a window waits for the past of foam that lives, where it jumped to another time


_built = weakref.WeakValueDictionary()  # what a sea is made of → the sea, as long as an ocean plays it


class Simulation:
    """The live simulation of an ocean."""

    def __init__(self, name=""):
        self._name = name  # of its ocean, for messages
        self.scene = None  # the pelagic.Scene of its settings
        self.problem = ""  # why there is no sea for them, in words
        self.shown = None  # what is in the mesh, its foam too
        self.awaited = None  # what of whose foam is_behind waits for
        self.due = None  # the moment of that, until it is begun
        self.whole = 0  # how many vertices a render has, where the mesh may have fewer
        self._built = None
        self._key = None
        self._asked = None  # what scene was made from
        self._tried = None  # that, and the files it names, of the sea that was begun last
        self._surface = None  # what identifies the surface that was made last, and it
        self._job = None
        self._warned, self._warnings = None, ()  # of which scene
        self._lit, self._upwelling = None, None  # of which scene
        self._time_s, self._keys = 0.0, {}  # of the frame that was last shown, and of the sea's numbers
        self._last = None  # the frame that was last asked for, the step to it, the view
        self.is_behind = False  # whether the mesh has waves alone, and waits for the past of their foam

    @property
    def sea(self):
        """The pelagic.Sea that plays; None while the first one is being built."""
        return self._built and self._built.sea

    @property
    def significant_height_m(self):
        """Of the sea that plays, at the frame that it was last shown at."""
        return self.sea.significant_height_at(self._time_s)

    @property
    def warnings(self):
        """What an artist should know of the sea of the settings, a sentence each. A matter of milliseconds, for panels."""
        asked = self._key if self._keys else self.scene
        if self._warned != asked:
            scene = keyed.put(self.scene, self._keys)
            self._warned, self._warnings = asked, () if scene.validate() else tuple(scene.warnings())
        return self._warnings

    def upwelling(self, is_lit):
        """upwelling.Upwelling of the settings; None where the water is the same everywhere, or nobody looks, which frees what it holds."""
        scene = self.scene if is_lit else None
        if self._lit is not scene:
            self._lit, self._upwelling = scene, None
            if scene and (upwelling.has_bubbles(scene) or upwelling.has_crests(scene)):
                try:
                    self._upwelling = upwelling.Upwelling(scene)
                except (ValueError, pelagic.ShotError):  # look.py says so
                    pass
        return self._upwelling

    @property
    def needs_view(self):
        """Whether the surface that plays is what a camera sees."""
        return self._built.needs_view

    @property
    def is_building(self):
        return self._job is not None

    def frame_at(self, time_s):
        """A pelagic.Frame at a time [s], for queries; the next call may set it to another. Any order, any thread."""
        return self._built.frame_at(time_s)

    def moment_at(self, frame, *seen_from):
        shot = self.scene.shot
        return Moment(shot.time_s(frame), shot.time_scale, *seen_from)

    def buffers(self, moment, patience_s):
        """The surface and the products' arrays at a moment, until look_ahead(). None: BuiltSea.buffers()."""
        return self._built.buffers(moment, patience_s)

    def without_foam(self, moment):
        """The same at once, with foam yet to come; None where foam needs no time."""
        return self._built.without_foam(moment) if self._built.looks_back else None

    @property
    def is_new(self):
        """Whether nothing of the foam's past is known yet."""
        return self._built.is_new

    def prepare(self, moment):
        self._built.prepare(moment)

    @property
    def progress(self):
        """Of what is_behind waits for, 0 to 1."""
        return self._built.progress if self._built else 1.0

    def look_ahead(self, frame):
        """While it plays in even steps before a camera that stands still, the frame after this one is computed beside what
        Blender does."""
        if self.shown is None or self._built is None or self.is_behind:
            return
        moment, last = self.shown[2], self._last
        step = frame - last[0] if last else 0
        self._last = (frame, step, moment.view)
        if step and self._last[1:] == last[1:]:
            self.prepare(self.moment_at(frame + step, *moment.seen_from))

    def follow(self, obj, bpy_scene, depsgraph, wait):
        """Brings the sea to the object's settings, or begins to. obj: the original. Returns the view that it is seen by,
        None where that doesn't matter."""
        try:
            read = _read[obj.name_full] = settings_of(obj.evaluated_get(depsgraph))
            keys = keyed.keys_of_sea(obj, read, bpy_scene)
            settings = settled(keyed.with_numbers(read, {path: each["keys"][0][1] for path, each in keys.items()}), obj, bpy_scene, depsgraph)
            surface_key, make_surface, view = _surface_of(obj, settings, bpy_scene, depsgraph)
            asked = (keyed.with_numbers(settings, keyed.of_numbers(read, keys)), frame_rate(bpy_scene), surface_key)  # a cage is a part of its scene
            if asked != self._asked:
                self.scene = scene_of(obj, bpy_scene, depsgraph, asked[0])
                self._asked = asked
        except Exception as error:
            self.refuse(error)
            return None
        clock = (asked[1],) + tuple(settings[place] for place in CLOCK_FIELDS) if keys or settings[PLACE["shot.loop_s"]] or settings[PLACE["waves.heroes"]] or settings[PLACE["waves.vessels"]] or settings[PLACE["sea.gust_fronts"]] else ()
        velocity = wants_velocity(obj, bpy_scene)
        drops = tuple(settings[place] for place in DROPS_FIELDS) if settings[PLACE["effects.spray_drops"]] else ()  # they are the sea's
        key = (tuple(settings[place] for place in SEA_FIELDS), clock, surface_key, velocity, drops, repr(keys))
        self._time_s, self._keys = self.scene.shot.time_s(bpy_scene.frame_current_final), keys
        if (key != self._key or self.problem and self._tried != (asked, files_of(asked[0]))
                or (view is not None and self._built and not self._built.serves(view))):
            self._seek(key, make_surface, view, velocity, wait)
        return view

    def _seek(self, key, make_surface, view, velocity, wait):
        known = _built.get(key)
        if known is not None and known.serves(view):
            self._adopt(key, known)
        elif wait or self._job is None:
            if self._job is None or (self._job.key, self._job.view) != (key, view):
                if self.is_behind and not _is_shared(self):
                    self._built.drop()  # nobody wants its foam any more
                    self.due = None
                if self._surface is None or self._surface[0] != key[2]:  # of a million points it takes longer than the sea
                    self._surface = key[2], make_surface()
                self._tried = self._asked, files_of(self._asked[0])
                self._job = BuiltSea.job(key, keyed.put(self.scene, self._keys), self._surface[1], view, velocity)
            if wait:
                self._take()
            else:
                _look_later()

    def poll(self):
        """Whether there is news of the sea that is being built."""
        if self._job is None or not self._job.is_done:
            return False
        self._take()
        return True

    def _take(self):
        """Waits for the sea that is being built."""
        job, self._job = self._job, None
        job.finish()
        if job.made is None:
            self._refuse(job.key, job.problem)
        else:
            _built[job.key] = job.made
            self._adopt(job.key, job.made)

    def _adopt(self, key, built):
        self._key, self._built, self.problem, self.due = key, built, "", None

    def refuse(self, error):
        """The ocean can't be shown as it is now: an exception says why."""
        self._refuse(None, words_of(error))

    def _refuse(self, key, problem):
        """The old sea plays on."""
        problem = without_place(problem)
        if bpy.app.background and problem != self.problem:  # nobody sees the panel
            print(f"Error: {self._name} stands still: {problem}", flush=True)
        self._key, self.problem = key, problem


_simulations = {}  # by the names of their objects
_read = {}  # the settings of oceans, by their names, as read since the last handler here began
_rendering = set()  # names of scenes
_objects = 0  # how many there were when settings of older files were looked for
is_saving = False  # whether files' markers are in the meshes' place
_is_told = False  # whether the pointer shows a progress
_turn = threading.RLock()  # a render has a thread of its own


# ---- Which oceans, and what of them


def _limits(obj, bpy_scene):
    """The share of the vertices a side, and how many vertices at most: all of them in a render."""
    if bpy_scene.name in _rendering:
        return 1.0, math.inf
    return obj.pelagic.viewport_percentage / 100, obj.pelagic.viewport_vertices or math.inf


def vertices_of(obj):
    """How many an ocean's mesh has, and how many in a render."""
    count = len(obj.data.vertices)
    return count, simulation_of(obj).whole or count


def _surface_of(obj, settings, bpy_scene, depsgraph):
    """What identifies the surface; a function that makes it; and the view, if it depends on one. ValueError if it can't be
    made."""
    mesh, setting = obj.data, obj.pelagic
    if setting.own_mesh:
        signature = mesh.get(meshes.SIGNATURE, "")
        if signature.split(" ")[:2] != ["own", str(len(mesh.vertices))] or meshes.REST not in mesh.attributes:
            if mesh.library:
                raise ValueError("The mesh is linked, and nobody knows where it is at rest: play it in its own file, and save that")
            signature = meshes.capture(mesh)
        return signature, lambda: surfaces.own_mesh(meshes.rest_of(mesh), meshes.edges_of(mesh), signature), None
    if settings[PLACE["surface.kind"]] in BAKED_ALONE:
        name = BAKED_ALONE[settings[PLACE["surface.kind"]]]
        raise ValueError(f"{name} is baked, not shown: bake it, or choose another kind of surface to look at")
    if settings[PLACE["surface.kind"]] == "cage":
        level = settings[PLACE["surface.cage_level"]]
        if level == "adaptive":
            raise ValueError("An adaptive cage is baked, not shown: bake it, or give its level to look at it")
        cage = cages.cage_of(obj, settings[PLACE["surface.cage_file"]] or "", depsgraph)
        return f"cage {level} {cage.content}", lambda: surfaces.cage(cage, level), None
    if settings[PLACE["surface.kind"]] == "projected-grid":
        pinhole = pinhole_of(obj, bpy_scene, depsgraph)
        if pinhole is None:
            raise ValueError("The projected grid is what the scene's camera sees: the scene needs one, with perspective")
        return "grid", lambda: None, pinhole.view()
    size_m, resolution, horizon = settings[PLACE["surface.size_m"]], settings[PLACE["surface.resolution"]], setting.horizon
    share, most = _limits(obj, bpy_scene)
    coarser = surfaces.resolution_within(most, size_m, max(1, round(resolution * share)), horizon)
    patch = (size_m, coarser, horizon, surfaces.patch_points(size_m, resolution, horizon))
    return patch, lambda: surfaces.patch(*patch), None


def _eye_of(obj, bpy_scene, depsgraph):
    """Where the camera is that sees the light in the waves, in the ocean's coordinates [m], and the ocean's axes in the world, rows of a
    matrix: (3 numbers, 9 numbers). None without a camera, and for Cycles in water that is seen through, which is opaque in EEVEE."""
    is_clear = bpy_scene.render.engine == "CYCLES" and depths.is_seen_through(obj, _simulation(obj).scene)
    pinhole = None if is_clear else pinhole_of(obj, bpy_scene, depsgraph)
    turned = obj.evaluated_get(depsgraph).matrix_world.to_3x3().normalized()
    return pinhole and (tuple(map(float, pinhole.position_m)), tuple(number for row in turned for number in row))


def is_lit_in_a_view():
    """Whether a view of a window shows materials."""
    manager = bpy.context.window_manager
    return any(area.type == "VIEW_3D" and area.spaces.active.shading.type in {"RENDERED", "MATERIAL"}
               for window in (manager.windows if manager else ()) for area in window.screen.areas)


def is_seen(obj, depsgraph):
    """Whether anything in this depsgraph shows it; during renders that is another question than in a window."""
    if not obj.evaluated_get(depsgraph).is_evaluated or obj.mode == "EDIT":
        return False
    layer = depsgraph.view_layer
    # What isn't in the view layer itself, and evaluated all the same, is there as an instance.
    return depsgraph.mode == "RENDER" or obj.visible_get(view_layer=layer) or obj.name not in layer.objects


def _driven(objects, depsgraph):
    """The oceans among the objects that are to be brought up to date: one for each mesh."""
    by_mesh = {}
    for obj in objects:
        if is_ocean(obj) and obj.data.name_full not in by_mesh and is_seen(obj, depsgraph):
            by_mesh[obj.data.name_full] = obj
    return list(by_mesh.values())


def _simulation(obj):
    return _simulations.setdefault(obj.name_full, Simulation(obj.name_full))


def _is_shared(simulation):
    """Whether another ocean plays the same sea."""
    return any(other is not simulation and other.sea is simulation.sea for other in _simulations.values())


def _driver_of(obj):
    """Of linked duplicates, the ocean that drives their mesh."""
    mesh = obj.original.data
    return next(other for other in oceans() if other.data == mesh)


def simulation_of(obj):
    """The Simulation of an ocean, original or evaluated; of linked duplicates, the one that drives their mesh."""
    return _simulation(_driver_of(obj))


def is_rendering():
    return bool(_rendering)


def settings_read(obj, depsgraph):
    """settings_of() an ocean as evaluated, for handlers after those here: reading takes 0.2 ms, once is enough."""
    return _read.pop(obj.name_full, None) or settings_of(obj.evaluated_get(depsgraph))


def brought_up(obj, bpy_scene, depsgraph, wait=False):
    """The Simulation of an ocean, brought to its settings though nothing may show it; without waiting in a window it has
    its old sea, or none, while that is being built."""
    first = _driver_of(obj)
    simulation = _simulation(first)
    simulation.follow(first, bpy_scene, depsgraph, wait or bpy.app.background or is_rendering())
    return simulation


def _show(obj, bpy_scene, depsgraph, again, wait=False, foam_later=False):
    """Brings the mesh of an ocean to the present, or, in a window, begins to. again: though it is there already.
    foam_later: shows the waves, and begins what takes longer."""
    try:
        _put(_simulation(obj), obj, bpy_scene, depsgraph, again, wait, foam_later)
    except Exception as error:  # a handler has nobody who would hear of it
        _simulation(obj).refuse(error)


def _put(simulation, obj, bpy_scene, depsgraph, again, wait, foam_later):
    wait = wait or bpy.app.background or is_rendering()
    view = simulation.follow(obj, bpy_scene, depsgraph, wait)
    if simulation.sea is None or (view is None and simulation.needs_view):
        return
    frame = bpy_scene.frame_current_final
    moment = simulation.moment_at(frame, view, *_limits(obj, bpy_scene) if view else ())
    lit = simulation.upwelling(bpy_scene.name in _rendering or is_lit_in_a_view())  # it would be a fifth of each frame's time
    eye = _eye_of(obj, bpy_scene, depsgraph) if lit and upwelling.has_crests(lit.scene) else None
    shown = (obj.data.name_full, id(simulation.sea), moment, obj.pelagic.uv_map, lit, eye)
    if shown == simulation.shown and not again and (is_saving or obj.data.get(meshes.SIGNATURE) != meshes.MARKER):
        return
    if shown == simulation.awaited and not again and not wait and (simulation.is_building or simulation.due or simulation.progress < 1.0):
        return
    # Waves first where nobody waits for foam, that is in a window: of a new sea at once, after a jump when it takes long.
    # Oceans that share a sea and show different moments of it would take its frame from each other, and none be done.
    waves = simulation.without_foam(moment) if foam_later or (not wait and simulation.is_new) else None
    buffers = waves or simulation.buffers(moment, None if wait or _is_shared(simulation) else PATIENCE_S)
    if buffers is None:
        buffers = waves = simulation.without_foam(moment)
    surface, arrays = buffers
    simulation.whole = surface.whole
    mesh = meshes.fillable(obj.data)
    if not meshes.holds(mesh, surface):
        if surface.faces is None:
            return
        meshes.put_surface(mesh, surface, obj.pelagic.uv_map and not waves)
    elif surface.moves and not _is_of_the_same_view(shown, simulation.shown or simulation.awaited):
        meshes.move_rest(mesh, surface)
    if surface.faces is not None and not waves:  # a mesh of the user's own keeps its maps
        meshes.keep_uv(mesh, surface, obj.pelagic.uv_map)
    added = lit and lit.added(arrays, surface, moment.time_s, eye)
    if added is not None:  # not in arrays themselves, which oceans of other waters share
        arrays = {**arrays, upwelling.ATTRIBUTE: added}
    meshes.put_frame(mesh, arrays)
    meshes.hand_over(mesh, obj.data)
    simulation.shown, simulation.awaited = (None, shown) if waves else (shown, None)
    simulation.is_behind, simulation.due = waves is not None, moment if waves else None
    if waves:
        _look_later()


def _is_of_the_same_view(shown, before):
    """Whether the points at rest are the same, of two values of Simulation.shown."""
    return before is not None and shown[:2] == before[:2] and shown[2].seen_from == before[2].seen_from


def forget(obj):
    """The ocean is another one from here on, though another had its name."""
    _simulations.pop(obj.name_full, None)


def show(obj, bpy_scene, depsgraph, foam_later=False):
    """Brings an ocean to the present, and waits for it; foam_later: for its waves, and begins the rest."""
    _show(obj, bpy_scene, depsgraph, False, True, foam_later)


def _forget_deleted():
    there = {obj.name_full for obj in oceans()}
    for name in set(_simulations) - there:
        del _simulations[name]
    cages.forget(there)


# ---- Handlers


@persistent
def _before_frame(*_):
    """What was appended, linked or read anew may be of an older file."""
    global _objects
    _objects = len(bpy.data.objects)
    for obj in oceans():
        migrate(obj)


@persistent
def _before_update(*_):
    if len(bpy.data.objects) != _objects:  # of a large scene they aren't gone through for each that moves
        _before_frame()


@persistent
def _on_frame(bpy_scene, depsgraph):
    with _turn:
        _read.clear()
        _forget_deleted()
        cages.let_go(depsgraph)
        driven = _driven(bpy.data.objects, depsgraph)
        for obj in driven:
            _show(obj, bpy_scene, depsgraph, True)
        if not _rendering:
            for obj in driven:  # after all of them: oceans with the same settings share a sea and its buffers
                _simulation(obj).look_ahead(bpy_scene.frame_current_final)


@persistent
def _on_update(bpy_scene, depsgraph):
    """A setting, the frame rate, an ocean shown again: whatever evaluates an ocean or the scene."""
    _read.clear()
    cages.let_go(depsgraph)
    if _rendering:
        return
    changed = {update.id.original for update in depsgraph.updates}
    if any(isinstance(each, bpy.types.Scene) for each in changed):
        _forget_deleted()
    elif not any(is_ocean(each) or each == bpy_scene.camera or cages.is_asked_for(each)
                 for each in changed if isinstance(each, bpy.types.Object)):
        return
    for obj in _driven(bpy.data.objects, depsgraph):
        _show(obj, bpy_scene, depsgraph, False)


@persistent
def _on_other_data(*_):
    """Undo, redo: meshes are of another moment now."""
    global _objects
    _objects = 0
    cages.forget()
    for simulation in _simulations.values():
        simulation.shown = simulation.awaited = None
    for obj in oceans():
        migrate(obj)
        obj.update_tag()


def _follow_shading():
    """Views that begin to show materials say so: nothing else would tell."""
    bpy.msgbus.clear_by_owner(_simulations)
    bpy.msgbus.subscribe_rna(key=(bpy.types.View3DShading, "type"), owner=_simulations, args=(), notify=_on_shading)


def _on_shading():
    for obj in oceans():
        obj.update_tag()


@persistent
def _on_load(*_):
    _follow_shading()
    _simulations.clear()
    _rendering.clear()
    _on_other_data()
    if bpy.app.background:  # nobody comes back to it: who looks at the meshes next finds the seas
        _on_frame(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    else:  # a window's first evaluation of a file calls no handler
        bpy.app.timers.register(_on_other_data, first_interval=0.0)


@persistent
def _on_render(bpy_scene, _depsgraph=None):
    _rendering.add(bpy_scene.name)


@persistent
def _on_render_end(bpy_scene, _depsgraph=None):
    _rendering.discard(bpy_scene.name)
    _on_other_data()


def _look_later():
    redraw()
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll, first_interval=POLL_S)


def _poll():
    """The timer while seas are being built, or the past of their foam is: their objects are evaluated again once they are
    ready."""
    busy, progress = False, []
    for name, simulation in list(_simulations.items()):  # a render's thread may add to them
        news = simulation.poll()
        if simulation.due and not simulation.is_building:  # Blender has copied and drawn the waves: threads are free
            simulation.prepare(simulation.due)
            simulation.due = None
        elif simulation.is_behind and not simulation.is_building:
            progress.append(simulation.progress)
            if progress[-1] == 1.0:
                news, simulation.is_behind = True, False
        if news:
            redraw()
            obj = next((obj for obj in oceans() if obj.name_full == name), None)
            if obj is not None:
                obj.update_tag()
        busy = busy or simulation.is_building or simulation.is_behind
    _tell(min(progress, default=1.0))
    return POLL_S if busy else None


def redraw():
    """The views, and the panels, whose words may be others."""
    manager = bpy.context.window_manager
    for window in manager.windows if manager else ():
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                area.tag_redraw()


def _tell(progress):
    """Shows it at the pointer, below 1."""
    global _is_told
    manager = bpy.context.window_manager
    if manager is not None and (progress < 1.0 or _is_told):
        if not _is_told:
            manager.progress_begin(0.0, 1.0)
        _is_told = progress < 1.0
        manager.progress_update(progress) if _is_told else manager.progress_end()


HANDLERS = (("frame_change_pre", _before_frame), ("depsgraph_update_pre", _before_update), ("frame_change_post", _on_frame), ("depsgraph_update_post", _on_update), ("undo_post", _on_other_data),
            ("redo_post", _on_other_data), ("load_post", _on_load), ("render_init", _on_render),
            ("render_complete", _on_render_end), ("render_cancel", _on_render_end))


def register():
    if pelagic is None:
        return
    handlers.add(HANDLERS)
    _follow_shading()
    if not bpy.app.background:  # a file that was open before: nothing else would tell its oceans
        bpy.app.timers.register(_on_other_data, first_interval=0.0)


def unregister():
    handlers.remove(HANDLERS)
    if bpy.app.timers.is_registered(_on_other_data):
        bpy.app.timers.unregister(_on_other_data)
    bpy.msgbus.clear_by_owner(_simulations)
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
    _simulations.clear()
    cages.forget()
