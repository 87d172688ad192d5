"""Settings with keyframes: a sea that changes plays as the core has it, and goes into shots and comes out of them as keys."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import compat, exchange, keyed, light, ocean, play

FOLDER = Path(tempfile.mkdtemp())


def curve_of(obj, path):
    return next(curve for curve in compat.curves(obj) if curve.data_path == f"pelagic.{path}")


def keyframed(obj, path, keys, interpolation="LINEAR"):
    table, name = path.split(".")
    for frame, value in keys.items():
        setattr(getattr(obj.pelagic, table), name, value)
        obj.keyframe_insert(f"pelagic.{path}", frame=frame)
    for point in curve_of(obj, path).keyframe_points:
        point.interpolation = interpolation


def ocean_of(first=1, last=40, **settings):
    fresh_file()
    bpy_scene = bpy.context.scene
    bpy_scene.frame_start, bpy_scene.frame_end = first, last
    return add_ocean(**settings)


def exported(obj):
    return exchange.shot_of(bpy.context, obj)


with checking("keys through values: straight, gentle, with corners, none; of angles the short way round"):
    frames = np.arange(1, 41)
    assert keyed.keys_through(frames, np.full(40, 0.1, np.float32), 0.01) == 0.1
    line = keyed.keys_through(frames, np.interp(frames, (5, 30), (6.0, 14.0)), 0.01)
    assert line == {"keys": ((5, 6.0), (30, 14.0)), "interpolation": "linear"}, line
    t = np.clip((frames - 5) / 25, 0, 1)
    gentle = keyed.keys_through(frames, 6.0 + 8.0 * t * t * (3 - 2 * t), 0.01)
    assert gentle == {"keys": ((5, 6.0), (30, 14.0)), "interpolation": "smooth"}, gentle
    wild = 10.0 + 4.0 * np.sin(frames / 5.0)
    for tolerance in (0.01, 0.1):
        keys = dict(keyed.keys_through(frames, wild, tolerance)["keys"])
        off = np.abs(np.interp(frames, list(keys), list(keys.values())) - wild).max() / np.ptp(wild)
        assert off <= tolerance and len(keys) < 20, (off, len(keys))
    turned = keyed.keys_through(frames, (350.0 + np.interp(frames, (1, 40), (0.0, 39.0))) % 360.0, 0.001, True)
    assert turned["keys"] == ((1, 350.0), (40, 29.0)), turned
    for turn_deg in (270.0, -720.0):  # the long way round
        scene = pelagic.Scene()
        scene.light.sun_azimuth_deg = keyed.keys_through(frames, np.interp(frames, (1, 40), (0.0, turn_deg)), 0.001, True)
        off = [(scene.at(frame).light.sun_azimuth_deg - turn_deg * (frame - 1) / 39 + 180.0) % 360.0 - 180.0 for frame in frames.tolist()]
        assert np.abs(off).max() < 0.01, (turn_deg, scene.light.sun_azimuth_deg)
    noise = np.random.default_rng(1).uniform(5.0, 15.0, 400)
    assert len(keyed.keys_of_sea_through(np.arange(400), noise, False)["keys"]) <= keyed.MOST_KEYS

    spun = keyed.keys_of_sea_through(np.arange(1000), np.linspace(0.0, 360.0 * 40, 1000), True)  # more half turns than keys
    assert keyed.MOST_KEYS < len(spun["keys"]) < 200, len(spun["keys"])

with checking("a wind with keyframes: one sea for all frames, and it is the core's"):
    obj = ocean_of()
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0})
    seas, heights = set(), []
    shot = None
    for frame in (1, 20, 40, 10):
        bpy.context.scene.frame_set(frame)
        seas.add(id(play.simulation_of(obj).sea))
        shot = shot or keyed.put(ocean.scene_of(obj, bpy.context.scene), {"sea.wind_speed_mps": {"keys": ((1, 6.0), (40, 14.0))}})
        core = pelagic.Frame(pelagic.Sea(shot, ["position"]))
        core.set(shot.shot.time_s(frame))
        rest, _ = pelagic.patch(shot.surface.size_m, shot.surface.resolution)
        # The add-on's patch has its rows the other way round, maybe: heights of both are compared as they are spread.
        mine, theirs = numbers(obj.data), core.evaluate(rest)["position"]
        order = lambda points: points[np.lexsort(points.T)]  # noqa: E731
        assert np.allclose(order(mine), order(theirs), atol=1e-4), frame
        heights.append(play.simulation_of(obj).significant_height_m)
    assert len(seas) == 1 and heights[0] < heights[3] < heights[1] < heights[2], (len(seas), heights)
    assert abs(heights[0] - shot.at(1).significant_height_m()) < 1e-6 and abs(heights[2] - shot.at(40).significant_height_m()) < 1e-6

with checking("it is baked and exported as keys, with the light's; what can't have any is named"):
    keyframed(obj, "light.sun_elevation_deg", {1: 40.0, 40: 10.0})
    keyframed(obj, "waves.choppiness", {1: 0.5, 40: 1.0})
    keyframed(obj, "sea.gust_size_m", {1: 200.0, 40: 300.0})
    keyframed(obj, "sea.gust_strength", {1: 0.0, 40: 0.8})
    shot, remarks = exported(obj)
    assert shot.sea.wind_speed_mps == {"keys": ((1, 6.0), (40, 14.0)), "interpolation": "linear"}, shot.sea.wind_speed_mps
    assert shot.light.sun_elevation_deg["keys"] == ((1, 40.0), (40, 10.0)), shot.light.sun_elevation_deg
    assert shot.sea.gust_strength["keys"] == ((1, 0.0), (40, 0.8)), shot.sea.gust_strength
    assert shot.waves.choppiness["keys"] == ((1, 0.5), (40, 1.0)), shot.waves.choppiness
    keyframed(obj, "sea.depth_m", {1: 30.0, 40: 5.0})  # of a sea that has a floor
    assert exported(obj)[0].sea.depth_m == np.inf
    obj.pelagic.sea.use_depth_m, obj.pelagic.waves.second_order = True, 0.0
    assert exported(obj)[0].sea.depth_m["keys"] == ((1, 30.0), (40, 5.0)), exported(obj)[0].sea.depth_m
    assert [remark for remark in remarks if "sea.gust_size_m" in remark], remarks
    assert not [remark for remark in remarks if "waves.choppiness" in remark], remarks

with checking("the sun stands where its keys have it"):
    for frame in (1, 20, 40):
        bpy.context.scene.frame_set(frame)
        up = light.own_sun(bpy.context.scene).matrix_world.col[2]
        assert abs(np.degrees(np.arcsin(up[2])) - (40.0 - 30.0 * (frame - 1) / 39)) < 0.05, frame

with checking("Blender's own gentle curve is the shot's, and one that swings is so to 2 % of its range"):
    obj = ocean_of()
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0}, "BEZIER")
    assert exported(obj)[0].sea.wind_speed_mps == {"keys": ((1, 6.0), (40, 14.0)), "interpolation": "smooth"}
    keyframed(obj, "sea.wind_speed_mps", {10: 12.0, 25: 7.0}, "BEZIER")
    assert exported(obj)[0].sea.wind_speed_mps == {"keys": ((1, 6.0), (10, 12.0), (25, 7.0), (40, 14.0)), "interpolation": "smooth"}
    curve = curve_of(obj, "sea.wind_speed_mps")
    curve.keyframe_points[1].interpolation = "ELASTIC"
    shot, _ = exported(obj)
    off = max(abs(shot.at(frame).sea.wind_speed_mps - curve.evaluate(frame)) for frame in range(1, 41))
    assert off < 0.021 * 8.0 and len(shot.sea.wind_speed_mps["keys"]) < 20, (off, shot.sea.wind_speed_mps)

with checking("a driver's sea is that of each frame, and has keys in a shot"):
    obj = ocean_of(last=4)
    driver = obj.driver_add("pelagic.sea.wind_speed_mps").driver
    driver.expression = "6 + frame"
    bpy.context.scene.frame_set(3)
    bpy.context.view_layer.update()
    assert play.simulation_of(obj).scene.sea.wind_speed_mps == 9.0
    assert exported(obj)[0].sea.wind_speed_mps["keys"] == ((1, 7.0), (4, 10.0))

with checking("a shot of some of the frames has the keys of the sea that plays"):
    obj = ocean_of(10, 30)
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0})
    assert exported(obj)[0].sea.wind_speed_mps["keys"] == ((1, 6.0), (40, 14.0))

with checking("easing, a curve that goes on, and one that leaves the range of its number"):
    def keys_now():
        scene = bpy.context.scene
        scene.frame_set(20)
        return keyed.keys_of_sea(obj, ocean.settings_of(obj), scene)["sea.wind_speed_mps"]["keys"]

    obj = ocean_of()
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0}, "EXPO")
    curve = curve_of(obj, "sea.wind_speed_mps")
    before = keys_now()
    for point in curve.keyframe_points:
        point.easing = "EASE_OUT"
    assert keys_now() != before
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0})
    curve.extrapolation = "LINEAR"
    assert keys_now()[-1] == (40, 14.0)
    bpy.context.scene.frame_end = 79
    assert keys_now()[-1] == (79, 22.0), keys_now()
    keyframed(obj, "sea.wind_speed_mps", {1: 79.0, 40: 60.0}, "BACK")
    for point in curve.keyframe_points:
        point.easing = "EASE_IN"
    assert max(value for _, value in keys_now()) == 80.0, keys_now()

with checking("what a driver or the NLA decides has no keys, though the curve has the same value"):
    obj = ocean_of()
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0})
    bpy.context.scene.frame_set(1)
    assert keyed.keys_of_sea(obj, ocean.settings_of(obj), bpy.context.scene)
    obj.driver_add("pelagic.sea.wind_speed_mps").driver.expression = "6.0"
    assert not keyed.keys_of_sea(obj, ocean.settings_of(obj), bpy.context.scene)
    obj.driver_remove("pelagic.sea.wind_speed_mps")
    bpy.context.scene.frame_set(1)
    obj.animation_data.nla_tracks.new().strips.new("Wind", 1, obj.animation_data.action)
    assert not keyed.keys_of_sea(obj, ocean.settings_of(obj), bpy.context.scene)

with checking("an angle comes in without turning back"):
    fresh_file()
    shot = FOLDER / "turns.toml"
    shot.write_text("[shot]\nframes = [1, 11]\n[light]\nsun_azimuth_deg = { keys = [[1, 350.0], [11, 10.0]] }\n", encoding="utf-8")
    assert bpy.ops.pelagic.import_shot(filepath=str(shot)) == {"FINISHED"}
    curve = curve_of(bpy.context.object, "light.sun_azimuth_deg")
    assert abs(curve.evaluate(10.5) - 369.0) < 0.01, curve.evaluate(10.5)
    assert exported(bpy.context.object)[0].light.sun_azimuth_deg["keys"] == ((1, 350.0), (11, 10.0))

with checking("what a changing sea can't be is said, and the old one stays"):
    obj = ocean_of()
    keyframed(obj, "sea.wind_speed_mps", {1: 6.0, 40: 14.0})
    change(obj, shot__loop_s=4.0)
    bpy.context.scene.frame_set(5)
    assert "keys" in play.simulation_of(obj).problem, play.simulation_of(obj).problem

with checking("a swell and a band's gain with keyframes: the core's sea, out of a shot, and into one"):
    obj = ocean_of(last=20)
    obj.pelagic.sea.wind_speed_mps = 6.0
    for height, period, direction in ((1.0, 8.0, 100.0), (2.0, 12.0, 30.0)):
        bpy.ops.pelagic.list_add(path="sea.swell")
        row = obj.pelagic.sea.swell[-1]
        row.height_m, row.period_s, row.direction_deg = height, period, direction
    bpy.ops.pelagic.list_add(path="waves.band_gains")
    gain = obj.pelagic.waves.band_gains[0]
    gain.from_m, gain.to_m = 2.0, 9.0
    wanted = {"sea.swell[1].height_m": {1: 0.5, 20: 4.0}, "sea.swell[1].direction_deg": {1: 30.0, 20: 60.0},
              "waves.band_gains[0].gain": {1: 1.0, 20: 0.25}}
    for path, keys in wanted.items():
        rows, name = path.rsplit(".", 1)
        for frame, value in keys.items():
            setattr(obj.pelagic.path_resolve(rows), name, value)
            obj.keyframe_insert(f"pelagic.{path}", frame=frame)
        for point in curve_of(obj, path).keyframe_points:
            point.interpolation = "LINEAR"
    seas = set()
    for frame in (20, 10, 1):
        bpy.context.scene.frame_set(frame)
        seas.add(id(play.simulation_of(obj).sea))
    assert len(seas) == 1, seas
    shot, remarks = exported(obj)
    assert not [remark for remark in remarks if "animated" in remark], remarks
    found = {number.path: dict(keys["keys"]) for number, keys in keyed.numbers_with_keys(shot)}
    assert found == wanted, found
    assert shot.sea.swell[0].height_m == 1.0 and shot.at(10).sea.swell[1].height_m > 1.5
    assert abs(play.simulation_of(obj).significant_height_m - shot.at(1).significant_height_m()) < 1e-5
    shot.save(str(FOLDER / "swell.toml"))
    assert ocean.changing(shot) and not ocean.changing(shot, keyed.BY_PATH)
    fresh_file()
    bpy.context.scene.frame_end = 20
    assert bpy.ops.pelagic.import_shot(filepath=str(FOLDER / "swell.toml")) == {"FINISHED"}
    again, _ = exported(bpy.context.object)
    assert {number.path: dict(keys["keys"]) for number, keys in keyed.numbers_with_keys(again)} == wanted

with checking("an entry that is removed takes its keyframes along, and the later ones keep theirs"):
    obj = ocean_of(last=20)
    for _ in range(3):
        bpy.ops.pelagic.list_add(path="sea.swell")
    for row, ends in ((0, (1.0, 2.0)), (2, (0.5, 3.0))):
        for frame, height in zip((1, 20), ends):
            obj.pelagic.sea.swell[row].height_m = height
            obj.keyframe_insert(f"pelagic.sea.swell[{row}].height_m", frame=frame)
    bpy.ops.pelagic.list_remove(path="sea.swell", index=0)
    assert [curve.data_path for curve in compat.curves(obj)] == ["pelagic.sea.swell[1].height_m"]
    assert abs(curve_of(obj, "sea.swell[1].height_m").evaluate(20) - 3.0) < 1e-6
    bpy.ops.pelagic.list_remove(path="sea.swell", index=1)
    assert not len(compat.curves(obj))

for file in ("rising.toml", "sunset.toml"):
    with checking(f"{file} comes in with its keys, and goes out with them"):
        fresh_file()
        assert bpy.ops.pelagic.import_shot(filepath=str(ROOT / "examples" / file)) == {"FINISHED"}
        obj, before = bpy.context.object, pelagic.Scene.from_file(str(ROOT / "examples" / file))
        bpy_scene = bpy.context.scene
        bpy_scene.frame_end = min(bpy_scene.frame_end, bpy_scene.frame_start + 30)  # a frame of it takes long
        after, _ = exported(obj)
        numbers_with_keys = [number for number, _ in keyed.numbers_with_keys(before)]
        assert numbers_with_keys, file
        for number in numbers_with_keys:
            for frame in range(bpy_scene.frame_start, bpy_scene.frame_end + 1, 5):
                was, now = (number.of(getattr(getattr(shot.at(frame), number.setting.table), number.setting.name))
                            for shot in (before, after))
                assert abs(was - now) < 1e-2 * max(abs(was), 1.0), (number.path, frame, was, now)
