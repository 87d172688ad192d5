"""Blender's Ocean modifier beside a frame of ours of as many vertices, in one process, in turn.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \\
        --python tests/bench/blender_ocean.py [-- TURNS]

Blender's time: scene.frame_set() with the modifier's time keyframed (set from Python it would start over each frame)
and the evaluated mesh: simulation, normals and foam on, and the mesh that the modifier generates anew with edges,
faces and foam as vertex colours, which is most of it. Blender leaves the mesh's own normals to whoever asks for
them; nobody does here. Ours: Frame.set() and Frame.evaluate() of positions, normals, slope variance and whitecap
coverage into arrays that are made once. No mesh: blender_played.py has one. Both: one square of N × N waves, (N + 1)² vertices
on its own grid, nothing filtered, all the threads that the machine has. "in new arrays": where evaluate() must make its arrays each time.
"""

import os
import sys
from pathlib import Path

import bpy
import numpy as np
import pelagic

sys.path.insert(0, str(Path(__file__).parent))
from blender_sides import FPS, FRAMES, SIZE_M, Modifier, interleaved_ms  # noqa: E402

# N, target. The modifier's resolution r stands for r² × r² waves, and as many quads.
ROWS = ((1024, 40.0), (256, 30.0))
PRODUCTS = ("position", "normal", "slope_variance", "coverage")


class Ours:
    """One cascade on its own grid."""

    def __init__(self, n):
        scene = pelagic.Scene()
        scene.surface.size_m, scene.surface.resolution = SIZE_M, n
        scene.waves.cascades = [pelagic.CascadeSize(size_m=SIZE_M, resolution=n)]
        self.rest, _ = pelagic.patch(SIZE_M, n)
        self.frame = pelagic.Frame(pelagic.Sea(scene, PRODUCTS, cell_m=0.0, pixel_m=0.0,
                                               lattice=(-SIZE_M / 2, SIZE_M / n)))
        points = len(self.rest)
        self.arrays = {product: np.empty(points if product == "coverage" else (points, 3), np.float32)
                       for product in PRODUCTS}
        self.time_s = 0.0

    def set(self):
        self.time_s += 1.0 / FPS
        self.frame.set(self.time_s)

    def step(self):
        self.set()
        self.frame.evaluate(self.rest, **self.arrays)

    def step_anew(self):
        self.set()
        self.frame.evaluate(self.rest, outputs=PRODUCTS)


def main():
    given = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    turns = int(given[0]) if given else 5
    print(f"The Ocean modifier of Blender {bpy.app.version_string} against a frame of ours, "
          f"{len(os.sched_getaffinity(0))} CPUs, ms: medians of {turns} turns\n"
          f"of {FRAMES} frames of each (of four times as many at 256²)\n"
          "  theirs: frame_set with keyframed time: simulation with normals and foam, a mesh generated anew\n"
          "  ours:   set + evaluate of positions, normals, slope variance, coverage into numpy arrays; no mesh\n"
          f"  {'':8s} {'vertices':>9s} {'theirs':>9s} {'ours':>8s} {'set alone':>10s} {'in new arrays':>14s} "
          f"{'× faster':>9s}")
    for n, target in ROWS:
        theirs, ours = Modifier(n), Ours(n)
        modifier, whole, only_set, anew = interleaved_ms((theirs.step, ours.step, ours.set, ours.step_anew),
                                                         turns * 1024 // n)
        ratio = modifier / whole
        print(f"  {n:6d}²  {len(ours.rest):9d} {modifier:9.1f} {whole:8.2f} {only_set:10.2f} {anew:14.2f} {ratio:9.1f}  "
              f"≥ {target:g} {'met' if ratio >= target else 'missed'}", flush=True)
        theirs.remove()


main()
