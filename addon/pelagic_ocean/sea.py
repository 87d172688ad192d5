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


class _Slot:
    """One frame of a sea, its points and their buffers."""

    def __init__(self, sea, products):
        self.frame = pelagic.Frame(sea)
        self.moment, self.surface, self.arrays = None, None, {}
        self._products = products

    def evaluate(self, moment, surface):
        points = len(surface)
        if self.surface is None or points != len(self.surface):
            self.arrays = {product: np.empty(points if product == "coverage" else (points, 3), np.float32)
                           for product in self._products}
        # What a cell hides of the slopes depends on the cell alone, not on the time.
        wanted = {name: array for name, array in self.arrays.items()
                  if name != "slope_variance" or surface is not self.surface}
        self.moment, self.surface = None, surface
        self.frame.set(moment.time_s)
        self.frame.evaluate(surface.rest, surface.origin_m, cell_m=surface.cell_m, pixel_m=surface.cell_m, **wanted)
        position, velocity = self.arrays["position"], self.arrays["velocity"]
        if surface.origin_m != (0.0, 0.0):
            position[:, :2] += np.array(surface.origin_m, np.float32)
        if surface.height_m is not None:
            position[:, 2] += surface.height_m
        if moment.time_scale != 1.0:
            velocity *= np.float32(moment.time_scale)  # metres in a second of the screen
        self.moment = moment


class BuiltSea:
    """A sea on a surface. While Blender takes one frame over, which keeps one thread busy, the next one is computed."""

    def __init__(self, scene, surface, view):
        """surface: None for the projected grid, whose points are those of a pelagic.View."""
        products = ["position", "velocity", "slope_variance"] + ["coverage"] * scene.effects.whitecaps
        if surface is None:
            self.sea = pelagic.Sea(scene, products, views=[view])
        else:
            ladder_m = surface.ladder_m()
            self.sea = pelagic.Sea(scene, products, cell_m=ladder_m, pixel_m=ladder_m)
        self._products = products
        self._fixed, self._uv_m = surface, scene.surface.size_m
        self._lock = threading.RLock()
        self._shown, self._ahead = _Slot(self.sea, products), None
        self._worker = None
        self._asked_frame = None

    @property
    def needs_view(self):
        return self._fixed is None

    def serves(self, view):
        return self._fixed is not None or (view is not None and self.sea.serves(view))

    def buffers(self, moment, next_moment=None):
        """The surface, and each product's array, at a Moment, until the next call. next_moment: what is likely to be asked
        for next."""
        with self._lock:
            if moment != self._shown.moment:
                self._wait()
                if self._ahead is not None and self._ahead.moment == moment:
                    self._shown, self._ahead = self._ahead, self._shown
                else:
                    self._shown.evaluate(moment, self._surface_at(moment))
            if next_moment is not None and self._worker is None:
                self._begin(next_moment)
            return self._shown.surface, self._shown.arrays

    def frame_at(self, time_s):
        """A pelagic.Frame at a time [s]; the next call may set it to another."""
        with self._lock:
            if self._asked_frame is None:
                self._asked_frame = pelagic.Frame(self.sea)
                self._asked_frame.set(time_s)
            elif self._asked_frame.time_s != time_s:
                self._asked_frame.set(time_s)
            return self._asked_frame

    def _surface_at(self, moment):
        return self._fixed or surfaces.projected_grid(self.sea, moment.view, moment.share, self._uv_m)

    def _begin(self, moment):
        if self._ahead is None:
            self._ahead = _Slot(self.sea, self._products)
        elif self._ahead.moment == moment:
            return
        ahead = self._ahead
        self._worker = Worker(lambda: ahead.evaluate(moment, self._surface_at(moment)))

    def _wait(self):
        if self._worker is not None:
            self._worker.join()
            self._worker = None
