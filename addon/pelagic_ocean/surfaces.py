# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a sea is looked at: points at rest, what they can resolve, and the faces between them."""

import math
from dataclasses import dataclass, field

import numpy as np

from .module import pelagic

HORIZON_M = 30e3  # ends less than a pixel below the true horizon for cameras up to about 15 m above the sea
DEFAULT_CELL_M = 1.0  # of vertices without edges
FINEST_CELL = 4096  # at most: the largest cell of a mesh over its smallest
RING_GROWTH = 1.1  # each ring of quads round the patch is wider than the last by this factor


@dataclass(eq=False)
class Surface:
    """Points at rest and their faces.

    rest: float32 (n, 2) [m]. cell_m: float32 (n,), the distance to the neighbours, or a number for all. corners: int32,
    the faces' vertices one after another; face_starts: int32, where each begins; None for a mesh that has its faces.
    height_m: float32 (n,), what is added to z, or None. uv_m: the length that is 1 in the UV map.
    """

    signature: str
    rest: np.ndarray
    cell_m: object
    corners: np.ndarray = None
    face_starts: np.ndarray = None
    height_m: np.ndarray = None
    uv_m: float = 1.0
    ladder_m: list = field(init=False)

    def __post_init__(self):
        low, high = float(np.min(self.cell_m)), float(np.max(self.cell_m))
        rungs = math.ceil(math.log2(high / low) - 1e-6) + 1
        self.ladder_m = [low * 2**rung for rung in range(rungs)]

    def __len__(self):
        return len(self.rest)


def patch(size_m, resolution, horizon):
    """The square patch, its points first as in a bake, and round it, where wanted, rings out to the horizon."""
    signature = f"patch {size_m!r} {resolution} {horizon}"
    rest, quads = pelagic.patch(size_m, resolution)
    spacing_m = size_m / resolution
    cell_m = spacing_m
    if horizon and size_m < HORIZON_M:
        rest, quads, cell_m = _with_rings(rest, quads, size_m, resolution)
    starts = np.arange(0, quads.size, 4, dtype=np.int32)
    return Surface(signature, rest, cell_m, quads.ravel(), starts, uv_m=size_m)


def _with_rings(rest, quads, size_m, resolution):
    spacing_m = size_m / resolution
    side, row = np.arange(resolution), resolution + 1
    # The patch's edge, counter-clockwise from its south-west corner: 4N points.
    edge = np.concatenate([side, side * row + resolution, (row * row - 1) - side, (resolution - side) * row])
    count = math.ceil(math.log(1 + HORIZON_M / spacing_m * (RING_GROWTH - 1), RING_GROWTH))
    steps_m = spacing_m * RING_GROWTH ** np.arange(1, 1 + count)
    scale = 1 + np.cumsum(steps_m) / (size_m / 2)
    rings = scale[:, None, None] * rest[edge].astype(np.float64)

    first = len(rest) + len(edge) * np.arange(count)
    around = np.arange(len(edge))
    inner = np.concatenate([edge[None], first[:-1, None] + around])
    outer = first[:, None] + around
    ring_quads = np.stack([inner, outer, np.roll(outer, -1, 1), np.roll(inner, -1, 1)], axis=-1)
    cell_m = np.concatenate([np.full(len(rest), spacing_m),
                             np.repeat(np.maximum(steps_m, spacing_m * scale), len(edge))])
    return (np.concatenate([rest, rings.reshape(-1, 2)]).astype(np.float32),
            np.concatenate([quads, ring_quads.reshape(-1, 4)]).astype(np.int32), cell_m.astype(np.float32))


def own_mesh(rest, edges, signature):
    """A mesh's own vertices. rest: float32 (n, 3) [m]; edges: int32 (m, 2). A point's cell is its longest edge's length."""
    lengths = np.linalg.norm(rest[edges[:, 0], :2] - rest[edges[:, 1], :2], axis=1)
    cell_m = np.zeros(len(rest), np.float32)
    for end in (0, 1):
        np.maximum.at(cell_m, edges[:, end], lengths)
    # A vertex without edges is as fine as most others. The rest bounds the ladder.
    usual = np.median(cell_m[cell_m > 0]) if cell_m.any() else DEFAULT_CELL_M
    cell_m = np.clip(np.where(cell_m > 0, cell_m, usual), max(cell_m.max(), usual) / FINEST_CELL, None).astype(np.float32)
    height_m = np.ascontiguousarray(rest[:, 2])
    return Surface(signature, np.ascontiguousarray(rest[:, :2]), cell_m, height_m=height_m if height_m.any() else None)
