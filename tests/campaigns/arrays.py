#!/usr/bin/env python3
"""Arrays of any type, shape and stride as arguments of the Python module: NaN, read-only, misaligned, overlapping, without end.

Each case is a process of its own with some hundred calls. Each call answers, or raises TypeError, ValueError, OverflowError or
MemoryError with a message; what is answered is finite where the arguments are usual ones; no argument that is only read is changed, and
nothing is written beside the arrays that results go to.
"""

import os
import pathlib
import random
import sys

import numpy as np

from common import Campaign

CALLS = 150  # of a case
SENTINEL = np.float32(-77.25)
OUTPUTS = {"position": 3, "displacement": 3, "normal": 3, "velocity": 3, "slope_variance": 3, "slope_variance_at_rest": 3,
           "jacobian": 3, "coverage": 1, "foam_active": 1, "foam_age": 1}
REFUSALS = (TypeError, ValueError, MemoryError, OverflowError)


class Memory:
    """Arrays within memory with sentinels round them, and whether what lies beside them is as it was."""

    def __init__(self, draw):
        self.draw, self.kept = draw, []

    def values(self, shape, kind):
        """Usual numbers, or with `kind` odd ones now and then."""
        made = np.array([self.draw.uniform(-20.0, 20.0) for _ in range(int(np.prod(shape)))], np.float32).reshape(shape)
        if kind == "odd" and made.size:
            for _ in range(3):
                made.reshape(-1)[self.draw.randrange(made.size)] = self.draw.choice(
                    (np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-45, 1e9, -1e9, 1.1e9, 0.0, -0.0))
        return made

    def laid(self, values, writable=False):
        """The same values, with points and components some way apart, backwards or at odd addresses, in memory that is looked at
        afterwards."""
        count, width = len(values), int(np.prod(values.shape[1:]))
        apart = self.draw.choice((1, 1, 1, 2))
        step = width * apart + self.draw.choice((0, 0, 1, 4))
        room = 8 + max(count, 1) * step + 8
        memory = np.zeros(4 * room + 4, np.uint8)
        odd = self.draw.choice((0, 0, 0, 1))
        memory = memory[odd:odd + 4 * room].view(np.float32)
        memory[...] = SENTINEL
        inner = memory[8:8 + count * step].reshape(count, step)[:, :width * apart:apart]
        view = inner[:, 0] if values.ndim == 1 else inner
        if self.draw.random() < 0.3:
            view = view[::-1]
        if self.draw.random() < 0.1 and values.ndim == 2:
            view = view[:, ::-1]
        view[...] = values
        inside = np.zeros(len(memory), bool)
        inside[8:8 + count * step].reshape(count, step)[:, :width * apart:apart] = True
        self.kept.append((memory, memory.copy(), inside if writable else np.zeros(len(memory), bool)))
        return view

    def wrong(self, values):
        """Something that isn't quite the array."""
        draw, count = self.draw, len(values)
        kinds = ("f8", "f2", "i4", "u1", "c8", "?", ">f4", "O", "S4", "list", "none", "number", "text", "flat", "more", "fewer",
                 "column", "deep", "zero-dimensional", "read-only", "misaligned", "overlapping", "endless", "fortran", "masked", "record")
        kind = draw.choice(kinds)
        if kind in ("f8", "f2", "i4", "u1", "c8", "?", ">f4", "O", "S4"):
            with np.errstate(all="ignore"):
                return np.nan_to_num(values).astype(kind)
        if kind == "list":
            return values.tolist()
        if kind == "number":
            return draw.choice((0, 1.5, -1, 10**400, float("nan"), True))
        if kind == "text":
            return "position"
        if kind == "flat":
            return values.reshape(-1)
        if kind == "more":
            return np.concatenate([values, values[:1]]) if count else np.zeros((3,) + values.shape[1:], np.float32)
        if kind == "fewer":
            return values[:-1]
        if kind == "column":
            return values.reshape(count, -1)[:, :1]
        if kind == "deep":
            return values.reshape((1,) * draw.choice((1, 5)) + values.shape)
        if kind == "zero-dimensional":
            return np.float32(1.0)[...]
        if kind == "read-only":
            read_only = values.copy()
            read_only.flags.writeable = False
            return read_only
        if kind == "misaligned":
            memory = np.zeros(values.nbytes + 1, np.uint8)
            return memory[1:].view(np.uint8)[:values.nbytes].view(np.float32).reshape(values.shape)
        if kind == "overlapping" and count:
            return np.lib.stride_tricks.as_strided(values.copy(), values.shape, (4,) * values.ndim)
        if kind == "endless" and count:
            return np.broadcast_to(values[0], (draw.choice((1 << 40, 1 << 62)),) + values.shape[1:])
        if kind == "fortran":
            return np.asfortranarray(values)
        if kind == "masked":
            return np.ma.masked_array(values, mask=np.zeros(values.shape, bool))
        if kind == "record":
            return np.zeros(count, [("x", "f4"), ("y", "f4")])
        return None

    def argument(self, shape, writable=False, kind="odd"):
        values = self.values(shape, "usual" if self.draw.random() < 0.7 else kind)
        return self.wrong(values) if self.draw.random() < 0.12 else self.laid(values, writable)

    def check(self):
        for memory, before, may_change in self.kept:
            changed = (memory.view(np.uint32) != before.view(np.uint32)) & ~may_change
            assert not changed.any(), f"memory was written that no result goes to, at {np.flatnonzero(changed)[:5]}"


def usual(arguments):
    """Whether all numbers are such that answers must be finite."""
    return all(isinstance(a, np.ndarray) and a.dtype == np.float32 and np.isfinite(a).all() and (np.abs(a) < 1e6).all()
               for a in arguments if a is not None)


def expect_finite(found, what):
    for name, array in found.items():
        assert not isinstance(array, np.ndarray) or np.isfinite(array).all(), f"{what}: {name} isn't finite"


class Calls:
    def __init__(self, pelagic, draw):
        self.pelagic, self.draw = pelagic, draw
        scene = self.scene = pelagic.Scene()
        scene.sea.wind_speed_mps = draw.choice((0.0, 8.0, 30.0))
        scene.waves.cascades = [pelagic.CascadeSize(60.0, 64), pelagic.CascadeSize(25.0, 32)]
        scene.effects.foam_decay_s = 0.0
        self.sea = pelagic.Sea(scene, cell_m=[0.5, 2.0, 8.0], pixel_m=[0.5, 2.0, 8.0])
        self.frame = pelagic.Frame(self.sea)
        self.frame.set(1.5)
        self.sky, self.water = pelagic.Sky(scene), pelagic.WaterBody(scene)

    def maybe(self, memory, *given, **named):
        return memory.argument(*given, **named) if self.draw.random() < 0.4 else None

    def evaluate(self, memory):
        count = self.draw.choice((0, 1, 2, 7, 33))
        rest = memory.argument((count, 2))
        reads = {"cell_m": (count,), "pixel_m": (count,), "cell_axis_m": (count, 2), "pixel_axis_m": (count, 2),
                 "rest_normal": (count, 3)}
        given = {}
        for name, shape in reads.items():
            if self.draw.random() < 0.25:
                given[name] = memory.argument(shape)
                if name in ("cell_m", "pixel_m") and isinstance(given[name], np.ndarray) and self.draw.random() < 0.8:
                    given[name] = memory.laid(np.abs(memory.values(shape, "usual")))
        if isinstance(given.get("rest_normal"), np.ndarray):
            given["rest_normal"] = memory.laid(np.tile(np.float32([0.0, 0.6, 0.8]), (count, 1)))
        read = list(given.values())
        for name in self.draw.sample(list(OUTPUTS), self.draw.choice((0, 0, 1, 3))):
            width = OUTPUTS[name]
            given[name] = memory.argument((count, width) if width > 1 else (count,), writable=True, kind="usual")
        if self.draw.random() < 0.3:
            given["outputs"] = self.draw.choice((["position"], ("normal", "normal"), [], "position", ["nothing"], [None], 3))
        origin = self.draw.choice(((0.0, 0.0), (0.0, 0.0), (1e6, -1e6), (np.nan, 0.0), (1e300, 0.0), (1.0,), None, np.zeros(2)))
        found = self.frame.evaluate(rest, origin, **given)
        if usual([rest, *read]) and np.abs(origin).max() <= 1e6:
            expect_finite(found, "evaluate")

    def heights(self, memory):
        count = self.draw.choice((0, 1, 5))
        xy = memory.argument((count, 2))
        footprint = self.maybe(memory, (count,))
        outputs = self.draw.choice((None, None, ["position"], ["nothing"], []))
        found = self.frame.heights(xy, footprint_m=footprint, outputs=outputs)
        if usual([xy, footprint]):
            expect_finite(found, "heights")

    def radiance(self, memory):
        count = self.draw.choice((0, 1, 9))
        directions = memory.argument((count, 3))
        out = self.maybe(memory, (count, 3), writable=True, kind="usual")
        self.sky.radiance(directions, out=out)

    def shade(self, memory):
        count = self.draw.choice((0, 1, 9))
        unit = lambda: memory.laid(np.tile(np.float32([0.0, 0.6, 0.8]), (count, 1)))  # noqa: E731
        to_eye, normal = (unit() if self.draw.random() < 0.7 else memory.argument((count, 3)) for _ in range(2))
        variance = memory.laid(np.tile(np.float32([0.02, 0.03, 0.001]), (count, 1))) if self.draw.random() < 0.7 \
            else memory.argument((count, 3))
        given = {name: memory.argument((count, 3), writable=True, kind="usual")
                 for name in ("sun_layer", "sky_layer", "sea_layer", "foam_layer") if self.draw.random() < 0.2}
        self.pelagic.shade(self.sky, self.water, to_eye, normal, variance, self.maybe(memory, (count,)), **given,
                           sky_quality=self.draw.choice(("one", "nine", "nine", "none", "")))

    def cage(self, memory):
        points = np.array([[x, y, 0.0] for y in range(3) for x in range(3)])
        counts = np.full(4, 4)
        indices = np.array([0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7])
        parts = {"points": points, "face_counts": counts, "indices": indices}
        if self.draw.random() < 0.5:
            parts["creases"] = np.array([[0, 1], [4, 5]])
            parts["crease_sharpness"] = self.draw.choice((2.5, np.array([1.0, 99.0]), -1.0, np.nan, np.ones(3), None))
        if self.draw.random() < 0.5:
            parts["corners"], parts["holes"] = np.array([0]), np.array([1])
        if self.draw.random() < 0.3:
            parts["st"], parts["st_indices"] = points[:, :2].copy(), indices.copy()
        name = self.draw.choice(list(parts))
        array = parts[name]
        if isinstance(array, np.ndarray) and self.draw.random() < 0.7:
            if self.draw.random() < 0.4:
                parts[name] = memory.wrong(np.float32(array))
            else:
                array = array.astype(self.draw.choice((np.float64, np.int64, np.uint8, np.float32)))
                with np.errstate(all="ignore"):
                    array.reshape(-1)[self.draw.randrange(array.size)] = np.array(self.draw.choice(
                        (0, 1, 3, 9, 100, 255, 1e5, np.nan, np.inf, 2.0**40))).astype(array.dtype)
                parts[name] = array
        cage = self.pelagic.Cage(**parts, boundary=self.draw.choice(("edge-and-corner", "edge", "none", "")))
        surface = self.pelagic.CageSurface(cage, self.draw.choice((0, 1, 2, -1, 7)))
        moved = memory.argument((len(points), 3)) if self.draw.random() < 0.7 else None
        made = surface.limit(moved)
        if usual([moved]):
            expect_finite(made, "limit")
        assert surface.indices.max() < len(made["rest_m"]) and surface.face_counts.sum() == len(surface.indices)

    def view(self, memory):
        good = {"position_m": (0.0, -20.0, 5.0), "right": (1.0, 0.0, 0.0), "up": (0.0, 0.0, 1.0), "forward": (0.0, 1.0, 0.0),
                "tan_half_width": 0.5, "resolution": (16, 9)}
        name = self.draw.choice(list(good))
        good[name] = self.draw.choice((None, (), (1.0,), (np.nan,) * 3, (1e300,) * 3, (0, 0), (-1, 5), (1 << 40, 1), np.zeros(3), "abc", good[name]))
        view = self.pelagic.View(**good)
        size = self.draw.choice((None, (4, 3), (0, 3), (-1, 1), (1 << 31, 2), (1.5, 2), (2,)))
        grid = self.sea.projected_grid(view, size)
        assert np.isfinite(grid.rest).all() if hasattr(grid, "rest") else True

    def plain(self, memory):
        odd = lambda: self.draw.choice((0, 1, 3, -1, 1.5, 1 << 31, 1 << 40, 1 << 70, None, np.nan, "2", np.int64(3), 10000))  # noqa: E731
        if self.draw.random() < 0.5:
            self.pelagic.grid_quads(odd(), odd())
        else:
            self.pelagic.patch(self.draw.choice((100.0, 0.0, -1.0, np.nan, np.inf, "x", 1e308)), odd())


def run_calls(seed, folder):
    sys.path.insert(0, folder)
    import pelagic

    draw = random.Random(seed)
    calls, refused = Calls(pelagic, draw), 0
    kinds = [calls.evaluate] * 4 + [calls.heights, calls.radiance, calls.shade, calls.cage, calls.cage, calls.view, calls.plain]
    for number in range(CALLS):
        memory = Memory(draw)
        call = draw.choice(kinds)
        try:
            call(memory)
        except REFUSALS as refusal:
            refused += 1
            assert str(refusal) or isinstance(refusal, MemoryError), f"call {number}, {call.__name__}: refused without a word"
        memory.check()
    assert CALLS // 20 < refused < CALLS - CALLS // 20, f"{refused} of {CALLS} calls refused: the calls are all alike"


def judge(draw, folder):
    run = campaign.run(pathlib.Path(__file__).resolve(), "--calls", draw.case, modules, timeout=240, memory_gib=16)
    campaign.ended_well(run, (0,))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--calls"]:
        run_calls(sys.argv[2], sys.argv[3])
        sys.exit(0)
    campaign = Campaign(__doc__.split("\n")[0], 200)
    modules = str(campaign.program.parent / "python")
    campaign.program = pathlib.Path(os.environ.get("PELAGIC_PYTHON_EXECUTABLE", "/usr/bin/python3"))
    campaign.go(judge)
