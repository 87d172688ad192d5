"""The same material and light in EEVEE, which needs a display."""

import math
import sys
import tempfile
import traceback
from pathlib import Path

from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

SIZE = (160, 90) if at_night() else (80, 45)


def picture(samples=4):
    from pictures import read_exr
    bpy_scene = bpy.context.scene
    bpy_scene.render.engine = "BLENDER_EEVEE_NEXT" if bpy.app.version[:2] in ((4, 2), (4, 3), (4, 4), (4, 5)) else "BLENDER_EEVEE"
    bpy_scene.eevee.taa_render_samples = samples
    bpy_scene.render.resolution_x, bpy_scene.render.resolution_y = SIZE
    bpy_scene.render.image_settings.file_format = "OPEN_EXR"
    with tempfile.TemporaryDirectory() as folder:
        bpy_scene.render.filepath = str(Path(folder) / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return read_exr(bpy_scene.render.filepath)[..., :3]


def run():
    enable(sky_width=256)
    import pelagic
    from pictures import shot_in_blender

    with checking("EEVEE draws sea and sky like the core's in brightness"):
        obj = shot_in_blender(ROOT / "examples" / "first-shot.toml", SIZE)
        pixels = picture()
        assert np.isfinite(pixels).all()
        sea, sky = pixels[:SIZE[1] // 2].mean(), pixels[-SIZE[1] // 9:].mean()
        print("   sea", sea, "sky", sky)
        assert 20 < sky < 80 and 12 < sea < 48 and pixels[:SIZE[1] // 2].std() > 0.5  # `pelagic render`: 41 and 25

    with checking("EEVEE shows a lagoon, of which Cycles has a volume, in the colour that its floor and depth give the water"):
        from pelagic_ocean import depths
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], object=obj):
            bpy.ops.pelagic.preset_apply(name="lagoon")
        obj.pelagic.surface.kind, obj.pelagic.horizon = "patch", True
        obj.pelagic.light.sun_elevation_deg, obj.pelagic.light.sun_azimuth_deg = 55.0, 60.0  # no glitter before the camera
        bpy.context.view_layer.update()
        assert depths.OUTPUT in obj.data.materials[0].node_tree.nodes
        lagoon = picture()[:SIZE[1] // 3].mean((0, 1))
        ratio = lagoon / (2.466, 6.925, 7.291)  # `pelagic render`
        print("   lagoon", ratio)
        # Red light is the most changed by the way up to a level eye: 1.35 in the colour for an eye at 45 degrees.
        assert (np.abs(ratio - 1.0) < (0.28, 0.1, 0.1)).all(), ratio

    if not at_night():
        return
    with checking("EEVEE shows a camera in it Snell's window, the water mirrored round it, and the floor, as bright as the core's pictures"):
        from pictures import core_layers
        from pelagic_ocean import diving, ocean
        camera, ratios = bpy.context.scene.camera, []
        camera.data.sensor_fit = "HORIZONTAL"
        for pitch_deg, fov_deg, parts in ((89.0, 120.0, ((0.77, 1.0), (0.0, 0.57))), (-10.0, 70.0, ((0.05, 0.5), (-1.0, -0.2)))):
            camera.data.angle = math.radians(fov_deg)
            camera.matrix_world = Matrix.Translation((0.0, 0.0, -1.5)) @ Matrix.Rotation(math.radians(90.0 + pitch_deg), 4, "X")
            bpy.context.view_layer.update()
            assert diving.SHOWN in obj.data.materials[0].node_tree.nodes
            with tempfile.TemporaryDirectory() as folder:
                scene = ocean.scene_of(obj, bpy.context.scene)
                scene.shot.name, scene.shot.frames = "below", (1, 1)
                scene.save(Path(folder) / "below.toml")
                layers = core_layers(Path(folder) / "below.toml", SIZE)
            mine, core = picture(), 1.34**2 * sum(layers.values())  # whose camera is in air, behind its glass
            x, y = np.meshgrid(*((np.arange(count) + 0.5 - 0.5 * count) * 2.0 * math.tan(math.radians(0.5 * fov_deg)) / SIZE[0] for count in SIZE))
            up = (np.stack([x, y, -np.ones_like(x)], axis=-1) / np.sqrt(x * x + y * y + 1.0)[..., None]) @ np.array(camera.matrix_world.to_3x3())[2]
            no_sun = layers["sun"][..., 1] == 0.0
            seen = [no_sun & (low < up) & (up < high) for low, high in parts]
            ratios += [mine[part].mean(0)[1:] / core[part].mean(0)[1:] for part in seen]
        print("   green and blue: window {}, round it {}, surface ahead {}, floor {}".format(*(np.round(each, 3) for each in ratios)))
        # Before the surface the water glows as it does level, where it has more of the floor's green.
        limits = (0.9, 1.1), (0.95, 1.25), (0.92, 1.25), (0.97, 1.05)
        assert all((low < each).all() and (each < high).all() for each, (low, high) in zip(ratios, limits)), ratios


def main():
    try:
        run()
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


bpy.app.timers.register(main, first_interval=0.5)
