"""The same material and light in EEVEE, which needs a display."""

import sys
import tempfile
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

SIZE = (160, 90)


def picture():
    from pictures import read_exr
    bpy_scene = bpy.context.scene
    bpy_scene.render.engine = "BLENDER_EEVEE_NEXT" if bpy.app.version[:2] in ((4, 2), (4, 3), (4, 4), (4, 5)) else "BLENDER_EEVEE"
    bpy_scene.eevee.taa_render_samples = 16
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = SIZE
    bpy_scene.render.image_settings.file_format = "OPEN_EXR"
    with tempfile.TemporaryDirectory() as folder:
        bpy_scene.render.filepath = str(Path(folder) / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return read_exr(bpy_scene.render.filepath)[..., :3]


def run():
    enable(sky_width=None)
    import pelagic
    from pictures import shot_in_blender

    with checking("EEVEE draws sea and sky like the core's in brightness"):
        obj = shot_in_blender(ROOT / "examples" / "first-shot.toml", SIZE)
        pixels = picture()
        assert np.isfinite(pixels).all()
        sea, sky = pixels[:45].mean(), pixels[80:].mean()
        print("   sea", sea, "sky", sky)
        assert 20 < sky < 80 and 12 < sea < 48 and pixels[:45].std() > 0.5  # `pelagic render`: 41 and 25

    with checking("EEVEE shows a lagoon, of which Cycles has a volume, in the colour that its floor and depth give the water"):
        from pelagic_ocean import depths
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], object=obj):
            bpy.ops.pelagic.preset_apply(name="lagoon")
        obj.pelagic.surface.kind, obj.pelagic.horizon = "patch", True
        obj.pelagic.light.sun_elevation_deg, obj.pelagic.light.sun_azimuth_deg = 55.0, 60.0  # no glitter before the camera
        bpy.context.view_layer.update()
        assert depths.OUTPUT in obj.data.materials[0].node_tree.nodes
        lagoon = picture()[:30].mean((0, 1))
        ratio = lagoon / (2.466, 6.925, 7.291)  # `pelagic render`
        print("   lagoon", ratio)
        # Red light is the most changed by the way up to a level eye: 1.35 in the colour for an eye at 45 degrees.
        assert (np.abs(ratio - 1.0) < (0.28, 0.1, 0.1)).all(), ratio


def main():
    try:
        run()
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


bpy.app.timers.register(main, first_interval=0.5)
