"""What a 1024² ocean occupies in Blender: resident memory after adding it and playing a few frames, less what the empty
Blender had, each side in a process of its own.

    PYTHONPATH=build/release/python blender -b --factory-startup --python-exit-code 1 --python tests/bench/blender_memory.py

And 200 frames of a 256² ocean: how much the resident size grows from the 20th on.
"""

import os
import subprocess
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import blender_sides  # noqa: E402

N, FRAMES = 1024, 5
TIMELINE, SETTLED, FLAT_MIB = 200, 20, 8.0


def resident_mib(which="VmRSS"):
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith(which))


def played(make):
    """Resident MiB and the most there were, above the empty Blender's."""
    before = resident_mib()
    side = make()
    for _ in range(FRAMES):
        side.step()
    return f"{resident_mib() - before:.0f} {resident_mib('VmHWM') - before:.0f}"


def timeline():
    side = blender_sides.AddOn(256)
    for frame in range(TIMELINE):
        side.step()
        if frame == SETTLED:
            before = resident_mib()
    return f"{resident_mib() - before:.1f}"


SIDES = {"modifier": lambda: played(lambda: blender_sides.Modifier(N)),
         "waves": lambda: played(lambda: blender_sides.AddOn(N, as_the_modifier=True)),
         "default": lambda: played(lambda: blender_sides.AddOn(N)),
         "all": lambda: played(lambda: blender_sides.AddOn(N, all_attributes=True)),
         "timeline": timeline}


def in_own_process(side):
    done = subprocess.run([bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "--python", __file__,
                           "--", side], stdout=subprocess.PIPE, text=True, check=True)
    return [float(number) for line in done.stdout.splitlines() if line.startswith("MiB ") for number in line.split()[1:]]


def main():
    print(f"Resident memory of a {N}² ocean in Blender {bpy.app.version_string} after {FRAMES} frames, above the empty "
          "Blender's; each in its own process")
    modifier_mib, modifier_most_mib = in_own_process("modifier")
    print(f"  {'the modifier':28s} {modifier_mib:7.0f} MiB, at most {modifier_most_mib:.0f}")
    for side, name in (("waves", "Pelagic, as many waves"), ("default", "Pelagic, default sea"), ("all", "the same with UV map and velocity")):
        mib, most_mib = in_own_process(side)
        print(f"  {name:28s} {mib:7.0f} MiB, at most {most_mib:.0f}   {mib / modifier_mib:.2f} of the modifier's, "
              f"≤ 1 {'met' if mib <= modifier_mib else 'missed'}", flush=True)
    (grown_mib,) = in_own_process("timeline")
    print(f"  {TIMELINE} frames of 256²: {grown_mib:+.1f} MiB after the first {SETTLED}, ≤ {FLAT_MIB:g} "
          f"{'met' if grown_mib <= FLAT_MIB else 'missed'}")


if sys.argv[-1] in SIDES:
    blender_sides.pelagic_ocean.register()
    print("MiB", SIDES[sys.argv[-1]]())
else:
    main()
