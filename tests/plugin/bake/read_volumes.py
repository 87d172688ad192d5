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


def mesh_of(frame):
    """The mesh's points of a frame, by row and column of its square."""
    text = (folder / f"mesh/{name}.{int(frame):04}.usda").read_text(encoding="utf-8")
    listed = re.search(r"point3f\[\] points\.timeSamples = \{\s*\S+: \[(.*?)\],\n", text, re.DOTALL).group(1)
    numbers = np.array(re.sub(r"[(),]", " ", listed).split(), float)
    side = settings["surface.resolution"] + 1
    return numbers.reshape(side, side, 3)


def heights_at(points, x, y):
    """The mesh's heights at places, and where they were found: waves displace its points along x and y as well."""
    cells = points.shape[0] - 1
    wanted = np.stack([x, y], axis=-1)

    def point_at(rest):
        at = np.clip((rest / size_m + 0.5) * cells, 0, cells - 1e-9)
        cell, part = at.astype(int), at % 1
        column, row = cell[..., 0], cell[..., 1]
        u, v = part[..., :1], part[..., 1:]
        return ((1 - v) * ((1 - u) * points[row, column] + u * points[row, column + 1])
                + v * ((1 - u) * points[row + 1, column] + u * points[row + 1, column + 1]))

    rest = wanted.copy()
    for _ in range(100):
        rest += 0.7 * (wanted - point_at(rest)[..., :2])
    found = point_at(rest)
    return found[..., 2], (np.abs(found[..., :2] - wanted) < 1e-3 * voxel_m).all(axis=-1)


for frame in frames:
    told = record["frames"][frame]
    spray = folder / f"volumes/{name}.spray.{int(frame):04}.vdb"
    pages = printed(spray)
    expect(sorted(pages) == ["density", "v", "velocity"], f"vdb_print finds {list(pages)}")
    expect("class: fog volume" in pages["density"], pages["density"])
    for each in ("velocity", "v"):
        expect("vector_type: contravariant relative" in pages[each], pages[each])
    about = vdb.readMetadata(str(spray))
    made_of = told["files"][f"volumes/{name}.spray.{int(frame):04}.vdb"]["fingerprint"]
    expect(about["fingerprint"] == made_of, f"made of {about['fingerprint']}, recorded is {made_of}")
    expect(about["frame"] == int(frame) and math.isclose(about["time"], told["time_s"]), str(about))
    density, velocity, again = (vdb.read(str(spray), each) for each in ("density", "velocity", "v"))
    expect(again.activeVoxelCount() == velocity.activeVoxelCount() and again.evalMinMax() == velocity.evalMinMax(), "v is another grid")
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
    mesh, is_found = heights_at(mesh_of(frame), *np.meshgrid(*(places[axis][within[axis]] for axis in (0, 1)), indexing="ij"))
    expect(is_found.all(), f"{(~is_found).sum()} places that no point of the mesh's square lies over")
    # Waves between two voxels and two cells of the mesh are in the mesh alone; in these heights their share is a twentieth.
    apart = np.abs(heights - mesh)
    expect(math.sqrt((apart**2).mean()) < 0.1 * mesh.std() and apart.max() < 0.25 * voxel_m,
           f"the level set lies {math.sqrt((apart**2).mean())} m, at most {apart.max()} m from a mesh of {mesh.std()} m")
print(f"{len(frames)} frames of spray and level sets are as OpenVDB reads them")
