"""Foam that lives, in frames and maps."""

import threading
import time
import unittest

import numpy as np
import pelagic

FOAM = ("coverage", "foam_active", "foam_age")


def windy(decay_s=2.0):
    scene = pelagic.Scene()
    scene.sea.wind_speed_mps = 16.0
    scene.effects.foam_decay_s = decay_s
    scene.surface.size_m, scene.surface.resolution = 40.0, 48
    return scene


def sea_of(decay_s=2.0, products=FOAM):
    return pelagic.Sea(windy(decay_s), products)


class LivingFoam(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sea = sea_of()
        cls.rest, _ = pelagic.patch(40.0, 48)

    def at(self, t, frame=None, **given):
        frame = frame or pelagic.Frame(self.sea)
        frame.set(t)
        return frame.evaluate(self.rest, **given)

    def test_it_is_there_and_has_an_age(self):
        self.assertEqual(self.sea.products, FOAM)
        foam = self.at(20.0)
        active, total, age_s = foam["foam_active"], foam["coverage"], foam["foam_age"]
        self.assertTrue((total >= active).all() and (total <= 1.0).all())
        self.assertTrue((total > active + 0.05).any() and (active > 0.05).any())
        self.assertTrue((age_s >= 0.0).all() and (age_s < 6.0).all() and (age_s > 1.0).any())
        # What breaks now is a part of what does in a sea whose foam doesn't live, and all of whose law's foam is that.
        plain = pelagic.Frame(sea_of(0.0))
        plain.set(20.0)
        without = plain.evaluate(self.rest)
        np.testing.assert_array_equal(without["foam_active"], without["coverage"])
        np.testing.assert_array_equal(without["foam_age"], 0.0)
        self.assertTrue((active <= without["coverage"] + 1e-6).all())

    def test_a_frame_alone_is_that_of_a_run(self):
        run = pelagic.Frame(self.sea)
        for t in (17.0, 19.9, 19.95, 3.0, 20.0):
            warm = self.at(t, run)
        for name, cold in self.at(20.0).items():
            np.testing.assert_array_equal(warm[name], cold, name)

    def test_outputs_are_those_that_are_asked_for(self):
        whole = self.at(20.0)
        for name in FOAM:
            alone = self.at(20.0, outputs=(name,))
            self.assertEqual(sorted(alone), [name])
            np.testing.assert_array_equal(alone[name], whole[name])
        into = np.zeros((len(self.rest), 3), np.float32)
        written = self.at(20.0, foam_age=into[:, 1])
        self.assertEqual(sorted(written), ["foam_age"])
        np.testing.assert_array_equal(into[:, 1], whole["foam_age"])
        self.assertFalse(into[:, [0, 2]].any())
        with self.assertRaisesRegex(ValueError, "foam_age: the sea was built without it"):
            self.at(20.0, pelagic.Frame(sea_of(products=("coverage",))), outputs=("foam_age",))

    def test_heights_have_it_too(self):
        sea = sea_of(products=("position",) + FOAM)
        frame = pelagic.Frame(sea)
        frame.set(20.0)
        found = frame.heights(self.rest, outputs=FOAM)
        there = frame.evaluate(found["rest_m"], outputs=FOAM)
        for name in FOAM:
            np.testing.assert_array_equal(found[name], there[name], name)

    def test_threads_that_ask_one_frame_get_the_same(self):
        frame = pelagic.Frame(self.sea)
        frame.set(20.0)
        whole, got = self.at(20.0), {}

        def ask(part):
            got[part] = frame.evaluate(self.rest[part::4])

        threads = [threading.Thread(target=ask, args=(part,)) for part in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for part, foam in got.items():
            for name in FOAM:
                np.testing.assert_array_equal(foam[name], whole[name][part::4])

    def test_a_long_past_says_how_far_it_is_and_can_be_cancelled(self):
        frame, told = pelagic.Frame(self.sea), []
        frame.set(20.0)
        frame.evaluate(self.rest, progress=told.append)
        self.assertEqual(told, sorted(told))
        self.assertTrue(len(told) > 5 and told[-1] == 1.0)
        frame.set(20.02)
        frame.evaluate(self.rest, progress=lambda done: self.fail("a step looks back"))
        frame.set(200.0)
        with self.assertRaises(pelagic.Cancelled):
            frame.evaluate(self.rest, progress=told.append, cancel=lambda: told[-1] > 0.3)
        for name, cold in self.at(200.0).items():  # and goes on
            np.testing.assert_array_equal(frame.evaluate(self.rest)[name], cold)

        def fail(done):
            raise RuntimeError("told enough")
        frame.set(300.0)
        with self.assertRaisesRegex(RuntimeError, "told enough"):
            frame.evaluate(self.rest, progress=fail)
        task = frame.begin(400.0, self.rest)
        foam = task.result()
        self.assertEqual(task.progress, (1.0,))
        np.testing.assert_array_equal(foam["coverage"], self.at(400.0)["coverage"])
        # Begun with its first step, of many: it can't be done before it is cancelled.
        far, _ = pelagic.patch(300.0, 100)
        task = frame.begin(500.0, far)
        while task.progress is None and not task.is_done:
            time.sleep(0.001)
        task.cancel()
        with self.assertRaises(pelagic.Cancelled):
            task.result()
        self.assertLess(task.progress[0], 1.0)

    def test_heights_say_how_far_they_are_and_can_be_cancelled(self):
        frame, told = pelagic.Frame(sea_of(products=("position",) + FOAM)), []
        frame.set(20.0)
        whole = frame.heights(self.rest, outputs=FOAM, progress=told.append)
        self.assertEqual(told, sorted(told))
        self.assertTrue(len(told) > 5 and told[-1] == 1.0)
        frame.set(200.0)
        with self.assertRaises(pelagic.Cancelled):
            frame.heights(self.rest, outputs=FOAM, progress=told.append, cancel=lambda: told[-1] < 0.9)
        frame.set(20.0)
        for name, values in frame.heights(self.rest, outputs=FOAM).items():  # and goes on
            np.testing.assert_array_equal(values, whole[name])

    def test_it_has_no_history_without_whitecaps(self):
        frame = pelagic.Frame(sea_of(products=("position", "coverage")))
        frame.set(20.0)
        frame.evaluate(self.rest, outputs=("position",), progress=lambda done: self.fail("nobody asked for foam"))

    def test_maps_have_it(self):
        scene = windy()
        scene.output.map_resolution = 32
        maps, told = pelagic.Maps(scene, ("whitecaps",), tiles=True), []
        patch, tiles = maps.at(20.0, progress=told.append)
        self.assertEqual(sorted(patch), ["coverage", "foam_active", "foam_age", "jacobian"])
        self.assertTrue(all("foam_age" not in tile for tile in tiles))
        self.assertTrue((patch["coverage"] >= patch["foam_active"]).all() and (patch["foam_age"] > 1.0).any())
        self.assertEqual(told[-1], 1.0)
        cancel = pelagic.Cancel()
        cancel.set()
        with self.assertRaises(pelagic.Cancelled):
            maps.at(90.0, cancel=cancel)
        scene.effects.foam_decay_s = 0.0
        self.assertEqual(sorted(pelagic.Maps(scene, ("whitecaps",)).at(20.0)[0]), ["coverage", "jacobian"])


if __name__ == "__main__":
    unittest.main()
