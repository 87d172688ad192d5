"""Ctrl-C: whatever takes long is soon left by KeyboardInterrupt, and what was done is kept.

Each case is a program of its own that gets SIGINT. Soon: in time for a patience of which its work would take many times."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest

import pelagic

PATIENCE_S = 20  # what is interrupted here would take minutes

SCENE = """
    import pelagic
    scene = pelagic.Scene()
    scene.waves.model, scene.waves.trains = "trochoid", 300  # a point takes microseconds
    scene.surface.resolution, scene.camera.resolution = 128, (64, 40)
    scene.effects.foam_decay_s = 0.0
    scene.shot.frames = (1, 9000)
    """


class Interrupted(unittest.TestCase):
    def ends(self, folder, lines, after_s=0.0, before="", frames=0):
        """A program that does this is interrupted so long after it has begun to, and after it has baked so many frames, and ends with
        KeyboardInterrupt, and well."""
        program = textwrap.dedent(SCENE) + textwrap.dedent(before) + textwrap.dedent("""
            try:
                print("ready", flush=True)
                WORK
            except KeyboardInterrupt:
                print("interrupted", flush=True)
            else:
                raise SystemExit("it was not interrupted")
            """).replace("WORK", lines)
        with subprocess.Popen([sys.executable, "-c", program], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, env=os.environ) as process:
            try:
                if process.stdout.readline() != "ready\n":
                    self.fail(process.stderr.read())
                time.sleep(after_s)
                while process.poll() is None and self.baked(folder) < frames:
                    time.sleep(0.01)
                process.send_signal(signal.SIGINT)
                out, err = process.communicate(timeout=PATIENCE_S)
            except subprocess.TimeoutExpired:
                self.fail(f"{lines}: goes on after Ctrl-C")
            finally:
                process.kill()
        self.assertEqual((out, err, process.returncode), ("interrupted\n", "", 0), lines)

    @staticmethod
    def baked(folder):
        return len(list((pathlib.Path(folder) / "out" / "mesh").glob("sea.[0-9]*")))

    def test_a_bake_keeps_its_frames_and_goes_on(self):
        """At several moments, into one folder: the first begins, those that follow go on."""
        made = {}
        exec(textwrap.dedent(SCENE), made)
        with tempfile.TemporaryDirectory() as folder:
            out, whole = pathlib.Path(folder) / "out", 0
            for after_s, more in ((0.02, 0), (0.0, 1), (0.2, 5), (0.0, 40)):
                self.ends(folder, "pelagic.bake(scene, 'out')", after_s, frames=whole + more)
                if out.exists():
                    # That frames are still to come is all there is to find.
                    self.assertLessEqual({found.path for found in pelagic.verify(out)}, {"sea.json"})
                self.assertGreaterEqual(self.baked(folder), whole + more)
                whole = self.baked(folder)
            report = pelagic.bake(made["scene"], out, frames=[1, whole, whole + 1])
            self.assertEqual((report.kept, report.done), (2, 1))

    def test_all_that_takes_long_is_left(self):
        """Also where no progress is told and nothing asks Python. Nine programs, half a second each: they alone would find a call that
        doesn't look for signals."""
        arrays = "import numpy as np; up = np.tile(np.float32([0, .6, .8]), (5000000, 1))"
        for before, work in (
                ("", "pelagic.bake(scene, 'out', progress=lambda *_: None)"),
                ("scene.camera.resolution = (1920, 1080)", "pelagic.render(scene, 1, samples=4, sky_quality='integral')"),
                ("scene.quality.max_error, scene.camera.resolution = 1e-3, (1920, 1080)", "pelagic.render(scene, 1)"),
                ("task = pelagic.begin_bake(scene, 'task')", "task.result()"),
                ("task = pelagic.begin_bake(scene, 'task')", "task.wait()"),
                (f"{arrays}; sky, water = pelagic.Sky(scene), pelagic.WaterBody(scene)",
                 "pelagic.shade(sky, water, up, up, 0.02 * up, sky_quality='integral')"),
                (f"{arrays}; rest = np.broadcast_to(up[0, :2], (30000000, 2)); frame = pelagic.Frame(pelagic.Sea(scene)); frame.set(1.0)",
                 "frame.evaluate(rest, outputs=['position'])"),
                ("scene.output.map_resolution = 1024; maps = pelagic.Maps(scene)", "[maps.at(t) for t in range(1000)]"),
                ("scene = pelagic.Scene(); scene.waves.cascades = [pelagic.CascadeSize(60.0, 4096)]",
                 "[pelagic.Frame(pelagic.Sea(scene, cell_m=0.0, pixel_m=0.0)).set(t) for t in range(1000)]"),
        ):
            with self.subTest(work), tempfile.TemporaryDirectory() as folder:
                self.ends(folder, work, 0.3, before)

    def test_other_signals_are_answered_too_and_go_by_without_harm(self):
        """A handler that raises nothing ends nothing; Ctrl-C in a bake of another thread reaches the main thread at once."""
        program = "import os, signal\n" + textwrap.dedent(SCENE) + textwrap.dedent("""
            seen = []
            signal.signal(signal.SIGUSR1, lambda *_: seen.append(1))
            scene.shot.frames = (1, 40)
            told = []
            def tell(stage, frame, done, *_):
                if stage == "frames" and done == 3 and not told:
                    told.append(1)
                    os.kill(os.getpid(), signal.SIGUSR1)
            report = pelagic.bake(scene, "out", progress=tell)
            assert (report.done, seen) == (40, [1]), (report.done, seen)
            """)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-c", program], cwd=folder, env=os.environ, timeout=PATIENCE_S,
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
