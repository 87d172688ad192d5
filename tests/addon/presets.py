"""Presets: the core's each give a sea; the user's own are saved, applied, deleted."""

import os
import runpy
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import ocean, panels, play, presets, viewport

fresh_file()
obj = add_ocean()

with checking("the core's presets: a sea each, and higher waves with each force of the wind"):
    heights = {}
    for preset in pelagic.presets():
        bpy.ops.pelagic.preset_apply(name=preset["name"])
        bpy.context.view_layer.update()
        simulation = play.simulation_of(obj)
        assert not simulation.problem, f"{preset['name']}: {simulation.problem}"
        scene = ocean.scene_of(obj, bpy.context.scene)
        for path, value in preset["values"].items():
            table, name = path.split(".")
            if path.startswith("camera.") and name != "exposure_ev":  # Blender's own
                continue
            assert getattr(getattr(scene, table), name) == value, f"{preset['name']}: {path}"
        heights[preset["name"]] = simulation.sea.significant_height_m
    beaufort = [heights[f"beaufort-{force}"] for force in range(13)]
    assert beaufort == sorted(beaufort) and beaufort[0] < 0.05 and beaufort[12] > 10, beaufort

with checking("the menu is the main panel's first row, and in a view's header for an active ocean alone; each preset says what it is"):
    class Layout:
        """Writes down what is drawn."""

        def __init__(self):
            self.drawn = []

        def __getattr__(self, what):
            return lambda *words, **_: self.drawn.append((what, *words)) or self

    def drawn(draw, on):
        draw(on, bpy.context)
        return on.layout.drawn

    menu = ("menu", "PELAGIC_MT_presets")
    assert drawn(panels.Main.draw, SimpleNamespace(layout=Layout()))[0] == menu
    assert menu in drawn(viewport._header, SimpleNamespace(layout=Layout()))
    bpy.context.view_layer.objects.active = bpy.data.objects["Camera"]
    assert menu not in drawn(viewport._header, SimpleNamespace(layout=Layout()))
    bpy.context.view_layer.objects.active = obj
    for preset in pelagic.presets():
        assert (presets.THUMBNAILS / f"{preset['name']}.jpg").is_file(), f"{preset['name']} has no thumbnail: examples/pictures.sh"
    drawn(presets.PELAGIC_MT_presets.draw, SimpleNamespace(layout=Layout()))
    assert set(presets._icons) == {preset["name"] for preset in pelagic.presets()}, set(presets._icons)
    told = {presets.PELAGIC_OT_preset_apply.description(None, SimpleNamespace(name=preset["name"])) for preset in pelagic.presets()}
    assert len(told) == len(pelagic.presets()) and all(words[0].isupper() and ". Sets " in words for words in told), told

with checking("a preset of one's own: saved, applied, and only the sea, the light and the water are in it"):
    assert Path(os.environ["BLENDER_USER_SCRIPTS"]) in presets.folder(create=True).parents
    bpy.ops.pelagic.preset_apply(name="southern-ocean")
    change(obj, sea__wind_direction_deg=77.0)
    expected = ocean.scene_of(obj, bpy.context.scene)
    bpy.ops.pelagic.preset_save(name="My own/ sea")
    (name,) = presets.own_presets()
    bpy.ops.pelagic.preset_apply(name="beaufort-2")
    change(obj, surface__resolution=20)
    bpy.ops.pelagic.preset_apply(name=name)
    scene = ocean.scene_of(obj, bpy.context.scene)
    assert str(scene.sea) == str(expected.sea) and str(scene.light) == str(expected.light)
    assert scene.surface.resolution == 20

with checking("what is refused: no name, a name of the core's, a preset that isn't there"):
    assert refused(lambda: bpy.ops.pelagic.preset_save(name=" "), "needs a name")
    assert refused(lambda: bpy.ops.pelagic.preset_save(name="beaufort-3"), "another name")
    assert refused(lambda: bpy.ops.pelagic.preset_apply(name="nowhere"), "nowhere")

with checking("deleted, it is gone"):
    bpy.ops.pelagic.preset_delete(name=name)
    assert not presets.own_presets()
    assert refused(lambda: bpy.ops.pelagic.preset_delete(name=name), "no preset")

with checking("a library of assets: thumbnails, empty meshes, and an ocean of the preset where one arrives"):  # two seas are rendered
    library = Path(tempfile.mkdtemp()) / "presets.blend"
    sys.argv = ["blender", "--", str(library), "--presets", "beaufort-10,glassy-swell", "--samples", "1", "--size", "32"]
    runpy.run_path(str(ROOT / "examples" / "blender-presets.py"), run_name="__main__")
    fresh_file()
    with bpy.data.libraries.load(str(library), assets_only=True) as (there, here):
        here.objects = there.objects
    storm, swell = (bpy.data.objects[name] for name in ("10 Storm", "Glassy swell"))
    for each in (storm, swell):
        picture = np.array(each.preview.image_pixels_float[:]).reshape(32, 32, 4)[..., :3]
        assert not len(each.data.vertices) and picture.std() > 0.02 and library.stat().st_size < 2e6, library.stat().st_size
        bpy.context.collection.objects.link(each)
    bpy.context.view_layer.update()
    assert numbers(storm.data)[:, 2].std() > 3 * numbers(swell.data)[:, 2].std() > 0
    assert storm.data.materials[0] != swell.data.materials[0]
