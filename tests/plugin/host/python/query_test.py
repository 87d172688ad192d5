"""Heights at places of the world."""

import math
import threading
import time
import unittest

import numpy as np
import pelagic


def storm(choppiness=1.0):
    scene = pelagic.Scene()
    scene.sea.wind_speed_mps = 16.0
    scene.waves.choppiness = choppiness
    return scene


class Heights(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sea = pelagic.Sea(storm(), cell_m=[0.5, 1.0, 2.0, 4.0, 8.0], pixel_m=[0.5, 1.0, 2.0, 4.0, 8.0])
        cls.frame = pelagic.Frame(cls.sea)
        cls.frame.set(3.0)
        cls.xy = np.random.default_rng(1).uniform(-200.0, 200.0, (400, 2))

    def test_the_surface_is_above_the_places(self):
        found = self.frame.heights(self.xy)
        self.assertEqual(sorted(found), ["height_m", "normal", "residual_m", "rest_m", "velocity"])
        self.assertLess(found["residual_m"].max(), 1e-3)
        there = self.frame.evaluate(found["rest_m"])
        np.testing.assert_allclose(there["position"][:, :2], self.xy, atol=1.1e-3)
        np.testing.assert_allclose(there["position"][:, 2], found["height_m"], atol=1e-6)
        np.testing.assert_array_equal(there["normal"], found["normal"])
        np.testing.assert_array_equal(there["velocity"], found["velocity"])
        # The horizontal displacement matters: heights at rest are others.
        at_rest = self.frame.evaluate(np.float32(self.xy))["position"]
        self.assertGreater(np.abs(at_rest[:, 2] - found["height_m"]).max(), 0.2)

    def test_a_place_is_the_same_alone_and_in_any_form(self):
        found = self.frame.heights(self.xy)
        alone = self.frame.heights([tuple(self.xy[7])])
        for name, array in found.items():
            np.testing.assert_array_equal(alone[name][0], array[7])
        strided = np.zeros((400, 9))
        strided[:, 3:5] = self.xy
        np.testing.assert_array_equal(self.frame.heights(strided[:, 3:5])["height_m"], found["height_m"])
        self.assertEqual(len(self.frame.heights(np.empty((0, 2)))["height_m"]), 0)

    def test_a_footprint_leaves_short_waves_out(self):
        fine, coarse = (self.frame.heights(self.xy, footprint_m=size)["normal"][:, :2].std() for size in (0.5, 8.0))
        self.assertLess(coarse, 0.7 * fine)
        each = self.frame.heights(self.xy, footprint_m=np.full(400, 3.0, np.float32))
        np.testing.assert_array_equal(each["height_m"], self.frame.heights(self.xy, footprint_m=3.0)["height_m"])

    def test_an_origin_stands_for_far_places(self):
        far = self.frame.heights(self.xy, (3e6, -2e6))
        self.assertLess(far["residual_m"].max(), 1e-3)
        there = self.frame.evaluate(far["rest_m"], (3e6, -2e6), outputs=("position",))["position"]
        np.testing.assert_allclose(there[:, :2], self.xy, atol=1.1e-3)

    def test_far_places_are_as_exact_as_with_an_origin(self):
        origin = np.array((1e7, -3e7))
        near, far = self.frame.heights(self.xy, origin), self.frame.heights(self.xy + origin)
        np.testing.assert_allclose(far["height_m"], near["height_m"], atol=2e-3)
        np.testing.assert_allclose(far["normal"], near["normal"], atol=2e-3)
        self.assertLess(far["residual_m"].max(), 1e-3)
        # Far ones and near ones in one call, in any order, each as it is alone.
        both = np.concatenate([self.xy[:50] + origin, self.xy[:50]])[::-1]
        found = self.frame.heights(both, outputs=("position", "velocity"))
        for i in (0, 49, 50, 99):
            for name, array in self.frame.heights(both[i:i + 1], outputs=("position", "velocity")).items():
                np.testing.assert_array_equal(array[0], found[name][i], name)
        np.testing.assert_array_equal(found["height_m"][:50], self.frame.heights(self.xy[:50])["height_m"][::-1])
        np.testing.assert_allclose(found["position"][:, :2], both, rtol=1e-7, atol=2e-3)

    def test_a_folded_sea_is_finite(self):
        frame = pelagic.Frame(pelagic.Sea(storm(choppiness=5.0), cell_m=0.25, pixel_m=0.25))
        frame.set(1.0)
        found = frame.heights(self.xy)
        for name, array in found.items():
            self.assertTrue(np.isfinite(array).all(), name)
        self.assertGreater((found["residual_m"] < 1e-3).mean(), 0.99)
        at_rest = frame.evaluate(np.float32(self.xy), outputs=("normal",))["normal"]
        self.assertTrue((at_rest[:, 2] < 0.0).any())  # it has folded indeed

    def test_outputs_are_those_of_the_sea(self):
        self.assertEqual(sorted(self.frame.heights(self.xy, outputs=("position", "coverage"))),
                         ["coverage", "height_m", "position", "residual_m", "rest_m"])
        plain = pelagic.Frame(pelagic.Sea(storm(), ("position",)))
        plain.set(0.0)
        self.assertEqual(sorted(plain.heights(self.xy)), ["height_m", "residual_m", "rest_m"])
        with self.assertRaisesRegex(ValueError, "normal: the sea was built without it"):
            plain.heights(self.xy, outputs=("normal",))
        without = pelagic.Frame(pelagic.Sea(storm(), ("normal",)))
        without.set(0.0)
        with self.assertRaisesRegex(ValueError, "position: the sea was built without it"):
            without.heights(self.xy)

    def test_what_is_no_place_is_refused(self):
        for wrong in ([1.0, 2.0], [(1.0, 2.0, 3.0)], "here", None, [(math.nan, 0.0)], [(1e30, 0.0)]):
            with self.assertRaisesRegex(ValueError, "xy: "):
                self.frame.heights(wrong)
        with self.assertRaisesRegex(ValueError, "footprint_m"):
            self.frame.heights(self.xy, footprint_m=-1.0)
        with self.assertRaisesRegex(ValueError, "set"):
            pelagic.Frame(self.sea).heights(self.xy)

    def test_threads_may_ask_together(self):
        expected, answers = self.frame.heights(self.xy)["height_m"], []
        threads = [threading.Thread(target=lambda: answers.append(self.frame.heights(self.xy)["height_m"]))
                   for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(answers), 4)
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)

    def test_a_place_costs_no_more_than_ninety_points(self):
        points = np.float32(np.random.default_rng(2).uniform(-200.0, 200.0, (4000, 2)))
        asked = (lambda: self.frame.heights(self.xy), lambda: self.frame.evaluate(points, outputs=("position", "normal")))
        best_s = [math.inf, math.inf]
        for _ in range(20):
            for i, ask in enumerate(asked):
                begin = time.process_time()  # others use the machine as well
                ask()
                best_s[i] = min(best_s[i], time.process_time() - begin)
        points_a_place = best_s[0] / len(self.xy) / (best_s[1] / len(points))
        print(f"a place costs what {points_a_place:.0f} points cost")  # 30
        self.assertLess(points_a_place, 90.0)


class Drops(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scene = storm()
        scene.waves.cascades = [pelagic.CascadeSize(150.0, 96), pelagic.CascadeSize(31.0, 64)]
        cls.without = pelagic.Sea(scene, ["position"])
        scene.effects.spray = scene.effects.spray_drops = True
        cls.sea = pelagic.Sea(scene, ["position"])
        cls.drops = pelagic.SprayDrops(cls.sea)

    def test_a_moment_is_the_same_alone_and_in_a_run(self):
        run = [self.drops.in_air(t) for t in (2.0, 2.1, 2.2)]
        self.assertGreater(len(run[2]["id"]), 100)
        alone = pelagic.SprayDrops(self.sea, self.drops.size_m).in_air(2.2)
        for name, array in run[2].items():
            np.testing.assert_array_equal(alone[name], array, name)
        self.assertLess(np.abs(alone["position"][:, :2]).max(), 0.5 * self.drops.size_m)
        np.testing.assert_allclose(alone["opacity"], -np.expm1(-alone["section_m2"] / (0.25 * np.pi * alone["width_m"] ** 2)), rtol=1e-5)
        _, before, now = np.intersect1d(run[1]["id"], alone["id"], return_indices=True)
        way = alone["position"][now] - run[1]["position"][before]
        # Most fly nearly straight in a tenth of a second.
        self.assertLess(np.median(np.abs(way - 0.05 * (alone["velocity"][now] + run[1]["velocity"][before]))), 2e-3)

    def test_an_eye_sees_those_near_it(self):
        eye = (10.0, 5.0, 3.0)
        all_of_them, seen = self.drops.in_air(2.0, eye[:2]), self.drops.in_air(2.0, eye=eye)
        away_m = np.linalg.norm(all_of_them["position"] - eye, axis=1)
        part = np.clip(2.0 * away_m / 96.0 - 1.0, 0.0, 1.0)
        share = 1.0 - part**2 * (3.0 - 2.0 * part)
        kept = share > 0.0
        self.assertTrue(2.0 < away_m.min() and not kept.all())
        np.testing.assert_array_equal(seen["id"], all_of_them["id"][kept])
        np.testing.assert_allclose(seen["section_m2"], (share * all_of_them["section_m2"])[kept], rtol=1e-5)

    def test_none_and_refused(self):
        self.assertEqual(pelagic.SprayDrops(self.without).in_air(2.0)["position"].shape, (0, 3))
        for wrong in (lambda: self.drops.in_air(math.nan), lambda: self.drops.in_air(1.0, (math.inf, 0.0)),
                      lambda: self.drops.in_air(1.0, eye=(0.0, 0.0, math.nan)), lambda: pelagic.SprayDrops(self.sea, 0.0)):
            with self.assertRaisesRegex(ValueError, "accepted"):
                wrong()


class StormCameras(unittest.TestCase):
    """Those of presets from force 6 on: the water stays below them for ten seconds, and from force 9 on they stand in a trough."""

    def test_stand_in_a_trough(self):
        for name in [f"beaufort-{force}" for force in range(6, 13)] + ["north-sea-storm", "southern-ocean"]:
            with self.subTest(name):
                scene = pelagic.Scene()
                scene.apply_preset(name)
                frame = pelagic.Frame(pelagic.Sea(scene))
                eye, aim = np.array(scene.camera.position_m), np.array(scene.camera.look_at_m)
                ahead = (aim - eye)[:2] / np.hypot(*(aim - eye)[:2])
                self.assertLess(np.abs(eye[:2] + 70.0 * ahead).max(), 100.0)  # the default patch is before it
                for t in np.arange(0.0, 10.01, 0.5):
                    frame.set(t)
                    self.assertLess(frame.heights([eye[:2]])["height_m"][0], eye[2] - 0.3, t)
                frame.set(0.5)
                away_m = np.arange(10.0, 200.0, 2.0)
                crest_m = frame.heights(eye[:2] + away_m[:, None] * ahead)["height_m"] - eye[2]
                if name not in ("beaufort-6", "beaufort-7", "beaufort-8"):  # which are seen from a deck
                    self.assertGreater(np.degrees(np.arctan2(crest_m, away_m)).max(), 1.0)

    def test_each_force_is_whiter_than_the_one_before(self):
        def white(force):
            """The share of the sea in the picture that foam and spray make white, without the sun's glitter."""
            scene = pelagic.Scene()
            scene.apply_preset(f"beaufort-{force}")
            seen = pelagic.render(scene, 1, (96, 54), 1, layers=[])
            light = (seen["sky"] + seen["sea"] + seen["foam"] + seen["air"])[seen["is_sea"]] * pelagic.Sky(scene).exposure(scene)
            return np.mean((light @ [0.2126, 0.7152, 0.0722] > 0.3) & (light.min(1) > 0.7 * light.max(1)))

        shares = [white(force) for force in range(4, 13)]
        self.assertTrue(all(more >= less for less, more in zip(shares, shares[1:])), shares)
        self.assertTrue(all(more > 1.3 * less > 0.0 for less, more in zip(shares[2:-1], shares[3:-1])), shares)  # from force 6 on
        self.assertGreater(shares[8], 1.2 * shares[7], shares)  # nearly all of it is
        self.assertLess(shares[4], 0.12, shares)  # a gale is streaked, not white; 0.09 measured
        self.assertGreater(shares[8], 0.6, shares)  # foam's film, which water shows through, isn't counted


if __name__ == "__main__":
    unittest.main()
