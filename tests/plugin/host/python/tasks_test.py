"""Work in native threads: the results are the blocking calls', nothing waits for Python meanwhile, and all of it ends."""

import gc
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest

import numpy as np
import pelagic


def small_scene(resolution=32):
    scene = pelagic.Scene()
    scene.waves.cascades = [pelagic.CascadeSize(60.0, resolution)]
    scene.surface.resolution = 8
    scene.camera.resolution = (32, 20)
    return scene


def long_bake(folder):
    scene = small_scene()
    scene.shot.frames = (1, 4000)
    return pelagic.begin_bake(scene, folder)


def begun(task):
    while task.progress is None and not task.is_done:
        time.sleep(0.001)
    return task


class Results(unittest.TestCase):
    def test_a_sea_and_a_frame_are_those_of_the_blocking_calls(self):
        scene = small_scene()
        rest, _ = pelagic.patch(60.0, 8)
        task = pelagic.Sea.begin(scene, ["position", "coverage"])
        scene.sea.wind_speed_mps = 3.0  # too late
        sea = task.result()
        self.assertTrue(task.is_done)
        self.assertIs(task.result(), sea)
        self.assertEqual(sea.products, ("position", "coverage"))
        expected = pelagic.Frame(pelagic.Sea(small_scene(), ["position", "coverage"]))
        expected.set(2.5)
        wanted = expected.evaluate(rest, (3.0, 4.0), cell_m=1.0)
        mine = np.empty((len(rest), 3), np.float32)
        frame = pelagic.Frame(sea)
        made = frame.begin(2.5, rest, (3.0, 4.0), cell_m=1.0, position=mine, outputs=["coverage"]).result()
        self.assertIs(made["position"], mine)
        self.assertEqual(frame.time_s, 2.5)
        for name, array in wanted.items():
            np.testing.assert_array_equal(made[name], array)

    def test_a_frame_that_nobody_holds_keeps_its_arrays_alive(self):
        rest, _ = pelagic.patch(60.0, 256)
        sea = pelagic.Sea(small_scene(), ["position"])
        tasks = [pelagic.Frame(sea).begin(t, rest.copy(), cell_m=np.full(len(rest), 0.5, np.float32)) for t in (1.0, 2.0)]
        gc.collect()
        frame = pelagic.Frame(sea)
        for task, t in zip(tasks, (1.0, 2.0)):
            frame.set(t)
            np.testing.assert_array_equal(task.result()["position"], frame.evaluate(rest, cell_m=0.5)["position"])

    def test_what_a_gpu_draws_from(self):
        scene = small_scene()
        sea, light = pelagic.GpuSea.begin(scene, 0.5).result(), pelagic.GpuLight.begin(scene).result()
        self.assertEqual(sea.finest_m, 0.5)
        self.assertTrue(sea.serves(scene) and light.serves(scene))
        self.assertEqual(light.uniforms, pelagic.GpuLight(scene).uniforms)

    def test_a_bake_is_polled(self):
        with tempfile.TemporaryDirectory() as folder:
            task = pelagic.begin_bake(small_scene(), folder, frames="1-3")
            report = task.result()
            self.assertEqual((report.done, report.total, report.cancelled), (3, 3, False))
            self.assertEqual(task.progress[0], "frames")
            self.assertEqual(task.progress[2:5], (3, 0, 3))

    def test_python_goes_on_meanwhile_and_the_work_without_python(self):
        """Also while this thread never lets go of the interpreter."""
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000.0)
        try:
            task = pelagic.Sea.begin(small_scene(128))
            end = time.monotonic() + 60
            while not task.is_done and time.monotonic() < end:
                pass
            self.assertTrue(task.is_done)
        finally:
            sys.setswitchinterval(interval)


class Refusals(unittest.TestCase):
    def test_bad_arguments_are_refused_before_it_begins(self):
        wrong = pelagic.Scene()
        wrong.sea.depth_m, wrong.waves.cascades = 5.0, [pelagic.CascadeSize(60.0, 32)] * 2
        for begin in (lambda: pelagic.Sea.begin(wrong), lambda: pelagic.GpuSea.begin(wrong),
                      lambda: pelagic.GpuLight.begin(wrong), lambda: pelagic.begin_bake(wrong)):
            with self.assertRaises(pelagic.ShotError):
                begin()
        with self.assertRaisesRegex(ValueError, "is no product"):
            pelagic.Sea.begin(small_scene(), ["positions"])
        with self.assertRaisesRegex(ValueError, "finest_m"):
            pelagic.GpuSea.begin(small_scene(), -1.0)
        frame = pelagic.Frame(pelagic.Sea(small_scene()))
        with self.assertRaisesRegex(TypeError, "rest"):
            frame.begin(1.0, [[0.0, 0.0]])

    def test_what_goes_wrong_is_raised_by_result_each_time(self):
        frame = pelagic.Frame(pelagic.Sea(small_scene()))
        task = frame.begin(float("inf"), np.zeros((1, 2), np.float32))
        for _ in range(2):
            with self.assertRaises(ValueError):
                task.result()
        with tempfile.NamedTemporaryFile() as file:
            with self.assertRaises(pelagic.FileError):
                pelagic.begin_bake(small_scene(), file.name).result()

    def test_cancelling(self):
        with tempfile.TemporaryDirectory() as folder:
            task = begun(long_bake(folder))
            task.cancel()
            self.assertTrue(task.result().cancelled)
        for _ in range(20):  # on a busy machine the work may end before this thread comes to cancel it
            task = pelagic.Sea.begin(small_scene(2048))
            task.cancel()
            try:
                task.result()
            except pelagic.Cancelled:
                return
        self.fail("a cancelled task is never cancelled")


class Endings(unittest.TestCase):
    def test_a_task_that_nobody_holds_any_more_ends(self):
        with tempfile.TemporaryDirectory() as folder:
            task = begun(long_bake(folder))
            del task
            before = sorted(pathlib.Path(folder).rglob("*"))
            time.sleep(0.1)
            self.assertEqual(sorted(pathlib.Path(folder).rglob("*")), before)

    def end_of(self, lines):
        with tempfile.TemporaryDirectory() as folder:
            program = textwrap.dedent("""
                import os, time, numpy as np, pelagic
                scene = pelagic.Scene()
                scene.waves.cascades = [pelagic.CascadeSize(60.0, 512)]
                scene.shot.frames = (1, 4000)
                """) + "\n".join(lines)
            done = subprocess.run([sys.executable, "-c", program], cwd=folder, env=os.environ, timeout=120,
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), lines)

    def test_a_program_ends_while_one_runs(self):
        frames = "rest = np.zeros((1000000, 2), np.float32); frame = pelagic.Frame(pelagic.Sea(scene))"
        for begin in (["task = pelagic.begin_bake(scene, 'out')"], ["task = pelagic.Sea.begin(scene)"],
                      ["task = pelagic.GpuSea.begin(scene)"], ["task = pelagic.GpuLight.begin(scene)"],
                      [frames, "task = [frame.begin(t, rest) for t in range(5)]"]):
            self.end_of([*begin, "time.sleep(0.05)"])

    def test_none_begins_once_the_program_ends(self):
        self.end_of(["import atexit",
                     "def late():",
                     "    try: pelagic.Sea.begin(scene)",
                     "    except pelagic.Cancelled: return",
                     "    os._exit(3)",
                     "atexit._run_exitfuncs()",
                     "late()"])

    def test_a_forked_process_has_none_of_them(self):
        self.end_of(["task = pelagic.begin_bake(scene, 'out')",
                     "child = os.fork()",
                     "if child == 0:",
                     "    try: task.result()",
                     "    except pelagic.Cancelled: task = None",
                     "else:",
                     "    status = os.waitpid(child, 0)[1]",
                     "    assert status == 0, status",
                     "    assert not task.is_done"])

    LIVING_FOAM = ["scene.sea.wind_speed_mps, scene.effects.foam_decay_s = 16.0, 8.0",
                   "sea = pelagic.GpuSea(scene, 0.1)",
                   "view = pelagic.View(position_m=(0.0, 0.0, 8.0), right=(1, 0, 0), up=(0, 0, 1), forward=(0, 1, 0),",
                   "                    tan_half_width=0.5, resolution=(640, 360))",
                   "grids = [sea.grid(view)]",
                   "def foam(t):",
                   "    sea.ask_foam(t, grids)",
                   "    while sea.is_foam_busy: time.sleep(0.001)",
                   "    return sea.take_foam()['foam_nodes']"]

    def test_a_program_ends_while_a_sea_makes_its_foam(self):
        for wait in ("pass", "time.sleep(0.05)", "foam(3.0)"):
            self.end_of([*self.LIVING_FOAM, wait, "sea.ask_foam(500.0, grids)", "kept = [sea]; kept.append(kept)"])

    def test_a_forked_process_is_told_how_to_compute(self):
        """TBB's threads aren't in it. What was made before is left alone, and the process ends."""
        for before in ([], ["foam(3.0)"], ["foam(3.0)", "sea.ask_foam(500.0, grids)"]):
            self.end_of([*self.LIVING_FOAM,
                         *before,
                         "child = os.fork()",
                         "if child == 0:",
                         "    assert not sea.is_foam_busy",
                         "    for work in (lambda: foam(3.0), lambda: sea.set(1.0), lambda: pelagic.Sea(scene),",
                         "                 lambda: pelagic.Sea.begin(scene), lambda: pelagic.begin_bake(scene, 'out')):",
                         "        try: work()",
                         "        except RuntimeError as error: assert 'spawn' in str(error), error",
                         "        else: raise AssertionError('a forked process computed')",
                         "else:",
                         "    end = time.monotonic() + 60",
                         "    done = (0, 0)",
                         "    while done[0] == 0 and time.monotonic() < end:",
                         "        done = os.waitpid(child, os.WNOHANG)",
                         "        time.sleep(0.01)",
                         "    if done[0] == 0: os.kill(child, 9)",
                         "    assert done == (child, 0), done"])

    def test_a_process_forked_before_any_work_computes(self):
        self.end_of(["child = os.fork()",
                     "pelagic.Sea(scene)",
                     "if child != 0: assert os.waitpid(child, 0)[1] == 0"])


if __name__ == "__main__":
    unittest.main()
