"""The add-on's ocean in Blender: what a frame change costs beside the Ocean modifier and beside the copy of the mesh that
Blender makes anyway, what part of it is ours, and how long a moved slider takes.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \\
        --python tests/bench/blender_played.py [-- TURNS]

One frame change: scene.frame_set() until the evaluated mesh is there, with foam and normals, of (N + 1)² vertices; each
side in a scene of its own, in turn. The modifier: its time keyframed, its mesh generated anew. Pelagic: positions,
velocity, slope variance and coverage into the mesh, whose normals Blender computes. "as many waves": one square of N × N
waves on the mesh's own grid, as the modifier's; "default sea": what Add Ocean makes, four cascades of 256². The copy: a
tagged update of a plain mesh; bare, and with the attributes and the UV map that ours has.

Our part: the add-on's handlers, from the first to the last, of one frame change. A slider: the wind of the default sea set
and the scene evaluated until the new sea is in the mesh, in frame changes of that ocean. Without a window the sea is
built at once; in one the same work is done beside the old sea, which plays on.
"""

import statistics
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import blender_sides  # noqa: E402
from blender_sides import AddOn, Copy, Modifier, interleaved_ms, meshes  # noqa: E402

SIZES = (1024, 256)
OF_THE_COPY = 0.8  # × modifier / copy, at least
OUR_PART = 1 / 4  # of the copy, at most
SLIDER_FRAMES = 10  # at most
WINDS_MPS = (14.0, 9.0, 20.0, 6.0, 12.0)


class Stopwatch:
    """The time between the first and the last of Blender's handlers, and in one function."""

    def __init__(self):
        self.handlers_ms, self.writing_ms = [], []
        self._start = None
        for name in ("frame_change_post", "depsgraph_update_post"):
            handlers = getattr(bpy.app.handlers, name)
            handlers.insert(0, self._first)
            handlers.append(self._last)
        self._put_frame, meshes.put_frame = meshes.put_frame, self._timed_put_frame

    def _first(self, *_):
        self._start = time.perf_counter()

    def _last(self, *_):
        self._spent_ms += 1e3 * (time.perf_counter() - self._start)

    def _timed_put_frame(self, *arguments):
        start = time.perf_counter()
        self._put_frame(*arguments)
        self.writing_ms.append(1e3 * (time.perf_counter() - start))

    def around(self, work):
        def run():
            self._spent_ms = 0.0
            work()
            self.handlers_ms.append(self._spent_ms)
        return run

    def remove(self):
        for name in ("frame_change_post", "depsgraph_update_post"):
            handlers = getattr(bpy.app.handlers, name)
            handlers.remove(self._first)
            handlers.remove(self._last)
        meshes.put_frame = self._put_frame


def verdict(value, limit, at_most):
    return f"{'≤' if at_most else '≥'} {limit:.3g} {'met' if (value <= limit) == at_most else 'missed'}"


def frame_change(n, turns):
    modifier, bare = Modifier(n), Copy.bare(n)
    oceans = {"as many waves": AddOn(n, as_the_modifier=True), "default sea": AddOn(n),
              "the same with UV map and velocity": AddOn(n, all_attributes=True)}
    full = Copy(oceans["the same with UV map and velocity"].object.data.copy())
    parts = {name: ([], []) for name in oceans}

    def timed(name, side):
        def step():
            watch = Stopwatch()
            watch.around(side.step)()
            watch.remove()
            parts[name][0].extend(watch.handlers_ms)
            parts[name][1].extend(watch.writing_ms)
        return step

    works = [modifier.step, bare.step, full.step] + [timed(name, side) for name, side in oceans.items()]
    modifier_ms, bare_ms, full_ms, *ours_ms = interleaved_ms(works, turns)
    print(f"  {n}², {(n + 1) ** 2} vertices")
    print(f"    {'the modifier':34s} {modifier_ms:8.1f} ms")
    for name, copy_ms in (("bare mesh", bare_ms), ("mesh with attributes and UV map", full_ms)):
        print(f"    {'copy of a ' + name:34s} {copy_ms:8.1f} ms   modifier / copy {modifier_ms / copy_ms:5.2f}")
    for (name, (handlers, writing)), spent_ms in zip(parts.items(), ours_ms):
        part_ms, write_ms = statistics.median(handlers), statistics.median(writing)
        faster, share = modifier_ms / spent_ms, part_ms / full_ms
        print(f"    {'Pelagic, ' + name:34s} {spent_ms:8.1f} ms   {faster:5.2f} × faster, "
              f"{verdict(faster, OF_THE_COPY * modifier_ms / full_ms, False)} "
              f"({verdict(faster, OF_THE_COPY * modifier_ms / bare_ms, False)} with the bare copy)")
        print(f"    {'  our part':34s} {part_ms:8.1f} ms   {share:5.2f} of the copy, {verdict(share, OUR_PART, True)} "
              f"({part_ms / bare_ms:.2f} of the bare one); of it writing into the mesh {write_ms:.1f} ms", flush=True)
    for side in (modifier, bare, full, *oceans.values()):
        side.remove()


def slider():
    side = AddOn()

    def move(wind_mps):
        before = blender_sides.heights(side.object.data).copy()
        start = time.perf_counter()
        side.object.pelagic.sea.wind_speed_mps = wind_mps
        side.layer.update()
        side.evaluated()
        spent_ms = 1e3 * (time.perf_counter() - start)
        if (before == blender_sides.heights(side.object.data)).all():
            sys.exit("the wind changed nothing")
        return spent_ms

    moves = []
    frames = []
    for wind_mps in WINDS_MPS:
        moves.append(move(wind_mps))
        for _ in range(3):
            start = time.perf_counter()
            side.step()
            frames.append(1e3 * (time.perf_counter() - start))
    moved_ms, frame_ms = statistics.median(moves), statistics.median(frames)
    print(f"  {len(side.object.data.vertices)} vertices: the wind moved {moved_ms:.0f} ms, a frame change {frame_ms:.0f} ms: "
          f"{moved_ms / frame_ms:.1f} frame changes, {verdict(moved_ms / frame_ms, SLIDER_FRAMES, True)}", flush=True)
    side.remove()


def main():
    given = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    turns = int(given[0]) if given else 5
    print(f"One frame change in Blender {bpy.app.version_string}, medians of {turns} turns (four times as many at 256²) "
          f"of {blender_sides.FRAMES} frames")
    for n in SIZES:
        frame_change(n, turns * 1024 // n)
    print("A slider moved in the default sea, with its horizon, until the new sea is in the mesh")
    slider()


blender_sides.pelagic_ocean.register()
main()
