"""Cages from arrays and files, their limit surfaces, and the sea on them."""

import math
import os
import tempfile
import unittest

import numpy as np
import pelagic

CUBE = dict(points=[[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], face_counts=[4] * 6,
            indices=[0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 1, 3, 7, 5, 3, 2, 6, 7, 2, 0, 4, 6])


def sheet(side=6, z=0.0):
    """A sheet of side² quads of 5 m: points, counts, indices."""
    x, y = np.meshgrid(np.arange(side + 1), np.arange(side + 1))
    points = np.stack([5.0 * x - 2.5 * side, 5.0 * y - 2.5 * side, 0.0 * x + z], -1).reshape(-1, 3)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    return points, np.full(side * side, 4), (first[:, None] + [0, 1, side + 2, side + 1]).ravel()


class Cages(unittest.TestCase):
    def test_arrays_of_any_type_make_one(self):
        cage = pelagic.Cage(**CUBE)
        self.assertEqual((cage.points, cage.faces), (8, 6))
        self.assertTrue(cage.content.startswith("6 faces, 8 points, "))
        same = pelagic.Cage(np.float32(CUBE["points"]), np.uint8(CUBE["face_counts"]), np.int64(CUBE["indices"]))
        self.assertEqual(cage, same)
        sharp = pelagic.Cage(**CUBE, creases=[[0, 1], [4, 5]], crease_sharpness=2.5, corners=[7], holes=[1])
        self.assertNotEqual(cage, sharp)
        self.assertEqual(sharp, pelagic.Cage(**CUBE, creases=[[0, 1], [4, 5]], crease_sharpness=[2.5, 2.5], corners=[7],
                                             corner_sharpness=10, holes=[1]))

    def test_what_is_no_cage_is_refused_in_words(self):
        for wrong, words in ((dict(indices=CUBE["indices"][:-1]), "23 indices for 24 corners"),
                             (dict(indices=[9] + CUBE["indices"][1:]), "face 0 has the point 9; accepted: points 0 … 7"),
                             (dict(face_counts=[2] + [4] * 5), "face 0 has 2 corners"),
                             (dict(face_counts=[], indices=[]), "has no faces"),
                             (dict(points=[[math.nan, 0, 0]] + CUBE["points"][1:]), "point 0 is at nan"),
                             (dict(creases=[[0, 7]]), "crease 0 lies between"),
                             (dict(creases=[0, 7]), r"creases: accepted: whole numbers of shape \(n, 2\)"),
                             (dict(holes=[0.5]), "holes: accepted: whole numbers"),
                             (dict(holes=[2**40]), "of 32 bits"),
                             (dict(creases=[[0, 1]], crease_sharpness=[1, 2]), "crease_sharpness: accepted"),
                             (dict(creases=[[0, 1]], crease_sharpness=-1), "from 0 up"),
                             (dict(points=CUBE["points"][0]), r"points: accepted: numbers of shape \(n, 3\)"),
                             (dict(boundary="round"), "boundary: accepted")):
            with self.assertRaisesRegex(ValueError, words):
                pelagic.Cage(**{**CUBE, **wrong})

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.obj")
            with open(path, "w", encoding="utf-8") as file:
                file.write("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
            cage = pelagic.Cage.from_file(path)
            self.assertEqual(cage.faces, 1)
            scene = pelagic.Scene.from_text("[surface]\nkind = 'cage'\ncage_file = 'a.obj'\n", folder)
            self.assertEqual(scene.surface.cage, cage)
            self.assertEqual(scene.surface.cage_level, 2)
            again = pelagic.Scene.from_text(scene.shot_text(), "elsewhere")
            self.assertEqual(again.surface.cage, cage)
            with open(path, "a", encoding="utf-8") as file:
                file.write("f 1 2\n")
            with self.assertRaisesRegex(ValueError, "a.obj:5: the face has 2 corners"):
                pelagic.Cage.from_file(path)
            with self.assertRaisesRegex(ValueError, "does not exist"):
                pelagic.Cage.from_file(os.path.join(folder, "b.obj"))

    def test_a_scene_takes_one(self):
        scene = pelagic.Scene()
        self.assertIsNone(scene.surface.cage)
        scene.surface.cage = pelagic.Cage(**CUBE)
        self.assertTrue(any("leaves a cage unused" in line for line in scene.validate()))
        scene.surface.kind = "cage"
        scene.surface.cage_level = "adaptive"
        self.assertEqual((scene.surface.cage_level, scene.validate()), ("adaptive", []))
        with self.assertRaisesRegex(ValueError, "came from no file"):
            scene.shot_text()
        with self.assertRaisesRegex(ValueError, 'is not the word "adaptive"'):
            scene.surface.cage_level = "fine"
        with self.assertRaisesRegex(TypeError, "accepted: a Cage, or None"):
            scene.surface.cage = 3
        scene.surface.cage = None
        self.assertTrue(any("comes without a cage" in line for line in scene.validate()))


class Surfaces(unittest.TestCase):
    def test_a_cubes_limit_is_round(self):
        surface = pelagic.CageSurface(pelagic.Cage(**CUBE), 3)
        made = surface.limit()
        place = np.column_stack([made["rest_m"], made["height_m"]])
        self.assertEqual(len(place), 6 * 64 + 2)
        self.assertEqual(made["origin_m"], (0.0, 0.0))
        radius = np.linalg.norm(place, axis=1)
        self.assertLess(radius.max() / radius.min(), 1.2)
        self.assertGreater((place * made["normal"]).sum(1).min(), 0.0)  # outwards
        self.assertTrue((surface.face_counts == 4).all())
        self.assertEqual(surface.indices.max(), len(place) - 1)
        self.assertEqual(surface.st.shape, (len(place), 2))
        self.assertTrue((made["cell_m"] > 0).all())

    def test_points_that_move_use_the_same_stencils(self):
        cage = pelagic.Cage(**CUBE)
        surface = pelagic.CageSurface(cage, 2)
        moved = 2.0 * np.array(CUBE["points"]) + [1e5, 3.0, 5.0]
        made, still = surface.limit(moved), surface.limit()
        place = np.column_stack([made["rest_m"] + np.array(made["origin_m"]), made["height_m"]])
        expected = 2.0 * np.column_stack([still["rest_m"], still["height_m"]]) + [1e5, 3.0, 5.0]
        np.testing.assert_allclose(place, expected, atol=2e-4)
        np.testing.assert_allclose(made["normal"], still["normal"], atol=1e-6)
        for wrong in (moved[:7], moved[:, :2], np.full((8, 3), math.nan), np.full((8, 3), 1e7)):
            with self.assertRaisesRegex(ValueError, "points: accepted"):
                surface.limit(wrong)
        with self.assertRaisesRegex(ValueError, "level: accepted"):
            pelagic.CageSurface(cage, 7)

    def test_the_sea_on_a_flat_sheet_is_the_sea_above_it(self):
        scene = pelagic.Scene()
        scene.waves.cascades = [pelagic.CascadeSize(60.0, 64)]
        sea = pelagic.Sea(scene, cell_m=1.25, pixel_m=1.25)
        frame = pelagic.Frame(sea)
        frame.set(2.0)
        made = pelagic.CageSurface(pelagic.Cage(*sheet(z=3.0)), 2).limit()
        flat = frame.evaluate(made["rest_m"], outputs=("position", "normal"))
        on = frame.evaluate(made["rest_m"], made["origin_m"], rest_normal=made["normal"], outputs=("position", "normal"))
        np.testing.assert_allclose(on["normal"], flat["normal"], atol=1e-6)
        np.testing.assert_array_equal(on["position"], flat["position"])
        self.assertTrue((made["height_m"] == 3.0).all())
        with self.assertRaisesRegex(ValueError, "rest_normal"):
            frame.evaluate(made["rest_m"], rest_normal=made["normal"][:3])

    def test_a_bake_of_it_is_what_the_module_says(self):
        points, counts, indices = sheet()
        points[:, 2] = 0.04 * points[:, 0] * np.abs(points[:, 1])
        scene = pelagic.Scene()
        scene.shot.frames = (1, 1)
        scene.waves.cascades = [pelagic.CascadeSize(60.0, 64)]
        scene.surface.kind, scene.surface.cage_level = "cage", 2
        scene.surface.cage = pelagic.Cage(points, counts, indices)
        scene.effects.whitecaps = False
        made = pelagic.CageSurface(scene.surface.cage, 2).limit()
        with tempfile.TemporaryDirectory() as folder:
            pelagic.bake(scene, folder)
            arrays = pelagic.read_mesh(os.path.join(folder, "mesh", "sea.0001.usdc"))
        self.assertEqual(len(arrays["position"]), len(made["rest_m"]))
        sea = arrays["position"] - np.column_stack([made["rest_m"], made["height_m"]])
        self.assertLess(np.abs(sea).max(), 5.0)
        self.assertGreater(sea[:, 2].std(), 0.1)  # there are waves
        scene.sea.wind_speed_mps = 0.0
        with tempfile.TemporaryDirectory() as folder:
            pelagic.bake(scene, folder)
            arrays = pelagic.read_mesh(os.path.join(folder, "mesh", "sea.0001.usdc"))
        np.testing.assert_allclose(arrays["position"], np.column_stack([made["rest_m"], made["height_m"]]), atol=1e-5)
        np.testing.assert_allclose(arrays["normal"], made["normal"], atol=1e-5)


if __name__ == "__main__":
    unittest.main()
