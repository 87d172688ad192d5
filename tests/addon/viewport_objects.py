"""Objects in the sea's light in the viewport preview: their shadow, their mirror image, what of them is in the water, their hulls and the foam along
these, beside the program's own picture. It alone would catch what Blender's gpu module makes of shaders, textures and depths that gpu_test.py knows as
text and numbers; a map, a picture or a hull that stays where a body was; and what is compiled or drawn of objects where there are none. At night also
in a calm, in a breeze with whitecaps and in opaque water. Needs a display (xvfb-run will do) and PELAGIC_PROGRAM, the program's path."""

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

BLOCK_M, SUNK_M, TUB_M = np.array((6.0, 2.0)), np.array((-5.0, -12.0)), np.array((-13.0, 2.0))  # x and y


def painted(name, colours, odd):
    """A material with a picture of squares, four of which are a side of a cube with Blender's own UV map; of floats where each side has odd texels."""
    made, image = bpy.data.materials.new(name), bpy.data.images.new(name, 64, 64, float_buffer=bool(odd))
    at = np.arange(64) // 8
    pixels = np.insert(np.float32(colours)[(at[:, None] + at) % 2], 3, 1.0, axis=2)
    for number, value in enumerate(odd):
        pixels[12::16, 4 + 8 * number::16, :3] = value
    image.pixels.foreach_set(pixels.ravel())
    made.use_nodes = True
    nodes = made.node_tree.nodes
    node, picture = next(node for node in nodes if node.type == "BSDF_PRINCIPLED"), nodes.new("ShaderNodeTexImage")
    picture.image = image
    made.node_tree.links.new(picture.outputs["Color"], node.inputs["Base Color"])
    return made


def meter_alike(obj, here):
    """Sets Blender's exposure so that both pictures are of one: the program meters where its camera is, which is the view, and the preview where
    Blender's is."""
    camera, sky = ocean.scene_of(obj, bpy.context.scene), pelagic.Sky(here)
    bpy.context.scene.view_settings.exposure += math.log2(sky.exposure(here) / sky.exposure(camera)) - light.stops_by_hand(bpy.context.scene)


def block_of(name, place_m, high_m, *colours, odd=()):
    """A block whose sides are painted, but the one to -x, which is plain and the first of its materials; where it is in the picture, the picture repeats."""
    with in_view():
        bpy.ops.mesh.primitive_cube_add(size=6.0, location=place_m, rotation=(0.0, 0.0, 0.3))
        made = bpy.context.object
    made.name, made.scale.z = name, high_m / 6.0
    plain = bpy.data.materials.new("plain")
    plain.use_nodes = True
    next(node for node in plain.node_tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"].default_value = (0.2, 0.9, 0.3, 1.0)
    made.data.materials.append(plain)
    made.data.materials.append(painted(name, colours, odd))
    for side in made.data.polygons:
        side.material_index = int(side.normal.x > -0.5)
    for corner in made.data.uv_layers.active.data:
        corner.uv[0] -= 1.0
    return made


def tub_of():
    """Open above, under way to +x."""
    tub = bpy.data.meshes.new("tub")
    corners = [(x, y, z) for z in (-2.0, 1.0) for y in (-4.0, 4.0) for x in (-6.0, 6.0)]
    tub.from_pydata(corners, [], [(0, 1, 3, 2), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)])
    tub = bpy.data.objects.new("tub", tub)
    bpy.context.scene.collection.objects.link(tub)
    for frame, east_m in ((0, TUB_M[0] - 4.0), (48, TUB_M[0] + 4.0)):
        tub.location = east_m, TUB_M[1], 0.0
        tub.keyframe_insert("location", frame=frame)
    for curve in compat.curves(tub):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    return tub


def part_of(corners):
    """The pixels round some world points, with those between them."""
    rows, columns = np.array([place_of(corner) for corner in corners]).T
    return np.s_[max(rows.min(), 0):rows.max() + 1, max(columns.min(), 0):columns.max() + 1]


def corners_of(least, most):
    return [(x, y, z) for x in (least[0], most[0]) for y in (least[1], most[1]) for z in (least[2], most[2])]


def compare_elsewhere(mine, program):
    """Changes, where the program has none, nor in a pixel beside. The sea is built anew for hulls, as fine as the view wants it by now: some of the
    nearest pixels differ by that."""
    changed = np.abs(program).max(2) > 0.0
    for axis in (0, 1):
        changed = changed | np.roll(changed, 1, axis) | np.roll(changed, -1, axis)
    off = np.abs(mine).max(2)[~changed]
    print(f"    elsewhere, in {1.0 - changed.mean():.2f} of the picture, at most {off.max():.3f}; {(off >= 2 / 255).mean():.5f} of it by 2/255 and more")
    assert changed.mean() < 0.5 and off.max() < 12 / 255 and (off >= 2 / 255).mean() < 4e-3


def compare(what, mine, program, part, least=0.08):
    """Changes, of two pictures each, in a part where the program has some, so many that their steps of 1/255 don't count; and elsewhere."""
    compare_elsewhere(mine, program)
    mine, program = mine[part], program[part]
    seen = np.abs(program).max(2) > least
    off = np.abs(mine - program).max(2)[seen] / np.abs(program).max(2)[seen]
    print(f"    {what}: {seen.sum()} pixels, by {np.abs(program).max(2)[seen].mean():.3f}; off by a median of {np.median(off):.4f}, nine of ten within "
          f"{np.quantile(off, 0.9):.4f}; elsewhere at most {np.abs(mine).max(2)[~seen].max(initial=0.0):.3f}")
    assert seen.sum() > 150 and np.median(off) < 0.1 and np.quantile(off, 0.9) < 0.25


def steps():
    fresh_file()  # one view, and nothing in it
    yield lambda: True
    with in_view():
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    with in_view():
        obj = add_ocean(quality__level="draft", sea__wind_speed_mps=3.0, light__sun_elevation_deg=25.0, light__sun_azimuth_deg=180.0, water__type="coastal")
    _, area = view3d()
    area.spaces.active.show_gizmo = area.spaces.active.overlay.show_overlays = False
    bpy.context.window_manager.pelagic_preview.show_sky = True
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, 48
    bodies = [block_of("block", (*BLOCK_M, 2.4), 6.0, (0.9, 0.3, 0.2), (0.95, 0.95, 0.95), odd=(np.nan, 20.0)), block_of("sunk", (*SUNK_M, -2.8), 4.0, (0.95, 0.85, 0.2), (0.2, 0.4, 0.3)), tub_of()]
    bpy.context.scene.frame_set(24)
    viewport.turn_on(obj)
    look(-24.0, 16.0, 30.0)
    block, sunk, tub = bodies

    def show(are_shown):
        for body in bodies:
            body.pelagic_in_light.enabled = are_shown

    def texels(name):
        """Those of a picture of the bodies (height, width, 3)."""
        return np.array(viewport._preview.drawing.pictures.textures[name].read().to_list())[..., :3]

    def has_none(shaders):
        """Whether the sea and these shaders' texts are of a scene without objects."""
        return not viewport._preview.drawing.sea.hull_footprints_m and not any(
            word in text for each in shaders for text in each for word in ("hull_maps", "mirrored_objects", "sun_blockers", "in_water_from_grid", "object_materials"))

    for wind_mps in (3.0, 1.0, 11.0) if at_night() else (3.0,):
        with checking(f"wind {wind_mps}: the views' pictures, without bodies, with them, and without their foam"):
            change(obj, sea__wind_speed_mps=wind_mps)
            here = seen_from_here(obj)
            meter_alike(obj, here)
            show(False)
            plain = picture()
            assert not viewport._preview.problem, viewport._preview.problem
            drawing = viewport._preview.drawing
            assert has_none(drawing._compiled if wind_mps == 3.0 else drawing._texts.values())
            without_hulls = drawing.sea
            # First they are elsewhere: what they leave in the sea goes along with them.
            for number, body in enumerate(bodies):
                body.delta_location.x = 200.0 + 9.0 * number
            show(True)
            settle()
            assert len(drawing.sea.hull_footprints_m) == 1, drawing.sea.hull_footprints_m
            for body in bodies:
                body.delta_location.x = 0.0
            bpy.context.view_layer.update()
            full = picture()
            draw = drawing.hulls.draw
            drawing.hulls.draw = lambda bodies, origin_m, _sea, texture: draw(bodies, origin_m, without_hulls, texture)
            foamless = picture()
            drawing.hulls.draw = draw
            assert not viewport._preview.problem, viewport._preview.problem
            theirs = programs_picture(here, 24)
            with in_view():
                assert in_light.put(bpy.context, obj, here, FOLDER / "bodies") == []
            theirs_full = programs_picture(here, 24)
            here.objects = [each._replace(foam=0.0) for each in here.objects]
            theirs_foamless = programs_picture(here, 24)
            if "PELAGIC_PICTURES" in os.environ:
                for name, pixels in (("plain", plain), ("foamless", foamless), ("full", full), ("program-plain", theirs), ("program-full", theirs_full),
                                     ("program-foamless", theirs_foamless)):
                    keep(Path(os.environ["PELAGIC_PICTURES"]) / f"{name}-{wind_mps:g}.png", pixels)
            mine, program = full - plain, theirs_full - theirs

        with checking("odd texels of a picture count as in an export, NaN as black and 20 as 1"):
            red = texels("mirrored_objects")[..., 0]
            print(f"    at most {red.max():.1f}; 99 of 100 within {np.quantile(red[red > 0.0], 0.99):.1f}")
            assert np.isfinite(red).all() and red.max() < 2.0 * np.quantile(red[red > 0.0], 0.99)

        with checking("the sea mirrors a body as in the program's preview"):
            # Nearer than the block, where the shadow isn't.
            low = place_of((BLOCK_M[0], BLOCK_M[1] - 5.0, 0.0))[0] - 2
            part = part_of(corners_of((BLOCK_M[0] - 4.0, BLOCK_M[1] - 12.0, 0.0), (BLOCK_M[0] + 4.0, BLOCK_M[1] - 5.0, 0.0)))
            compare("mirrored", mine, program, np.s_[part[0].start:low, part[1]])

        with checking("the sea shows a body in the water as in the program's preview"):
            under = part_of(corners_of((*(SUNK_M - 4.0), -1.0), (*(SUNK_M + 4.0), 0.0)))
            compare("in the water", mine, program, under)

        if wind_mps > 3.0:
            continue  # foam of its own, and glitter

        with checking("its shadow lies where the program's preview has it"):
            row, column = place_of((BLOCK_M[0] + 4.5, BLOCK_M[1], 0.0))
            part = np.s_[row - 10:row + 10, column:]
            shadow, program_shadow = (a[part].mean(2) / b[part].mean(2) < 0.97 for a, b in ((full, plain), (theirs_full, theirs)))
            print(f"    {shadow.sum()} pixels here, {program_shadow.sum()} by the program, {(shadow & program_shadow).sum()} in both")
            assert shadow.sum() > 30 and (shadow & program_shadow).sum() > 0.95 * (shadow | program_shadow).sum()

        with checking("no sea is drawn in a hull"):
            row, column = place_of((*TUB_M, 0.0))
            inside = np.s_[row - 3:row + 3, column - 4:column + 4]
            was, now = plain[inside].mean((0, 1)), full[inside].mean((0, 1))
            print(f"    in the hull {np.round(was, 3)} before, {np.round(now, 3)} now")
            assert was[1] > was[0] + 0.03, "there was no sea in it"
            assert abs(now[1] - now[0]) < 0.02, "its bottom is grey"

        with checking("foam lies along a hull under way, where the program's preview has it, and nowhere else"):
            foam, program_foam = (np.abs(a - b).max(2) for a, b in ((full, foamless), (theirs_full, theirs_foamless)))
            both = foam[program_foam > 0.02], program_foam[program_foam > 0.02]
            off = np.abs(both[0] - both[1]) / both[1]
            elsewhere = foam.copy()
            for place_m, wide_m in ((TUB_M, (7.2, 5.2)), (BLOCK_M, (5.2, 5.2))):
                rows, columns = part_of(corners_of((*(place_m - wide_m), 0.0), (*(place_m + wide_m), 1.0)))
                elsewhere[max(rows.start - 1, 0):rows.stop + 1, max(columns.start - 1, 0):columns.stop + 1] = 0.0
            print(f"    {len(off)} pixels, by {both[1].mean():.3f}, at most {both[1].max():.3f}; off by a median of {np.median(off):.3f}; in all "
                  f"{both[0].sum() / both[1].sum():.3f} of the program's; elsewhere {elsewhere.max():.3f}")
            assert len(off) > 50 and both[1].max() > 0.1 and np.median(off) < 0.15 and abs(both[0].sum() / both[1].sum() - 1.0) < 0.1
            assert elsewhere.max() < 0.02

    if at_night():
        with checking("a picture is drawn as it was edited, and not at all when its node is unlinked"):
            bpy.data.images["sunk"].pixels.foreach_set(np.tile(np.float32((0.0, 0.0, 0.0, 1.0)), 64 * 64))
            bpy.data.images["sunk"].update()
            bpy.context.view_layer.update()
            black = picture()
            tree = bpy.data.materials["sunk"].node_tree
            socket = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"]
            socket.default_value = 0.0, 0.9, 0.0, 1.0
            tree.links.remove(socket.links[0])
            bpy.context.view_layer.update()
            green = picture()
            darker, greener = (full - black)[under], (green - black)[under]
            print(f"    {(darker[..., 0] > 0.05).sum()} pixels are darker, {(greener[..., 1] > 0.05).sum()} greener")
            assert (darker[..., 0] > 0.05).sum() > 200 and (greener[..., 1] > 0.05).sum() > 200

        with checking("opaque water draws no picture of what is in it"):
            assert "objects_in_water" in drawing.pictures.textures
            change(obj, water__body=False)
            settle()
            assert "objects_in_water" not in drawing.pictures.textures and drawing.pictures.uniforms["in_water_ahead"] == (0.0, 0.0, 0.0)

        with checking("a sun below the horizon: the pictures are finite, and elsewhere the sea is as without bodies"):
            change(obj, water__body=True, light__sun_elevation_deg=-5.0)
            full = picture()
            assert not viewport._preview.problem, viewport._preview.problem
            assert np.isfinite(texels("mirrored_objects")).all() and np.isfinite(texels("objects_in_water")).all()
            show(False)
            plain = picture()
            print(f"    a mean of {plain.mean():.3f}; {(change_of(full, plain) > 0.05).sum()} pixels show bodies")
            assert plain.mean() > 0.05 and (change_of(full, plain) > 0.05).sum() > 50
            compare_elsewhere(full - plain, program)

    with checking("nothing is left of them without them"):
        show(False)
        settle()
        assert has_none(drawing._texts.values())


in_window(steps)
