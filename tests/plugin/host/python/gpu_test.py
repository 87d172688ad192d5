"""What a host's GPU code draws the sea from. The pictures themselves: tests/addon/viewport.py, tests/plugin/host/preview."""

import math
import pathlib
import time
import unittest

import numpy as np
import pelagic


def small_scene(**waves):
    scene = pelagic.Scene()
    scene.waves.cascades = [{"size_m": 100.0, "resolution": 128}, {"size_m": 13.0, "resolution": 32}]
    for name, value in waves.items():
        setattr(scene.waves, name, value)
    return scene


def view(height_m=4.0, resolution=(320, 180)):
    return pelagic.View(position_m=(7.0, -3.0, height_m), right=(1, 0, 0), up=(0, 0, 1), forward=(0, 1, 0),
                        tan_half_width=0.5, resolution=resolution)


def a_tub():
    """Points and triangles of a box of 6 by 4 by 2 m without a lid."""
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-2, 2) for x in (-3, 3)], np.float32)
    return corners, np.array([(0, 1, 3), (0, 3, 2), (0, 1, 5), (0, 5, 4), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 3, 7), (1, 7, 5)])


class Seas(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sea = pelagic.GpuSea(small_scene(), 0.125)

    def test_textures_hold_the_frame_that_was_set(self):
        sea = pelagic.GpuSea(small_scene())
        self.assertEqual(sea.textures, {})
        sea.set(1.5)
        textures = {name: texels.copy() for name, texels in sea.textures.items()}
        self.assertEqual({name: texels.shape[2] for name, texels in textures.items()},
                         {"cell_fields": 4, "pixel_fields": 4, "pixel_fields_2": 4, "ellipse_table": 4})
        sea.set(2.5)
        self.assertFalse(np.array_equal(sea.textures["cell_fields"], textures["cell_fields"]))
        sea.set(1.5)
        for name, texels in textures.items():
            np.testing.assert_array_equal(sea.textures[name], texels)
        # The largest tile is that of the whole largest cascade, and its height has the sea's variance, nearly.
        height_m = textures["cell_fields"][:128, :128, 0]
        self.assertGreater(4 * height_m.std(), 0.3 * pelagic.Sea(small_scene()).significant_height_m)
        with self.assertRaises(ValueError):
            sea.textures["cell_fields"][0, 0, 0] = 1.0

    def test_hulls_are_textures_and_a_shader_of_their_own(self):
        corners, tub = a_tub()
        sheet = corners[:4], tub[:2]
        hulls = pelagic.GpuHulls([(corners, tub), sheet, (corners[:1], np.zeros((1, 3), int))])
        matrix = np.eye(4)
        matrix[:3, 3] = 5.0, 6.0, 0.5
        places = hulls.places([matrix] * 3).reshape(-1, 4)
        self.assertEqual(places[0, 0], 1.0)  # the others keep no water out
        # Where (5, 6, 0.5) is the middle of it: nodes, by column, row and level.
        at = places[1:4] @ (5.0, 6.0, 0.5, 1.0)
        columns, rows = places[4, :2]
        np.testing.assert_allclose(at, ((columns - 1) / 2, (rows - 1) / 2, 48.0), atol=1.0)
        nodes = hulls.map.ravel()[:int(columns * rows) * 96].reshape(96, int(rows), int(columns))
        self.assertAlmostEqual(float(nodes[48, int(rows) // 2, int(columns) // 2]), -2.0, delta=0.1)
        self.assertGreater(nodes[48, 0, 0], 0.0)
        with self.assertRaises(ValueError):
            hulls.places([matrix])
        sea, light = self.sea, pelagic.GpuLight(small_scene())
        sea.set(0.0)
        self.assertNotIn("hull_maps", sea.shaders(light)["sea"][1])
        self.assertIn("hull_maps", sea.shaders(light, objects=True)["sea"][1])

    def test_foam_along_hulls_is_of_the_water_and_of_their_own_way(self):
        hulls, at, still = pelagic.GpuHulls([a_tub()]), np.eye(4), np.zeros((4, 4))
        footprints_m = hulls.footprints_m([at], [None])
        self.assertEqual(len(footprints_m), 1)
        self.assertEqual(len(hulls.footprints_m([at], [0.0])), 3)  # what floats asks for waves as long as it is
        self.assertEqual(hulls.footprints_m([np.diag((1.0, 1.0, 0.0, 1.0))], [None]), [])
        sea = pelagic.GpuSea(small_scene(), 0.125, footprints_m)
        self.assertEqual(sea.hull_footprints_m, footprints_m)

        def foam(*more):
            """Its strength, its width, and the water's velocities less the hull's [m/s]."""
            texels = hulls.places([at], *more).reshape(-1, 4)
            return texels[5, 0], texels[5, 1], texels[1 + 6:, :3]

        self.assertEqual(foam()[0], 0.0)
        self.assertEqual(foam(sea, (0.0, 0.0), [still], [None])[0], 0.0)  # it has no time yet
        sea.set(1.0)
        self.sea.set(1.0)
        self.assertEqual(foam(self.sea, (0.0, 0.0), [still], [None])[0], 0.0)  # it wasn't built for it
        strength, width_m, standing = foam(sea, (0.0, 0.0), [still], [None])
        self.assertAlmostEqual(strength, 0.9, places=6)
        self.assertAlmostEqual(width_m, 0.12 * 4.0, places=6)
        known = np.abs(standing).max(1) > 0.0
        self.assertGreater(known.sum(), 50)
        # Under way at 3 m/s, and turning by 0.1 a second about its origin.
        way = still.copy()
        way[:2, 3] = 3.0, -1.0
        np.testing.assert_allclose(foam(sea, (0.0, 0.0), [way], [None])[2][known], standing[known] - (3.0, -1.0, 0.0), atol=1e-5)
        turn = still.copy()
        turn[:2, :2] = (0.0, -0.1), (0.1, 0.0)
        turned = (standing - foam(sea, (0.0, 0.0), [turn], [None])[2])[known]
        self.assertLess(np.abs(turned.mean(0)).max(), 0.1)
        self.assertAlmostEqual(np.hypot(turned[:, 0], turned[:, 1]).max(), 0.1 * math.hypot(3.0, 2.0), delta=0.1)
        # Elsewhere the water is another; the grid's origin is what tells.
        there = foam(sea, (40.0, 7.0), [still], [None])[2]
        self.assertGreater(np.abs(there[known] - standing[known]).max(), 0.1)
        # What floats goes along with the water under it.
        afloat = pelagic.GpuSea(small_scene(), 0.125, hulls.footprints_m([at], [0.0]))
        afloat.set(1.0)
        rising = np.abs(foam(afloat, (0.0, 0.0), [still], [0.0])[2][known, 2]).mean()
        self.assertLess(rising, 0.7 * np.abs(standing[known, 2]).mean())
        for wrong in ((sea, (0.0, 0.0), [], [None]), (sea, (0.0, 0.0), [still], [])):
            with self.assertRaises(ValueError):
                hulls.places([at], *wrong)
        with self.assertRaisesRegex(ValueError, "hull_footprints_m"):
            pelagic.GpuSea(small_scene(), 0.125, [0.0])

    def test_the_pictures_hold_the_bodies(self):
        sea, light = self.sea, pelagic.GpuLight(small_scene())
        sea.set(0.0)
        bare = sea.shaders(light)
        self.assertEqual(set(bare), {"sea", "sky"})
        shaders = sea.shaders(light, objects=True)
        for word in ("sun_blockers", "mirrored_objects", "objects_in_water_depth"):
            self.assertNotIn(word, bare["sea"][1])
            self.assertIn(word, shaders["sea"][1])
        self.assertIn("kMirrored = true", shaders["object_mirrored"][1])
        self.assertIn("kInWater = true", shaders["object_in_water"][1])
        for name in ("object_mirrored", "object_in_water"):
            self.assertNotIn("host_colour", shaders[name][1])  # light, not colours
        grid, matrix = sea.grid(view()), np.eye(4)
        matrix[:3, 3] = np.array((9.0, 60.0, 1.0)) - (*grid.origin_m, 0.0)
        box = ((-3.0, -2.0, -1.5), (3.0, 2.0, 4.0))
        told = grid.objects(view(), [matrix], [box], [0.25])
        corners = np.array([(*(matrix @ (x, y, z, 1.0))[:2], z + 1.0, 1.0) for x in (-3, 3) for y in (-2, 2) for z in (-1.5, 4.0)])
        for picture, parted, away_m in ((told["mirrored"], np.maximum, (50.0, 75.0)), (told["in_water"], np.minimum, (50.0, 100.0))):
            self.assertTrue(all(16 <= side <= 1024 and side & (side - 1) == 0 for side in picture["size"]), picture["size"])
            part = corners.copy()
            part[:, 2] = parted(part[:, 2], 0.25)
            clip = part @ picture["clip_from_grid"].T
            np.testing.assert_allclose(clip[:, 3], clip[:, 3].clip(*away_m))
            places = clip[:, :2] / clip[:, 3:]
            self.assertTrue((np.abs(places) < 1.0).all())
            np.testing.assert_allclose(np.ptp(places, axis=0), 2.0 * (1.0 - 4.0 / (np.array(picture["size"]) + 4.0)), atol=0.02)
        np.testing.assert_allclose(np.add(told["mirrored"]["eye_m"], (*grid.origin_m, 0.0)), (7.0, -3.0, 0.5 - 4.0), atol=1e-9)
        self.assertGreater(told["in_water"]["eye_m"][2], 4.0)  # higher than the eye: refracted rays are steeper
        matrix[2, 3] += 3.0
        self.assertNotIn("in_water", grid.objects(view(), [matrix], [box], [0.25]))
        matrix[2, 3] -= 3.0
        # The box as a cube.
        cube = told["boxes"].reshape(-1, 4, 4)[0].T @ (matrix @ (3.0, -2.0, 4.0, 1.0))
        np.testing.assert_allclose(cube, (1.0, -1.0, 1.0, 1.0), atol=1e-4)
        many = [matrix + np.eye(4, k=3) * 3.0 * i for i in range(20)]
        self.assertEqual(grid.objects(view(), many, [box] * 20, [0.0] * 20)["boxes"].shape, (16, 16))
        with self.assertRaises(ValueError):
            grid.objects(view(), [], [], [])
        round_it = sea.surroundings(small_scene(), light)
        self.assertEqual(round_it, sea.surroundings(small_scene(), light))
        self.assertGreater(min(round_it["object_flat_part"]), 0.0)
        foamy = small_scene()
        foamy.sea.wind_speed_mps = 25.0
        self.assertGreater(min(np.subtract(sea.surroundings(foamy, light)["object_water"], round_it["object_water"])), 0.0)

    def test_pictures_of_masks_are_a_texture(self):
        picture = str(pathlib.Path(__file__).parents[4] / "examples" / "data" / "tiles.exr")
        scene = small_scene(masks=[pelagic.WaveMask(0.0, 0.0, length_m=40.0, width_m=30.0, edge_m=8.0, waves=0.5, picture=picture),
                                   pelagic.WaveMask(9.0, 0.0, foam=0.5),
                                   pelagic.WaveMask(50.0, 0.0, length_m=24.0, width_m=20.0, edge_m=4.0, waves=0.5, picture=picture)])
        sea = pelagic.GpuSea(scene)
        sea.set(1.0)
        cells = sea.textures["mask_cells"]  # of half an edge, one picture's rows after another's
        self.assertEqual(cells.shape, (7 + 10, 12, 1))
        np.testing.assert_array_equal(cells[:7, 10:], 0.0)
        self.assertTrue((cells[:7, :10] > 0.0).all() and (cells <= 1.0).all())
        self.assertIn("kMaskPictures = true", sea.shaders(pelagic.GpuLight(scene))["sea"][0])

    def test_a_coast_is_textures(self):
        scene = pelagic.Scene.from_file(str(pathlib.Path(__file__).parents[4] / "examples" / "beach.toml"))
        scene.waves.trains = 20
        scene.effects.foam_decay_s = 0.0
        sea = pelagic.GpuSea(scene)
        sea.set(1.0)
        cells, trains = sea.textures["coast_cells"], sea.textures["coast_trains"]
        rows, columns = cells.shape[:2]
        self.assertEqual(cells.shape[2], 4)
        self.assertEqual((trains.shape[0] % rows, trains.shape[1] % columns, trains.shape[2]), (0, 0, 2))
        self.assertGreater(cells[..., 0].max(), 0.5)  # breaks
        np.testing.assert_array_equal(trains[:rows, :columns, 1][cells[..., 2] == 0.0], 0.0)  # and is gone on land
        scene.waves.model, scene.waves.trains = "fft", pelagic.Scene().waves.trains
        tiles = pelagic.GpuSea(scene)
        tiles.set(1.0)
        self.assertIn("mask_cells", tiles.textures)
        self.assertNotIn("coast_trains", tiles.textures)

    def test_a_view_under_water_is_known(self):
        sea = pelagic.GpuSea(small_scene(), 0.125)
        self.assertIsNone(sea.water_over(view(-9.0)))  # it has no time yet
        sea.set(1.5)
        self.assertIsNone(sea.water_over(view(30.0)))
        surface_m = sea.water_over(view(-9.0))
        frame = pelagic.Frame(pelagic.Sea(small_scene()))
        frame.set(1.5)
        self.assertAlmostEqual(surface_m, float(frame.heights(np.array([[7.0, -3.0]]))["height_m"][0]), delta=0.05)
        # From where the view is depends how fine a sea it sees.
        self.assertIsNone(sea.water_over(view(surface_m + 0.05)))
        self.assertAlmostEqual(sea.water_over(view(surface_m - 0.05)), surface_m, delta=0.05)

    def test_a_sea_that_changes_has_the_tables_of_its_time(self):
        scene = small_scene()
        scene.sea.wind_speed_mps = {"keys": [(1, 6.0), (49, 16.0)]}
        shot, alone = pelagic.GpuSea(scene), pelagic.GpuSea(scene)
        self.assertTrue(shot.changes and not self.sea.changes)
        tables = []
        for time_s in (0.0, 1.0):
            shot.set(time_s)
            tables.append({name: pixels.copy() for name, pixels in shot.textures.items()} | {"uniforms": shot.uniforms})
        alone.set(0.5)
        held = alone.textures
        kept = {name: pixels.copy() for name, pixels in held.items()}
        alone.set(1.0)
        for name, pixels in held.items():  # views of another time's memory
            self.assertTrue(np.array_equal(pixels, kept[name]), name)
        self.assertNotEqual(tables[0]["uniforms"], tables[1]["uniforms"])
        self.assertFalse(np.array_equal(tables[0]["ellipse_table"], tables[1]["ellipse_table"]))
        self.assertEqual(tables[1]["uniforms"], alone.uniforms)
        for name, pixels in alone.textures.items():
            self.assertTrue(np.array_equal(pixels, tables[1][name]), name)
        self.assertTrue(shot.serves(scene) and not shot.serves(scene.at(25)))
        scene.shot.fps = 12.0  # keys at other times
        self.assertFalse(shot.serves(scene))

    def test_tables_follow_the_origin(self):
        here, cycles = self.sea.at_origin((0.0, 0.0))
        self.assertIsNone(cycles)
        self.assertEqual((here.dtype, here.size % 16), (np.uint8, 0))
        self.assertFalse(np.array_equal(here, self.sea.at_origin((1.0, 0.0))[0]))
        np.testing.assert_array_equal(here, self.sea.at_origin((0.0, 0.0))[0])
        for nowhere in (np.nan, np.inf):
            with self.assertRaisesRegex(ValueError, "finite"):
                self.sea.at_origin((0.0, nowhere))

    def test_trains_have_a_table_and_phases_that_depend_on_time_and_place(self):
        sea = pelagic.GpuSea(small_scene(model="trochoid", cascades=[]))
        sea.set(1.0)
        _, count, channels = sea.textures["train_table"].shape
        self.assertEqual((count - 1, channels), (sea.uniforms["train_count"], 4))
        before = sea.at_origin((0.0, 0.0))[1]
        self.assertEqual(before.shape, (1, count - 1, 1))
        self.assertFalse(np.array_equal(before, sea.at_origin((9.0, 0.0))[1]))
        sea.set(2.0)
        self.assertFalse(np.array_equal(before, sea.at_origin((0.0, 0.0))[1]))

    def test_shaders_name_all_that_the_host_gives_them(self):
        light = pelagic.GpuLight(small_scene())
        shaders = self.sea.shaders(light)
        for vertex, fragment in shaders.values():
            self.assertNotIn("#version", vertex + fragment)
            self.assertIn("host_colour(", fragment)
        text = "".join(shaders["sea"])
        for name in (*self.sea.uniforms, *light.uniforms, *light.air(2.0)[0], "exposure", "clip_from_grid", "view_centre", "sky_map", "SeaTables",
                     "rest_in", "cell_in", "pixel_in"):
            self.assertIn(name, text)
        self.assertIn("farthest", shaders["sky"][0])

    def test_a_finer_sea_has_larger_textures(self):
        def texels(finest_m):
            sea = pelagic.GpuSea(pelagic.Scene(), finest_m)
            sea.set(0.0)
            return sum(texels.size for texels in sea.textures.values())

        self.assertGreater(texels(0.125), texels(1.0))
        self.assertGreater(pelagic.GpuSea(small_scene()).bytes, 0)
        for wrong in (-1.0, math.nan, math.inf):
            with self.assertRaises(ValueError):
                pelagic.GpuSea(small_scene(), wrong)

    def test_the_finest_footprint_follows_the_view(self):
        near, far = self.sea.finest_for(view(4.0)), self.sea.finest_for(view(400.0))
        self.assertGreaterEqual(far, 32 * near)
        self.assertEqual(math.log2(near) % 1, 0)

    def test_serves_says_when_nothing_needs_to_be_built(self):
        scene = small_scene()
        light = pelagic.GpuLight(scene)
        scene.light.sun_elevation_deg = 40.0
        self.assertTrue(self.sea.serves(scene))
        self.assertFalse(light.serves(scene))
        scene = small_scene()
        scene.sea.wind_speed_mps = 3.0
        self.assertFalse(self.sea.serves(scene))
        self.assertTrue(light.serves(scene))

    def test_the_clock_matters_only_in_a_loop(self):
        scene = small_scene()
        scene.shot.time_scale, scene.shot.time_offset_s, scene.shot.fps = 0.5, 100.0, 25.0
        self.assertTrue(self.sea.serves(scene))
        scene.shot.loop_s = 2.0
        looping = pelagic.GpuSea(scene, finest_m=1.0)
        scene.shot.time_offset_s = 0.0
        self.assertTrue(looping.serves(scene))
        scene.shot.time_scale = 1.0
        self.assertFalse(looping.serves(scene))

    def test_wakes_come_with_the_frame_and_go_by_the_clock(self):
        path = "1 -20 0, 97 20 4"
        scene = small_scene(vessels=[{"path": path}, {"path": "1 0 -60, 49 0 -40"}])
        sea = pelagic.GpuSea(scene, finest_m=0.5)
        sea.set(1.0)
        wakes = sea.textures["wake_table"].copy()
        self.assertEqual(wakes.shape[2], 4)
        self.assertEqual(wakes.shape[0] % 2, 0)
        self.assertTrue(np.isfinite(wakes).all() and wakes[2:].any())
        here, there = sea.at_origin((0.0, 0.0))[0], sea.at_origin((30.0, 0.0))[0]
        sea.set(2.0)
        self.assertFalse(np.array_equal(sea.textures["wake_table"], wakes))
        self.assertFalse(np.array_equal(sea.at_origin((0.0, 0.0))[0], here))
        self.assertFalse(np.array_equal(here, there))
        self.assertTrue(sea.serves(scene))
        scene.shot.fps = 25.0
        self.assertFalse(sea.serves(scene))
        self.assertNotIn("wake_table", self.sea.textures)

    def test_gusts_fronts_go_by_the_clock(self):
        scene = small_scene()
        scene.sea.gust_fronts = [{"frame": 25.0, "east_m": 0.0, "north_m": 0.0}]
        sea = pelagic.GpuSea(scene, finest_m=1.0)
        self.assertTrue(sea.serves(scene))
        for name, other in {"fps": 25.0, "time_scale": 0.5, "time_offset_s": 3.0}.items():
            was = getattr(scene.shot, name)
            setattr(scene.shot, name, other)
            self.assertFalse(sea.serves(scene), name)
            setattr(scene.shot, name, was)
        self.assertTrue(sea.serves(scene))

    def test_how_foam_looks_needs_no_other_sea_and_no_other_sky(self):
        scene = small_scene()
        sea, light = pelagic.GpuSea(scene, finest_m=1.0), pelagic.GpuLight(scene)
        before = sea.foam(scene, (0.0, 0.0), light)
        scene.effects.foam_structure, scene.effects.foam_streaks = 0.25, 0.75
        self.assertTrue(sea.serves(scene) and light.serves(scene))
        self.assertNotEqual(sea.foam(scene, (0.0, 0.0), light), before)

    def test_water_follows_the_scene_over_the_same_sea_and_sky(self):
        scene = small_scene()
        sea, light = pelagic.GpuSea(scene, finest_m=1.0), pelagic.GpuLight(scene)
        before = sea.water(scene)
        self.assertEqual(sea.water(scene), before)
        scene.water.type, scene.water.bubbles = "jerlov-3C", 2.0
        self.assertTrue(sea.serves(scene) and light.serves(scene))
        after = sea.water(scene)
        self.assertEqual(after.keys(), before.keys())
        self.assertNotEqual(after["water_absorption_shorter"], before["water_absorption_shorter"])
        self.assertEqual(after["water_bubbles"][0], 2.0)
        fragment = sea.shaders(light)["sea"][1]
        self.assertTrue(all(name in fragment for name in after), after.keys())
        scene.water.bubbles = 0.0  # a sea has sums of them, or has none
        self.assertFalse(sea.serves(scene))


class LivingFoam(unittest.TestCase):
    @staticmethod
    def wait(sea):
        while sea.is_foam_busy:
            time.sleep(0.002)

    def test_comes_when_it_is_asked_for_and_ready(self):
        scene = small_scene()
        scene.sea.wind_speed_mps, scene.effects.foam_decay_s = 16.0, 1.0
        sea, light = pelagic.GpuSea(scene, finest_m=0.5), pelagic.GpuLight(scene)
        self.assertTrue(sea.has_living_foam)
        self.assertIn("foam_nodes", sea.shaders(light)["sea"][1])
        nothing = sea.take_foam()
        self.assertEqual(set(nothing), {"foam_nodes", "foam_pages"})
        self.assertFalse(nothing["foam_nodes"].any())
        self.assertEqual(sea.take_foam(), {})
        grid = sea.grid(view())
        sea.ask_foam(3.0, [grid])
        self.wait(sea)
        foam = sea.take_foam()
        nodes, pages, levels = foam["foam_nodes"], foam["foam_pages"], sea.foam_levels(grid.origin_m)
        self.assertEqual((nodes.dtype, nodes.shape[0] % 17, nodes.shape[1] % 17, nodes.shape[2]), (np.float32, 0, 0, 4))  # with bubbles
        self.assertEqual((pages.dtype, pages.shape[2], levels.shape[1:]), (np.float32, 1, (2, 4)))
        self.assertTrue((nodes >= 0.0).all() and nodes.max() > 0.05)
        numbers = np.sort(pages[pages >= 0.0])
        np.testing.assert_array_equal(numbers, np.arange(len(numbers)))  # each tile is in one place
        # The same alone and after other times.
        again = pelagic.GpuSea(scene, finest_m=0.5)
        for t in (2.0, 3.0):
            again.ask_foam(t, [grid])
            self.wait(again)
        np.testing.assert_array_equal(again.take_foam()["foam_nodes"], nodes)
        with self.assertRaises(ValueError):
            sea.ask_foam(math.nan, [grid])

    def test_is_left_behind_when_nobody_wants_it(self):
        scene = small_scene()
        scene.sea.wind_speed_mps, scene.effects.foam_decay_s = 16.0, 8.0
        sea = pelagic.GpuSea(scene, finest_m=0.5)
        grid = sea.grid(view())
        began = time.perf_counter()
        sea.ask_foam(3.0, [grid])
        self.wait(sea)
        whole = time.perf_counter() - began
        sea.ask_foam(500.0, [grid])
        began = time.perf_counter()
        del sea
        self.assertLess(time.perf_counter() - began, 0.5 * whole)

    def test_is_none_where_foam_does_not_live(self):
        scene = small_scene()
        scene.effects.foam_decay_s = 0.0
        sea, light = pelagic.GpuSea(scene, finest_m=0.5), pelagic.GpuLight(scene)
        self.assertFalse(sea.has_living_foam)
        self.assertNotIn("foam_nodes", sea.shaders(light)["sea"][1])
        self.assertEqual(sea.take_foam(), {})


class Grids(unittest.TestCase):
    def test_air_is_that_before_an_eye(self):
        light = pelagic.GpuLight(pelagic.Scene())
        uniforms, table = light.air(100.0)
        self.assertEqual((uniforms["eye_height_m"], table.dtype, table.shape[2]), (100.0, np.float32, 4))
        self.assertTrue(np.isfinite(table).all() and (table[0] != 0.0).any())
        none = light.air(None)[1]
        self.assertTrue((none[:48] == 0.0).all() and (none[48:] != 0.0).any())
        with self.assertRaises(ValueError):
            light.air(float("nan"))

    def test_is_the_seas_projected_grid(self):
        scene = small_scene()
        own = pelagic.Sea(scene, views=[view()]).projected_grid(view())
        sea = pelagic.GpuSea(scene)
        grid = sea.grid(view(), on_earth=False)
        self.assertEqual(grid.curvature_per_m, 0.0)
        self.assertAlmostEqual(sea.grid(view()).curvature_per_m * 6371e3, 1.0)
        self.assertEqual((grid.size, grid.origin_m), ((own.columns, own.rows), (7.0, -3.0)))
        np.testing.assert_array_equal(grid.vertices[:, :2], own.rest_m)
        self.assertEqual((grid.triangles.dtype, len(grid.triangles)), (np.uint32, 2 * own.columns * own.rows))
        self.assertLess(grid.triangles.max(), len(grid.vertices))

    def test_larger_cells_are_fewer_and_there_are_never_too_many(self):
        sea = pelagic.GpuSea(small_scene())
        self.assertLess(len(sea.grid(view(), 24.0).vertices), len(sea.grid(view(), 8.0).vertices))
        grid = sea.grid(view(resolution=(8000, 4500)), 1.0)
        self.assertEqual(grid.size, (1024, 1024))
        self.assertTrue(np.isfinite(grid.vertices).all())
        for wrong in (0.0, -1.0, math.nan):
            with self.assertRaises(ValueError):
                sea.grid(view(), wrong)


class Lights(unittest.TestCase):
    def test_all_levels_of_the_sky_are_in_one_picture(self):
        light = pelagic.GpuLight(pelagic.Scene())
        atlas = light.sky_map
        size = atlas.shape[0]
        self.assertEqual(atlas.shape, (size, size * 3 // 2, 4))
        # The finest has no ground: the others are means of the next finer one from level 2 on.
        whole, size = size, size // 2
        fine = atlas[whole - 2 * size:whole - size, whole:whole + size, :3]
        while size > 1:
            size //= 2
            fine = fine.reshape(size, 2, size, 2, 3).mean(axis=(1, 3))
            np.testing.assert_allclose(atlas[whole - 2 * size:whole - size, whole:whole + size, :3], fine, rtol=1e-4)

    def test_exposure_is_in_stops(self):
        scene = pelagic.Scene()
        light = pelagic.GpuLight(scene)
        self.assertAlmostEqual(light.exposure(scene, 2.0) / light.exposure(scene), 4.0, places=5)
        self.assertEqual(light.exposure(scene), pelagic.Sky(scene).exposure(scene))


if __name__ == "__main__":
    unittest.main()
