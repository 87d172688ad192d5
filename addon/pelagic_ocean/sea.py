# SPDX-License-Identifier: GPL-3.0-or-later
"""A sea on a surface, and its buffers at a moment. Knows nothing of Blender.

No Python in threads of its own, in the whole add-on: before Blender enters Python it asks whether *some* thread is in it,
not whether its own is, so that beside a thread of ours two would be in it at once, which ends in a crash. What runs beside
Blender is a pelagic.Task, in a native thread of the module that never enters Python.
"""

import math
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from . import surfaces
from .module import pelagic


NUMBERS = {"coverage", "foam_active", "foam_age"}  # products of one number a point; others have three


@dataclass(frozen=True)
class Moment:
    """What a sea is shown at: its time [s], how much of that passes in a second of the screen, and for the projected grid
    whose view, what share of the columns and rows that it needs, and how many points at most."""

    time_s: float
    time_scale: float = 1.0
    view: object = None
    share: float = 1.0
    most: float = math.inf

    @property
    def seen_from(self):
        """What the points of a surface that moves depend on."""
        return self.view, self.share, self.most


class Job:
    """What Tasks of the module work out beside everything else: one thing, `made`, or `problem`, why not."""

    def __init__(self, key, begin, make, view=None):
        """key, view: what it is for. begin: gives the pelagic.Tasks. make: makes the thing of their results."""
        self.key, self.view, self.made, self.problem = key, view, None, ""
        self._make, self._tasks = make, []
        with self._told():
            self._tasks = begin()

    @property
    def is_done(self):
        return all(task.is_done for task in self._tasks)

    def finish(self):
        """Waits for it."""
        with self._told():
            if not self.problem:
                self.made = self._make(*[task.result() for task in self._tasks])

    @contextmanager
    def _told(self):
        try:
            yield
        except Exception as error:  # a timer's function has nobody who would hear of it
            self.problem = str(error) or type(error).__name__


class BuiltSea:
    """A sea on a surface, and the buffers of one moment. While Blender copies the mesh, which keeps one thread busy, the
    next moment is computed."""

    @staticmethod
    def job(key, scene, surface, view, velocity):
        """A Job that builds one. surface: None for the projected grid, whose points are those of a pelagic.View. velocity:
        whether that is asked for."""
        effects = pelagic.effects(scene)
        products = (["position", "slope_variance"] + ["velocity"] * velocity + ["coverage"] * ("whitecaps" in effects) +
                    ["foam_active", "foam_age"] * ("living foam" in effects))

        def begin():
            if surface is None:
                return [pelagic.Sea.begin(scene, products, views=[view])]
            levels_m = surface.levels_m()
            return [pelagic.Sea.begin(scene, products, cell_m=levels_m, pixel_m=levels_m, lattice=surface.lattice)]

        return Job(key, begin, lambda sea: BuiltSea(sea, surface, scene.surface.size_m), view)

    def __init__(self, sea, surface, uv_m):
        self.sea = sea
        self._fixed, self._uv_m = surface, uv_m
        self._lock = threading.RLock()  # a render has a thread of its own
        self._frame = pelagic.Frame(self.sea)
        self._moment, self._surface, self._arrays = None, None, {}
        self._seen_from = None  # Moment.seen_from of a surface that moves
        self._task, self._coming = None, None  # what is being computed, and the moment of that
        self._asked_frame = None

    @property
    def needs_view(self):
        return self._fixed is None

    def serves(self, view):
        return self._fixed is not None or (view is not None and self.sea.serves(view))

    def buffers(self, moment, patience_s=None):
        """The surface, and each product's array, at a Moment, until the next call of this or of prepare(). With a patience
        None where the foam's past isn't gone through after so long [s]: what is done of it is kept, also for other moments."""
        with self._lock:
            self._begin(moment)
            if patience_s is not None and not self._is_there_in(patience_s):
                return None
            self._finish()
            return self._surface, self._arrays

    @property
    def is_new(self):
        """Whether no moment was asked for yet."""
        return self._coming is None

    @property
    def looks_back(self):
        """Whether a moment may take long, because its foam has a past."""
        return "foam_age" in self.sea.products

    def without_foam(self, moment):
        """The surface and each product's array at a Moment, at once: no foam in them."""
        with self._lock:
            surface = self._surface_at(moment)
            arrays = {product: np.zeros(len(surface), np.float32) for product in self.sea.products if product in NUMBERS}
            arrays |= self.frame_at(moment.time_s).evaluate(
                surface.rest, surface.origin_m, **_footprints(surface),
                outputs=[product for product in self.sea.products if product not in NUMBERS])
            _finish_arrays(arrays, surface, moment)
            return surface, arrays

    @property
    def progress(self):
        """The share of the foam's past that is gone through; 1 where nothing is waited for."""
        task = self._task
        if task is None or task.is_done:
            return 1.0
        return task.progress[0] if task.progress else 0.0

    def _is_there_in(self, patience_s):
        """False for what looks back over many earlier times alone: a step that is slow for its size is waited for."""
        until_s = time.monotonic() + patience_s
        while self._task is not None and not self._task.is_done:
            if time.monotonic() > until_s and self._task.progress is not None:
                return False
            time.sleep(0.001)
        return True

    def prepare(self, moment):
        """Begins to compute a moment that is likely to be asked for next."""
        with self._lock:
            self._begin(moment)

    def frame_at(self, time_s):
        """A pelagic.Frame at a time [s]; the next call may set it to another."""
        with self._lock:
            if self._asked_frame is None:
                self._asked_frame = pelagic.Frame(self.sea)
                self._asked_frame.set(time_s)
            elif self._asked_frame.time_s != time_s:
                self._asked_frame.set(time_s)
            return self._asked_frame

    def _begin(self, moment):
        if moment == (self._coming if self._task else self._moment):
            return
        self.drop()
        surface = self._surface_at(moment)
        self._moment = None
        if self._surface is None or len(surface) != len(self._surface):
            self._arrays = {product: np.empty(len(surface) if product in NUMBERS else (len(surface), 3), np.float32)
                            for product in self.sea.products}
        self._surface, self._seen_from = surface, moment.seen_from
        self._task = self._frame.begin(moment.time_s, surface.rest, surface.origin_m, **_footprints(surface), **self._arrays)
        self._coming = moment

    def drop(self):
        """What was begun isn't wanted any more."""
        with self._lock:
            if self._task is None:
                return
            task, self._task = self._task, None
            task.cancel()
            try:
                task.result()
            except pelagic.Cancelled:
                pass

    def _finish(self):
        """Waits for what was begun, if anything was."""
        if self._task is None:
            return
        task, self._task = self._task, None
        task.result()
        _finish_arrays(self._arrays, self._surface, self._coming)
        self._moment = self._coming

    def _surface_at(self, moment):
        if self._fixed is not None:
            return self._fixed
        if self._surface is not None and self._seen_from == moment.seen_from:
            return self._surface
        return surfaces.projected_grid(self.sea, *moment.seen_from, self._uv_m)


def _footprints(surface):
    """Arguments of pelagic.Frame.begin() and evaluate()."""
    return {"cell_m": surface.cell_m, "pixel_m": surface.cell_m, "cell_axis_m": surface.cell_axis_m,
            "pixel_axis_m": surface.cell_axis_m, "rest_normal": surface.normal}


def _finish_arrays(arrays, surface, moment):
    """From the core's arrays to the mesh's: in the object's coordinates and the screen's seconds."""
    if surface.origin_m != (0.0, 0.0):
        arrays["position"][:, :2] += np.array(surface.origin_m, np.float32)
    if surface.height_m is not None:
        arrays["position"][:, 2] += surface.height_m
    if "velocity" in arrays and moment.time_scale != 1.0:
        arrays["velocity"] *= np.float32(moment.time_scale)  # metres in a second of the screen
