"""Views, projected grids, seas that serve views, and scenes as text."""

import math
import os
import tempfile
import threading
import unittest

import numpy as np
import pelagic


def camera_scene(height_m=4.0):
    scene = pelagic.Scene()
    scene.surface.kind = "projected-grid"
    scene.surface.cell_px = 24.0
    scene.camera.position_m = (0.0, 0.0, height_m)
    scene.camera.look_at_m = (0.0, 50.0, height_m - 2.0)
    scene.camera.resolution = (320, 180)
    return scene


class Views(unittest.TestCase):
    def test_axes_make_the_view_that_the_scene_has(self):
        view = pelagic.View.of_scene(camera_scene(), 1)
        again = pelagic.View(position_m=view.position_m, right=np.float32(view.right), up=np.float32(view.up),
                             forward=np.float32(view.forward), tan_half_width=view.tan_half_width,
                             resolution=view.resolution)
        np.testing.assert_allclose(again.forward, view.forward, atol=1e-7)
        np.testing.assert_allclose(np.cross(again.right, again.forward), again.up, atol=1e-15)
        self.assertEqual(again.resolution, (320, 180))
        self.assertEqual(view, pelagic.View.of_scene(camera_scene(), 7))

    def test_what_is_no_camera_is_refused(self):
        good = dict(position_m=(0, 0, 2), right=(1, 0, 0), up=(0, 0, 1), forward=(0, 1, 0), tan_half_width=0.5,
                    resolution=(32, 18))
        pelagic.View(**good)
        for name, wrong in (("position_m", (0, 0, math.nan)), ("right", (2, 0, 0)), ("up", (0, 0, -1)),
                            ("forward", (1, 0, 0)), ("forward", (math.nan, 0, 0)), ("tan_half_width", 0.0),
                            ("resolution", (0, 18))):
            with self.assertRaisesRegex(ValueError, name + ".*accepted", msg=name):
                pelagic.View(**dict(good, **{name: wrong}))
        with self.assertRaisesRegex(ValueError, "frame"):
            pelagic.View.of_scene(camera_scene(), math.nan)


class Grids(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = camera_scene()
        cls.view = pelagic.View.of_scene(cls.scene, 1)
        cls.sea = pelagic.Sea(cls.scene, views=[cls.view])

    def test_a_grid_reaches_from_below_the_camera_to_the_horizon(self):
        grid = self.sea.projected_grid(self.view)
        points = (grid.columns + 1) * (grid.rows + 1)
        self.assertEqual(grid.rest_m.shape, (points, 2))
        self.assertEqual({a.dtype for a in (grid.rest_m, grid.cell_m, grid.pixel_m)}, {np.dtype(np.float32)})
        distance_m = np.hypot(*grid.rest_m.T)
        self.assertLess(distance_m.min(), 20.0)
        self.assertGreater(distance_m.max(), 5000.0)
        self.assertTrue((grid.pixel_m < grid.cell_m).mean() > 0.9)
        np.testing.assert_array_equal(grid.quads, pelagic.grid_quads(grid.columns, grid.rows))
        self.assertEqual((grid.quads.min(), grid.quads.max()), (0, points - 1))

    def test_a_size_that_is_asked_for_is_kept(self):
        for view in (self.view, pelagic.View.of_scene(camera_scene(40.0), 1)):
            grid = self.sea.projected_grid(view, (48, 80))
            self.assertEqual((grid.columns, grid.rows), (48, 80))
            self.assertTrue(np.isfinite(grid.rest_m).all())
        with self.assertRaisesRegex(ValueError, "size"):
            self.sea.projected_grid(self.view, (0, 3))

    def test_a_grid_far_away_is_the_same_round_its_own_origin(self):
        far = camera_scene()
        far.camera.position_m = (1e6, -3e6, 4.0)
        far.camera.look_at_m = (1e6, -3e6 + 50.0, 2.0)
        grid = self.sea.projected_grid(pelagic.View.of_scene(far, 1))
        np.testing.assert_allclose(grid.origin_m, (1e6, -3e6))
        here = self.sea.projected_grid(self.view)
        np.testing.assert_allclose(grid.rest_m, here.rest_m, rtol=1e-6, atol=1e-6)

    def test_awkward_cameras_and_a_calm_have_finite_seas(self):
        poses = {"under water": ((0, 0, -3), (0, 5, -2)), "at the surface": ((0, 0, 0), (9, 0, 0)),
                 "straight down": ((0, 0, 30), (0, 0, 0)), "up": ((0, 0, 30), (0, 1, 90)),
                 "high": ((0, 0, 2e4), (9, 0, 0))}
        for wind_mps in (0.0, 40.0):
            for name, (position_m, look_at_m) in poses.items():
                scene = camera_scene()
                scene.sea.wind_speed_mps = wind_mps
                scene.camera.position_m, scene.camera.look_at_m = position_m, look_at_m
                view = pelagic.View.of_scene(scene, 1)
                sea = pelagic.Sea(scene, views=[view])
                grid = sea.projected_grid(view)
                frame = pelagic.Frame(sea)
                frame.set(1.0)
                made = frame.evaluate(grid.rest_m, grid.origin_m, cell_m=grid.cell_m, pixel_m=grid.cell_m)
                for array in (grid.rest_m, grid.cell_m, grid.pixel_m, *made.values()):
                    self.assertTrue(np.isfinite(array).all(), (name, wind_mps))

    def test_a_point_is_the_same_in_a_sea_for_more_views(self):
        low = pelagic.View.of_scene(camera_scene(0.5), 1)
        self.assertTrue(self.sea.serves(self.view))
        self.assertFalse(self.sea.serves(low))
        both = pelagic.Sea(self.scene, views=[self.view, low])
        self.assertTrue(both.serves(low) and both.serves(self.view))
        answers = []
        for sea in (self.sea, both):
            grid = sea.projected_grid(self.view)
            frame = pelagic.Frame(sea)
            frame.set(2.0)
            answers.append(frame.evaluate(grid.rest_m, grid.origin_m, cell_m=grid.cell_m, pixel_m=grid.cell_m))
        for name, array in answers[0].items():
            np.testing.assert_array_equal(array, answers[1][name], name)
        self.assertGreater(answers[0]["position"][:, 2].std(), 0.05)
        self.assertFalse(pelagic.Sea(camera_scene()).serves(self.view))

    def test_normals_may_be_as_fine_as_pixels(self):
        fine = pelagic.Sea(self.scene, ("normal", "slope_variance"), views=[self.view], pixels=True)
        grid = fine.projected_grid(self.view)
        frame = pelagic.Frame(fine)
        frame.set(1.0)
        hidden = [frame.evaluate(grid.rest_m, grid.origin_m, pixel_m=size)["slope_variance"][:, :2].mean()
                  for size in (grid.cell_m, grid.pixel_m)]
        self.assertLess(hidden[1], 0.9 * hidden[0])

    def test_views_and_footprints_exclude_each_other(self):
        with self.assertRaisesRegex(ValueError, "views"):
            pelagic.Sea(self.scene, views=[self.view], cell_m=1.0)

    def test_wave_trains_serve_every_view(self):
        scene = camera_scene()
        scene.waves.model = "trochoid"
        sea = pelagic.Sea(scene, views=[self.view])
        self.assertTrue(sea.serves(pelagic.View.of_scene(camera_scene(0.5), 1)))


class Watching(unittest.TestCase):
    def test_progress_rises_to_the_end(self):
        told = []
        pelagic.Sea(camera_scene(), progress=told.append)
        self.assertEqual(told, sorted(told))
        self.assertEqual(told[-1], 1.0)

    def test_a_sea_can_be_cancelled_from_anywhere(self):
        cancel = pelagic.Cancel()
        cancel.set()
        self.assertTrue(cancel.is_set)
        for how in (cancel, lambda: True):
            with self.assertRaises(pelagic.Cancelled):
                pelagic.Sea(camera_scene(), cancel=how)
        pelagic.Sea(camera_scene(), cancel=pelagic.Cancel())
        caught = []
        cancel = pelagic.Cancel()

        def build():
            try:
                pelagic.Sea(camera_scene(), progress=lambda done: cancel.set(), cancel=cancel)
            except pelagic.Cancelled as error:
                caught.append(error)

        thread = threading.Thread(target=build)
        thread.start()
        thread.join()
        self.assertEqual(len(caught), 1)

    def test_what_a_callable_throws_comes_out(self):
        def fail(done):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            pelagic.Sea(camera_scene(), progress=fail)
        for wrong in (dict(progress=3), dict(cancel=True)):
            with self.assertRaisesRegex(TypeError, "accepted"):
                pelagic.Sea(camera_scene(), **wrong)


class Text(unittest.TestCase):
    def test_a_scene_goes_through_text_and_files(self):
        scene = camera_scene()
        scene.sea.swell = [pelagic.Swell(1.5, 11.0, 80.0)]
        scene.shot.seed = 2**62
        again = pelagic.Scene.from_text(scene.shot_text())
        self.assertEqual(str(again), str(scene))
        self.assertEqual(pelagic.Scene().shot_text(), "[shot]\nedition = 3\n")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "shot.toml")
            scene.save(path)
            self.assertEqual(str(pelagic.Scene.from_file(path)), str(scene))
            self.assertEqual(os.listdir(folder), ["shot.toml"])
            with self.assertRaisesRegex(pelagic.FileError, "nowhere"):
                scene.save(os.path.join(folder, "nowhere", "shot.toml"))
            self.assertTrue(issubclass(pelagic.FileError, OSError))

    def test_a_sky_is_found_from_the_folder_and_from_any_other(self):
        with tempfile.TemporaryDirectory() as folder:
            made = pelagic.Scene()
            made.surface.resolution = 4
            pelagic.bake(made, os.path.join(folder, "made"), 1)
            os.rename(os.path.join(folder, "made", "sea.sky.exr"), os.path.join(folder, "sky.exr"))
            text = '[light]\nsky = "sky.exr"\n'
            scene = pelagic.Scene.from_text(text, folder)
            self.assertEqual(scene.light.sky, os.path.join(folder, "sky.exr"))
            os.makedirs(os.path.join(folder, "other"))
            scene.save(os.path.join(folder, "other", "shot.toml"))
            saved = pelagic.Scene.from_file(os.path.join(folder, "other", "shot.toml"))
            self.assertTrue(os.path.samefile(saved.light.sky, os.path.join(folder, "sky.exr")))

    def test_a_mistake_in_a_text_has_its_line(self):
        with self.assertRaisesRegex(pelagic.ShotError, r"text:2:1: .*sea.wind_sped"):
            pelagic.Scene.from_text("[sea]\nwind_sped_mps = 3\n")


if __name__ == "__main__":
    unittest.main()
