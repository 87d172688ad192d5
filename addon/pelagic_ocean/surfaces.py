# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a sea is looked at: points at rest, what they can resolve, and the faces between them."""

import bisect
import math
from dataclasses import dataclass

import numpy as np

from .module import pelagic

HORIZON_M = 30e3  # where rings of quads end that are as fine as they are wide
FAR_M = 90e3  # where the last one does, which has no waves: a pixel below the horizon for cameras up to about 30 m above the sea
DEFAULT_CELL_M = 1.0  # of vertices without edges
FINEST_CELL = 4096  # at most: the largest cell of a mesh over its smallest
RING_GROWTH = 1.1  # each ring of quads round the patch is wider than the last by this factor


@dataclass(eq=False)
class Surface:
    """Points at rest.

    signature: which faces they have, in words. rest: float32 (n, 2) [m], relative to origin_m. cell_m: float32 (n,), the
    distance to the neighbours, or a number for all. cell_axis_m: float32 (n, 2), the cells' long sides where they have
    such, cell_m then being the short ones, or None. faces: a function that gives (corners, starts), int32: the faces'
    vertices one after another, and where each face begins; None for a mesh that has its own. height_m: float32 (n,),
    what is added to z, or None; normal: float32 (n, 3), of the surface that the sea lies on there, or None. uv_m: the length that is 1 in the UV map. moves: whether the next frame has other points.
    lattice: (first_m, spacing_m, last_m) where all points lie at first + i·spacing in x and in y, up to last. whole: how many
    points a render has, where these are fewer; else 0.
    """

    signature: str
    rest: np.ndarray
    cell_m: object
    faces: object = None
    origin_m: tuple = (0.0, 0.0)
    height_m: np.ndarray = None
    uv_m: float = 1.0
    moves: bool = False
    lattice: tuple = None
    cell_axis_m: np.ndarray = None
    normal: np.ndarray = None
    whole: int = 0

    def __len__(self):
        return len(self.rest)

    def levels_m(self):
        """Footprints, powers of two apart, for all cells."""
        low, high = float(np.min(self.cell_m)), float(np.max(self.cell_m))
        return [low * 2**level for level in range(math.ceil(math.log2(high / low) - 1e-6) + 1)]

    def rest_3d(self):
        """float32 (n, 3): the points' places in the object's coordinates."""
        rest = np.zeros((len(self), 3), np.float32)
        np.add(self.rest, self.origin_m, out=rest[:, :2], casting="same_kind")
        if self.height_m is not None:
            rest[:, 2] = self.height_m
        return rest

    def uv(self, corners):
        """float32 (corners, 2) of the faces' corners: rest over size, 0.5 at the origin."""
        uv = self.rest_3d()[:, :2] / np.float32(self.uv_m) + np.float32(0.5)
        return uv[corners]


def _quads(corners):
    return corners.ravel(), np.arange(0, corners.size, 4, dtype=np.int32)


def patch_points(size_m, resolution, horizon):
    """How many points patch() has."""
    rings = _ring_count(size_m / resolution) + 1 if horizon and size_m < HORIZON_M else 0
    return (resolution + 1) ** 2 + 4 * resolution * rings


def resolution_within(most, size_m, resolution, horizon):
    """The finest resolution, up to this one, of a patch of at most so many points; 1 if none is so small."""
    coarser = range(1, resolution + 1)
    return max(1, bisect.bisect_right(coarser, most, key=lambda each: patch_points(size_m, each, horizon)))


def patch(size_m, resolution, horizon, whole=0):
    """The square patch, its points first as in a bake, and round it, where wanted, rings out to the horizon."""
    def points():
        rest, quads = pelagic.patch(size_m, resolution)
        if horizon and size_m < HORIZON_M:
            return _with_rings(rest, quads, size_m, resolution)
        return rest, quads, size_m / resolution

    made = [points()]
    rest, quads, cell_m = made[0]
    lattice = (-0.5 * size_m, cell_m, 0.5 * size_m) if len(quads) == resolution**2 else None
    return Surface(f"patch {size_m!r} {resolution} {horizon}", rest, cell_m,
                   lambda: _quads((made.pop() if made else points())[1]), uv_m=size_m, lattice=lattice, whole=whole)


def projected_grid(sea, view, share, most, uv_m):
    """What a view shows of a sea, to the horizon. share: of the columns and rows that the view needs; most: points at most."""
    grid = sea.projected_grid(view)
    whole = (grid.columns + 1) * (grid.rows + 1)
    share = min(share, math.sqrt(most / whole))
    if share < 1.0:
        fewer = tuple(max(1, math.floor((count + 1) * share) - 1) for count in (grid.columns, grid.rows))
        grid = sea.projected_grid(view, fewer)
    columns, rows = grid.columns, grid.rows
    return Surface(f"grid {columns} {rows}", grid.rest_m, grid.cell_m, lambda: _quads(pelagic.grid_quads(columns, rows)),
                   grid.origin_m, uv_m=uv_m, moves=True, cell_axis_m=grid.cell_axis_m, whole=whole)


def _ring_count(spacing_m):
    """Without the last one."""
    return math.ceil(math.log(1 + HORIZON_M / spacing_m * (RING_GROWTH - 1), RING_GROWTH))


def _with_rings(rest, quads, size_m, resolution):
    spacing_m = size_m / resolution
    side, row = np.arange(resolution), resolution + 1
    # The patch's edge, counter-clockwise from its south-west corner: 4N points.
    edge = np.concatenate([side, side * row + resolution, (row * row - 1) - side, (resolution - side) * row])
    steps_m = spacing_m * RING_GROWTH ** np.arange(1, 1 + _ring_count(spacing_m))
    scale = 1 + np.cumsum(steps_m) / (size_m / 2)
    ring_cell_m = np.maximum(steps_m, spacing_m * scale)
    ring_cell_m, scale = np.append(ring_cell_m, ring_cell_m[-1]), np.append(scale, FAR_M / (size_m / 2))
    count = len(scale)
    rings = scale[:, None, None] * rest[edge].astype(np.float64)

    first = len(rest) + len(edge) * np.arange(count)
    around = np.arange(len(edge))
    inner = np.concatenate([edge[None], first[:-1, None] + around])
    outer = first[:, None] + around
    ring_quads = np.stack([inner, outer, np.roll(outer, -1, 1), np.roll(inner, -1, 1)], axis=-1)
    cell_m = np.concatenate([np.full(len(rest), spacing_m),
                             np.repeat(ring_cell_m, len(edge))])
    return (np.concatenate([rest, rings.reshape(-1, 2)]).astype(np.float32),
            np.concatenate([quads, ring_quads.reshape(-1, 4)]).astype(np.int32), cell_m.astype(np.float32))


def cage(cage, level):
    """The limit surface of a pelagic.Cage, each of whose edges is halved so often."""
    surface = pelagic.CageSurface(cage, level)
    made = surface.limit()

    def faces():
        counts = surface.face_counts
        return surface.indices, np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int32)

    return Surface(f"cage {level} {cage.content}", made["rest_m"], made["cell_m"], faces, made["origin_m"],
                   made["height_m"], normal=made["normal"])


def own_mesh(rest, edges, signature):
    """A mesh's own vertices. rest: float32 (n, 3) [m]; edges: int32 (m, 2). A point's cell is its longest edge's length."""
    lengths = np.linalg.norm(rest[edges[:, 0], :2] - rest[edges[:, 1], :2], axis=1)
    cell_m = np.zeros(len(rest), np.float32)
    for end in (0, 1):
        np.maximum.at(cell_m, edges[:, end], lengths)
    # A vertex without edges is as fine as most others. The rest bounds the levels.
    usual = np.median(cell_m[cell_m > 0]) if cell_m.any() else DEFAULT_CELL_M
    cell_m = np.clip(np.where(cell_m > 0, cell_m, usual), max(cell_m.max(), usual) / FINEST_CELL, None).astype(np.float32)
    height_m = np.ascontiguousarray(rest[:, 2])
    return Surface(signature, np.ascontiguousarray(rest[:, :2]), cell_m, height_m=height_m if height_m.any() else None)
