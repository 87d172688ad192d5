"""Objects in the sea's light in the viewport preview: their shadow, their mirror image and their hulls, beside the program's own picture. Needs a
display (xvfb-run will do) and PELAGIC_PROGRAM, the program's path."""

import math
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import compat, in_light, light, ocean, viewport
from pelagic_ocean.module import pelagic
from views import *  # noqa: F403

CUBE_M = 6.0


def painted(name, colour):
    """A material that the viewport, too, shows in its colour."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    node = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    node.inputs["Base Color"].default_value = made.diffuse_color = (*colour, 1.0)
    return made


def meter_alike(obj, here):
    """Sets Blender's exposure so that both pictures are of one: the program meters where its camera is, which is the view, and the preview where
    Blender's is."""
    camera, sky = ocean.scene_of(obj, bpy.context.scene), pelagic.Sky(here)
    bpy.context.scene.view_settings.exposure += math.log2(sky.exposure(here) / sky.exposure(camera)) - light.stops_by_hand(bpy.context.scene)


def steps():
    fresh_file()  # one view, and nothing in it
    yield lambda: True
    with in_view():
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    with in_view():
        obj = add_ocean(quality__level="draft", sea__wind_speed_mps=3.0, light__sun_elevation_deg=25.0, light__sun_azimuth_deg=180.0, water__type="turbid")
    _, area = view3d()
    area.spaces.active.show_gizmo = area.spaces.active.overlay.show_overlays = False
    bpy.context.window_manager.pelagic_preview.show_sky = True
    bpy.context.scene.frame_start = bpy.context.scene.frame_end = 1
    viewport.turn_on(obj)

    with checking("an object in the sea's light throws its shadow, where the program's preview has it"):
        with in_view():
            bpy.ops.mesh.primitive_cube_add(size=CUBE_M, location=(-4.0, 0.0, 0.5 * CUBE_M))
            block = bpy.context.object
        look(-14.0, 14.0, 34.0)
        plain = picture()
        block.pelagic_in_light.enabled = True
        with_shadow, here = picture(), seen_from_here(obj)
        assert not viewport._preview.problem, viewport._preview.problem
        theirs = programs_picture(here)
        with in_view():
            assert in_light.put(bpy.context, obj, here, FOLDER / "bodies") == []
        theirs_with = programs_picture(here)
        # To the right of the block, where no mirror image of it is.
        row, column = place_of((0.0, 0.0, 0.0))
        part = np.s_[row - 12:row + 12, column:]
        mine, program = (a[part].mean(2) / b[part].mean(2) < 0.97 for a, b in ((with_shadow, plain), (theirs_with, theirs)))
        print(f"    {mine.sum()} pixels here, {program.sum()} by the program, {(mine & program).sum()} in both")
        assert mine.sum() > 30 and (mine & program).sum() > 0.7 * (mine | program).sum()
        aside = change_of(with_shadow, plain)[:, :column // 2]
        # The sea is built anew for hulls, as fine as the view wants it by now: single pixels far away glitter otherwise.
        assert aside.max() < 6 / 255 and (aside >= 2 / 255).mean() < 1e-3
        block.location.x += 200.0
        bpy.context.view_layer.update()
        assert (change_of(picture(), plain)[part] < 2 / 255).all(), "it goes along"
        bpy.data.objects.remove(block)

    with checking("the sea mirrors it as in the program's preview, calm and rough"):
        with in_view():
            bpy.ops.mesh.primitive_cube_add(size=CUBE_M, location=(0.0, 0.0, 0.4 * CUBE_M), rotation=(0.0, 0.0, 0.3))
            block = bpy.context.object
        block.scale.x = 2.0
        block.data.materials.append(painted("red", (0.8, 0.1, 0.05)))
        block.data.materials.append(painted("white", (0.9, 0.9, 0.9)))
        block.data.polygons[2].material_index = 1
        look(-14.0, 14.0, 34.0)
        for wind_mps in (1.0, 11.0) if at_night() else (11.0,):
            change(obj, sea__wind_speed_mps=wind_mps)
            here = seen_from_here(obj)
            meter_alike(obj, here)
            block.pelagic_in_light.enabled = False
            plain = picture()
            block.pelagic_in_light.enabled = True
            mirrored = picture()
            assert not viewport._preview.problem, viewport._preview.problem
            theirs = programs_picture(here)
            with in_view():
                assert in_light.put(bpy.context, obj, here, FOLDER / "bodies") == []
            theirs_mirrored = programs_picture(here)
            # Nearer than the block, where the shadow isn't.
            below = place_of((0.0, -0.8 * CUBE_M, 0.0))[0] - 2
            mine, program = ((a[:below] - b[:below]) for a, b in ((mirrored, plain), (theirs_mirrored, theirs)))
            seen = np.abs(program).max(2) > 0.03
            off = np.abs(mine - program).max(2)[seen] / np.abs(program).max(2)[seen]
            print(f"    wind {wind_mps}: {seen.mean():.3f} of the water, by {np.abs(program).max(2)[seen].mean():.3f}; off by a median of "
                  f"{np.median(off):.4f}, nine of ten within {np.quantile(off, 0.9):.4f}; elsewhere at most {np.abs(mine).max(2)[~seen].max():.3f}")
            if "PELAGIC_PICTURES" in os.environ:
                for name, pixels in (("mine", mirrored), ("theirs", theirs_mirrored), ("plain", plain)):
                    keep(Path(os.environ["PELAGIC_PICTURES"]) / f"{name}-{wind_mps:g}.png", pixels)
            assert seen.mean() > 0.02 and np.median(off) < 0.1 and np.quantile(off, 0.9) < 0.25
        bpy.data.objects.remove(block)

    with checking("no sea is drawn in a hull, wherever it goes"):
        change(obj, sea__wind_speed_mps=3.0)
        tub = bpy.data.meshes.new("tub")
        corners = [(x, y, z) for z in (-2.0, 1.0) for y in (-4.0, 4.0) for x in (-6.0, 6.0)]
        tub.from_pydata(corners, [], [(0, 1, 3, 2), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)])
        tub = bpy.data.objects.new("tub", tub)
        bpy.context.scene.collection.objects.link(tub)
        look(-24.0, 16.0, 34.0)
        full = picture()
        tub.pelagic_in_light.enabled = True
        dry = picture()
        assert not viewport._preview.problem, viewport._preview.problem
        row, column = place_of((0.0, 0.0, 0.0))
        inside = np.s_[row - 3:row + 3, column - 4:column + 4]
        was, now = full[inside].mean((0, 1)), dry[inside].mean((0, 1))
        print(f"    in the hull {np.round(was, 3)} before, {np.round(now, 3)} now")
        assert was[1] > was[0] + 0.03, "there was no sea in it"
        assert abs(now[1] - now[0]) < 0.02, "its bottom is grey"
        tub.location.x += 200.0
        bpy.context.view_layer.update()
        assert (change_of(picture(), full)[inside] < 2 / 255).all(), "it goes along"

    with checking("foam lies along a hull under way, where the program's preview has it, and nowhere else"):
        bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, 48
        for frame, east_m in ((0, -4.0), (48, 4.0)):
            tub.location.x = east_m
            tub.keyframe_insert("location", frame=frame)
        for curve in compat.curves(tub):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        bpy.context.scene.frame_set(24)
        drawing = viewport._preview.drawing
        tub.pelagic_in_light.enabled = False
        settle()
        tub.pelagic_in_light.enabled = True
        drawing.knows_hulls = lambda: True  # a sea that wasn't built for hulls will do
        without = picture()
        assert not drawing.sea.hull_footprints_m
        del drawing.knows_hulls
        foamy = picture()
        assert not viewport._preview.problem, viewport._preview.problem
        assert len(drawing.sea.hull_footprints_m) == 1, drawing.sea.hull_footprints_m
        here = seen_from_here(obj)
        with in_view():
            assert in_light.put(bpy.context, obj, here, FOLDER / "bodies") == []
        theirs = programs_picture(here, 24)
        here.objects = [each._replace(foam=0.0) for each in here.objects]
        mine, program = (np.abs(a - b).max(2) for a, b in ((foamy, without), (theirs, programs_picture(here, 24))))
        both = mine[program > 0.02], program[program > 0.02]
        off = np.abs(both[0] - both[1]) / both[1]
        rows, columns = np.array([place_of((x, y, z)) for x in (-7.2, 7.2) for y in (-5.2, 5.2) for z in (0.0, 1.0)]).T
        elsewhere = mine.copy()
        elsewhere[rows.min() - 1:rows.max() + 2, columns.min() - 1:columns.max() + 2] = 0.0
        print(f"    {len(off)} pixels, by {both[1].mean():.3f}, at most {both[1].max():.3f}; off by a median of {np.median(off):.3f}; in all {both[0].sum() / both[1].sum():.3f} "
              f"of the program's; elsewhere {elsewhere.max():.3f}")
        if "PELAGIC_PICTURES" in os.environ:
            for name, pixels in (("foam", foamy), ("no-foam", without), ("program-foam", theirs)):
                keep(Path(os.environ["PELAGIC_PICTURES"]) / f"{name}.png", pixels)
        assert len(off) > 50 and both[1].max() > 0.1 and np.median(off) < 0.15 and abs(both[0].sum() / both[1].sum() - 1.0) < 0.1
        assert elsewhere.max() < 0.02

    with checking("a scene without objects has a sea and shaders without all that"):
        tub.pelagic_in_light.enabled = False
        picture()
        assert not drawing.sea.hull_footprints_m and "object" not in drawing._shaders
        assert not any("hull_maps" in text or "mirrored_objects" in text or "sun_blockers" in text
                       for text in drawing.sea.shaders(drawing.light)["sea"])


in_window(steps)
