# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the water is: the live sea of an ocean object, which may be moved, turned and scaled."""

import numpy as np
from mathutils import Matrix

from . import ocean, play


def first_ocean(bpy_scene):
    """The scene's first ocean by name, None if it has none."""
    return min((obj for obj in bpy_scene.objects if ocean.is_ocean(obj)), key=lambda obj: obj.name, default=None)


def camera_depth_m(obj, bpy_scene, depsgraph=None):
    """How far below an ocean's level at rest the scene's camera is, to a centimetre and two digits, ≥ 0: its light changes little with less,
    and is made anew for each. None where it isn't below the surface, as that plays just now; at rest where there is no sea yet."""
    if obj.pelagic.surface.kind == "cage" or obj.pelagic.own_mesh:  # whose water may lie anywhere
        return None
    pinhole = ocean.pinhole_of(obj, bpy_scene, depsgraph)
    if pinhole is None:
        return None
    x, y, z = pinhole.position_m
    simulation = play.simulation_of(obj)
    if simulation.sea is None or abs(z) > 1.5 * simulation.significant_height_m:
        surface = 0.0
    else:
        surface = Water(obj, bpy_scene).heights([(x, y)])[0]
    return float(f"{round(max(-z, 0.0), 2):.2g}") if z < surface else None


class Water:
    """The sea of an ocean at one frame. Places are the ocean's own, in metres, with z = 0 at rest; `matrix` leads from
    them to the world."""

    def __init__(self, obj, bpy_scene, depsgraph=None, frame=None, wait=False):
        """frame: also between two; default the scene's. Without a depsgraph, which nobody may ask for while one is
        being evaluated: as it plays just now. wait: for the sea of today's settings, where an older one plays on.
        LookupError while the ocean has no sea, and of what is no ocean."""
        if not ocean.is_ocean(obj):
            raise LookupError(f"{obj.name} is no ocean")
        simulation = play.brought_up(obj, bpy_scene, depsgraph, wait) if depsgraph else play.simulation_of(obj)
        if simulation.sea is None:
            raise LookupError(f"{obj.name} has no sea: {simulation.problem or 'it is being built'}")
        frame = bpy_scene.frame_current_final if frame is None else frame
        self._frame = simulation.frame_at(simulation.scene.shot.time_s(frame))
        self.matrix = Matrix((obj.evaluated_get(depsgraph) if depsgraph else obj).matrix_world)

    def carried(self, rest, origin_m=(0.0, 0.0), cell_m=None):
        """Where the water is at this frame that is at rest (n, 2) in a calm sea: (n, 3), both from the origin. cell_m: without waves that
        are too short for cells of this size."""
        rest = np.ascontiguousarray(rest, np.float32)
        return self._frame.evaluate(rest, origin_m, cell_m=cell_m, outputs=("position",))["position"].astype(float)

    def heights(self, places):
        """How high the surface is at places (n, 2): (n,)."""
        return self._frame.heights(np.asarray(places, float), outputs=())["height_m"].astype(float)

    def world_heights(self, points):
        """The z in the world of the surface at points (n, 2) of the world: (n,). The ocean may be turned about z."""
        to_sea, to_world = np.array(self.matrix.inverted_safe()), np.array(self.matrix)
        places = np.asarray(points, float) @ to_sea[:2, :2].T + to_sea[:2, 3]
        return self.heights(places) * to_world[2, 2] + to_world[2, 3]
