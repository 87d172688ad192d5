"""A default bake beside Blender's Ocean modifier of as many vertices, in turn: 1024 × 1024 quads over 200 m, two threads, living foam
and untiled as they are by default, crates in a folder of memory.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 \\
        --python tests/bench/blender_baked.py -- PELAGIC [TURNS]

Blender's time: as in blender_ocean.py, simulation with normals and foam and the mesh that the modifier generates, nothing written. Ours: the
program's, of a bake of many frames less one of few, so that what is once in a bake doesn't count; each frame's crate with all default
attributes is written.
"""

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from blender_sides import FRAMES, Modifier  # noqa: E402

N, FEW, MANY, TARGET = 1024, 2, 14, 12.0
SHOTS = {"one cascade on the patch's grid": "[waves]\ncascades = [ { size_m = 200.0, resolution = 1024 } ]\n",
         "the default cascades": ""}


def frame_ms(program, shot, folder):
    def seconds(frames):
        out = folder / "out"
        begun = time.perf_counter()
        subprocess.run([program, "bake", shot, "--out", out, "--frames", f"1-{frames}", "--threads", "2"], check=True,
                       capture_output=True)
        took = time.perf_counter() - begun
        shutil.rmtree(out)
        return took

    return 1e3 * (seconds(MANY) - seconds(FEW)) / (MANY - FEW)


def main():
    given = sys.argv[sys.argv.index("--") + 1:]
    program, turns = given[0], int(given[1]) if len(given) > 1 else 5
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
    theirs = Modifier(N)
    print(f"A bake of {N}² quads beside the Ocean modifier, 2 CPUs, ms a frame: medians of {turns} turns\n"
          f"  {'':34s} {'theirs':>8s} {'ours':>8s} {'× faster':>9s}")
    memory = "/dev/shm" if os.path.isdir("/dev/shm") else None
    with tempfile.TemporaryDirectory(dir=memory) as folder:
        folder = Path(folder)
        for name, waves in SHOTS.items():
            shot = folder / "shot.toml"
            shot.write_text(f"[shot]\nframes = [1, 100]\n[surface]\nsize_m = 200.0\nresolution = {N}\n{waves}",
                            encoding="utf-8")
            modifier, ours = [], []
            for _ in range(turns):
                for _ in range(FRAMES):
                    begun = time.perf_counter()
                    theirs.step()
                    modifier.append(1e3 * (time.perf_counter() - begun))
                ours.append(frame_ms(program, shot, folder))
            ratio = statistics.median(modifier) / statistics.median(ours)
            print(f"  {name:34s} {statistics.median(modifier):8.1f} {statistics.median(ours):8.1f} {ratio:9.1f}  ≥ {TARGET:g} "
                  f"{'met' if ratio >= TARGET else 'missed'}", flush=True)


main()
