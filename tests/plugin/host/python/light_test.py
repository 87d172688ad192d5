"""Sky, water and the sea's light on arrays."""

import math
import tempfile
import unittest

import numpy as np
import pelagic


def scene_with_sun(elevation_deg=25.0, azimuth_deg=40.0):
    scene = pelagic.Scene()
    scene.light.sun_elevation_deg, scene.light.sun_azimuth_deg = elevation_deg, azimuth_deg
    return scene


def vectors(count, value):
    return np.tile(np.float32(value), (count, 1))


class Sky(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sky = pelagic.Sky(scene_with_sun())

    def test_the_sun_is_where_the_scene_has_it(self):
        elevation, azimuth = math.radians(25.0), math.radians(40.0)
        np.testing.assert_allclose(self.sky.sun_direction, (math.cos(elevation) * math.cos(azimuth),
                                                            math.cos(elevation) * math.sin(azimuth),
                                                            math.sin(elevation)), atol=1e-4)
        solid_angle = math.pi * self.sky.sun_angular_radius**2
        np.testing.assert_allclose(self.sky.sun_irradiance,
                                   np.float32(self.sky.sun_radiance) * solid_angle * self.sky.sun_direction[2],
                                   rtol=1e-3)
        self.assertTrue(all(value > 1.0 for value in self.sky.sky_irradiance))
        self.assertEqual(pelagic.Sky(scene_with_sun(-20.0)).sun_radiance, (0.0, 0.0, 0.0))

    def test_the_image_is_the_radiance_in_each_pixels_direction(self):
        width = 1024
        image = self.sky.image(width)
        self.assertEqual((image.shape, image.dtype), ((width // 2, width, 3), np.float32))
        rows, columns = np.meshgrid(np.arange(0, 250, 5), np.arange(0, width, 7), indexing="ij")
        elevation = math.pi / 2 - (rows.ravel() + 0.5) * math.pi / (width // 2)
        azimuth = math.pi - (columns.ravel() + 0.5) * 2 * math.pi / width
        directions = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                               np.sin(elevation)], axis=1).astype(np.float32)
        np.testing.assert_allclose(self.sky.radiance(directions), image[rows.ravel(), columns.ravel()], rtol=0.03)
        for wrong in (7, 9, 0):
            with self.assertRaisesRegex(ValueError, "accepted"):
                self.sky.image(wrong)

    def test_the_light_of_spray_is_brightest_towards_the_sun(self):
        scene = scene_with_sun()
        scene.sea.wind_speed_mps, scene.effects.spray = 20.0, True
        image = self.sky.spray_image(scene, 64)
        self.assertEqual(image.shape, (32, 64, 3))
        row, column = divmod(int(image[..., 1].argmax()), 64)
        pixel = 360.0 / 64
        self.assertLess(abs(90.0 - (row + 0.5) * pixel - 25.0), pixel)
        self.assertLess(abs(180.0 - (column + 0.5) * pixel - 40.0), pixel)
        # Isotropic light comes out as it is: on average over all directions sky, sea and a sun spread over all of them.
        weight = np.cos(np.pi / 2 - (np.arange(32) + 0.5) * np.pi / 32)[:, None]
        mean = (image[..., 1] * weight).sum() / (weight.sum() * 64)
        sun = self.sky.sun_irradiance[1] / self.sky.sun_direction[2] / (4 * np.pi)
        self.assertTrue(0.9 * sun < mean < sun + self.sky.sky_irradiance[1] / np.pi + self.sky.sun_irradiance[1] / np.pi, (mean, sun))
        with self.assertRaisesRegex(ValueError, "accepted"):
            self.sky.spray_image(scene, 7)

    def test_radiance_is_written_into_the_callers_array(self):
        directions = vectors(1000, (0.0, 0.6, 0.8))
        wide = np.full((1000, 5), 9.0, np.float32)
        self.assertIs(type(self.sky.radiance(directions, out=wide[:, 1:4])), np.ndarray)
        np.testing.assert_array_equal(wide[:, 1:4], self.sky.radiance(directions))
        apart = np.zeros((3, len(directions)), np.float32).T
        np.testing.assert_array_equal(self.sky.radiance(np.asfortranarray(directions), out=apart), wide[:, 1:4])
        np.testing.assert_array_equal(wide[:, [0, 4]], 9.0)
        with self.assertRaisesRegex(ValueError, "out: its shape"):
            self.sky.radiance(directions, out=np.zeros((3, 3), np.float32))

    def test_a_picture_that_cannot_be_read_is_named(self):
        with tempfile.NamedTemporaryFile(suffix=".exr") as file:
            scene = pelagic.Scene()
            scene.light.sky = file.name
            with self.assertRaisesRegex(ValueError, file.name):
                pelagic.Sky(scene)


class Shade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scene = scene_with_sun()
        cls.sky, cls.water = pelagic.Sky(scene), pelagic.WaterBody(scene)
        cls.up = vectors(300, (0.0, 0.0, 1.0))
        cls.to_eye = vectors(300, (-0.6, 0.0, 0.8))
        cls.rough = vectors(300, (0.02, 0.02, 0.0))

    def lit(self, **changes):
        arguments = dict(to_eye=self.to_eye, normal=self.up, slope_variance=self.rough)
        return pelagic.shade(self.sky, self.water, **dict(arguments, **changes))

    def test_layers_are_written_into_arrays_of_any_strides(self):
        plain = self.lit()
        apart = np.zeros((6, len(plain["sky"])), np.float32).T[:, ::2]
        made = self.lit(normal=np.asfortranarray(self.up), sky_layer=apart)
        self.assertIs(made["sky"], apart)
        np.testing.assert_array_equal(apart, plain["sky"])

    def test_a_mirror_reflects_the_sky_by_fresnel(self):
        lit = self.lit(slope_variance=vectors(300, (1e-7, 1e-7, 0.0)))
        # Unpolarised light on water of index 1.34 at 36.87° (Fresnel's equations).
        cos_in = 0.8
        cos_out = math.sqrt(1 - (0.6 / 1.34)**2)
        s = (cos_in - 1.34 * cos_out) / (cos_in + 1.34 * cos_out)
        p = (cos_out - 1.34 * cos_in) / (cos_out + 1.34 * cos_in)
        mirrored = self.sky.radiance(vectors(1, (0.6, 0.0, 0.8)))
        # The fit of the Fresnel term is good to some per cent; the map's texel is a degree wide.
        np.testing.assert_allclose(lit["sky"][:1], 0.5 * (s * s + p * p) * mirrored, rtol=0.08)
        np.testing.assert_array_equal(lit["foam"], 0.0)

    def test_water_has_the_colour_of_what_is_in_it(self):
        turbid = scene_with_sun()
        turbid.water.type = "turbid"
        murky = pelagic.WaterBody(turbid)
        clear = self.lit()["sea"][0]
        muddy = pelagic.shade(self.sky, murky, self.to_eye, self.up, self.rough)["sea"][0]
        # A body's light goes by the sun's way as well: to a tenth it is as bright as its reflectance.
        np.testing.assert_allclose(clear * np.float32(murky.reflectance), muddy * np.float32(self.water.reflectance),
                                   rtol=0.1)
        self.assertGreater(muddy[0], 3.0 * clear[0])
        self.assertTrue(all(m > c for m, c in zip(murky.backscatter_per_m, self.water.backscatter_per_m)))
        self.assertGreater(self.water.absorption_per_m[0], 5.0 * self.water.absorption_per_m[2])

    def test_a_rough_sea_lets_in_more_of_a_low_sun(self):
        low, level = (math.cos(0.05), 0.0, math.sin(0.05)), scene_with_sun()
        level.water.body = False
        rough, flat = (water.entering(low) for water in (pelagic.WaterBody(scene_with_sun()), pelagic.WaterBody(level)))
        self.assertGreater(rough, 0.7)
        self.assertLess(flat, 0.4)
        self.assertEqual(pelagic.WaterBody(level).entering((1.0, 0.0, -0.1)), pelagic.WaterBody(level).entering((1.0, 0.0, 0.0)))

    def test_the_water_as_a_diffuse_surface(self):
        def albedo(water, **points):
            return pelagic.water_albedo(self.sky, water, self.to_eye, **points)

        # The light of the lit sea, before what the surface keeps: of a level one Fresnel's part, at 36.87 degrees 0.0231.
        irradiance = np.array(self.sky.sun_irradiance) + np.array(self.sky.sky_irradiance)
        level = albedo(self.water)
        sea = self.lit(slope_variance=vectors(300, (1e-7, 1e-7, 0.0)))["sea"]
        np.testing.assert_allclose(level * irradiance / np.pi * (1.0 - 0.0231), sea, rtol=5e-3)
        plain = scene_with_sun()
        plain.water.body = False
        self.assertTrue((albedo(pelagic.WaterBody(plain)) != level).any())
        # Bubbles: the more foam, the brighter, and less under what is old.
        foam = np.linspace(0.0, 1.0, 300).astype(np.float32)
        fresh = albedo(self.water, coverage=foam)
        old = albedo(self.water, coverage=foam, foam_active=0.0 * foam, foam_age=0.0 * foam + 5.0)
        np.testing.assert_allclose(fresh[0], level[0], atol=1e-6)
        self.assertTrue((np.diff(fresh[:, 1]) > 0.0).all() and (old < fresh)[1:, 1].all() and (old > level)[1:, 1].all())
        np.testing.assert_allclose(albedo(self.water, coverage=foam, foam_active=0.0 * foam, foam_age=0.0 * foam), fresh, atol=1e-6)
        # Many that differ by their foam alone are looked up in a table; beside one that differs otherwise each is computed.
        crest = np.zeros((300, 3), np.float32)
        crest[0] = (0.2, 0.0, 0.5)
        np.testing.assert_allclose(albedo(self.water, coverage=foam, crest=crest)[1:], fresh[1:], atol=2e-4)
        # A face towards the sun has more of its light than one that leans away, and out keeps what else its array holds.
        towards = np.sign(self.sky.sun_direction[0])
        crest[:, 0] = np.where(foam > 0.5, -0.3, 0.3) * towards
        wide = np.full((300, 5), 9.0, np.float32)
        pelagic.water_albedo(self.sky, self.water, self.up, crest=crest, out=wide[:, 1:4])
        self.assertTrue((wide[250, 2:4] > 1.05 * wide[50, 2:4]).all(), wide[[50, 250]])
        np.testing.assert_array_equal(wide[:, [0, 4]], 9.0)
        with self.assertRaisesRegex(ValueError, "coverage: its shape"):
            albedo(self.water, coverage=foam[:3])

    def test_an_eye_in_the_water_sees_the_water_and_its_floor(self):
        down, level = vectors(2, (0.0, 0.0, -1.0)), vectors(2, (1.0, 0.0, 0.0))
        deep = [pelagic.water_radiance(self.sky, self.water, down, depth)[0] for depth in (0.0, 10.0, 40.0)]
        irradiance = np.array(self.sky.sun_irradiance) + np.array(self.sky.sky_irradiance)
        # Just below the surface the light that comes up is that of the water's reflectance, of all that enters.
        np.testing.assert_allclose(deep[0][1:], (np.array(self.water.reflectance) * irradiance / np.pi)[1:], rtol=0.25)
        self.assertTrue((deep[1] < deep[0])[1:].all() and (deep[2] < deep[1])[1:].all())
        lagoon = scene_with_sun()
        lagoon.sea.depth_m, lagoon.water.floor_colour = 3.0, (0.5, 0.5, 0.5)
        water = pelagic.WaterBody(lagoon)
        floor = pelagic.water_radiance(self.sky, water, down, 2.9)[0]
        # Half of what it sends up comes down again.
        self.assertTrue((floor > 3.0 * deep[0]).all() and (floor < 0.5 * irradiance / np.pi / (1.0 - 0.5 * 0.5)).all())
        self.assertTrue((pelagic.water_radiance(self.sky, water, level, 1.0)[0] < floor).all())
        np.testing.assert_allclose(water.lets_through(0.0), 1.0, atol=1e-3)
        near, far = water.lets_through(2.0), water.lets_through(4.0)
        np.testing.assert_allclose(np.square(near[2]), far[2], rtol=0.05)
        self.assertTrue(near[0] < near[2] and all(0.0 < b < a < 1.0 for a, b in zip(near, far)))
        out = np.zeros((2, 3), np.float32)
        self.assertIs(pelagic.water_radiance(self.sky, water, down, 2.9, out=out), out)
        np.testing.assert_array_equal(out[0], floor)
        plain = scene_with_sun()
        plain.water.body = False
        for ask in (lambda: pelagic.water_radiance(self.sky, pelagic.WaterBody(plain), down, 1.0), lambda: pelagic.WaterBody(plain).lets_through(1.0),
                    lambda: pelagic.water_radiance(self.sky, water, down, -1.0), lambda: water.lets_through(math.nan),
                    lambda: pelagic.water_radiance(self.sky, water, down, math.inf)):
            self.assertRaises(ValueError, ask)

    def test_foam_takes_its_share(self):
        none, half, full = (self.lit(coverage=np.full(300, share, np.float32)) for share in (0.0, 0.5, 1.0))
        for name, array in self.lit().items():
            np.testing.assert_array_equal(none[name], array, name)
        self.assertTrue((half["foam"] > 0.0).all() and (half["foam"] < full["foam"]).all())
        self.assertTrue((half["sky"] < none["sky"]).all())

    def test_layers_are_written_into_the_callers_arrays(self):
        wide = np.full((300, 7), 9.0, np.float32)
        foam = np.zeros((300, 3), np.float32)
        written = self.lit(sea_layer=wide[:, 2:5], foam_layer=foam, coverage=np.full(300, 0.3, np.float32))
        self.assertEqual(sorted(written), ["foam", "sea", "sky", "sun"])
        self.assertIs(written["foam"], foam)
        np.testing.assert_array_equal(wide[:, 2:5], self.lit(coverage=np.full(300, 0.3, np.float32))["sea"])
        np.testing.assert_array_equal(wide[:, [0, 1, 5, 6]], 9.0)

    def test_glitter_comes_from_the_suns_side(self):
        x, y, z = self.sky.sun_direction
        towards, away = self.lit(to_eye=vectors(300, (-x, -y, z))), self.lit(to_eye=vectors(300, (x, y, z)))
        self.assertGreater(towards["sun"][0, 1], 100.0 * away["sun"][0, 1])

    def test_better_skies_differ_a_little(self):
        by_word = {word: self.lit(sky_quality=word)["sky"][0] for word in ("one", "nine", "integral")}
        np.testing.assert_allclose(by_word["nine"], by_word["integral"], rtol=0.05)
        self.assertFalse((by_word["nine"] == by_word["integral"]).all())
        self.assertFalse((self.lit(fresnel="paper")["sky"][0] == by_word["nine"]).all())

    def test_what_does_not_fit_is_refused(self):
        for said, wrong in (("normal", dict(normal=self.up.astype(np.float64))),
                            ("to_eye", dict(to_eye=self.to_eye[:7])),
                            ("coverage", dict(coverage=np.zeros((300, 1), np.float32))),
                            ("sky_quality", dict(sky_quality="ten")), ("fresnel", dict(fresnel="schlick"))):
            with self.assertRaisesRegex((TypeError, ValueError), said + ".*accepted"):
                self.lit(**wrong)


if __name__ == "__main__":
    unittest.main()
