# SPDX-License-Identifier: GPL-3.0-or-later
"""A sea on a surface, and its buffers at a moment. Knows nothing of Blender, so it may be built and asked in any thread."""

import atexit
import threading
from dataclasses import dataclass

import numpy as np

from . import surfaces
from .module import pelagic


@dataclass(frozen=True)
class Moment:
    """What a sea is shown at: its time [s], how much of that passes in a second of the screen, and for the projected grid
    whose view, and what share of the columns and rows that it needs."""

    time_s: float
    time_scale: float = 1.0
    view: object = None
    share: float = 1.0


class Worker(threading.Thread):
    """A thread that is waited for when Blender ends."""

    _running = set()

    def __init__(self, work):
        super().__init__(daemon=True)
        self._work = work
        self._running.add(self)
        self.start()

    def run(self):
        try:
            self._work()
        finally:
            self._work = None  # whoever keeps the thread doesn't keep what it worked on
            self._running.discard(self)

    @classmethod
    def join_all(cls):
        for worker in list(cls._running):
            worker.join()


atexit.register(Worker.join_all)


class BuiltSea:
    """A sea on a surface, and the buffers of one moment. While Blender copies the mesh, which keeps one thread busy, the
    next moment is computed."""

    def __init__(self, scene, surface, view):
        """surface: None for the projected grid, whose points are those of a pelagic.View."""
        self._products = ["position", "velocity", "slope_variance"] + ["coverage"] * scene.effects.whitecaps
        if surface is None:
            self.sea = pelagic.Sea(scene, self._products, views=[view])
        else:
            ladder_m = surface.ladder_m()
            self.sea = pelagic.Sea(scene, self._products, cell_m=ladder_m, pixel_m=ladder_m, lattice=surface.lattice)
        self._fixed, self._uv_m = surface, scene.surface.size_m
        self._lock = threading.RLock()
        self._frame = pelagic.Frame(self.sea)
        self._moment, self._surface, self._arrays = None, None, {}
        self._seen_from = None  # the view and the share that a surface that moves is of
        self._worker, self._prepared = None, None
        self._asked_frame = None

    @property
    def needs_view(self):
        return self._fixed is None

    def serves(self, view):
        return self._fixed is not None or (view is not None and self.sea.serves(view))

    def buffers(self, moment):
        """The surface, and each product's array, at a Moment, until the next call of this or of prepare()."""
        with self._lock:
            self._wait()
            if moment != self._moment:
                self._evaluate(moment)
            return self._surface, self._arrays

    def prepare(self, moment):
        """Begins to compute a moment that is likely to be asked for next."""
        with self._lock:
            if moment != self._prepared:
                self._wait()
                self._worker, self._prepared = Worker(lambda: self._evaluate(moment)), moment

    def frame_at(self, time_s):
        """A pelagic.Frame at a time [s]; the next call may set it to another."""
        with self._lock:
            if self._asked_frame is None:
                self._asked_frame = pelagic.Frame(self.sea)
                self._asked_frame.set(time_s)
            elif self._asked_frame.time_s != time_s:
                self._asked_frame.set(time_s)
            return self._asked_frame

    def _evaluate(self, moment):
        before, surface = self._moment, self._surface_at(moment)
        self._moment = None
        if self._surface is None or len(surface) != len(self._surface):
            self._arrays = {product: np.empty(len(surface) if product == "coverage" else (len(surface), 3), np.float32)
                            for product in self._products}
        # What a cell hides of the slopes depends on the cell alone, not on the time.
        wanted = {name: array for name, array in self._arrays.items()
                  if name != "slope_variance" or before is None or surface is not self._surface}
        self._surface = surface
        self._frame.set(moment.time_s)
        self._frame.evaluate(surface.rest, surface.origin_m, cell_m=surface.cell_m, pixel_m=surface.cell_m,
                             cell_axis_m=surface.cell_axis_m, pixel_axis_m=surface.cell_axis_m, **wanted)
        position, velocity = self._arrays["position"], self._arrays["velocity"]
        if surface.origin_m != (0.0, 0.0):
            position[:, :2] += np.array(surface.origin_m, np.float32)
        if surface.height_m is not None:
            position[:, 2] += surface.height_m
        if moment.time_scale != 1.0:
            velocity *= np.float32(moment.time_scale)  # metres in a second of the screen
        self._seen_from = (moment.view, moment.share)
        self._moment = moment

    def _surface_at(self, moment):
        if self._fixed is not None:
            return self._fixed
        if self._surface is not None and self._seen_from == (moment.view, moment.share):
            return self._surface
        return surfaces.projected_grid(self.sea, moment.view, moment.share, self._uv_m)

    def _wait(self):
        if self._worker is not None:
            self._worker.join()
            self._worker, self._prepared = None, None
