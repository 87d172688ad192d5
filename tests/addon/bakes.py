"""Bakes: baked in Blender as on the command line, and played from disk.

    bakes.py -- PELAGIC_PROGRAM
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic

from pelagic_ocean import baked, farm, module, ocean, play

program = sys.argv[-1]
folder = Path(tempfile.mkdtemp())
LIVE = ("position", "velocity", "slope_variance", "whitecap_coverage", "foam_active", "foam_age")


def shot_file(name, more=""):
    path = folder / f"{name}.toml"
    path.write_text(f'[shot]\nname = "{name}"\nframes = [1, 6]\n[sea]\nwind_speed_mps = 15.0\n[effects]\nfoam_decay_s = 1.0\n{more}', encoding="utf-8")
    return path


def bake(path):
    subprocess.run([program, "bake", str(path), "--out", str(folder / path.stem)], check=True, capture_output=True)
    return folder / path.stem


def played(path):
    assert bpy.ops.pelagic.play_bake(filepath=str(path)) == {"FINISHED"}
    return bpy.context.object


PATCH = "[surface]\nsize_m = 90.0\nresolution = 48\n"
GRID = """[surface]
kind = "projected-grid"
cell_px = 16.0
[camera]
resolution = [320, 180]
keys = [ { frame = 1, position_m = [0.0, -60.0, 4.0], look_at_m = [0.0, 0.0, 0.0] },
         { frame = 6, position_m = [0.0, -60.0, 24.0], look_at_m = [0.0, 0.0, 0.0] } ]
"""

for name, mesh in (("binary", ""), ("text", '[output]\nmesh = "usda"\n')):
    with checking(f"a {name} bake plays what the live ocean shows, to the bit"):
        fresh_file()
        path = shot_file(name, PATCH + mesh)
        bpy.ops.pelagic.import_shot(filepath=str(path))
        live = bpy.context.object
        live.pelagic.uv_map = live.pelagic.velocity = True
        there = bake(path)
        from_disk = played(there)
        scene = bpy.context.scene
        for frame in (4, 1, 6):
            scene.frame_set(frame)
            for attribute in LIVE:
                both = (numbers(obj.data, attribute) for obj in (from_disk, live))
                assert np.array_equal(*both), (frame, attribute)
        nodes = from_disk.data.materials[0].node_tree.nodes
        densities = [nodes[name].outputs[0].default_value for name in ("Active Foam Density", "Residual Foam Density")]
        assert np.allclose(densities, play.simulation_of(live).sea.dense_foam) and densities[0] > densities[1], densities
        faces = [[tuple(face.vertices) for face in obj.data.polygons] for obj in (from_disk, live)]
        assert faces[0] == faces[1]
        uvs = [np.array([entry.uv for entry in obj.data.uv_layers["UVMap"].data]) for obj in (from_disk, live)]
        assert np.allclose(*uvs, atol=1e-5)
        assert np.allclose(numbers(from_disk.data, "rest_position"), numbers(live.data, "rest_position"), atol=1e-5)

with checking("frames outside the bake show its ends; an offset moves it"):
    scene.frame_set(6)
    last = numbers(from_disk.data)
    scene.frame_end = 300
    scene.frame_set(200)
    assert np.array_equal(numbers(from_disk.data), last)
    from_disk.pelagic_baked.offset = 100
    scene.frame_set(106)
    assert np.array_equal(numbers(from_disk.data), last)
    scene.frame_set(105)
    assert not np.array_equal(numbers(from_disk.data), last)

with checking("a fitted cage plays as the sea: every vertex on it, at the cage's own and between them"):
    fresh_file()
    coarse = PATCH.replace("48", "32") + '[output]\nmesh_scheme = "catmullClark"\n'
    there, fine = bake(shot_file("cage", coarse)), bake(shot_file("fine", PATCH.replace("48", "128")))
    from_disk = played(there)
    bpy.context.scene.frame_set(4)
    wanted, plain = (pelagic.read_mesh(fine / "mesh" / "fine.0004.usdc"), pelagic.read_mesh(there / "mesh" / "cage.0004.usdc"))
    assert len(plain["position"]) == 35**2 and len(from_disk.data.vertices) == 129**2

    # Waves that 32 quads hold are in both; the rest, which only the finer mesh has, is as large for points as between them.
    def error(mesh, every=1):
        mine, sea = (values.reshape(129, 129, 3)[::every, ::every] for values in (numbers(mesh), wanted["position"]))
        return np.sqrt(np.mean((mine - sea)[..., 2]**2))

    on_cage, between = error(from_disk.data, 4), error(from_disk.data)
    print(f"    the sea's waves are {wanted['position'][:, 2].std():.2f} m, what the coarser one leaves out {on_cage:.3f} m, between "
          f"its vertices {between:.3f} m")
    assert between < 1.1 * on_cage < 0.2 * wanted["position"][:, 2].std()
    # OpenSubdiv's limit of the same cage, whose outermost faces only shape the others.
    told = pelagic.read_mesh(there / "mesh" / "cage.topology.usdc")
    limit = pelagic.CageSurface(pelagic.Cage(plain["position"], told["face_counts"], told["face_corners"], boundary="none"),
                                2).limit()
    limit = np.column_stack([limit["rest_m"] + np.array(limit["origin_m"]), limit["height_m"]])
    farthest = max(np.linalg.norm(limit - point, axis=1).min() for point in numbers(from_disk.data)[::7])
    assert len(limit) == 129**2 and farthest < 1e-4, farthest  # metres in single precision
    st = np.array([entry.uv for entry in from_disk.data.uv_layers["UVMap"].data])
    assert (st.min(), st.max()) == (0.0, 1.0), "the ring is no part of it"
    assert len(numbers(from_disk.data, "whitecap_coverage")) == 129**2 and not from_disk.data.validate(verbose=True)
    from_disk.pelagic_baked.halvings = 0
    assert len(from_disk.data.vertices) == 33**2
    sharp = pelagic.Scene.from_file(folder / "cage.toml")
    frame = pelagic.Frame(pelagic.Sea(sharp))
    frame.set(sharp.shot.time_s(4))
    core = frame.evaluate(pelagic.patch(90.0, 32)[0])
    for name, product in (("position", "position"), ("velocity", "velocity"), ("whitecap_coverage", "coverage")):
        assert np.abs(numbers(from_disk.data, name) - core[product]).max() < 1e-4, name

with checking("a camera's grid has other faces in each frame"):
    fresh_file()
    there = bake(shot_file("grid", GRID))
    for given in (there, there / "grid.json", there / "grid.usda"):
        from_disk = played(given)
    counts = set()
    for frame in (1, 6, 3, 1):
        bpy.context.scene.frame_set(frame)
        told = pelagic.read_mesh(there / "mesh" / f"grid.{frame:04}.usdc")
        counts.add(len(told["position"]))
        assert np.array_equal(numbers(from_disk.data), told["position"])
        assert np.array_equal(numbers(from_disk.data, "velocity"), told["velocity"])
        assert np.array_equal(numbers(from_disk.data, "rest_position")[:, :2], told["position"][:, :2])
        assert len(from_disk.data.polygons) == len(told["face_counts"])
        assert not from_disk.data.validate(verbose=True)
    assert len(counts) > 1, counts
    assert from_disk.data.materials[0] is not None
    assert any(obj.type == "LIGHT" and obj.data.type == "SUN" for obj in bpy.context.scene.objects)

def places(obj, told):
    """float64: where the evaluated object has its points, and where the bake has them [m]."""
    matrix = np.array(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world, np.float64)
    return numbers(obj.data) @ matrix[:3, :3].T + matrix[:3, 3], told["position"] + told["origin_m"]


with checking("far out the object is where its points' origin is, and stays where it is put"):
    fresh_file()
    far = bake(shot_file("far", """[surface]
kind = "projected-grid"
cell_px = 16.0
[camera]
resolution = [320, 180]
keys = [ { frame = 1, position_m = [1e7, -3e6, 4.0], look_at_m = [1e7, -2.99e6, 0.0] },
         { frame = 6, position_m = [1.0004e7, -3e6, 4.0], look_at_m = [1.0004e7, -2.99e6, 0.0] } ]
"""))
    from_disk = played(far)
    twin = from_disk.copy()
    bpy.context.collection.objects.link(twin)
    twin.location = -1e7, 3e6, 0.0
    scene, origins = bpy.context.scene, set()
    for frame in (1, 6, 3, 6, 1):
        scene.frame_set(frame)
        told = pelagic.read_mesh(far / "mesh" / f"far.{frame:04}.usdc")
        origins.add(tuple(told["origin_m"]))
        assert np.array_equal(numbers(from_disk.data), told["position"])
        assert np.array_equal(*places(from_disk, told))
        ours, theirs = places(twin, told)
        assert np.array_equal(ours, theirs - [1e7, -3e6, 0.0])  # home, to the bit
        rest = numbers(from_disk.data, "rest_position")
        assert np.abs(rest - numbers(from_disk.data)).max() < 1e5 and tuple(from_disk.location) == (0, 0, 0)
    assert len(origins) == 2, origins
    twin.rotation_euler.z = math.pi / 2
    scene.frame_set(6)
    scene.frame_set(1)
    told = pelagic.read_mesh(far / "mesh" / "far.0001.usdc")
    ours, (x, y, z) = places(twin, told)[0], places(twin, told)[1].T
    # Blender's own turn is a float's: 1e7 m times 1e-7.
    assert np.allclose(ours, np.stack([-1e7 - y, 3e6 + x, z], axis=-1), atol=3.0)
    from_disk.pelagic_baked.path = str(there / "grid.json")
    scene.frame_set(1)
    assert tuple(from_disk.delta_location) == (0, 0, 0)

with checking("missing frames are named, and the one before is shown"):
    for frame in (3, 4, 6):
        (there / "mesh" / f"grid.{frame:04}.usdc").unlink()
    from_disk = played(there)
    bpy.context.scene.frame_set(4)
    assert "3-4, 6" in baked.problems[from_disk.name_full]
    assert np.array_equal(numbers(from_disk.data), pelagic.read_mesh(there / "mesh" / "grid.0002.usdc")["position"])
    bpy.context.scene.frame_set(2)
    assert from_disk.name_full not in baked.problems

with checking("saved and loaded it plays on"):
    blend = str(folder / "play.blend")
    name = from_disk.name
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.wm.open_mainfile(filepath=blend)
    bpy.context.scene.frame_set(1)
    first = pelagic.read_mesh(there / "mesh" / "grid.0001.usdc")
    assert np.array_equal(numbers(bpy.data.objects[name].data), first["position"])

with checking("what is no bake is refused in words, and a damaged frame leaves the last one"):
    assert refused(lambda: played(folder / "none"), "is not there")
    (folder / "empty").mkdir()
    assert refused(lambda: played(folder / "empty"), "no bakes in this folder")
    (folder / "empty" / "x.json").write_text('{"a": 1}', encoding="utf-8")
    assert refused(lambda: played(folder / "empty"), "is not the record of a bake")
    from_disk = bpy.data.objects[name]
    file = there / "mesh" / "grid.0005.usdc"
    file.write_bytes(file.read_bytes()[:-100])
    before = numbers(from_disk.data)
    bpy.context.scene.frame_set(5)
    assert "cut short" in baked.problems[from_disk.name_full]
    assert np.array_equal(numbers(from_disk.data), before)
    shutil.rmtree(there)
    bpy.context.scene.frame_set(2)
    assert "is not there" in baked.problems[from_disk.name_full]

with checking("baked in Blender as exported and baked on the command line, byte by byte"):
    fresh_file()
    sea = add_ocean(sea__wind_speed_mps=11.3, surface__size_m=77.7, light__sun_elevation_deg=12.1,
                    effects__foam_decay_s=1.0)
    sea.name = "our sea"
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.fps, scene.render.fps_base = 30, 1.001
    scene.camera.data.keyframe_insert("lens", frame=1)
    scene.camera.data.lens = 80
    scene.camera.data.keyframe_insert("lens", frame=3)
    for kind in ("patch", "projected-grid"):
        change(sea, surface__kind=kind, output__maps={"displacement"}, output__map_resolution=32)
        sea.pelagic.surface.cell_px = 20
        sea.pelagic_bake.folder = str(folder / kind)
        assert bpy.ops.pelagic.bake() == {"FINISHED"}
        shot = folder / f"{kind}.toml"
        bpy.ops.pelagic.export_shot(filepath=str(shot))
        ours, theirs = folder / kind / "our_sea", folder / "line" / kind
        subprocess.run([program, "bake", str(shot), "--out", str(theirs)], check=True, capture_output=True)
        names = sorted(str(file.relative_to(ours)) for file in ours.rglob("*") if file.is_file())
        assert names == sorted(str(file.relative_to(theirs)) for file in theirs.rglob("*") if file.is_file())
        assert sum(name.startswith("maps/") for name in names) == 3 and "our_sea.sky.exr" in names and len(names) > 8
        for name in names:
            assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name

with checking("a second bake keeps what is there"):
    before = {file: file.stat().st_mtime_ns for file in ours.rglob("*.usdc")}
    assert bpy.ops.pelagic.bake() == {"FINISHED"}
    assert before == {file: file.stat().st_mtime_ns for file in ours.rglob("*.usdc")}

with checking("a job for the farm leaves what a bake leaves, with copies of the files that it names; without the program the shot and a command"):
    square = folder / "a square.obj"
    square.write_text("v -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\nf 1 2 3 4\n", encoding="utf-8")
    change(sea, surface__kind="cage", surface__cage_file=str(square), output__maps=set())
    path = os.environ["PATH"]
    sea.pelagic_bake.folder = str(folder / "jobs")
    job, baked_here = folder / "jobs" / "our_sea", folder / "jobs" / "baked"
    assert bpy.ops.pelagic.bake() == {"FINISHED"}
    job.rename(baked_here)
    try:
        os.environ["PATH"] = "/nowhere"
        assert bpy.ops.pelagic.write_job() == {"FINISHED"}
        assert [file.name for file in sorted(job.rglob("*")) if file.is_file()] == ["a square.obj", "our_sea.toml"]
        os.environ["PATH"] = f"{Path(program).parent}:{path}"
        assert bpy.ops.pelagic.write_job() == {"FINISHED"}
        assert farm.other_version() is None
        other = folder / "other"
        other.mkdir()
        (other / "pelagic").write_text("#!/bin/sh\necho pelagic 0.0.9\n", encoding="utf-8")
        (other / "pelagic").chmod(0o755)
        os.environ["PATH"] = f"{other}:{path}"
        assert f"is pelagic 0.0.9, and the add-on is of pelagic {'.'.join(map(str, module.VERSION))}" in farm.other_version(), farm.other_version()
        os.environ["PATH"] = f"{Path(program).parent}:{path}"
        square.unlink()
        tasks = json.loads((job / "farm" / "our_sea.bake.json").read_text())["tasks"]
        for task in tasks:
            subprocess.run(["bash", str(job / "farm" / "our_sea.bake.sh"), str(task["task"])], check=True, capture_output=True)
        subprocess.run(["bash", str(job / "farm" / "our_sea.bake.verify.sh")], check=True, capture_output=True)
    finally:
        os.environ["PATH"] = path
    files = [[file.relative_to(at) for file in sorted(at.rglob("*")) if file.is_file() and "farm" not in file.relative_to(at).parts]
             for at in (baked_here, job)]
    assert files[0] == files[1] and len(files[0]) > 6, files
    for file in set(files[0]) - {Path("our_sea.json")}:  # that says where the cage was read
        assert (baked_here / file).read_bytes() == (job / file).read_bytes(), file
    change(sea, surface__kind="projected-grid", surface__cage_file="", output__maps={"displacement"})

with checking("a folder that can't be written, // of a file that isn't saved, the own mesh: words"):
    scene.frame_end = 1
    sea.pelagic_bake.folder = "/proc/bakes"
    assert refused(bpy.ops.pelagic.bake, "/proc/bakes")
    sea.pelagic_bake.folder = "//bakes"
    assert refused(bpy.ops.pelagic.bake, "isn't saved yet")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "place.blend"))
    assert bpy.ops.pelagic.bake() == {"FINISHED"}
    assert (folder / "bakes" / "our_sea" / "our_sea.json").exists()
    bpy.ops.mesh.primitive_grid_add(size=20)
    bpy.ops.pelagic.use_mesh()
    assert refused(bpy.ops.pelagic.bake, "own mesh")

with checking("Check for the Farm says what needs the add-on, which files are missing and which paths absolute; all baked, nothing"):
    def farm_says():
        assert bpy.ops.pelagic.check_farm() == {"FINISHED"}
        return bpy.data.texts["Check for the Farm"].as_string()

    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "place.blend"))
    raft = bpy.data.objects.new("Raft", None)
    bpy.context.collection.objects.link(raft)
    raft.pelagic_float.enabled = True
    raft.driver_add("location", 0).driver.expression = "pelagic_height(0, 0, frame)"
    sea.pelagic.light.sky = "/no/sky.exr"
    baked_folder = bake(shot_file("farm", "[surface]\nresolution = 16\n"))
    next((baked_folder / "mesh").glob("*.0003.usdc")).unlink()
    show_bake = played(baked_folder)
    said = farm_says()
    for words in ("need the add-on Pelagic Ocean", f"{sea.name} is a live sea", "Raft floats", "Raft has drivers", "farm plays a bake",
                  "/no/sky.exr is missing", "/no/sky.exr is an absolute path", "missing on disk: 3"):
        assert words in said, (words, said)
    for obj in bpy.data.objects[:]:
        if ocean.is_ocean(obj) or obj in (raft, show_bake):
            bpy.data.objects.remove(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "place.blend"))
    assert "don't need the add-on" in farm_says() and "No file is missing" in farm_says()

with checking("where a hull is the sea is cut out"):
    fresh_file()
    corners = [(x, y, z) for z in (-6, 6) for y in (-5, 5) for x in (-15, 15)]
    faces = ((1, 3, 4, 2), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))  # without a top
    (folder / "barge.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                                      + "".join(f"f {' '.join(map(str, face))}\n" for face in faces), encoding="utf-8")
    afloat = played(bake(shot_file("afloat", PATCH + '[[objects]]\nfile = "barge.obj"\n')))
    places, dry = numbers(afloat.data), numbers(afloat.data, "dry").ravel()
    outside = np.maximum(abs(places[:, 0]) - 15, abs(places[:, 1]) - 5)
    assert (dry[outside < -1.5] == 1).all() and (dry[outside > 1.5] == 0).all() and 40 < (dry == 1).sum() < 160
    tree = afloat.data.materials[0].node_tree
    outputs = [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL" and node.inputs["Surface"].links]
    for output in outputs:
        cut = output.inputs["Surface"].links[0].from_node
        assert cut.type == "MIX_SHADER" and cut.inputs[0].links[0].from_node.name == "In a Hull"
    plain = played(folder / "text")
    assert outputs and "In a Hull" not in plain.data.materials[0].node_tree.nodes and "dry" not in plain.data.attributes
