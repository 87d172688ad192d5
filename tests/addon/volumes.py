"""Volumes: baked, shown as Blender's own, replaced, undone; and as Cycles sees them.

    volumes.py -- PELAGIC_PROGRAM
"""

import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import baking, compat, volumes
from pelagic_ocean.query import Water
from pictures import cycles_exr

program = sys.argv[-1]
folder = Path(tempfile.mkdtemp())


def stormy():
    """A small sea that breaks, for three frames, with volumes of coarse voxels."""
    fresh_file()
    bpy_scene = bpy.context.scene
    bpy_scene.frame_start, bpy_scene.frame_end = 1, 3
    sea = add_ocean(sea__wind_speed_mps=20.0, surface__size_m=60.0, output__voxel_m=2.0, effects__spray=True,
                    effects__spray_gain=30.0)
    sea.pelagic_bake.folder = str(folder / "bakes")
    return sea


def files_of(volume):
    """Frame → file, of those that it shows."""
    return volumes.files_of(Path(bpy.path.abspath(volume.data.filepath)).parent.parent, "Ocean", volume.pelagic_volume.kind)


def bake(kind="spray"):
    return bpy.ops.pelagic.bake_volume(kind=kind)


def grids(volume, frame):
    """{name: the grid} of what is shown at a frame; {} where nothing is."""
    bpy.context.scene.frame_set(frame)
    shown = volume.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    shown.grids.load()  # Blender 3.4 says no ever after a file that was missing, and loads the next ones all the same
    return {grid.name: grid for grid in shown.grids}


def density(file):
    """The largest and the mean extinction of a file's voxels, by OpenVDB's own module."""
    script = """
import sys
try:
    import openvdb as vdb
except ImportError:  # its name before OpenVDB 11
    import pyopenvdb as vdb
values = [i.value for i in vdb.read(sys.argv[1], "density").citerOnValues() for _ in range(i.count)]
print(max(values), sum(values) / len(values), min(values))
"""
    told = subprocess.run(["/usr/bin/python3", "-c", script, str(file)], check=True, capture_output=True, text=True).stdout
    return [float(each) for each in told.split()]


with checking("a volume of spray: below its ocean, with the scene's frames and a material"):
    sea = stormy()
    assert bake() == {"FINISHED"}
    spray = volumes.volumes_of(sea)["spray"]
    assert spray.parent == sea and spray.data.is_sequence and spray.data.render.precision == "FULL"
    files = files_of(spray)
    assert files[1].parent.parent == folder / "bakes" / "Ocean-spray"
    assert sorted(files) == [1, 2, 3] and Path(spray.data.filepath) == files[1]
    assert sorted(file.suffix for file in (folder / "bakes" / "Ocean-spray").rglob("*") if file.is_file()) == [
        ".json", ".vdb", ".vdb", ".vdb"], "a bake of a volume writes nothing else"
    nodes = spray.data.materials[0].node_tree.nodes
    droplets = next(node for node in nodes if node.bl_idname == "ShaderNodeVolumePrincipled")
    assert droplets.inputs["Density Attribute"].default_value == "density"
    assert droplets.inputs["Density"].default_value == 1.0, "the grid is the extinction itself"

with checking("each frame shows its own file, with its grids; frames outside the bake show none"):
    for frame in (1, 3, 2):
        shown = grids(spray, frame)
        assert set(shown) == {"density", "velocity", "v"}, shown
        assert shown["density"].data_type == "FLOAT" and shown["velocity"].data_type == shown["v"].data_type == "VECTOR_FLOAT"
        evaluated = spray.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        assert evaluated.grids.frame == frame
        assert not volumes.problem_of(spray, bpy.context.scene, frame), volumes.problem_of(spray, bpy.context.scene, frame)
    assert not grids(spray, 9) and "Nothing is baked" in volumes.problem_of(spray, bpy.context.scene, 9)

with checking("it lies on the patch, in metres"):
    grids(spray, 1)
    box = np.array([corner[:] for corner in spray.evaluated_get(bpy.context.evaluated_depsgraph_get()).bound_box])
    # Blender's box is of blocks of 8 voxels, before 5.0 from the middle of the first to the middle of the last.
    low, high = box.min(axis=0), box.max(axis=0)
    assert np.allclose(low[:2], -29.0 if bpy.app.version < (5, 0) else -30.0) and (high[:2] >= 29.0).all() and (high[:2] <= 30.0 + 8 * 2.0).all(), box
    heights = numbers(sea.data)[:, 2]
    assert heights.min() - 8 * 2.0 < low[2] < heights.max() < high[2] < heights.max() + 8 * 2.0 + 14.0, (box, heights.max())

with checking("the numbers are the core's: in proportion to the gain"):
    much = density(files[2])
    assert 1e-4 < much[1] < much[0] < 10.0 and much[2] >= 0.0, much
    change(sea, effects__spray_gain=3.0)
    assert "settings have changed" in volumes.problem_of(spray, bpy.context.scene, 2)
    assert bake() == {"FINISHED"}
    assert not volumes.problem_of(spray, bpy.context.scene, 2)
    assert volumes.volumes_of(sea) == {"spray": spray}, "baked anew it is replaced"
    # A Blender that keeps what it has read is shown a new place.
    assert (files != files_of(spray)) == compat.reads_volumes_once()
    files = files_of(spray)
    little = density(files[2])
    assert np.allclose(np.array(much), 10.0 * np.array(little), rtol=1e-3), (much, little)

with checking("from 3.4 to 4.x Blender shows voxels off their place"):
    off_m = np.array(spray.delta_location)
    assert compat.voxels_off((3, 4, 1)) == compat.voxels_off((4, 3, 2)) == 0.5
    assert compat.voxels_off((3, 3, 9)) == compat.voxels_off((5, 2, 2)) == 0.0
    assert np.allclose(off_m, -2.0 * compat.voxels_off()), off_m

with checking("what doesn't change the volume leaves it as it is"):
    change(sea, surface__resolution=16, light__sun_elevation_deg=33.0)
    assert not volumes.problem_of(spray, bpy.context.scene, 2)
    before = {file: file.stat().st_mtime_ns for file in files.values()}
    assert bake() == {"FINISHED"}
    assert before == {file: file.stat().st_mtime_ns for file in files.values()}

with checking("a material of the artist's own stays"):
    own = bpy.data.materials.new("Own")
    spray.data.materials[0] = own
    assert bake() == {"FINISHED"} and list(spray.data.materials) == [own]

with checking("a missing file is said, and the frame shows nothing"):
    files[2].unlink()
    assert "is missing" in volumes.problem_of(spray, bpy.context.scene, 2)
    assert not volumes.problem_of(spray, bpy.context.scene, 3)
    spray.data.grids.unload()
    assert not grids(spray, 2) and grids(spray, 3)
    assert bake() == {"FINISHED"} and not volumes.problem_of(spray, bpy.context.scene, 2)

with checking("whatever the surface is"):
    for kind in ("projected-grid", "planet", "near-far"):
        change(sea, surface__kind=kind, surface__cell_px=30.0)
        assert bake() == {"FINISHED"}, kind
    assert before[files[1]] == files[1].stat().st_mtime_ns, "the patch's, as before"
    change(sea, surface__kind="patch")

with checking("refused in words: no whitecaps, // of a file that isn't saved, a folder that can't be written"):
    change(sea, effects__whitecaps=False)
    assert refused(bake, "whitecaps")
    change(sea, effects__whitecaps=True)
    sea.pelagic_bake.folder = "//bakes"
    assert refused(bake, "isn't saved yet")
    sea.pelagic_bake.folder = "/proc/bakes"
    assert refused(bake, "/proc/bakes")
    sea.pelagic_bake.folder = str(folder / "bakes")

with checking("a level set: a volume that isn't rendered, and the mesh of its zero, which is the sea's"):
    change(sea, output__voxel_m=1.0, surface__resolution=60)  # the same waves in the mesh
    assert bake("level-set") == {"FINISHED"}
    level = volumes.volumes_of(sea)["level-set"]
    assert level.hide_render and set(grids(level, 2)) == {"surface"}
    mesh = next(obj for obj in level.children if obj.type == "MESH")
    points = numbers(evaluated_mesh(mesh)).astype(float) + np.array(mesh.matrix_world.translation)
    # Away from the sides, where it is closed, and from the floor.
    top = points[(np.abs(points[:, :2]) < 25.0).all(axis=1) & (points[:, 2] > points[:, 2].min() + 2.0)]
    assert len(top) > 1000
    water = Water(sea, bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    error = top[:, 2] - water.heights(top[:, :2])
    print(f"    heights of the level set: off by {error.mean():.3f} m, on average {np.abs(error).mean():.3f}, at most {np.abs(error).max():.2f}")
    assert np.abs(error).mean() < 0.1, "a tenth of a voxel; waves shorter than two voxels aren't in it"

with checking("each kind depends on its own settings, and both on the clock of the scene"):
    kinds = {word: volumes.volumes_of(sea)[word] for word in volumes.KINDS}
    assert all(bake(word) == {"FINISHED"} for word in kinds)

    def outdated():
        return {word for word, volume in kinds.items()
                if "settings have changed" in volumes.problem_of(volume, bpy.context.scene, 2)}

    for settings, of in (({}, set()), ({"effects__spray_gain": 7.0}, {"spray"}), ({"effects__whitecap_amount": 1.5}, {"spray"}),
                         ({"sea__gust_strength": 0.4}, {"spray"}), ({"effects__spray": False}, set()),
                         ({"light__sun_elevation_deg": 12.0}, set()), ({"sea__wind_speed_mps": 19.0}, set(kinds)),
                         ({"output__voxel_m": 3.0}, set(kinds)), ({"surface__size_m": 61.0}, set(kinds)),
                         ({"shot__time_scale": 0.5}, set(kinds))):
        before = {path: getattr(getattr(sea.pelagic, path.split("__")[0]), path.split("__")[1]) for path in settings}
        change(sea, **settings)
        assert outdated() == of, settings
        change(sea, **before)
        assert not outdated(), settings
    bpy.context.scene.render.fps = 25
    assert outdated() == set(kinds)
    bpy.context.scene.render.fps = 24
    assert not outdated()

with checking("a volume needs no cage, also where the ocean's file of one is missing"):
    change(sea, surface__kind="cage", surface__cage_file="/nowhere.obj")
    assert bake() == {"FINISHED"}
    change(sea, surface__kind="patch")
    assert not outdated()

with checking("settings that change while it is baked: the volume is of those that were ordered"):
    ended = baking.Baking.outcome

    def outcome(ordered):
        change(sea, sea__wind_speed_mps=18.0)
        return ended(ordered)

    baking.Baking.outcome = outcome
    change(sea, sea__wind_speed_mps=19.0)
    assert bake() == {"FINISHED"}
    baking.Baking.outcome = ended
    assert outdated() == set(kinds)
    change(sea, sea__wind_speed_mps=19.0)
    assert outdated() == {"level-set"}

with checking("a bake that is stopped or fails says which frames are of earlier settings"):
    def stopped(after):
        """A bake that is stopped once so many frames are done; how many it did."""
        report = []

        def outcome(ordered):
            while not ordered.task.is_done and (ordered.task.progress or (0, 0, 0))[2] < after:
                pass
            ordered.task.cancel()
            told = ended(ordered)
            report.append((ordered.report.cancelled, ordered.report.done, told))
            return told

        baking.Baking.outcome = outcome
        assert bake() == {"FINISHED"}
        baking.Baking.outcome = ended
        return report[0]

    FRAMES = 60
    scene = bpy.context.scene
    scene.frame_end = FRAMES
    assert bake() == {"FINISHED"}
    change(sea, sea__wind_speed_mps=17.0)
    cancelled, done, _ = stopped(1)
    assert cancelled and 0 < done < FRAMES, done
    mixed = not compat.reads_volumes_once()  # else what was baked has a folder of its own
    assert ("wasn't finished" in volumes.problem_of(kinds["spray"], scene, 2)) == mixed
    change(sea, sea__wind_speed_mps=19.0)
    problem = volumes.problem_of(kinds["spray"], scene, 1)
    assert ("wasn't finished" if mixed else "settings have changed") in problem, "nor is it all of the earlier ones"
    change(sea, sea__wind_speed_mps=17.0)
    assert bake() == {"FINISHED"} and not volumes.problem_of(kinds["spray"], scene, 2)
    scene.frame_end = 2 * FRAMES
    cancelled, done, _ = stopped(1)
    assert cancelled and done < FRAMES and not volumes.problem_of(kinds["spray"], scene, 2), "more frames of the same settings"
    scene.frame_end = 3

    def failed(ordered):
        ended(ordered)
        return "ERROR", "The disk is full"

    change(sea, sea__wind_speed_mps=16.0)
    baking.Baking.outcome = failed
    assert refused(bake, "disk is full")
    baking.Baking.outcome = ended
    change(sea, sea__wind_speed_mps=17.0)
    assert ("wasn't finished" in volumes.problem_of(kinds["spray"], scene, 2)) == mixed

with checking("a deleted ocean is gone, and no file keeps it because of its volume"):
    sea = stormy()
    assert bake() == {"FINISHED"}
    spray, mesh = volumes.volumes_of(sea)["spray"], sea.data.name
    name = sea.name
    bpy.ops.object.select_all(action="DESELECT")
    sea.select_set(True)
    bpy.ops.object.delete()
    change(sea, sea__wind_speed_mps=10.0)
    assert not volumes.problem_of(spray, bpy.context.scene, 2), "nobody's settings have changed"
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "deleted.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(folder / "deleted.blend"))
    assert name not in bpy.data.objects and mesh not in bpy.data.meshes
    assert bpy.data.objects["Ocean Spray"].pelagic_volume.of is None
    fresh_file()  # which isn't saved

with checking("undo takes the objects away, redo brings them back"):
    sea = stormy()
    bpy.ops.ed.undo_push(message="sea")
    assert bake() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="spray")
    bpy.ops.ed.undo()
    assert not any(obj.type == "VOLUME" for obj in bpy.data.objects)
    bpy.ops.ed.redo()
    spray = volumes.volumes_of(bpy.data.objects["Ocean"])["spray"]
    assert grids(spray, 2)

with checking("saved and loaded, // is beside the .blend"):
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "sea.blend"))
    sea = bpy.data.objects["Ocean"]
    sea.pelagic_bake.folder = "//bakes"
    assert bake() == {"FINISHED"}
    assert volumes.volumes_of(sea)["spray"].data.filepath.startswith("//bakes/")
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(folder / "sea.blend"))
    assert grids(volumes.volumes_of(bpy.data.objects["Ocean"])["spray"], 2)

with checking("a bake with volumes plays with them, also later"):
    shot = folder / "both.toml"
    shot.write_text('[shot]\nname = "both"\nframes = [1, 3]\n[sea]\nwind_speed_mps = 20.0\n[surface]\nsize_m = 60.0\n'
                    'resolution = 16\n[effects]\nspray = true\n[output]\nvolumes = ["spray", "level-set"]\nvoxel_m = 2.0\n',
                    encoding="utf-8")
    subprocess.run([program, "bake", str(shot), "--out", str(folder / "both")], check=True, capture_output=True)
    assert bpy.ops.pelagic.play_bake(filepath=str(folder / "both")) == {"FINISHED"}
    played = bpy.context.object
    both = volumes.volumes_of(played)
    assert set(both) == {"spray", "level-set"} and both["spray"].parent == played
    played.pelagic_baked.offset = 10
    assert grids(both["spray"], 12) and not grids(both["spray"], 2)

with checking("Cycles sees it: brighter than the dark before it, and as much as the gain says"):
    def seen(gain):
        sea = stormy()
        change(sea, effects__spray_gain=gain)
        scene = bpy.context.scene
        scene.camera.location, scene.camera.rotation_euler = (0.0, -80.0, 6.0), (1.5708, 0.0, 0.0)
        assert bake() == {"FINISHED"}
        sea.hide_render = scene.render.film_transparent = True
        scene.frame_set(2)
        with_spray = cycles_exr(folder / "with.exr", (64, 36), 8)[..., :3].mean()
        volumes.volumes_of(sea)["spray"].hide_render = True
        return with_spray - cycles_exr(folder / "without.exr", (64, 36), 8)[..., :3].mean()

    # Hardly anything at nature's own; a thin layer's light is in proportion to the gain.
    once, more, much = seen(1.0), seen(10.0), seen(30.0)
    print(f"    change of the picture's mean: gain 1: {once:.2e}, 10: {more:.2e}, 30: {much:.2e}")
    # Cycles of Debian's 5.2.2 shows no grid of a volume, of Blender's own Volume Cube neither; 4.3.2 shows both.
    assert 0.05 * more < once < 0.2 * more and much > 1.5 * more or (much == 0.0 and bpy.app.version >= (5, 2))
