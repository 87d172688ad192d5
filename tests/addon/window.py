"""In a window: an ocean is added, its settings change while it plays, it is undone, rendered, and seen.

    xvfb-run blender --factory-startup --python window.py
"""

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import drops, play, sea, upwelling

BESIDE = Path(tempfile.mkdtemp()) / "window"


def height(obj):
    return numbers(obj.data)[:, 2].std()


def the_ocean():
    """Undo makes objects anew."""
    return bpy.data.objects["Ocean"]


def steps():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    here = {"window": window, "area": area, "region": region}
    with bpy.context.temp_override(**here):
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        area.spaces.active.region_3d.view_perspective = "CAMERA"
        bpy.ops.ed.undo_push(message="start")

    with checking("by hand: waves at once, foam and look from timers; one step of undo, to which the look comes back"):
        def is_whole():
            data = the_ocean().data
            return len(data.materials) == 1 and numbers(data, "whitecap_coverage").any() and "UVMap" in data.uv_layers

        with bpy.context.temp_override(**here):
            obj = add_ocean(how="INVOKE_DEFAULT")
            assert np.ptp(numbers(obj.data)[:, 2]) > 0.1 and not is_whole()
            bpy.ops.ed.undo_push(message="ocean")
        waves = numbers(obj.data)
        yield is_whole
        assert np.array_equal(numbers(obj.data), waves) and bpy.data.scenes[0].world.name == "Pelagic Sky"
        with bpy.context.temp_override(**here):
            bpy.ops.ed.undo_push(message="more")
            bpy.ops.ed.undo()
        assert not is_whole()
        yield is_whole
        with bpy.context.temp_override(**here):
            bpy.ops.ed.undo()
        assert "Ocean" not in bpy.data.objects and bpy.data.scenes[0].world.name == "World"
        with bpy.context.temp_override(**here):
            bpy.ops.ed.redo()
        yield is_whole

    obj, scene = the_ocean(), bpy.data.scenes[0]
    obj.pelagic.surface.resolution = 64
    with bpy.context.temp_override(**here):
        bpy.ops.ed.undo_push(message="64")
    yield lambda: np.ptp(numbers(obj.data)[:, 2]) > 0 and len(obj.data.vertices) == 65**2

    with checking("drops of spray come from a timer, filled by the sea that has them, and go"):
        obj.pelagic.effects.spray = obj.pelagic.effects.spray_drops = True
        yield lambda: drops.drops_of(obj) and drops.drops_of(obj).data.vertices
        obj.pelagic.effects.spray = obj.pelagic.effects.spray_drops = False
        yield lambda: not drops.drops_of(obj) and not play.simulation_of(obj).is_building

    with checking("the light from the water is in the mesh while a view shows materials"):
        assert upwelling.ATTRIBUTE not in obj.data.attributes
        for shading in ("MATERIAL", "SOLID"):
            area.spaces.active.shading.type = shading
            yield lambda: (upwelling.ATTRIBUTE in obj.data.attributes) == (shading == "MATERIAL")

    with checking("while another sea is built, the old one plays on; then the new one is shown"):
        before, is_done = height(obj), sea.Job.is_done
        sea.Job.is_done = False
        obj.pelagic.sea.wind_speed_mps = 25.0
        yield lambda: play.simulation_of(obj).is_building
        assert is_alone_in_python()
        first = numbers(obj.data)
        scene.frame_set(5)
        assert not np.array_equal(numbers(obj.data), first) and abs(height(obj) - before) < 0.3 * before
        obj.pelagic.sea.wind_speed_mps = 28.0
        sea.Job.is_done = is_done
        yield lambda: height(obj) > 2 * before and not play.simulation_of(obj).is_building
        assert play.simulation_of(obj).scene.sea.wind_speed_mps == 28.0

    with checking("foam with a long past follows its waves: after a slider, after a jump, after undo; what isn't wanted is dropped"):
        patience, play.PATIENCE_S = play.PATIENCE_S, 0.0
        simulation = play.simulation_of(obj)

        def has_foam():
            return numbers(the_ocean().data, "whitecap_coverage").any()

        def wait_for_foam(how):
            """It comes, moves no wave, and is what it would have been at once."""
            waves = numbers(obj.data)
            yield lambda: not simulation.is_behind and has_foam()
            assert np.array_equal(numbers(obj.data), waves), how
            followed = {name: numbers(obj.data, name) for name in ("position", "whitecap_coverage", "foam_active", "foam_age")}
            play._show(obj, bpy.data.scenes[0], bpy.context.evaluated_depsgraph_get(), True, True)
            for name, values in followed.items():
                assert np.array_equal(numbers(obj.data, name), values), (how, name)

        first, built = numbers(obj.data), simulation._built
        obj.pelagic.effects.foam_decay_s = 4.0
        yield lambda: simulation._built is not built and simulation.is_behind
        assert "foam_age" in obj.data.attributes and not has_foam()
        yield from wait_for_foam("slider")
        for frame in (3000, 6000):
            scene.frame_set(frame)
            assert simulation.is_behind and not has_foam() and not np.array_equal(numbers(obj.data), first), frame
            first = numbers(obj.data)
        assert is_alone_in_python()
        yield from wait_for_foam("jump")
        scene.frame_set(9000)
        built = simulation._built
        assert built._task is not None
        sea.Job.is_done = False
        obj.pelagic.sea.wind_speed_mps = 27.0
        yield lambda: simulation.is_building
        assert built._task is None, "the older foam is worked out on"
        sea.Job.is_done = is_done
        yield lambda: simulation._built is not built and simulation.is_behind
        assert not has_foam()
        yield from wait_for_foam("a slider while foam follows")
        with bpy.context.temp_override(**here):
            bpy.ops.ed.undo_push(message="27")
            built = simulation._built
            the_ocean().pelagic.sea.wind_speed_mps = 28.0
            bpy.ops.ed.undo_push(message="28")
            yield lambda: simulation._built is not built and not simulation.is_behind
            built = simulation._built
            bpy.ops.ed.undo()
        yield lambda: simulation._built is not built and simulation.is_behind
        obj = the_ocean()
        assert obj.pelagic.sea.wind_speed_mps == 27.0 and not has_foam()
        yield from wait_for_foam("undo")
        obj.pelagic.sea.wind_speed_mps = 28.0
        play.PATIENCE_S = patience
        obj.pelagic.effects.foam_decay_s = 0.0
        scene = bpy.data.scenes[0]
        scene.frame_set(5)
        yield lambda: "foam_age" not in obj.data.attributes

    with checking("samples of a hidden ocean are of the sea that is set, not of the one that still plays"):
        obj.hide_set(True)
        with bpy.context.temp_override(**here):
            bpy.ops.mesh.primitive_grid_add(x_subdivisions=30, y_subdivisions=30, size=100)
            grid = bpy.context.object
            obj.pelagic.sea.wind_speed_mps = 3.0
            bpy.ops.pelagic.sample_heights(into="ATTRIBUTE")
            assert numbers(grid.data, "sea_height").std() < 0.1 * before
            bpy.data.objects.remove(grid)
        obj.pelagic.sea.wind_speed_mps = 28.0
        obj.hide_set(False)
        yield lambda: height(obj) > 2 * before and not play.simulation_of(obj).is_building

    with checking("undo in a window"):
        with bpy.context.temp_override(**here):
            bpy.ops.ed.undo_push(message="wind")
            for _ in range(2):
                bpy.ops.ed.undo()
        yield lambda: abs(height(the_ocean()) - before) < 0.3 * before
        with bpy.context.temp_override(**here):
            for _ in range(2):
                bpy.ops.ed.redo()
        yield lambda: height(the_ocean()) > 2 * before

    with checking("it plays"):
        scene = bpy.data.scenes[0]
        start = scene.frame_current
        with bpy.context.temp_override(**here):
            bpy.ops.screen.animation_play()
        yield lambda: scene.frame_current > start + 2
        with bpy.context.temp_override(**here):
            bpy.ops.screen.animation_cancel(restore_frame=False)

    with checking("a render from the menu, with more vertices than the viewport has, and back"):
        obj = the_ocean()
        obj.pelagic.viewport_percentage = 25
        yield lambda: len(obj.data.vertices) == 17**2
        counts, ended = [], []
        render = scene.render
        render.engine, render.resolution_percentage = "CYCLES", 5
        scene.cycles.samples, scene.cycles.use_denoising = 1, False
        scene.frame_start, scene.frame_end = 3, 5
        render.filepath, render.use_motion_blur = f"{BESIDE}.frame", True
        bpy.app.handlers.render_post.append(lambda *_: counts.append(len(the_ocean().data.vertices)))
        bpy.app.handlers.render_complete.append(lambda *_: ended.append(True))
        with bpy.context.temp_override(**here):
            bpy.ops.render.render("INVOKE_DEFAULT", animation=True)
        yield lambda: ended
        yield lambda: len(the_ocean().data.vertices) == 17**2
        assert counts == [65**2] * 3, counts

    with checking("the sea is seen"):
        obj = the_ocean()
        obj.pelagic.viewport_percentage = 100
        obj.pelagic.horizon = True
        until = time.monotonic() + 5
        yield lambda: time.monotonic() > until
        shown = window_pixels(window)
        high, wide = shown.shape[:2]
        lower = shown[high // 3:high // 2, wide // 4:wide // 2]
        assert lower.std() > 0.01, lower.std()

    with checking("a file that can't be written leaves the mesh; saved and opened in a window, the sea is there"):
        held, mesh, file = numbers(obj.data), obj.data, f"{BESIDE}.blend"
        assert refused(lambda: bpy.ops.wm.save_as_mainfile(filepath=str(Path(file) / "no.blend")), "no.blend")
        yield lambda: obj.data == mesh
        bpy.ops.wm.save_as_mainfile(filepath=file)
        assert obj.data == mesh and np.array_equal(numbers(mesh), held) and Path(file).stat().st_size < 5e6
        bpy.ops.wm.open_mainfile(filepath=file)
        until = time.monotonic() + 60
        yield lambda: len(the_ocean().data.vertices) == len(held) or time.monotonic() > until
        assert np.array_equal(numbers(the_ocean().data), held)


in_window(steps)
