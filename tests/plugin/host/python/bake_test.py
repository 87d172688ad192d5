"""Bakes, maps and pictures from Python: the command line's, to the bit."""

import concurrent.futures
import os
import pathlib
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np
import pelagic

PROGRAM = os.environ["PELAGIC_PROGRAM"]


def shot(frames=(1, 3)):
    scene = pelagic.Scene()
    scene.shot.name, scene.shot.frames = "bay", frames
    scene.sea.wind_speed_mps = 14.0
    scene.surface.size_m, scene.surface.resolution = 60.0, 24
    scene.waves.cascades = [pelagic.CascadeSize(60.0, 96), pelagic.CascadeSize(11.0, 32)]
    scene.output.maps, scene.output.map_resolution = ("displacement", "normal", "slope-variance", "whitecaps"), 32
    scene.output.cascade_tiles = True
    scene.camera.resolution = (64, 40)
    return scene


def files(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(pathlib.Path(folder).rglob("*"))
            if path.is_file()}


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)


class Bake(InFolder):
    def test_files_are_the_command_lines_byte_by_byte(self):
        scene = shot()
        scene.save(self.path / "shot.toml")
        subprocess.run([PROGRAM, "bake", str(self.path / "shot.toml"), "--out", str(self.path / "theirs")], check=True,
                       stdout=subprocess.DEVNULL)
        report = pelagic.bake(scene, self.path / "ours")
        self.assertEqual((report.done, report.kept, report.total, report.cancelled), (3, 0, 3, False))
        ours, theirs = files(self.path / "ours"), files(self.path / "theirs")
        self.assertEqual(sorted(ours), sorted(theirs))
        self.assertGreater(len(ours), 3 * (1 + 4 + 2 * 4))
        for name, content in ours.items():
            if name != "bay.json":  # which has the times that it took
                self.assertEqual(content, theirs[name], name)
        self.assertEqual(report.root, self.path / "ours" / "bay.usda")
        self.assertEqual(report.maps, self.path / "ours" / "maps")
        self.assertIn("compute", report.times)

    def test_frames_are_kept_and_named_as_on_the_command_line(self):
        out = self.path / "out"
        self.assertEqual(pelagic.bake(shot(), out, frames=2).done, 1)
        report = pelagic.bake(shot(), out, frames="1-3x2")
        self.assertEqual((report.done, report.kept), (2, 0))
        report = pelagic.bake(shot(), out, frames=[3, 1, 1])
        self.assertEqual((report.done, report.kept, report.total), (0, 2, 2))
        maps_only = shot()
        maps_only.output.mesh = "none"
        self.assertIsNone(pelagic.bake(maps_only, self.path / "maps only", frames=1).root)
        changed = shot()
        changed.shot.seed = 7
        report = pelagic.bake(changed, out, frames=[1])
        self.assertEqual((report.done, report.stale), (1, [2, 3]))

    def test_verify_names_what_is_not_as_it_was_written_and_a_bake_makes_it_again(self):
        out = self.path / "out"
        pelagic.bake(shot(), out)
        self.assertEqual(pelagic.verify(out), [])
        whole = files(out)
        mesh = next(path for path in (out / "mesh").iterdir() if ".0002." in path.name)
        data = bytearray(mesh.read_bytes())
        data[len(data) // 2] ^= 4
        mesh.write_bytes(data)
        (out / "maps" / "old.normal.0001.exr").write_bytes(b"somebody's")
        found = pelagic.verify(str(out))
        self.assertEqual([(finding.path, finding.flaw) for finding in found],
                         [("maps/old.normal.0001.exr", "foreign"), (f"mesh/{mesh.name}", "damaged")])
        self.assertIn("other bytes than were written", found[1].what)
        self.assertIn(mesh.name, repr(found[1]))
        report = pelagic.bake(shot(), out)
        self.assertEqual((report.done, report.kept, len(report.damaged)), (1, 2, 1))
        (out / "maps" / "old.normal.0001.exr").unlink()
        self.assertEqual(files(out), whole)
        self.assertEqual(pelagic.bake(shot(), out, trust_times=True).kept, 3)
        with self.assertRaises(pelagic.FileError):
            pelagic.verify(self.path / "nowhere")
        cancel = pelagic.Cancel()
        cancel.set()
        with self.assertRaises(pelagic.Cancelled):
            pelagic.verify(out, cancel=cancel)

    def test_progress_tells_each_frame(self):
        told = []
        pelagic.bake(shot(), self.path / "out", progress=lambda *now: told.append(now))
        self.assertEqual([now[0] for now in told if now[0] == "frames"][-1:], ["frames"])
        self.assertEqual([now[2] for now in told if now[0] == "frames" and now[2] > 0], [1, 2, 3])
        self.assertEqual(told[-1][1:5], (3, 3, 0, 3))
        self.assertIn("building", {now[0] for now in told})

    def test_a_bake_in_a_thread_is_cancelled_from_another_and_goes_on(self):
        cancel, reports, begun = pelagic.Cancel(), [], threading.Event()

        def run():
            reports.append(pelagic.bake(shot((1, 4000)), self.path / "out", cancel=cancel,
                                        progress=lambda stage, frame, done, *rest: done > 1 and begun.set()))

        thread = threading.Thread(target=run)
        thread.start()
        self.assertTrue(begun.wait(60.0))
        ticks = 0
        while ticks < 10:  # others run meanwhile
            time.sleep(0.001)
            ticks += 1
        cancel.set()
        thread.join(60.0)
        self.assertFalse(thread.is_alive())
        self.assertTrue(reports[0].cancelled)
        self.assertTrue(2 <= reports[0].done < 4000)
        again = pelagic.bake(shot((1, 4000)), self.path / "out", frames=list(range(1, reports[0].done + 1)))
        self.assertEqual((again.done, again.kept), (0, reports[0].done))

    def test_a_callable_may_cancel_and_may_fail(self):
        for true in (True, ["any object"]):
            report = pelagic.bake(shot((1, 4000)), self.path / "out", cancel=lambda: true)
            self.assertTrue(report.cancelled)
        self.assertFalse(pelagic.bake(shot((1, 1)), self.path / "out", cancel=lambda: []).cancelled)

        def fail(*now):
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            pelagic.bake(shot(), self.path / "out", progress=fail)

    def test_what_cannot_be_baked_is_said_in_the_command_lines_words(self):
        for wrong, said in (("7", "outside the shot"), ([9], "range|shot"), ([], "none"), ("x", "not a frame")):
            with self.assertRaisesRegex(ValueError, said):
                pelagic.bake(shot(), self.path / "out", frames=wrong)
        (self.path / "file").write_text("in the way")
        with self.assertRaisesRegex(pelagic.FileError, "file"):
            pelagic.bake(shot(), self.path / "file")
        scene = shot()
        scene.sea.wind_speed_mps = -1.0
        with self.assertRaisesRegex(pelagic.ShotError, "sea.wind_speed_mps = -1"):
            pelagic.bake(scene, self.path / "out")


class Meshes(InFolder):
    """What evaluate() gives is what a bake writes, to the bit."""

    def baked(self, scene, frame):
        pelagic.bake(scene, self.path, frame)
        return pelagic.read_mesh(self.path / "mesh" / f"bay.{frame:04}.usdc")

    def compare(self, ours, theirs, origin_m=(0.0, 0.0)):
        self.assertEqual((theirs["origin_m"].dtype, theirs["origin_m"].shape), (np.float64, (3,)))
        offset_m = np.array([*origin_m, 0.0]) - theirs["origin_m"]
        ours["position"] = np.float32(np.float64(ours["position"]) + offset_m)
        for name in ("position", "normal", "velocity", "slope_variance", "coverage"):
            np.testing.assert_array_equal(ours[name], theirs[name], name)

    def test_a_patch(self):
        scene = shot()
        size_m, quads = scene.surface.size_m, scene.surface.resolution
        frame = pelagic.Frame(pelagic.Sea(scene, lattice=(-size_m / 2, size_m / quads, size_m / 2)))
        frame.set(scene.shot.time_s(3))
        self.compare(frame.evaluate(pelagic.patch(size_m, quads)[0]), self.baked(scene, 3))

    def test_a_lattice_with_an_end_is_a_bakes(self):
        """It lies within one copy of each large tile, and reads its nodes."""
        scene = shot()
        scene.waves.cascades = [pelagic.CascadeSize(256.0, 128)]
        size_m, quads = 64.0, 32
        scene.surface.size_m, scene.surface.resolution = size_m, quads
        endless = (-size_m / 2, size_m / quads)
        lattice = (*endless, size_m / 2)
        transforms = [pelagic.Sea(scene, ("normal", "coverage"), lattice=each).transforms_per_frame for each in (lattice, endless)]
        self.assertLess(*transforms)
        frame = pelagic.Frame(pelagic.Sea(scene, lattice=lattice))
        frame.set(scene.shot.time_s(3))
        self.compare(frame.evaluate(pelagic.patch(size_m, quads)[0]), self.baked(scene, 3))
        for wrong in ((0.0,), (0.0, 1.0, -1.0), (0.0, 1.0, np.inf), (0.0, 1.0, 2.0, 3.0), (0.0, 0.0, 1.0)):
            with self.assertRaisesRegex(ValueError, "lattice: accepted"):
                pelagic.Sea(scene, lattice=wrong)

    def test_a_projected_grid(self):
        scene = shot()
        scene.surface.kind = "projected-grid"
        scene.surface.earth_curvature = False  # a Sea's own grid is flat
        scene.output.maps, scene.output.cascade_tiles = (), False
        for x_m, origin_m in ((1234.5, [0, 0, 0]), (-1e7 + 0.5, [-9998336, 0, 0])):
            scene.camera.position_m, scene.camera.look_at_m = (x_m, 2.25, 4.0), (x_m, 60.0, 2.0)
            view = pelagic.View.of_scene(scene, 2)
            sea = pelagic.Sea(scene, views=[view])
            frame, grid = pelagic.Frame(sea), sea.projected_grid(view)
            frame.set(scene.shot.time_s(2))
            baked = self.baked(scene, 2)
            self.assertEqual(baked["origin_m"].tolist(), origin_m)
            self.compare(frame.evaluate(grid.rest_m, grid.origin_m, cell_m=grid.cell_m, pixel_m=grid.cell_m,
                                        cell_axis_m=grid.cell_axis_m, pixel_axis_m=grid.cell_axis_m), baked,
                         grid.origin_m)
            np.testing.assert_array_equal(grid.quads.ravel(), baked["face_corners"])


class Maps(unittest.TestCase):
    def test_maps_are_the_query_on_their_squares(self):
        scene = shot()
        scene.effects.foam_decay_s = 0.0
        maps = pelagic.Maps(scene)
        patch, tiles = maps.at(1.5)
        self.assertEqual(sorted(patch), ["coverage", "displacement", "jacobian", "normal", "slope_variance"])
        self.assertEqual((patch["displacement"].shape, patch["coverage"].shape, tiles), ((32, 32, 3), (32, 32), []))
        size_m, n = 60.0, 32
        line = np.arange(n, dtype=np.float32) * np.float32(size_m / n) - np.float32(0.5 * size_m)
        rest = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        frame = pelagic.Frame(pelagic.Sea(scene, tuple(patch), cell_m=size_m / n, pixel_m=size_m / n,
                                          lattice=(-0.5 * size_m, size_m / n, 0.5 * size_m)))
        frame.set(1.5)
        for name, array in frame.evaluate(rest).items():
            np.testing.assert_allclose(patch[name].reshape(array.shape), array, atol=2e-5, err_msg=name)
        self.assertGreater(patch["displacement"][..., 2].std(), 0.1)

    def test_the_floors_light(self):
        scene = shot()
        scene.sea.depth_m = 3.0
        light = pelagic.Maps(scene, ("floor",)).at(1.5)[0]["floor_light"]
        self.assertEqual(light.shape, (32, 32))
        self.assertGreater(light.std(), 0.05)
        self.assertAlmostEqual(light.mean(), 1.0, delta=0.05)

    def test_tiles_are_the_cascades_own(self):
        patch, tiles = pelagic.Maps(shot(), ["displacement"], tiles=True).at(0.5)
        self.assertEqual([tile["displacement"].shape for tile in tiles], [(96, 96, 3), (32, 32, 3)])
        self.assertGreater(tiles[0]["displacement"][..., 2].std(), tiles[1]["displacement"][..., 2].std())

    def test_times_in_any_order(self):
        maps = pelagic.Maps(shot(), ("normal",))
        first = maps.at(1.0)[0]["normal"]
        maps.at(2.0)
        np.testing.assert_array_equal(maps.at(1.0)[0]["normal"], first)

    def test_times_from_several_threads(self):
        maps = pelagic.Maps(shot(), ("displacement",))
        times = (0.0, 1.0, 2.0, 3.0)
        alone = [maps.at(t)[0]["displacement"] for t in times]
        with concurrent.futures.ThreadPoolExecutor(len(times)) as threads:
            together = list(threads.map(lambda t: maps.at(t)[0]["displacement"], times * 25))
        np.testing.assert_array_equal(together, alone * 25)

    def test_names_are_the_keys(self):
        with self.assertRaisesRegex(pelagic.ShotError, "output.maps"):
            pelagic.Maps(shot(), ("slopes",))
        with self.assertRaisesRegex(ValueError, "^maps: are none"):
            pelagic.Maps(shot(), ())
        cancel = pelagic.Cancel()
        cancel.set()
        with self.assertRaises(pelagic.Cancelled):
            pelagic.Maps(shot(), cancel=cancel)


class Pictures(unittest.TestCase):
    def test_a_picture_adds_up_and_has_sea_below_and_sky_above(self):
        layers = pelagic.render(shot(), 1, (48, 32), 1, sky_quality="one")
        self.assertEqual(sorted(layers), ["air", "foam", "is_sea", "sea", "sky", "sun"])
        for name in ("sun", "sky", "sea", "foam", "air"):
            self.assertEqual((layers[name].shape, layers[name].dtype), ((32, 48, 3), np.float32))
            self.assertTrue(np.isfinite(layers[name]).all())
        is_sea = layers["is_sea"]
        self.assertEqual((is_sea.dtype, is_sea.shape), (np.dtype(bool), (32, 48)))
        self.assertTrue(is_sea[-1].all() and not is_sea[0].any())
        self.assertTrue((layers["sea"][is_sea][:, 2] > 0.0).all() and (layers["sea"][~is_sea] == 0.0).all())

    def test_layers_alpha_and_shutter(self):
        shapes = {"depth": (8, 12), "position": (8, 12, 3), "normal": (8, 12, 3), "motion": (8, 12, 4),
                  "vector": (8, 12, 4), "coverage": (8, 12), "foam_active": (8, 12), "foam_age": (8, 12),
                  "slope_variance": (8, 12, 3)}
        light = ["air", "foam", "is_sea", "sea", "sky", "sun"]
        full = pelagic.render(shot(), 1, (12, 8), 1, sky_quality="one", layers=list(shapes), alpha=True, shutter=0.5)
        self.assertEqual(sorted(full), sorted([*light, "alpha", *shapes]))
        for name, shape in {**shapes, "alpha": (8, 12)}.items():
            self.assertEqual((full[name].shape, full[name].dtype), (shape, np.float32), name)
            self.assertTrue(np.isfinite(full[name]).all(), name)
        self.assertTrue((full["depth"][~full["is_sea"]] == 1e10).all() and (full["depth"][full["is_sea"]] < 1e9).all())
        self.assertTrue(full["alpha"].min() >= 0.0 and full["alpha"].max() == 1.0 and full["alpha"][0].max() == 0.0)
        for first in range(3):  # a picture for each name would take most of this file's time
            some = list(shapes)[first::3]
            made = pelagic.render(shot(), 1, (12, 8), 1, sky_quality="one", layers=some)
            self.assertEqual(sorted(made), sorted([*light, *some]))
        for wrong in ({"layers": ["z"]}, {"layers": [""]}, {"shutter": -0.1}, {"shutter": 4.1}, {"shutter": float("nan")}):
            with self.assertRaises(ValueError, msg=wrong):
                pelagic.render(shot(), 1, (12, 8), 1, **wrong)
        with self.assertRaises(TypeError):
            pelagic.render(shot(), 1, (12, 8), 1, layers=5)

    def test_overscan_and_regions(self):
        def look(**more):
            return pelagic.render(shot(), 1, (48, 32), 1, layers=["position"], alpha=True, **more)
        whole, wide, part = look(), look(overscan=(6, 4)), look(region=(5, 20, 30, 31))
        for name, values in whole.items():
            self.assertEqual(wide[name].shape[:2], (40, 60), name)
            np.testing.assert_array_equal(wide[name][4:-4, 6:-6], values, name)
            np.testing.assert_array_equal(part[name], values[20:31, 5:30], name)
        for wrong in ({"overscan": (25, 0)}, {"overscan": (-1, 0)}, {"region": (0, 0, 49, 1)}, {"region": (5, 5, 5, 6)}):
            with self.assertRaises(ValueError, msg=wrong):
                look(**wrong)

    def test_it_is_the_sky_that_sky_has(self):
        scene = shot()
        scene.camera.position_m, scene.camera.look_at_m = (0.0, 0.0, 3.0), (0.0, 10.0, 13.0)
        view = pelagic.View.of_scene(scene, 1)
        layers = pelagic.render(scene, 1, (65, 65), 1)
        # The picture's is the sky from the eye's height; Sky has a map of it from sea level.
        np.testing.assert_allclose(layers["sky"][32, 32], pelagic.Sky(scene).radiance(np.float32([view.forward]))[0],
                                   rtol=5e-3)

    def test_a_mirror_is_shaded_as_shade_does(self):
        scene = shot()
        scene.sea.wind_speed_mps = 0.0
        scene.surface.earth_curvature = False
        size = (40, 24)
        layers = pelagic.render(scene, 1, size, 1)
        view = pelagic.View.of_scene(scene, 1)
        column, row = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
        tangent = 2.0 * view.tan_half_width / size[0]
        ray = (np.float64(view.forward) + np.multiply.outer((column - size[0] / 2) * tangent, view.right) +
               np.multiply.outer((size[1] / 2 - row) * tangent, view.up))
        to_eye = np.float32(-ray / np.linalg.norm(ray, axis=-1, keepdims=True))[layers["is_sea"]]
        up, flat = np.zeros_like(to_eye), np.zeros_like(to_eye)
        up[:, 2] = 1.0
        lit = pelagic.shade(pelagic.Sky(scene), pelagic.WaterBody(scene), to_eye, up, flat)
        self.assertGreater(len(to_eye), 300)
        # Through the air, which takes the same part of both.
        sky, sea = (layers[name][layers["is_sea"]] for name in ("sky", "sea"))
        self.assertTrue((sea <= lit["sea"] * 1.002 + 1e-5).all())
        np.testing.assert_allclose(sky * lit["sea"], sea * lit["sky"], rtol=2e-3, atol=1e-5)

    def test_it_can_be_cancelled_and_refuses_what_is_too_large(self):
        told = []
        pelagic.render(shot(), 1, (16, 16), 1, progress=told.append)
        self.assertEqual(told, sorted(told))
        with self.assertRaises(pelagic.Cancelled):
            pelagic.render(shot(), 1, cancel=lambda: True)
        for wrong in (dict(samples=0), dict(size=(0, 3)), dict(sky_quality="ten")):
            with self.assertRaises(ValueError):
                pelagic.render(shot(), 1, **wrong)


class PictureFiles(InFolder):
    LOOK = {"size": (32, 20), "samples": 1, "layers": ["depth"], "exposure": 1.0}

    def render(self, **more):
        return pelagic.render_files(shot(), self.path / "ours", **self.LOOK | more)

    def command_line(self):
        shot().save(self.path / "shot.toml")
        subprocess.run([PROGRAM, "render", str(self.path / "shot.toml"), "--out", str(self.path / "theirs"), "--size", "32x20",
                        "--samples", "1", "--layers", "sun,sky,sea,foam,air,depth", "--exposure", "1"],
                       check=True, stdout=subprocess.DEVNULL)
        return files(self.path / "theirs")

    def test_they_are_the_command_lines_and_rendering_goes_on(self):
        cancel = pelagic.Cancel()

        def first(stage, frame, done, kept, total, share):
            if stage == "frames" and done == 1:
                cancel.set()

        begun = self.render(progress=first, cancel=cancel)
        self.assertTrue(begun.cancelled)
        self.assertIn(begun.done, (1, 2))
        report = self.render()
        self.assertEqual((report.done, report.kept, report.total, report.cancelled), (3 - begun.done, begun.done, 3, False))
        self.assertEqual((report.root, report.record), (None, None))
        theirs = self.command_line()
        self.assertEqual(len(theirs), 6)
        self.assertEqual(files(self.path / "ours"), theirs)
        picture = self.path / "ours" / "bay.0002.exr"
        picture.write_bytes(picture.read_bytes()[:-100] + bytes(100))
        self.assertEqual([found.path for found in pelagic.verify(self.path / "ours")], ["bay.0002.exr"])
        report = self.render()
        self.assertEqual((report.done, report.kept), (1, 2))
        self.assertEqual(files(self.path / "ours"), theirs)

    def test_others_are_named_and_wrong_ones_refused(self):
        self.render()
        (self.path / "ours" / "bay.0009.png").write_bytes(b"somebody's")
        report = self.render(frames=[2], samples=2)
        self.assertEqual((report.done, report.stale), (1, [1, 3]))
        self.assertEqual(len(report.foreign), 1)
        for wrong in (dict(samples=0), dict(exposure=31.0), dict(exposure=float("nan")), dict(layers=["z"]), dict(frames=9),
                      dict(frames="1-9"), dict(sky_quality="ten")):
            with self.assertRaises(ValueError, msg=wrong):
                self.render(**wrong)
            with self.assertRaises(ValueError, msg=wrong):
                pelagic.begin_render_files(shot(), self.path / "none", **self.LOOK | wrong).result()
        with self.assertRaises(MemoryError):
            self.render(max_memory_bytes=1 << 20, frames=1, alpha=True)
        self.assertFalse((self.path / "none").exists())

    def test_a_task_makes_the_same(self):
        task = pelagic.begin_render_files(shot(), self.path / "ours", **self.LOOK)
        self.assertEqual(task.result().done, 3)
        self.assertEqual(task.progress[:5], ("frames", 3, 3, 0, 3))
        self.assertEqual(files(self.path / "ours"), self.command_line())


if __name__ == "__main__":
    unittest.main()
