# SPDX-License-Identifier: GPL-3.0-or-later
"""The hulls of objects in the sea's light, in which the viewport preview draws no sea, and the foam along them (plugin/host/gpu/hulls.glsl).

Only a draw handler may call draw(): it needs the view's OpenGL context.
"""

import numpy as np

from .module import pelagic


class Hulls:
    """The textures, and what is in them."""

    def __init__(self):
        self._made = self._of = None
        self.map = self.places = None
        self.footprints_m = []  # what a pelagic.GpuSea must be built for to have foam along them

    def draw(self, bodies, origin_m, sea, texture):
        """Brings the textures up. bodies: Objects.seen(); origin_m: of the grid, in the sea's coordinates; sea: the pelagic.GpuSea; texture: makes
        one of an array."""
        # Parts as they lie in the body; to the tenth of a millimetre, or every turn of a ship would make its hull anew.
        found = [[(part.shape, np.round(body.in_body(part), 4) + 0.0) for part in body.parts] for body in bodies]
        wanted = [[(shape, matrix.tobytes()) for shape, matrix in each] for each in found]
        if wanted != self._of:
            self._made, self._of = pelagic.GpuHulls([_joined(each) for each in found]), wanted
            self.map = texture(self._made.map)
        to_grid = np.eye(4)
        to_grid[:2, 3] = -np.array(origin_m)
        grid_from, water_m = [to_grid @ body.matrix for body in bodies], [body.water_m if body.floats else None for body in bodies]
        self.footprints_m = self._made.footprints_m(grid_from, water_m)
        self.places = texture(self._made.places(grid_from, sea, origin_m, [body.per_s for body in bodies], water_m))


def _joined(parts):
    points, corners, count = [], [], 0
    for shape, matrix in parts:
        points.append(shape.points @ matrix[:3, :3].T + matrix[:3, 3])
        corners.append(shape.corners + count)
        count += len(shape.points)
    return np.concatenate(points), np.concatenate(corners)
