"""The module `pelagic`: arrays of any stride, refusals, threads. What the numbers mean is tested in tests/core."""

import math
import pathlib
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import pelagic

SIZE_M, RESOLUTION = 40.0, 16
ALL = ("position", "displacement", "normal", "velocity", "slope_variance", "slope_variance_at_rest", "jacobian", "coverage")


def small_scene():
    scene = pelagic.Scene()
    scene.surface.size_m, scene.surface.resolution = SIZE_M, RESOLUTION
    scene.sea.wind_speed_mps = 12.0
    return scene


class Scene(unittest.TestCase):
    def test_keys_read_back_what_was_written(self):
        scene = pelagic.Scene()
        scene.sea.wind_speed_mps, scene.sea.spectrum = 7.5, "elfouhaily"
        scene.sea.swell = [pelagic.Swell(height_m=1.5, period_s=11.0, direction_deg=80.0)]
        scene.shot.frames, scene.shot.name = (3, 9), "bay"
        scene.camera.position_m = (1.0, 2.0, 3.0)
        self.assertEqual(scene.output.mesh, "usdc")
        scene.output.attributes, scene.output.mesh = ["normal"], "usda"
        self.assertEqual((scene.sea.wind_speed_mps, scene.sea.spectrum), (7.5, "elfouhaily"))
        self.assertEqual([s.period_s for s in scene.sea.swell], [11.0])
        self.assertEqual((scene.shot.frames, scene.shot.name), ((3, 9), "bay"))
        self.assertEqual(scene.camera.position_m, (1.0, 2.0, 3.0))
        self.assertEqual((scene.output.attributes, scene.output.mesh), (("normal",), "usda"))
        self.assertEqual(scene.validate(), [])

    def test_numbers_that_change_over_the_shot(self):
        scene = pelagic.Scene()
        scene.light.sun_elevation_deg = {"keys": [(1, 30.0), (5, 10.0)], "interpolation": "smooth"}
        scene.camera.ev100 = {"keys": [(2, 12.0)]}
        self.assertEqual(scene.light.sun_elevation_deg, {"keys": ((1, 30.0), (5, 10.0)), "interpolation": "smooth"})
        self.assertEqual(scene.camera.ev100["interpolation"], "linear")
        self.assertEqual(pelagic.Scene.from_text(scene.shot_text()).light.sun_elevation_deg, scene.light.sun_elevation_deg)
        self.assertEqual((scene.at(3).light.sun_elevation_deg, scene.at(-9).camera.ev100), (20.0, 12.0))
        for make in (pelagic.Sky, pelagic.GpuLight):
            with self.assertRaisesRegex(ValueError, "has keys, and this shows one moment"):
                make(scene)
        pelagic.Sky(scene.at(3))
        with self.assertRaisesRegex(ValueError, "sea.gust_size_m"):
            scene.sea.gust_size_m = {"keys": [(1, 200.0), (9, 300.0)]}
        with self.assertRaisesRegex(ValueError, "smooth"):
            scene.light.turbidity = {"keys": [(1, 2.0)], "interpolation": "smoth"}
        for bad in ({"key": [(1, 2.0)]}, {"keys": [(1, 2.0, 3.0)]}, {"keys": [("a", 2.0)]}):
            with self.assertRaises(TypeError):
                scene.light.turbidity = bad
        scene.light.turbidity = {"keys": [(5, 2.0), (1, 3.0)]}
        self.assertIn("light.turbidity.keys[1] = [1, 3]: does not come after", scene.validate()[0])
        scene.light.turbidity = 2.0
        self.assertEqual(scene.validate(), [])
        self.assertEqual([key["path"] for key in pelagic.keys() if key["may_have_keys"]].count("light.turbidity"), 1)

    def test_a_sea_that_changes_is_that_of_each_frames_time(self):
        scene = pelagic.Scene()
        scene.sea.wind_speed_mps = {"keys": [(1, 8.0), (9, 22.0)]}
        self.assertEqual(scene.validate(), [])
        with self.assertRaisesRegex(ValueError, "sea.wind_speed_mps has keys, and this shows one moment"):
            scene.significant_height_m()
        sea = pelagic.Sea(scene, ("position", "velocity"), cell_m=2.0)
        frame, rest = pelagic.Frame(sea), np.stack(np.meshgrid(*[np.arange(0.0, 2000.0, 20.0, dtype=np.float32)] * 2), -1).reshape(-1, 2)
        at = {}
        for number in (1, 5, 9):
            time_s = scene.shot.time_s(number)
            height_m = sea.significant_height_at(time_s)
            if number != 5:
                self.assertAlmostEqual(height_m, scene.at(number).significant_height_m(), 6)
            frame.set(time_s)
            at[number] = frame.evaluate(rest)["position"]
            self.assertAlmostEqual(4.0 * float(at[number][:, 2].std()) / height_m, 1.0, delta=0.2)
        self.assertEqual(sea.significant_height_m, sea.significant_height_at(scene.shot.time_s(1)))
        again = pelagic.Frame(sea)  # a frame alone is that of a run
        again.set(scene.shot.time_s(5))
        self.assertTrue(np.array_equal(again.evaluate(rest)["position"], at[5]))
        self.assertIn("faster than waves", " ".join(scene.warnings()))

    def test_trains_have_a_range_of_their_own_or_none(self):
        scene = pelagic.Scene()
        self.assertEqual((scene.waves.trains, scene.waves.shortest_m, scene.waves.longest_m), (250, None, None))
        scene.waves.model = "trochoid"
        scene.waves.trains = 12
        scene.waves.longest_m = 30
        self.assertEqual((scene.waves.trains, scene.waves.longest_m), (12, 30.0))
        self.assertEqual(scene.validate(), [])
        scene.waves.shortest_m = 31.0
        self.assertIn("waves.shortest_m = 31: ", scene.validate()[0])
        scene.waves.shortest_m = None
        self.assertEqual(scene.validate(), [])

    def test_a_coasts_depths_are_read_when_they_are_asked_for(self):
        data = pathlib.Path(__file__).parents[4] / "examples" / "data"
        scene = pelagic.Scene()
        scene.waves.model, scene.waves.trains, scene.sea.depth_m = "trochoid", 20, 10.0
        scene.sea.depth_file, scene.sea.depth_size_m = str(data / "beach.exr"), 400.0
        self.assertNotIn("waves.coast", str(scene))
        scene.waves.coast = True
        self.assertEqual(scene.validate(), [])
        self.assertIn("200 x 200 depths", str(scene))
        before = str(scene)
        scene.sea.depth_north_m = 50.0
        self.assertNotEqual(str(scene), before)
        scene.sea.depth_north_m = 0.0
        self.assertEqual(str(scene), before)
        with self.assertRaisesRegex(pelagic.ShotError, "sea.depth_file = "):
            scene.sea.depth_file = str(data / "gone.exr")
        self.assertEqual(str(scene), before)  # as it was
        frame = pelagic.Frame(pelagic.Sea(scene))
        frame.set(1.0)
        ashore, afloat = frame.evaluate(np.float32([(0.0, 195.0), (0.0, -100.0)]))["position"]
        self.assertEqual(ashore[2], 0.0)
        self.assertNotEqual(afloat[2], 0.0)

    def test_a_masks_picture_is_read_when_it_is_named(self):
        data = pathlib.Path(__file__).parents[4] / "examples" / "data"
        scene = pelagic.Scene()
        masks = [pelagic.WaveMask(0.0, 5.0, length_m=40.0, width_m=40.0, edge_m=5.0, waves=0.0, picture=str(data / "tiles.exr"))]
        scene.waves.masks = masks
        self.assertEqual((scene.waves.masks, scene.validate()), (tuple(masks), []))
        self.assertIn("texels", str(scene))
        self.assertNotIn("tiles.exr", str(scene))
        with self.assertRaisesRegex(pelagic.ShotError, r"waves.masks\[0\].picture = .*atoll.exr\": has .*; accepted: "):
            scene.waves.masks = [masks[0]._replace(picture=str(data / "atoll.exr"))]
        self.assertEqual(scene.waves.masks, tuple(masks))  # as it was
        again = pelagic.Scene.from_text(scene.shot_text(), "elsewhere")
        self.assertEqual(str(again), str(scene))
        rest = np.float32([(0.0, 5.0), (9.0, 8.0), (200.0, 0.0)])
        plain = pelagic.Scene()
        heights = [pelagic.Frame(pelagic.Sea(each)) for each in (plain, scene)]
        for frame in heights:
            frame.set(1.0)
        was, now = (frame.evaluate(rest)["position"][:, 2] for frame in heights)
        self.assertTrue((np.abs(now[:2]) < np.abs(was[:2])).all())
        self.assertEqual(now[2], was[2])

    def test_every_key_of_the_table_is_an_attribute(self):
        scene = pelagic.Scene()
        written = 0
        for key in pelagic.keys():
            table, _, name = key["path"].rpartition(".")
            if not table:
                continue  # a list of the scene's own, whose files are read: below
            holder = getattr(scene, table)
            if key["type"] in ("data file", "data time"):
                self.assertIsNone(getattr(holder, name))
                continue
            default = getattr(holder, name)
            self.assertEqual(default, key["default"], key["path"])
            self.assertIn(key["help"], getattr(type(holder), name).__doc__)
            other = {"truth": lambda: not default, "integer": lambda: default + 2, "number": lambda: 7.25,
                     "text": lambda: "other", "word": lambda: key["choices"][-1],
                     "words": lambda: tuple(key["choices"][:1]),
                     "point": lambda: (1.0, 2.0, 3.5), "pair": lambda: (3, 5), "entries": lambda: ()}[key["type"]]()
            if key["type"] == "entries":
                entry = getattr(pelagic, key["entry"])
                other = (entry(*({"point": (1.0, 2.0, 3.0), "integer": 64, "word": (k["choices"] or [""])[-1],
                                 "text": None if k["name"] == "picture" else "other"}.get(k["type"], 3.5) for k in key["keys"])),)
                setattr(holder, name, [dict(zip(entry._fields, other[0]))])  # a dictionary does as well
                self.assertEqual(getattr(holder, name), other, key["path"])
            setattr(holder, name, other)
            self.assertEqual(getattr(getattr(scene, table), name), other, key["path"])
            with self.assertRaises((TypeError, ValueError), msg=key["path"]):
                setattr(holder, name, {1: 2})
            written += 1
        self.assertGreater(written, 40)

    def test_bodies_are_read_when_they_are_set(self):
        boat = str(Path(__file__).parents[4] / "tests/plugin/format/shot/data/folder/boat.obj")
        scene = pelagic.Scene()
        self.assertEqual(scene.objects, ())
        scene.objects = [{"file": boat, "floats": True}, pelagic.SceneObject(boat, name="other", colour=(1.0, 0.5, 0.0))]
        self.assertEqual(scene.validate(), [])
        self.assertEqual([(each.file, each.name, each.floats) for each in scene.objects], [(boat, "", True), (boat, "other", False)])
        again = pelagic.Scene.from_text(scene.shot_text())
        self.assertEqual((str(again), again.objects), (str(scene), scene.objects))
        scene.objects = scene.objects[:1]
        self.assertEqual(len(scene.objects), 1)
        with self.assertRaisesRegex(ValueError, r'objects\[0\].file = "none.obj": the mesh does not exist; accepted: '):
            scene.objects = [{"file": "none.obj"}]
        for wrong in ({1: 2}, "boat.obj", [{"name": "no file"}], [{"file": boat, "height": 3}]):
            with self.assertRaises((TypeError, ValueError), msg=wrong):
                scene.objects = wrong
        self.assertEqual(len(scene.objects), 1)
        scene.objects = ()
        self.assertEqual(str(scene), str(pelagic.Scene()))

    def test_where_bodies_are_and_what_they_are_of(self):
        boat = str(Path(__file__).parents[4] / "tests/plugin/format/shot/data/folder/boat.obj")
        scene = pelagic.Scene()
        with self.assertRaisesRegex(IndexError, r"^objects\[0\]: the scene has no objects$"):
            scene.object_pose(0, 1.0)
        scene.objects = [pelagic.SceneObject(boat, name="still", east_m=3.0, north_m=-2.0, up_m=0.5, heading_deg=90.0, scale=2.0),
                         pelagic.SceneObject("", name="none", path="1 0 0, 11 30 40", interpolation="linear")]
        pose = scene.object_pose(0, 7.5)
        np.testing.assert_allclose(pose @ (1.0, 0.0, 0.0, 1.0), (3.0, 0.0, 0.5, 1.0), atol=1e-12)
        goes = scene.object_pose(1, 6.0)  # without a mesh, half way, its bow ahead
        np.testing.assert_allclose(goes[:3, 3], (15.0, 20.0, 0.0), atol=1e-9)
        np.testing.assert_allclose(goes[:3, 0], (0.6, 0.8, 0.0), atol=1e-9)
        mesh = scene.object_mesh(0)
        self.assertEqual((mesh["points_m"].shape[1], mesh["triangles"].shape[1], mesh["normals"].shape), (3, 3, (mesh["triangles"].size, 3)))
        self.assertEqual(len(mesh["material"]), len(mesh["triangles"]))
        self.assertLess(mesh["triangles"].max(), len(mesh["points_m"]))
        self.assertTrue(all(set(each) == {"name", "colour", "roughness", "glow", "image"} for each in mesh["materials"]))
        self.assertEqual(scene.object_mesh(1), {})
        for call in (lambda: scene.object_pose(2, 1.0), lambda: scene.object_mesh(-1)):
            self.assertRaises(IndexError, call)
        scene.objects = [pelagic.SceneObject("", vessel=1)]
        self.assertRaisesRegex(ValueError, "vessel = 1", scene.object_pose, 0, 1.0)
        self.assertRaises(ValueError, scene.object_pose, 0, float("nan"))

    def test_where_floating_bodies_are_in_the_waves(self):
        trawler = str(Path(__file__).parents[4] / "examples/data/trawler.obj")
        scene = pelagic.Scene()
        scene.waves.cascades = [{"size_m": 300.0, "resolution": 128}]
        scene.objects = [pelagic.SceneObject(trawler, floats=True, path="1 0 0, 49 9 6"), pelagic.SceneObject(trawler, name="stands", east_m=5.0)]
        frames = [1.0, 24.5, 48.0]
        np.testing.assert_array_equal(scene.object_poses(1, frames), [scene.object_pose(1, frame) for frame in frames])
        poses = {}
        for how in ("plane", "response"):
            scene.objects = [scene.objects[0]._replace(buoyancy=how), scene.objects[1]]
            told = []
            poses[how] = scene.object_poses(0, frames, progress=told.append)
            self.assertEqual(told[-1], 1.0)
            np.testing.assert_array_equal(scene.object_poses(0, frames[1:2])[0], poses[how][1])  # a frame alone
            calm = np.array([scene.object_pose(0, frame) for frame in frames])
            np.testing.assert_array_equal(poses[how][:, :2, 3], calm[:, :2, 3])
            self.assertGreater(np.ptp(poses[how][:, 2, 3]), 0.05)
            np.testing.assert_allclose(np.linalg.det(poses[how][:, :3, :3]), 1.0, atol=1e-9)
        self.assertGreater(np.abs(poses["plane"] - poses["response"]).max(), 0.01)
        # On the water, in waves about as long as it.
        frame = pelagic.Frame(pelagic.Sea(scene, ["position"], cell_m=26.0 / 3.0))
        frame.set(23.5 / scene.shot.fps)
        around = poses["plane"][1][:2, 3] + 6.0 * np.array([(x, y) for x in (-1, 0, 1) for y in (-0.5, 0, 0.5)])
        heights = frame.evaluate(around.astype(np.float32))["position"][:, 2]
        self.assertLess(abs(heights.mean() - poses["plane"][1][2, 3]), 0.1)
        self.assertEqual(scene.object_poses(0, []).shape, (0, 4, 4))
        self.assertRaises(IndexError, scene.object_poses, 2, [1.0])
        self.assertRaises(ValueError, scene.object_poses, 0, [float("inf")])
        self.assertRaises(pelagic.Cancelled, scene.object_poses, 0, frames, cancel=lambda: True)

    def test_keys_are_described(self):
        keys = {key["path"]: key for key in pelagic.keys()}
        wind = keys["sea.wind_speed_mps"]
        self.assertEqual((wind["unit"], wind["default"], wind["range"]), ("m/s", 10.0, (0.0, 80.0)))
        self.assertEqual((wind["feeds"], wind["label"]), (["waves"], "Wind speed"))
        self.assertLess(wind["soft_range"][1], wind["range"][1])
        self.assertEqual((keys["quality.max_error"]["default"], keys["quality.max_error"]["range"]), (None, (1e-6, 1.0)))
        self.assertEqual(keys["surface.kind"]["choices"], ["patch", "projected-grid", "near-far", "cage", "planet"])
        self.assertEqual([k["name"] for k in keys["sea.swell"]["keys"]], ["height_m", "period_s", "direction_deg"])

    def test_a_table_lives_as_long_as_somebody_holds_it_and_can_be_given_to_another_scene(self):
        light = pelagic.Scene().light
        light.turbidity = 5.0
        self.assertEqual(light.turbidity, 5.0)
        scene = pelagic.Scene()
        scene.light = light
        light.turbidity = 2.0
        self.assertEqual(scene.light.turbidity, 5.0)
        with self.assertRaisesRegex(TypeError, "accepted: a SeaTable"):
            scene.sea = light

    def test_lists_take_entries_or_dictionaries_with_all_of_their_keys(self):
        sea = pelagic.Scene().sea
        for wrong in ([{"height_m": 1.0}], [dict(height_m=1.0, period_s=9.0, direction_deg=0.0, more=1)], [3], "auto", 3):
            with self.assertRaisesRegex(TypeError, "sea.swell.*accepted: "):
                sea.swell = wrong
        with self.assertRaisesRegex(TypeError, r"sea.swell\[0\].period_s = 'long'"):
            sea.swell = [dict(height_m=1.0, period_s="long", direction_deg=0.0)]
        self.assertEqual(sea.swell, ())

    def test_a_misspelt_key_is_refused_not_added(self):
        with self.assertRaises(AttributeError):
            pelagic.Scene().sea.wind_speed = 3.0

    def test_words_are_checked_with_the_nearest(self):
        with self.assertRaisesRegex(pelagic.ShotError, 'sea.spectrum = "jonsvap".*nearest is "jonswap"'):
            pelagic.Scene().sea.spectrum = "jonsvap"

    def test_a_cascade_may_have_a_choppiness_of_its_own(self):
        scene = small_scene()
        scene.waves.cascades = [pelagic.CascadeSize(60.0, 64), pelagic.CascadeSize(25.0, 32, choppiness=0.5)]
        self.assertEqual([cascade.choppiness for cascade in scene.waves.cascades], [None, 0.5])
        self.assertIn("{ size_m = 60, resolution = 64 }, { size_m = 25, resolution = 32, choppiness = 0.5 }", str(scene))
        scene.waves.model = "trochoid"
        with self.assertRaisesRegex(pelagic.ShotError, r"waves.cascades\[1\].choppiness"):
            pelagic.Sea(scene)

    def test_warnings_say_what_a_sea_does_that_can_be_planned(self):
        scene = small_scene()
        self.assertEqual(scene.warnings(), [])
        scene.waves.choppiness = 6.0
        self.assertEqual(len(scene.warnings()), 1)
        self.assertIn("folds over itself", scene.warnings()[0])
        scene.sea.wind_speed_mps = -3.0
        with self.assertRaises(pelagic.ShotError):
            scene.warnings()

    def test_validate_lists_every_problem_and_a_sea_refuses_them(self):
        scene = small_scene()
        scene.sea.wind_speed_mps, scene.surface.resolution = -3.0, 0
        problems = scene.validate()
        self.assertEqual([p.split(" = ")[0] for p in problems], ["sea.wind_speed_mps", "surface.resolution"])
        with self.assertRaises(pelagic.ShotError) as refused:
            pelagic.Sea(scene)
        self.assertEqual(str(refused.exception).splitlines(), problems)
        with self.assertRaises(pelagic.ShotError):
            pelagic.explain(scene)

    def test_a_missing_file_is_a_value_error_that_names_it(self):
        with self.assertRaisesRegex(ValueError, "nowhere.toml"):
            pelagic.Scene.from_file("nowhere.toml")

    def test_frame_times_are_the_shot_files(self):
        self.assertEqual(pelagic.Scene().shot.time_s(25), 1.0)
        self.assertEqual(pelagic.Scene().shot.time_s(1.5), 0.5 / 24)

    def test_presets_set_the_keys_that_they_list(self):
        presets = pelagic.presets()
        self.assertEqual([p["name"] for p in presets if p["group"] == "beaufort"],
                         [f"beaufort-{force}" for force in range(13)])
        self.assertGreater(len(presets), 13)
        for preset in presets:
            scene = pelagic.Scene()
            scene.shot.seed = 77
            scene.apply_preset(preset["name"])
            for path, value in preset["values"].items():
                table, name = path.split(".")
                self.assertEqual(getattr(getattr(scene, table), name), value, path)
            self.assertEqual((scene.validate(), scene.shot.seed), ([], 77), preset["name"])
        with self.assertRaisesRegex(ValueError, 'nearest is "beaufort-8"'):
            pelagic.Scene().apply_preset("beaufor-8")

    def test_explain_says_what_the_sea_does(self):
        self.assertIn("transforms", pelagic.explain(small_scene()))

    def test_effects_are_those_that_are_on(self):
        scene = small_scene()
        scene.effects.whitecaps, scene.effects.spray = False, True
        self.assertEqual(pelagic.effects(scene), ["horizontal displacement", "second order"])
        scene.effects.whitecaps = True
        self.assertIn("spray", pelagic.effects(scene))


class Patch(unittest.TestCase):
    def test_points_and_quads_are_in_the_files_order(self):
        rest, quads = pelagic.patch(2.0, 2)
        self.assertEqual((rest.dtype, quads.dtype), (np.float32, np.int32))
        np.testing.assert_array_equal(rest, [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)])
        np.testing.assert_array_equal(quads, [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])

    def test_impossible_patches_are_refused(self):
        for size_m, resolution in ((0.0, 4), (math.nan, 4), (10.0, 0), (10.0, 10**6)):
            with self.assertRaisesRegex(ValueError, "accepted"):
                pelagic.patch(size_m, resolution)


class Query(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sea = pelagic.Sea(small_scene(), ALL)
        cls.frame = pelagic.Frame(cls.sea)
        cls.frame.set(2.5)
        cls.rest, _ = pelagic.patch(SIZE_M, RESOLUTION)
        cls.plain = cls.frame.evaluate(cls.rest)

    def test_fresh_arrays_hold_all_products_or_those_asked_for(self):
        self.assertEqual(tuple(self.plain), ALL)
        for name, array in self.plain.items():
            self.assertEqual((array.dtype, len(array)), (np.float32, len(self.rest)))
            self.assertTrue(np.isfinite(array).all(), name)
        self.assertEqual(list(self.frame.evaluate(self.rest, outputs=("coverage",))), ["coverage"])
        # The sea moves: an answer of zeros would pass everything else here.
        self.assertGreater(self.plain["position"][:, 2].std(), 0.1)

    def test_strided_outputs_are_the_same_bits_and_nothing_between_is_touched(self):
        # Blender 3.4's vertex: three floats, then four bytes that are its own.
        vertices = np.zeros(len(self.rest), np.dtype([("co", np.float32, 3), ("flags", np.uint32)]))
        vertices["flags"] = 0xDEADBEEF
        mixed = np.full((len(self.rest), 9), 7.0, np.float32)
        backwards = np.empty((len(self.rest), 3), np.float32)
        written = self.frame.evaluate(self.rest, position=vertices["co"], velocity=mixed[:, 1:4],
                                      coverage=mixed[:, 6], normal=backwards[::-1])
        np.testing.assert_array_equal(vertices["co"], self.plain["position"])
        np.testing.assert_array_equal(vertices["flags"], 0xDEADBEEF)
        np.testing.assert_array_equal(mixed[:, 1:4], self.plain["velocity"])
        np.testing.assert_array_equal(mixed[:, 6], self.plain["coverage"])
        np.testing.assert_array_equal(mixed[:, [0, 4, 5, 7, 8]], 7.0)
        np.testing.assert_array_equal(backwards[::-1], self.plain["normal"])
        self.assertEqual(sorted(written), ["coverage", "normal", "position", "velocity"])

    def test_strided_points_give_the_same_bits(self):
        wide = np.zeros((len(self.rest), 5), np.float32)
        wide[:, 2:4] = self.rest
        got = self.frame.evaluate(wide[:, 2:4], outputs=("position",))["position"]
        np.testing.assert_array_equal(got, self.plain["position"])

    def layouts(self, width):
        """(name, memory, view of (n, width) or, of width 0, of (n,)): layouts in which components lie apart or numbers at odd places."""
        n, columns = len(self.rest), max(width, 1)
        packed = np.dtype([("tag", np.uint8), ("co", np.float32, width or ())])
        odd = np.zeros(4 * n * columns + 1, np.uint8)
        for name, memory, view in (
                ("by component", wide := np.zeros((columns + 2, n), np.float32), wide[1:-1].T),
                ("backwards", wide := np.zeros((n, columns + 2), np.float32), wide[::-1, -2:0:-1]),
                ("apart", wide := np.zeros((2 * n, 3 * columns), np.float32), wide[::2, ::3]),
                ("odd", odd, odd[1:].view(np.float32).reshape(n, columns)),
                ("packed", record := np.zeros(n, packed), record["co"].reshape(n, columns) if not width else record["co"])):
            self.assertTrue(np.shares_memory(memory, view), name)
            memory.view(np.uint8).reshape(-1)[:] = 0x7B
            yield name, memory, view if width else view[:, 0]

    def test_components_apart_and_odd_addresses_are_taken_through_a_copy(self):
        asked = {"position": 3, "slope_variance": 3, "coverage": 0}
        for layouts in zip(*(self.layouts(width) for width in (2, 0, 2, 3, 3, 0))):
            (name, _, rest), (_, _, cell_m), (_, _, cell_axis_m), *outputs = layouts
            with self.subTest(name):
                rest[...], cell_m[...], cell_axis_m[...] = self.rest, 3.0, (4.0, 1.0)
                plain = self.frame.evaluate(self.rest, cell_m=3.0, cell_axis_m=np.tile(np.float32([4.0, 1.0]), (len(rest), 1)))
                for write in (lambda **into: self.frame.evaluate(rest, cell_m=cell_m, cell_axis_m=cell_axis_m, **into),
                              lambda **into: self.frame.begin(2.5, rest, cell_m=cell_m, cell_axis_m=cell_axis_m, **into).result()):
                    into = {}
                    for wanted, (_, memory, view) in zip(asked, outputs):
                        memory.view(np.uint8).reshape(-1)[:] = 0x7B
                        into[wanted] = view
                    written = write(**into)
                    for wanted, (_, memory, view) in zip(asked, outputs):
                        self.assertIs(written[wanted], view)
                        np.testing.assert_array_equal(view, plain[wanted])
                        view[...] = np.frombuffer(b"{{{{", np.float32)[0]
                        self.assertTrue((memory.view(np.uint8) == 0x7B).all(), "something beside the numbers was written")

    def test_an_origin_stands_for_far_points(self):
        # 2^20 m on, single-precision positions are 1/8 m apart. As an origin in double, the distance may be split
        # anyhow: what differs is the rounding of the rest, 2e-6 m, times the displacement's gradient (below 1), and
        # that of the sums, some 1e-7 of metres; with a margin of ten.
        far = self.frame.evaluate(self.rest, (2.0**20, 0.0), outputs=("displacement",))["displacement"]
        split = self.frame.evaluate(self.rest + np.float32([8, 0]), (2.0**20 - 8, 0.0),
                                    outputs=("displacement",))["displacement"]
        np.testing.assert_allclose(far, split, atol=3e-5)
        self.assertGreater(np.abs(far - self.plain["displacement"]).max(), 0.1)

    def test_footprints_a_number_or_one_a_point(self):
        levels = [2.5, 5.0, 10.0]
        frame = pelagic.Frame(pelagic.Sea(small_scene(), ALL, cell_m=levels, pixel_m=levels))
        frame.set(2.5)
        one = frame.evaluate(self.rest, cell_m=7, pixel_m=np.float32(7))
        each = np.full(len(self.rest), 7, np.float32)
        for name, array in frame.evaluate(self.rest, cell_m=each, pixel_m=each).items():
            np.testing.assert_array_equal(array, one[name])
        # What a larger footprint hides is slope variance.
        finest = frame.evaluate(self.rest)
        at_rest = "slope_variance_at_rest"
        self.assertTrue((one[at_rest][:, :2] > finest[at_rest][:, :2]).all())

    def test_other_types_are_refused(self):
        points = len(self.rest)
        for wrong in (self.rest.astype(np.float64), self.rest.astype(">f4"), self.rest.tolist(), None):
            with self.assertRaisesRegex(TypeError, "rest: .*accepted: a float32 numpy array"):
                self.frame.evaluate(wrong)
        with self.assertRaisesRegex(TypeError, "position: .*float64"):
            self.frame.evaluate(self.rest, position=np.zeros((points, 3)))
        with self.assertRaisesRegex(TypeError, "cell_m"):
            self.frame.evaluate(self.rest, cell_m="wide")

    def test_shapes_and_memory_that_cannot_serve_are_refused(self):
        points = len(self.rest)
        read_only = np.zeros((points, 3), np.float32)
        read_only.flags.writeable = False
        overlapping = np.lib.stride_tricks.as_strided(np.zeros(points + 3, np.float32), (points, 3), (4, 4))
        past_each_other = np.lib.stride_tricks.as_strided(np.zeros(4 * points, np.float32), (points, 3), (4, 4 * (points - 1)))
        for said, wrong in (("its shape is", np.zeros((points, 4), np.float32)),
                            ("its shape is", np.zeros((points - 1, 3), np.float32)),
                            ("read-only", read_only), ("overlap", overlapping), ("overlap", past_each_other),
                            ("overlap", np.lib.stride_tricks.as_strided(np.zeros(3, np.float32), (points, 3), (0, 4)))):
            with self.assertRaisesRegex(ValueError, "position: .*" + said):
                self.frame.evaluate(self.rest, position=wrong)
        with self.assertRaisesRegex(ValueError, "coverage: its shape is"):
            self.frame.evaluate(self.rest, coverage=np.zeros((points, 1), np.float32))

    def test_outputs_that_share_memory_are_refused(self):
        points = len(self.rest)
        one, table = np.zeros((points, 3), np.float32), np.zeros((points, 6), np.float32)
        for position, normal in ((one, one), (table[:, :3], table[:, 2:5]), (table[:, :3], table[::-1, :3])):
            with self.assertRaisesRegex(ValueError, "normal: overlaps position"):
                self.frame.evaluate(self.rest, position=position, normal=normal)
            with self.assertRaisesRegex(ValueError, "normal: overlaps position"):
                self.frame.begin(0.0, self.rest, position=position, normal=normal)
        expected = self.frame.evaluate(self.rest, outputs=("position", "normal"))
        self.frame.evaluate(self.rest, position=table[:, :3], normal=table[:, 3:])  # columns of one table share none
        np.testing.assert_array_equal(table, np.hstack([expected["position"], expected["normal"]]))

    def test_values_that_are_no_place_or_time_are_refused(self):
        for bad in (math.nan, math.inf, 1e30):
            rest = self.rest.copy()
            rest[5, 1] = bad
            with self.assertRaisesRegex(ValueError, "rest: point 5"):
                self.frame.evaluate(rest)
        for bad in (math.nan, 1e300, -1e10):
            for ask in (self.frame.evaluate, self.frame.heights):
                with self.assertRaisesRegex(ValueError, "origin: accepted: .* m"):
                    ask(self.rest, (bad, 0.0))
        with self.assertRaisesRegex(ValueError, "pixel_m"):
            self.frame.evaluate(self.rest, pixel_m=-1.0)
        with self.assertRaisesRegex(ValueError, "at most 1e12 s"):
            pelagic.Frame(self.sea).set(math.inf)
        with self.assertRaisesRegex(ValueError, "set"):
            pelagic.Frame(self.sea).evaluate(self.rest)

    def test_products_are_those_of_the_sea(self):
        frame = pelagic.Frame(pelagic.Sea(small_scene(), ("position",)))
        frame.set(0.0)
        self.assertEqual(frame.sea.products, ("position",))
        with self.assertRaisesRegex(ValueError, "coverage: the sea was built without it"):
            frame.evaluate(self.rest, outputs=("coverage",))
        with self.assertRaisesRegex(ValueError, 'nearest is "position"'):
            frame.evaluate(self.rest, outputs=("positon",))
        with self.assertRaisesRegex(ValueError, 'nearest is "velocity"'):
            pelagic.Sea(small_scene(), ("velocty",))
        for ask in (lambda: frame.evaluate(self.rest, outputs="position"), lambda: frame.heights(self.rest, outputs="position"),
                    lambda: pelagic.Sea(small_scene(), "position")):
            with self.assertRaisesRegex(TypeError, '^"position" is one text; accepted: a list or a tuple of names$'):
                ask()
        for name in ("cell_m", "pixel_m"):
            for wrong in (-1.0, math.nan, [], [2.0, 1.0]):
                with self.assertRaisesRegex(ValueError, f"^{name}: "):
                    pelagic.Sea(small_scene(), **{name: wrong})

    def test_no_points_are_an_empty_answer(self):
        for array in self.frame.evaluate(np.empty((0, 2), np.float32)).values():
            self.assertEqual(len(array), 0)


class Threads(unittest.TestCase):
    def test_two_frames_of_one_sea_in_two_threads_give_the_same_bits(self):
        sea = pelagic.Sea(small_scene(), ALL)
        rest, _ = pelagic.patch(SIZE_M, RESOLUTION)
        times = [0.25 * i for i in range(12)]

        def run(order, answers):
            frame = pelagic.Frame(sea)
            for t in order:
                frame.set(t)
                answers[t] = frame.evaluate(rest)
            answers["transforms"] = frame.executed_transforms

        alone, first, second = {}, {}, {}
        run(times, alone)
        threads = [threading.Thread(target=run, args=(times, first)),
                   threading.Thread(target=run, args=(times[::-1], second))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for answers in (first, second):
            self.assertEqual(answers["transforms"], len(times) * sea.transforms_per_frame)
            for t in times:
                for name in ALL:
                    np.testing.assert_array_equal(answers[t][name], alone[t][name])

    def test_seas_and_frames_are_made_in_several_threads_at_once(self):
        rest, _ = pelagic.patch(SIZE_M, RESOLUTION)
        answers = {}

        def build(size_m):
            scene = small_scene()
            scene.waves.cascades = [pelagic.CascadeSize(size_m=size_m, resolution=int(size_m))]
            frame = pelagic.Frame(pelagic.Sea(scene))
            frame.set(1.0)
            answers.setdefault(size_m, []).append(frame.evaluate(rest)["position"])

        sizes = [48.0, 60.0, 72.0, 80.0, 96.0, 108.0]
        threads = [threading.Thread(target=build, args=(size_m,)) for size_m in sizes]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for size_m in sizes:
            build(size_m)
            np.testing.assert_array_equal(*answers[size_m])

    def test_other_threads_run_while_a_frame_is_computed(self):
        # A second thread looks at the clock all the time. While set() held the interpreter it could not, and its
        # longest pause would be all of set().
        scene = small_scene()
        scene.waves.cascades = [pelagic.CascadeSize(size_m=400.0, resolution=1024)]
        frame = pelagic.Frame(pelagic.Sea(scene, ALL, cell_m=0.0, pixel_m=0.0))
        pauses, done = [], threading.Event()

        def watch():
            last = time.perf_counter()
            while not done.is_set():
                now = time.perf_counter()
                pauses.append((now - last, last))
                last = now

        thread = threading.Thread(target=watch)
        thread.start()
        begin = time.perf_counter()
        frame.set(1.0)
        end = time.perf_counter()
        done.set()
        thread.join()
        longest = max(pause for pause, start in pauses if begin - pause <= start <= end)
        self.assertLess(longest, 0.5 * (end - begin))


class Numbers(unittest.TestCase):
    def test_the_sea_says_what_it_is(self):
        sea = pelagic.Sea(small_scene())
        self.assertAlmostEqual(small_scene().significant_height_m(), sea.significant_height_m, delta=1e-3)
        points = pelagic.patch(2000.0, 200)[0]
        frame = pelagic.Frame(pelagic.Sea(small_scene(), ("displacement",), cell_m=0.0, pixel_m=0.0))
        frame.set(0.0)
        height = frame.evaluate(points, outputs=("displacement",))["displacement"][:, 2]
        # One realisation on 2 km: its variance strays by some 7 % from the spectrum's, Hs by half of that; four
        # deviations.
        self.assertLess(abs(4 * height.std() / sea.significant_height_m - 1), 0.14)
        self.assertTrue(0.0 < sea.mss < 0.2)
        self.assertTrue(-1.0 < sea.whitecap_threshold < 1.0)
        active, left = sea.dense_foam
        self.assertTrue(0.1 < left < 0.4 < active <= 1.0)  # the mean of all foam is 0.4
        scene = small_scene()
        scene.effects.foam_decay_s = 0.0
        self.assertEqual(pelagic.Sea(scene).dense_foam, pelagic.Sea(scene, ()).dense_foam)
        np.testing.assert_allclose(pelagic.Sea(scene).dense_foam, 0.4)
        self.assertGreater(sea.transforms_per_frame, 0)
        self.assertGreater(sea.bytes, 0)
        self.assertGreater(sea.frame_bytes, 0)

    def test_only_what_is_asked_for_is_computed(self):
        counts = [pelagic.Sea(small_scene(), products).transforms_per_frame
                  for products in (("slope_variance_at_rest",), ("position",), ("position", "normal"), ALL)]
        self.assertEqual(counts[0], 0)
        self.assertEqual(counts, sorted(set(counts)))


if __name__ == "__main__":
    unittest.main()
