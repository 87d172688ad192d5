"""examples/blender-first-look.py inside Blender: the mesh is the sea of its frame, and two pictures come out."""

import importlib.util
import os
import sys
import tempfile
import unittest

import bpy
import numpy as np
import pelagic

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
SHOT = """
[shot]
name = "tiny"
frames = [1, 8]
fps = 4
[sea]
wind_speed_mps = 12.0
[surface]
size_m = 80.0
resolution = 16
[camera]
keys = [ { frame = 1, position_m = [0, -30, 6], look_at_m = [0, 0, 0] },
         { frame = 5, position_m = [8, -30, 6], look_at_m = [4, 0, 0] } ]
"""


def load_example():
    path = os.path.join(ROOT, "examples", "blender-first-look.py")
    spec = importlib.util.spec_from_file_location("first_look", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class FirstLook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.shot_file = os.path.join(cls.folder.name, "tiny.toml")
        with open(cls.shot_file, "w", encoding="utf-8") as file:
            file.write(SHOT)
        cls.look = load_example()
        cls.shot = pelagic.Scene.from_file(cls.shot_file)
        cls.scene, cls.sea = cls.look.make_scene(cls.shot)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def evaluated(self):
        """What Blender shows: the evaluated mesh's points and attributes."""
        mesh = self.sea.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        got = {"position": np.empty((len(mesh.vertices), 3), np.float32)}
        mesh.vertices.foreach_get("co", got["position"].ravel())
        for name, _, numbers, product in self.sea.ATTRIBUTES:
            got[product] = np.empty_like(self.sea.arrays[product])
            mesh.attributes[name].data.foreach_get(numbers, got[product].ravel())
        return got

    def test_the_mesh_is_the_sea_of_the_frame_whichever_came_before(self):
        other = pelagic.Frame(self.sea.frame.sea)
        for frame, subframe in ((5, 0.0), (2, 0.0), (2, 0.25), (2, 0.25), (8, 0.0)):
            self.scene.frame_set(frame, subframe=subframe)
            other.set((frame + subframe - 1) / 4)
            expected = other.evaluate(self.sea.rest, cell_m=self.sea.cell_m, pixel_m=self.sea.cell_m)
            for product, array in self.evaluated().items():
                np.testing.assert_array_equal(array, expected[product], f"{product} at {frame} + {subframe}")

    def test_the_patch_comes_first_and_the_mesh_is_closed_to_the_horizon(self):
        rest, quads = pelagic.patch(80.0, 16)
        mesh = self.sea.object.data
        np.testing.assert_array_equal(self.sea.rest[: len(rest)], rest)
        corners = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        corners = corners.reshape(-1, 4)
        np.testing.assert_array_equal(corners[: len(quads)], quads)
        # Every quad faces up, and together they are the outermost square without gap or overlap: shared edges cancel
        # but for the rounding of double, and the square is as good as single-precision corners at 30 km, 1e-7.
        points = self.sea.rest.astype(np.float64)
        a, b, c, d = (points[corners[:, i]] for i in range(4))
        area = 0.5 * ((c - a)[:, 0] * (d - b)[:, 1] - (c - a)[:, 1] * (d - b)[:, 0])
        self.assertGreater(area.min(), 0.0)
        side = 2 * points.max()
        self.assertGreaterEqual(side / 2, self.look.HORIZON_M)
        self.assertLess(abs(area.sum() / side**2 - 1), 1e-6)
        self.assertEqual(len(mesh.vertices), len(np.unique(corners)))

    def test_the_uv_map_is_the_bakes(self):
        mesh = self.sea.object.data
        uv = np.empty((len(mesh.loops), 2), np.float32)
        mesh.uv_layers["UVMap"].data.foreach_get("uv", uv.ravel())
        patch = uv[: 4 * 16 * 16]
        self.assertEqual((patch.min(), patch.max()), (0.0, 1.0))
        np.testing.assert_allclose(patch[:4], [[0, 0], [1 / 16, 0], [1 / 16, 1 / 16], [0, 1 / 16]], atol=1e-6)

    def test_the_camera_goes_straight_between_its_keys(self):
        for frame, part in ((1, 0.0), (3, 0.5), (5, 1.0), (7, 1.0)):
            self.scene.frame_set(frame)
            matrix = self.scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
            at = np.array([8 * part, -30, 6])
            towards = np.array([4 * part, 0, 0]) - at
            np.testing.assert_allclose(matrix.translation, at, atol=1e-5)
            np.testing.assert_allclose(-np.array(matrix.col[2])[:3], towards / np.linalg.norm(towards), atol=1e-5)
            self.assertAlmostEqual(matrix.col[0][2], 0.0, places=5)  # the horizon is level

    def test_the_sun_stands_where_the_shot_says(self):
        # Blender's sky turns clockwise from +y; ours counter-clockwise from +x. 75° from +x is 15° clockwise from +y.
        self.shot.light.sun_azimuth_deg = 75.0
        world = self.look.make_world(self.shot.light)
        sky = next(node for node in world.node_tree.nodes if node.type == "TEX_SKY")
        self.assertAlmostEqual(np.degrees(sky.sun_rotation), 15.0, places=4)

    def test_two_pictures_come_out_differ_and_are_not_black(self):
        out = os.path.join(self.folder.name, "pictures")
        sys.argv = ["blender", "--", self.shot_file, "--out", out, "--samples", "1", "--size", "64x36",
                    "--frames", "5,8"]  # after the camera's last key: what differs is the sea
        self.look.main()
        self.assertEqual(sorted(os.listdir(out)), ["tiny.0005.png", "tiny.0008.png"])
        pictures = []
        for name in sorted(os.listdir(out)):
            image = bpy.data.images.load(os.path.join(out, name))
            self.assertEqual(tuple(image.size), (64, 36))
            pictures.append(np.array(image.pixels[:]).reshape(36, 64, 4)[..., :3])
        for picture in pictures:
            sky, sea = picture[-6:], picture[:18]
            self.assertGreater(sky.mean(), 0.1)
            self.assertGreater(sea.mean(), 0.05)
            self.assertLess((picture > 0.99).all(axis=2).mean(), 0.1)
        self.assertGreater(np.abs(pictures[0] - pictures[1]).mean(), 0.01)


if __name__ == "__main__":
    outcome = unittest.main(argv=["blender_first_look_test"], exit=False, verbosity=2).result
    sys.exit(0 if outcome.wasSuccessful() else 1)
