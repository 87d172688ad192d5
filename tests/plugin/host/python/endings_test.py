"""Objects without a value, callbacks that fail, and programs that end while a thread works."""

import copy
import inspect
import os
import pathlib
import pickle
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest

import numpy as np
import pelagic

NO_VALUE = ("was not called has no value", "non-held")
CLASSES = [each for _, each in inspect.getmembers(pelagic, inspect.isclass)
           if type(each).__name__ == "pybind11_type" and each.__module__ == "pelagic"]


def small_scene():
    scene = pelagic.Scene()
    scene.waves.cascades = [pelagic.CascadeSize(60.0, 32)]
    scene.surface.resolution = 8
    scene.camera.resolution = (32, 20)
    return scene


def arguments():
    """What some method of the module takes."""
    scene = small_scene()
    sea = pelagic.Sea(scene)
    places = np.zeros((4, 2))
    one = [1.0, 1, "x", scene, sea, pelagic.Frame(sea), places, np.zeros((4, 3)), {}]
    return [(), *((each,) for each in one), (1.0, places), (places, 1.0), (scene, 1), (1, scene), (1.0, 1.0)]


class WithoutAValue(unittest.TestCase):
    def use(self, thing):
        """How often each member of the object said that it has no value; anything else must be a TypeError as well."""
        said = 0
        for name in dir(type(thing)):
            if name.startswith("__"):
                continue
            try:
                member = getattr(thing, name)
            except TypeError as error:
                said += any(words in str(error) for words in NO_VALUE)
                continue
            if isinstance(inspect.getattr_static(type(thing), name), staticmethod) or not callable(member):
                continue
            for given in ARGUMENTS:
                with self.assertRaises(TypeError, msg=f"{type(thing).__name__}.{name}{given}") as caught:
                    member(*given)
                said += any(words in str(caught.exception) for words in NO_VALUE)
        return said

    def test_every_class_refuses_to_be_used_before_it_is_made(self):
        self.assertGreater(len(CLASSES), 12)
        for each in CLASSES:
            with self.subTest(each.__name__):
                members = [name for name in dir(each) if not name.startswith("__")]
                said = self.use(each.__new__(each))
                if members:
                    self.assertGreater(said, 0, "none of its members was reached")

    def test_a_frame_that_was_never_made_is_not_set(self):
        with self.assertRaisesRegex(TypeError, "no value"):
            pelagic.Frame.__new__(pelagic.Frame).set(1)

    def test_every_class_refuses_a_subclass_that_forgets_it(self):
        for each in CLASSES:
            with self.subTest(each.__name__):
                class Forgets(each):
                    def __init__(self):
                        pass

                class UsesItFirst(each):
                    def __init__(self):
                        for name in dir(each):
                            if not name.startswith("__") and not callable(getattr(each, name)):
                                getattr(self, name)
                        raise TypeError("none of these has a value")

                for wrong in (Forgets, UsesItFirst):
                    with self.assertRaises(TypeError):
                        wrong()

    def test_every_class_is_copied_whole_or_not_at_all(self):
        scene = small_scene()
        made = {pelagic.Scene: scene, pelagic.Sea: pelagic.Sea(scene), pelagic.Cancel: pelagic.Cancel(),
                pelagic.Sky: pelagic.Sky(scene), pelagic.WaterBody: pelagic.WaterBody(scene)}
        made[pelagic.Frame] = pelagic.Frame(made[pelagic.Sea])
        for each, thing in made.items():
            for way in (copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))):
                with self.subTest(each.__name__):
                    try:
                        way(thing)
                    except (TypeError, pickle.PicklingError):
                        continue
                    self.assertIs(each, pelagic.Scene)
        self.assertEqual(copy.copy(scene).camera.resolution, (32, 20))
        for each in CLASSES:
            with self.subTest(each.__name__):
                try:
                    copied = copy.copy(each.__new__(each))
                except TypeError:
                    continue
                self.use(copied)


class Cancelling(unittest.TestCase):
    def test_a_callback_that_fails_ends_its_own_work_alone(self):
        def fails(*_):
            raise RuntimeError("a mistake of the caller's")

        cancel = pelagic.Cancel()
        with tempfile.TemporaryDirectory() as folder:
            for work in (lambda: pelagic.bake(small_scene(), folder, progress=fails, cancel=cancel),
                         lambda: pelagic.Sea(small_scene(), progress=fails, cancel=cancel),
                         lambda: pelagic.Maps(small_scene(), progress=fails, cancel=cancel),
                         lambda: pelagic.render(small_scene(), 1, progress=fails, cancel=cancel)):
                with self.assertRaisesRegex(RuntimeError, "a mistake of the caller's"):
                    work()
                self.assertFalse(cancel.is_set)
            self.assertFalse(pelagic.bake(small_scene(), folder, frames=1, cancel=cancel).cancelled)

    def test_one_cancel_ends_all_that_was_begun_with_it_and_all_that_is(self):
        cancel, begun, reports = pelagic.Cancel(), threading.Barrier(3), []
        scene = small_scene()
        scene.shot.frames = (1, 4000)

        def bake(folder):
            first = []
            reports.append(pelagic.bake(scene, folder, cancel=cancel,
                                        progress=lambda *_: first or (first.append(True), begun.wait(60))))

        with tempfile.TemporaryDirectory() as folder:
            threads = [threading.Thread(target=bake, args=(pathlib.Path(folder) / name,)) for name in "ab"]
            for thread in threads:
                thread.start()
            begun.wait(60)
            cancel.set()
            for thread in threads:
                thread.join()
            self.assertEqual([report.cancelled for report in reports], [True, True])
            self.assertTrue(pelagic.bake(scene, folder, cancel=cancel).cancelled)
        self.assertTrue(cancel.is_set)


class AtTheEnd(unittest.TestCase):
    def end_of(self, work):
        """A program that ends while a daemon thread does this."""
        with tempfile.TemporaryDirectory() as folder:
            program = textwrap.dedent("""
                import sys, threading, time, pelagic
                scene = pelagic.Scene()
                scene.waves.cascades = [pelagic.CascadeSize(60.0, 128)]
                scene.surface.resolution, scene.camera.resolution = 32, (64, 40)
                scene.shot.frames = (1, 4000)
                begun = threading.Event()
                def tell(*_):
                    begun.set()
                def work():
                    try:
                        while True:
                            WORK
                    except pelagic.Cancelled:
                        pass
                threading.Thread(target=work, daemon=True).start()
                begun.wait(60)
                time.sleep(0.05)
                """).replace("WORK", work)
            done = subprocess.run([sys.executable, "-c", program], cwd=folder, env=os.environ, timeout=120,
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), work)

    def test_work_in_a_daemon_thread_is_ended(self):
        for work in ("pelagic.bake(scene, 'out', progress=tell)", "pelagic.bake(scene, 'out', cancel=tell)",
                     "pelagic.render(scene, 1, progress=tell)", "pelagic.Sea(scene, progress=tell)",
                     "tell(); frame = pelagic.Frame(pelagic.Sea(scene)); [frame.set(t) for t in range(10000)]"):
            for _ in range(3):
                self.end_of(work)

    def test_numpy_is_imported_with_the_module(self):
        """Later it would be within our C++, and a thread that the program's end meets there takes the program with it."""
        program = "import sys, pelagic; sys.exit('numpy.core.multiarray' not in sys.modules)"
        self.assertEqual(subprocess.run([sys.executable, "-c", program], env=os.environ, timeout=120).returncode, 0)


ARGUMENTS = arguments()

if __name__ == "__main__":
    unittest.main()
