# SPDX-License-Identifier: GPL-3.0-or-later
"""The hulls of objects in the sea's light, in which the viewport preview draws no sea (plugin/host/gpu/hulls.glsl).

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import numpy as np
from mathutils import Matrix

from . import bodies
from .module import pelagic

_dirty = set()  # names of objects whose shape has changed since it was read


def changed(depsgraph):
    """Takes notice of an update of the scene's."""
    _dirty.update(update.id.name for update in depsgraph.updates if update.is_updated_geometry and hasattr(update.id, "type"))


class Hulls:
    """The textures, and what is in them."""

    def __init__(self):
        self._shapes = {}  # name of a part → its triangles; None of what has no faces
        self._made = self._of = None
        self.map = self.places = None

    def draw(self, parts, sea_from_world, origin_m, texture):
        """Brings the textures up. parts: Shadow.parts(); origin_m: of the grid, in the sea's coordinates; texture: makes one of an array."""
        for name in _dirty:
            self._shapes.pop(name, None)
        _dirty.clear()
        found = {}
        for name, evaluated, body in parts:
            if name not in self._shapes:
                self._shapes[name] = bodies.triangles_of(evaluated)
            if self._shapes[name] is not None:
                # As it lies in the body; to the tenth of a millimetre, or every turn of a ship would make its hull anew.
                found.setdefault(body, {})[name] = np.round(np.array(body.matrix_world.inverted_safe() @ evaluated.matrix_world, float), 4) + 0.0
        wanted = [[(id(self._shapes[name]), matrix.tobytes()) for name, matrix in each.items()] for each in found.values()]
        if wanted != self._of:
            self._made, self._of = pelagic.GpuHulls([self._joined(each) for each in found.values()]), wanted
            self.map = texture(self._made.map)
        from_world = Matrix.Translation((-origin_m[0], -origin_m[1], 0.0)) @ sea_from_world
        self.places = texture(self._made.places([np.array(from_world @ body.matrix_world, float) for body in found]))

    def _joined(self, parts):
        points, corners, count = [], [], 0
        for name, matrix in parts.items():
            own, triangles = self._shapes[name]
            points.append(own @ matrix[:3, :3].T + matrix[:3, 3])
            corners.append(triangles + count)
            count += len(own)
        return np.concatenate(points), np.concatenate(corners)
