"""An ocean follows the timeline and its settings, and is the core's."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import ocean, play

scene = bpy.context.scene

with checking("the attributes equal the core's for the same shot"):
    fresh_file()
    scene = bpy.context.scene
    obj = add_ocean(sea__wind_speed_mps=17.0, surface__size_m=150.0)
    scene.frame_set(31)
    shot = ocean.scene_of(obj, scene)
    assert shot.sea.wind_speed_mps == 17.0 and shot.surface.resolution == 32
    rest, _ = pelagic.patch(150.0, 32)
    frame = pelagic.Frame(pelagic.Sea(shot))
    frame.set(shot.shot.time_s(31))
    core = frame.evaluate(rest)
    for name, product in (("position", "position"), ("velocity", "velocity"), ("slope_variance", "slope_variance"),
                          ("whitecap_coverage", "coverage")):
        assert np.array_equal(numbers(evaluated_mesh(obj), name), core[product]), name
    assert core["coverage"].max() > 0.01 and core["position"][:, 2].std() > 0.3

with checking("with a horizon the patch's vertices are the same"):
    near = numbers(obj.data)
    obj.pelagic.horizon = True
    bpy.context.view_layer.update()
    far = numbers(obj.data)
    assert len(far) > len(near) and np.array_equal(far[:len(near)], near)
    assert np.linalg.norm(far[:, :2], axis=1).max() > 25e3

with checking("frame 1 → 250 → 1 gives the same bits"):
    scene.frame_set(1)
    first = {name: numbers(obj.data, name) for name in ("position", "velocity", "slope_variance", "whitecap_coverage")}
    scene.frame_set(250)
    assert not np.array_equal(numbers(obj.data), first["position"])
    scene.frame_set(1)
    for name, before in first.items():
        assert np.array_equal(numbers(obj.data, name), before), name

with checking("a changed setting is a changed sea; put back, it is the same again"):
    before = numbers(obj.data)
    change(obj, sea__wind_speed_mps=8.0)
    assert numbers(obj.data)[:, 2].std() < 0.6 * before[:, 2].std()
    change(obj, sea__wind_speed_mps=17.0)
    assert np.array_equal(numbers(obj.data), before)

with checking("an effect that is off has no attribute"):
    change(obj, effects__whitecaps=False)
    assert "whitecap_coverage" not in obj.data.attributes
    change(obj, effects__whitecaps=True)
    assert "whitecap_coverage" in obj.data.attributes

with checking("a hidden ocean costs nothing"):
    obj.hide_set(True)
    before = numbers(obj.data)
    scene.frame_set(9)
    assert np.array_equal(numbers(obj.data), before)
    obj.hide_set(False)
    bpy.context.view_layer.update()
    assert not np.array_equal(numbers(obj.data), before)

with checking("simulation_of gives the sea that plays, at any time"):
    simulation = play.simulation_of(obj)
    assert simulation.sea.significant_height_m > 1 and simulation.scene.sea.wind_speed_mps == 17.0
    assert simulation.frame_at(3.0).time_s == 3.0 and simulation.frame_at(1.0).time_s == 1.0
