# SPDX-License-Identifier: GPL-3.0-or-later
"""The sea of a fitted cage: the limit surface of a grid of quads with a ring of vertices round it.

Inside such a grid the limit surface of Catmull and Clark (1978) is the uniform bicubic B-spline of the vertices. Knows
nothing of Blender, whose own subdivision would keep the ring.
"""

import numpy as np

RING = 1  # of vertices outside the surface
SMOOTHED = {"position", "velocity"}  # what the cage's vertices have for the spline; the rest is at the vertices' limits


def refined(arrays, quads, parts):
    """The arrays of a cage's frame on its limit surface, at (quads · parts + 1)² places of even parameters, columns fastest.

    arrays: {product: float32 (n,) or (n, c)}, others untouched. quads: of the surface, a side. parts: of each quad a side; 1
    gives the limits of the vertices alone. ValueError for arrays of another size."""
    side = quads + 1 + 2 * RING
    made = dict(arrays)
    for name, values in arrays.items():
        if name == "origin_m":
            continue
        if len(values) != side**2:
            raise ValueError(f"a frame has {len(values)} points, and its cage has {side**2}")
        grid = values.reshape(side, side, -1)
        if name in SMOOTHED:
            fine = _along(_along(grid, quads, parts, _spline).swapaxes(0, 1), quads, parts, _spline).swapaxes(0, 1)
        else:
            fine = _along(_along(grid, quads, parts, _linear).swapaxes(0, 1), quads, parts, _linear).swapaxes(0, 1)
        made[name] = np.ascontiguousarray(fine).reshape((-1,) + values.shape[1:])
    return made


def _along(grid, quads, parts, weights_at):
    """Values between the first axis' rows: (quads · parts + 1, …) of (quads + 3, …)."""
    place = np.arange(quads * parts + 1)
    quad = np.minimum(place // parts, quads - 1)
    weights = weights_at(place / parts - quad).astype(np.float32)
    return sum(weight[:, None, None] * grid[quad + row] for row, weight in enumerate(weights))


def _spline(t):
    """Weights of four vertices in a row between the second and the third of them."""
    return np.stack([(1 - t)**3, 3 * t**3 - 6 * t**2 + 4, 1 + 3 * t + 3 * t**2 - 3 * t**3, t**3]) / 6


def _linear(t):
    return np.stack([0 * t, 1 - t, t, 0 * t])
