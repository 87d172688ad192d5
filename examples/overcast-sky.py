"""Paints an overcast sky as a lat-long picture: the CIE's overcast distribution with soft clouds in it.

    blender -b --factory-startup -P examples/overcast-sky.py -- OUT.exr [storm]

Makes examples/data/overcast.exr, and storm.exr: darker, heavier clouds, rain below them all round, and a gap of light. Radiance in kcd/m², linear Rec. 709; the middle column is +x, azimuth grows to
the left, the top row is the zenith.
"""

import sys
from dataclasses import dataclass

import bpy
import numpy as np

WIDTH, HEIGHT = 512, 256
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear Rec. 709
EARTH_KM = 6371.0
OCTAVES = 6


@dataclass
class Look:
    illuminance: float  # [klx] on the ground
    base_km: float  # of the clouds
    largest_km: float  # clouds
    contrast: float  # of the clouds: exponent on a noise of variance about 0.1
    glow: float  # of the sun behind the clouds
    glow_deg: tuple  # its azimuth, elevation and width
    away: float = 0.0  # what opposite the sun lacks, 0 … 1
    rain: float = 0.0  # what it takes of the light at the horizon, 0 … 1
    thin: tuple = (1.02, 1.0, 0.95)  # tints: grey-blue for thick clouds
    thick: tuple = (0.90, 0.99, 1.20)


LOOKS = {
    "overcast": Look(15.0, 1.5, 5.0, 0.8, 0.6, (20.0, 35.0, 22.0)),  # an ordinary grey day
    "storm": Look(9.0, 1.2, 6.0, 1.5, 2.0, (20.0, 30.0, 28.0), 0.75, 0.5, (1.04, 1.0, 0.92), (0.92, 0.99, 1.13)),
}
RAIN_DEG = 9.0  # up to which it is seen


def lattice(x, y, octave):
    """A random number in −1 … 1 for each pair of integers."""
    with np.errstate(over="ignore"):  # the products are meant to wrap modulo 2³²
        h = x.astype(np.uint32) * np.uint32(0x9E3779B1) ^ y.astype(np.uint32) * np.uint32(0x85EBCA77)
        h ^= np.uint32(octave) * np.uint32(0xC2B2AE3D)
        for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39)):
            h = (h ^ (h >> np.uint32(shift))) * np.uint32(factor)
        h ^= h >> np.uint32(15)
    return h / 2.0**31 - 1.0


def noise(x, y, octave):
    """Interpolates smoothly between the lattice's numbers."""
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    s, t = x - i, y - j
    s, t = s**3 * (s * (6 * s - 15) + 10), t**3 * (t * (6 * t - 15) + 10)
    low = (1 - s) * lattice(i, j, octave) + s * lattice(i + 1, j, octave)
    high = (1 - s) * lattice(i, j + 1, octave) + s * lattice(i + 1, j + 1, octave)
    return (1 - t) * low + t * high


def clouds(direction, look):
    """Noise on the clouds' base, a sphere round the earth, without details smaller than a pixel."""
    up = direction[..., 2]
    radius = EARTH_KM * up
    distance = -radius + np.sqrt(radius**2 + look.base_km * (2 * EARTH_KM + look.base_km))
    x, y = direction[..., 0] * distance, direction[..., 1] * distance
    # The length of cloud base in a pixel, which grows where it is seen at a slant.
    slant = np.sqrt(up**2 + 2 * look.base_km / EARTH_KM)
    footprint = distance * np.pi / HEIGHT / slant
    total = np.zeros_like(up)
    for octave in range(OCTAVES):
        size = look.largest_km / 2.0**octave
        turn = 0.6 * octave  # rotates the lattices against each other
        u, v = np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y
        seen = np.exp(-((footprint / size) ** 2))
        total += seen * 0.6**octave * noise(u / size + 17.3 * octave, v / size - 9.1 * octave, octave)
    return total


def sky(direction, look):
    up = np.maximum(direction[..., 2], 0.0)
    overcast = (1 + 2 * up) / 3  # Moon & Spencer 1942, later the CIE standard overcast sky
    cloud = clouds(np.concatenate([direction[..., :2], up[..., None]], axis=-1), look)
    azimuth, elevation, width = np.radians(look.glow_deg)
    hidden = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    apart = np.arccos(np.clip(direction @ hidden, -1.0, 1.0))
    glow = look.glow * np.exp(-((apart / width) ** 2))
    rain = look.rain * np.exp(-((np.arcsin(up) / np.radians(RAIN_DEG)) ** 2)) / (1 + glow)
    side = 1 - look.away * (1 - np.cos(apart)) / 2
    luminance = overcast * np.exp(look.contrast * cloud) * (1 + glow) * side * (1 - rain)
    thick = np.clip(0.5 - cloud, 0.0, 1.0)[..., None]
    tint = np.array(look.thin) + (np.array(look.thick) - np.array(look.thin)) * thick
    tint /= (tint @ LUMINANCE)[..., None]
    return luminance[..., None] * tint


def picture(look):
    """Rows from the top. Scaled to the illuminance, because the clouds' mean is random."""
    azimuth = np.pi - 2 * np.pi * (np.arange(WIDTH) + 0.5) / WIDTH
    elevation = np.pi / 2 - np.pi * (np.arange(HEIGHT) + 0.5) / HEIGHT
    elevation, azimuth = np.meshgrid(elevation, azimuth, indexing="ij")
    direction = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                          np.sin(elevation)], axis=-1)
    radiance = sky(direction, look)
    upper = (elevation > 0)[..., None]
    share = np.where(upper, radiance * (np.sin(elevation) * np.cos(elevation))[..., None], 0.0)
    irradiance = share.sum(axis=(0, 1)) * (np.pi / HEIGHT) * (2 * np.pi / WIDTH)
    # The sea below reflects a fifteenth of the light.
    return np.where(upper, radiance, irradiance / np.pi / 15) * (look.illuminance / (irradiance @ LUMINANCE))


def save(pixels, path):
    image = bpy.data.images.new("overcast", WIDTH, HEIGHT, alpha=False, float_buffer=True)
    rgba = np.ones((HEIGHT, WIDTH, 4), dtype=np.float32)
    rgba[..., :3] = pixels[::-1]  # Blender's rows begin at the bottom
    image.pixels.foreach_set(rgba.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "16", "PIZ"
    image.save_render(path)


if __name__ == "__main__":
    out, *look = sys.argv[sys.argv.index("--") + 1:]
    save(picture(LOOKS[look[0] if look else "overcast"]), out)
