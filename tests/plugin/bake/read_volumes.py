#!/usr/bin/python3
"""Reads a bake's volumes with OpenVDB's own programs and compares them with the bake's record and its mesh.

    read_volumes.py DIR NAME FRAME..."""

import json
import math
import pathlib
import re
import subprocess
import sys

import numpy as np
import pyopenvdb as vdb

folder, name, frames = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]
record = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
settings = record["settings"]
size_m, voxel_m = settings["surface.size_m"], settings["output.voxel_m"]


def expect(holds, what):
    if not holds:
        sys.exit(f"{folder}: {what}")


def printed(path):
    """What vdb_print says, by grid's name."""
    text = subprocess.run(["vdb_print", "-l", str(path)], check=True, capture_output=True, text=True).stdout
    parts = re.split(r"^Name: ", text, flags=re.MULTILINE)
    return {part.split("\n")[0].strip(): part for part in parts[1:]}


def array_of(grid):
    """Values from the first to the last active voxel, and where the first stands."""
    first, last = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    values = np.empty(last - first + 1, np.float32)
    grid.copyToArray(values, ijk=tuple(int(i) for i in first))
    return values, first


for frame in frames:
    told = record["frames"][frame]
    spray = folder / f"volumes/{name}.spray.{int(frame):04}.vdb"
    pages = printed(spray)
    expect(list(pages) == ["density", "velocity"], f"vdb_print finds {list(pages)}")
    expect("class: fog volume" in pages["density"], pages["density"])
    expect("vector_type: contravariant relative" in pages["velocity"], pages["velocity"])
    about = vdb.readMetadata(str(spray))
    made_of = told["files"][f"volumes/{name}.spray.{int(frame):04}.vdb"]["fingerprint"]
    expect(about["fingerprint"] == made_of, f"made of {about['fingerprint']}, recorded is {made_of}")
    expect(about["frame"] == int(frame) and math.isclose(about["time"], told["time_s"]), str(about))
    density, velocity = (vdb.read(str(spray), each) for each in ("density", "velocity"))
    expect(density.metadata["seed"] == str(settings["shot.seed"]), str(density.metadata))
    expect(density.metadata["wind_speed_mps"] == settings["sea.wind_speed_mps"], str(density.metadata))
    expect(density.activeVoxelCount() == velocity.activeVoxelCount() > 0, "voxels that don't move")
    expect(density.transform.voxelSize() == (voxel_m,) * 3, str(density.transform))
    values, _ = array_of(density)
    expect(np.isfinite(values).all() and (values >= 0).all(), "a density that is none")
    thickness = values.sum(dtype="f8") * voxel_m**3 / size_m**2
    recorded = told["spray"]["optical_thickness"]
    expect(abs(thickness - recorded) < 1e-4 * recorded, f"optical thickness {thickness}, recorded is {recorded}")

    level_set = folder / f"volumes/{name}.level-set.{int(frame):04}.vdb"
    expect("class: level set" in printed(level_set)["surface"], "no level set")
    surface = vdb.read(str(level_set), "surface")
    expect(surface.background == 3 * voxel_m, f"a band of {surface.background} m")
    values, first = array_of(surface)
    expect(np.isfinite(values).all() and (np.abs(values) <= surface.background).all(), "a distance that is none")
    # Water below, air above, in each column within the square: from the floor up once out of it and once into it.
    places = [np.array(surface.transform.indexToWorld((0, 0, 0)))[axis] + voxel_m * (first[axis] + np.arange(count))
              for axis, count in enumerate(values.shape)]
    within = [np.abs(places[axis]) < size_m / 2 - voxel_m for axis in (0, 1)]
    columns = values[within[0]][:, within[1]]
    changes = np.diff(np.signbit(columns).astype(np.int8), axis=2)
    expect((np.abs(changes).sum(axis=2) == 2).all(), "columns that cross the boundary other than twice")
    top = changes.shape[2] - np.argmax(changes[:, :, ::-1] == -1, axis=2) - 1
    low, high = (np.take_along_axis(columns, (top + step)[..., None], 2)[..., 0] for step in (0, 1))
    heights = places[2][top] + voxel_m * low / (low - high)
    expected = told["hs_m"]
    expect(0.5 * expected < 4 * heights.std() < 2 * expected, f"a sea of {4 * heights.std()} m, its Hs is {expected}")
print(f"{len(frames)} frames of spray and level sets are as OpenVDB reads them")
