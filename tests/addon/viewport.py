"""The viewport preview in the real window: what is drawn where, beside the program's own picture; and that the mesh comes
back whatever happens. Needs a display (xvfb-run will do) and PELAGIC_PROGRAM, the program's path."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from bpy_extras.object_utils import world_to_camera_view
from harness import *  # noqa: F403
from mathutils import Vector

package = enable()
from pelagic_ocean import compat, ocean, viewport
from pelagic_ocean.module import pelagic
from views import *  # noqa: F403

CUBE_M = 6.0


# ---- The test


def steps():
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    window, area = view3d()
    with in_view():
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    _, area = view3d()
    space = area.spaces.active
    space.show_gizmo = False
    space.overlay.show_overlays = False
    with in_view():
        obj = add_ocean(quality__level="draft")
    options = bpy.context.window_manager.pelagic_preview
    look(-4.0, 12.0)
    # Calm where a picture says so, which is a texture of its own.
    mask = obj.pelagic.waves.masks.add()
    mask.picture = str(Path(__file__).parents[2] / "examples" / "data" / "tiles.exr")
    mask.length_m, mask.width_m, mask.edge_m, mask.waves = 120.0, 90.0, 10.0, 0.0

    with checking("the mesh is hidden, and the picture is the program's own"):
        shown = picture()
        options.show_sky = True
        with in_view():
            assert bpy.ops.pelagic.viewport_preview() == {"FINISHED"}
        # The exposure is metered where the scene's camera is, and in the program's picture that is the view.
        here, camera = seen_from_here(obj), ocean.scene_of(obj, bpy.context.scene)
        sky = pelagic.Sky(here)
        bpy.context.scene.view_settings.exposure += math.log2(sky.exposure(here) / sky.exposure(camera))
        drawn = picture()
        if "takes no GLSL" in viewport._problem:  # nor does the mesh go
            assert not viewport.is_on() and not obj.hide_get()
            return
        assert viewport.is_on() and not viewport._problem, viewport._problem
        assert obj.hide_get() and not obj.hide_viewport and not obj.hide_render
        assert change_of(shown, drawn).mean() > 0.1
        theirs = programs_picture(here)
        difference = change_of(drawn, theirs)
        ratio = drawn.mean(axis=(0, 1)) / theirs.mean(axis=(0, 1))
        print(f"    differences: median {np.median(difference):.4f}, mean {difference.mean():.4f}; mean colours {ratio}")
        assert np.median(difference) <= 2 / 255 and difference.mean() < 0.02
        assert np.abs(ratio - 1).max() < 0.02

    obj.pelagic.waves.masks.clear()

    with checking("foam that lives is the program's, too, and how it looks needs no other sea and no other sky"):
        wind_mps, obj.pelagic.sea.wind_speed_mps = obj.pelagic.sea.wind_speed_mps, 18.0
        obj.pelagic.effects.foam_decay_s = 1.0
        living, here = picture(), seen_from_here(obj)
        theirs = programs_picture(here)
        here.effects.foam_decay_s = 0.0
        without = programs_picture(here)
        here.effects.foam_decay_s = obj.pelagic.effects.foam_decay_s
        # What earlier breaking has left, a thin film, is seen in few pixels of the sea: there the picture is the one that has it.
        left = change_of(theirs, without) > 0.05
        left[place_of((0, 1e5, 0))[0] - 3:] = False
        near, far = change_of(living, theirs)[left].mean(), change_of(living, without)[left].mean()
        print(f"    where there is old foam, {left.mean():.4f} of the picture: differs by {near:.4f} from it, by {far:.4f} from none")
        assert left.mean() > 0.005 and near < 0.3 * far
        drawing = viewport._preview.drawing
        here.effects.foam_structure = 0.0
        assert drawing.sea.has_living_foam and drawing.sea.serves(here) and drawing.light.serves(here)
        obj.pelagic.sea.wind_speed_mps = wind_mps
    # What follows is about the window, for which a sea will do that takes half the time to draw in software.
    obj.pelagic.effects.foam_decay_s = 0.0
    obj.pelagic.waves.tiling = "periodic"
    drawn = picture()

    with checking("a turned ocean is another sea under the same sky"):
        obj.rotation_euler.z = 2.0
        turned = picture()
        horizon = place_of((0, 1e5, 0))[0]
        assert change_of(turned, drawn)[horizon + 3:].max() <= 3 / 255
        assert change_of(turned, drawn)[:horizon].mean() > 0.01
        obj.rotation_euler.z = 0.0

    with checking("without the sky there is the view's own background over the horizon, and the sea is the same"):
        options.show_sky = False
        sea = picture()
        assert change_of(sea, drawn)[:horizon - 3].max() <= 2 / 255
        above = sea[horizon + 3:]
        assert above.std(axis=(0, 1)).max() < 0.02 and change_of(above, drawn[horizon + 3:]).mean() > 0.1

    with checking("a near clip end doesn't cut the sea off"):
        clip_end, space.clip_end = space.clip_end, 100.0
        assert change_of(picture(), sea)[:horizon - 3].mean() < 0.005
        space.clip_end = clip_end

    with checking("a cube floats in it: its top is seen, its bottom is under water"):
        bpy.ops.mesh.primitive_cube_add(size=CUBE_M)
        cube = bpy.context.object
        with_cube = picture()
        changed = change_of(with_cube, sea) > 0.05
        top, left = place_of((-CUBE_M / 2, CUBE_M / 2, CUBE_M / 2))
        front, right = place_of((CUBE_M / 2, -CUBE_M / 2, CUBE_M / 2))
        bottom, middle = place_of((0, -CUBE_M / 2, -CUBE_M / 2))
        rows, columns = np.nonzero(changed)
        # What lies in front of the cube is the same, and so is what is beside it.
        assert changed[front - 1, left + 3:right - 3].all(), "no cube"
        assert not changed[:bottom + 3].any(), "the cube's bottom is seen through the sea"
        assert columns.min() >= place_of((-CUBE_M / 2, -CUBE_M / 2, 0))[1] - 2 and rows.max() <= top + 2
        water = rows.min()
        print(f"    the cube is seen from row {water} to {rows.max()}; its bottom would be at {bottom}")
        assert place_of((0, -CUBE_M / 2, -2.5))[0] < water < place_of((0, -CUBE_M / 2, 2.5))[0]
        space.shading.type = "MATERIAL"
        in_material = change_of(picture(), sea) > 0.05
        if "MATERIAL" in viewport.SHADINGS:
            assert in_material[front - 1, left + 3:right - 3].all() and not in_material[:bottom + 3].any()
        else:  # the mesh itself
            assert not obj.hide_get() and in_material[:bottom + 3].mean() > 0.2
        space.shading.type = "SOLID"
        picture()
        assert obj.hide_get()

    with checking("it moves with the timeline, without the mesh"):
        before = numbers(obj.data)
        bpy.context.scene.frame_set(20)
        assert change_of(picture(), with_cube)[:horizon].mean() > 0.01
        assert np.array_equal(numbers(obj.data), before)
        bpy.context.scene.frame_set(1)
        # A sea that is built anew may change single pixels far away, where a pixel has many waves; another frame changes most.
        again = change_of(picture(), with_cube)
        print(f"    frame 1 again: at most {again.max():.4f}, {(again > 2 / 255).mean():.5f} of the pixels differ")
        assert (again > 2 / 255).mean() < 1e-3

    with checking("it follows settings: another sun without another sea, another wind"):
        sea_before = viewport._preview.drawing.sea
        obj.pelagic.light.sun_elevation_deg = 60.0
        assert change_of(picture(), with_cube)[:horizon].mean() > 0.02
        assert viewport._preview.drawing.sea is sea_before
        settings = bpy.context.scene.view_settings
        darker = picture()[:horizon].mean()
        settings.exposure += 1.0
        assert picture()[:horizon].mean() > 1.2 * darker
        settings.exposure -= 1.0
        obj.pelagic.sea.wind_speed_mps = 4.0
        picture()
        assert viewport._preview.drawing.sea is not sea_before

    with checking("orthographic views and views through the camera are drawn"):
        region_3d = space.region_3d
        region_3d.view_perspective, region_3d.view_distance = "ORTHO", 60.0
        region_3d.view_rotation = (1, 0, 0, 0)
        region_3d.view_location = (0, 0, 0)
        top_view = picture()
        assert top_view[:, :, 2].mean() > top_view[:, :, 0].mean() + 0.02, "no blue sea from above"
        camera = bpy.context.scene.camera
        camera.location, camera.rotation_euler = (0, -60, 12), (np.radians(86), 0, 0)
        camera.data.shift_y, camera.data.shift_x = -0.1, 0.2
        region_3d.view_perspective = "CAMERA"
        through = picture()
        scene = bpy.context.scene
        horizon_in_frame = world_to_camera_view(scene, camera, Vector((0, 1e6, 0))).y
        assert 0.3 < horizon_in_frame < 0.95
        row = place_of((0, 1e6, 0))[0]
        sky = through[row + 6:row + 12]
        assert change_of(through[row - 12:row - 6], sky).mean() > 0.15 * sky.mean(), "the horizon isn't where it should be"
        look(-4.0, 12.0)

    with checking("two views at once: they come to rest, also where foam lives"):
        obj.pelagic.effects.foam_decay_s = 0.2
        with in_view():
            bpy.ops.screen.back_to_previous()
        settle()
        with in_view():
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
        yield lambda: all(area.width > 1 for area in bpy.context.window_manager.windows[0].screen.areas)
        settle()
        drawing = viewport._preview.drawing
        assert len(drawing._grids) >= 2 and drawing.sea.has_living_foam
        redraw()
        assert not drawing.awaits_foam, "each view's picture asks for both views' foam again"
        obj.pelagic.effects.foam_decay_s = 0.0

    with checking("a view that needs the mesh gets it"):
        space = view3d()[1].spaces.active
        space.shading.type = "WIREFRAME"
        settle()
        assert viewport.is_on() and not obj.hide_get()
        space.shading.type = "SOLID"
        settle()
        assert obj.hide_get()

    with checking("undo and redo leave the preview on and the mesh hidden"):
        with in_view():
            bpy.ops.ed.undo_push(message="before")
            cube.location.x = 3.0
            bpy.ops.ed.undo_push(message="moved")
            for step in (bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.undo):
                step()
                settle()
                assert viewport.is_on() and viewport._preview.obj().hide_get()
        obj = viewport._preview.obj()
        obj.name = "The sea"
        settle()
        assert viewport.is_on() and viewport._preview.obj() == obj

    with checking("off: everything is as before, and nothing is left behind"):
        with in_view():
            bpy.ops.pelagic.viewport_preview()
        assert not viewport.is_on() and not obj.hide_get()
        assert viewport._tend() is None

    with checking("an undo step from when it was on doesn't hide the mesh"):
        cube = bpy.data.objects["Cube"]
        viewport.turn_on(obj)
        settle()
        with in_view():
            cube.location.x = 4.0
            bpy.ops.ed.undo_push(message="moved while it was on")
            viewport.turn_off()
            cube.location.x = 5.0
            bpy.ops.ed.undo_push(message="moved after that")
            bpy.ops.ed.undo()
        obj = bpy.data.objects["The sea"]
        assert bpy.data.objects["Cube"].location.x == 4.0 and not obj.hide_get()

    with checking("whoever shows the mesh again turns it off"):
        viewport.turn_on(obj)
        settle()
        obj.hide_set(False)
        settle()
        assert not viewport.is_on() and not obj.hide_get()

    with checking("an error is said once, and the handler goes"):
        works, compat.shader = compat.shader, refuse_shaders
        viewport.turn_on(obj)
        settle()
        assert not viewport.is_on() and viewport._problem == "no shaders today" and not obj.hide_get()
        compat.shader = works

    with checking("a setting that gives no sea is said, and the old sea stays"):
        viewport.turn_on(obj)
        settle()
        obj.pelagic.light.sky = str(FOLDER / "missing.exr")
        settle()
        assert viewport.is_on() and "missing.exr" in viewport._preview.problem, viewport._preview.problem
        obj.pelagic.light.sky = "daylight"
        settle()
        assert viewport.is_on() and not viewport._preview.problem

    with checking("a saved file has its mesh shown, and opens without the preview"):
        file = str(FOLDER / "saved.blend")
        with in_view():
            bpy.ops.wm.save_as_mainfile(filepath=file)
            settle()
            assert viewport.is_on() and obj.hide_get()
            bpy.ops.wm.open_mainfile(filepath=file)
        assert not viewport.is_on() and not bpy.data.objects["The sea"].hide_get()

    with checking("a deleted ocean turns it off"):
        viewport.turn_on(bpy.data.objects["The sea"])
        settle()
        bpy.data.objects.remove(bpy.data.objects["The sea"])
        settle()
        assert not viewport.is_on() and not viewport._problem, viewport._problem

    fresh_file()
    yield lambda: True
    with checking("the add-on goes while it is on"):
        with in_view():
            obj = add_ocean(quality__level="draft")
        viewport.turn_on(obj)
        settle()
        assert obj.hide_get()
        package.unregister()
        assert not viewport.is_on() and not obj.hide_get()


def refuse_shaders(vertex, fragment):
    raise RuntimeError("no shaders today")


in_window(steps)
