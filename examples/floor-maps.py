"""Makes the floors of some shots: the depths of an atoll's rim and of a beach, a pool's tiles, and sand.

    blender -b --factory-startup -P examples/floor-maps.py -- DIR

Makes examples/data/atoll.exr and beach.exr, metres below the sea, 2 m a pixel, and examples/data/tiles.exr and sand.exr, linear Rec. 709.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

ATOLL, PIXEL_M = 200, 2.0
TILES, TILE = 128, 16  # pixels a side: of the picture, of a tile
GLAZE, JOINT = np.array([0.42, 0.78, 0.95]), np.array([0.9, 0.9, 0.88])


def noise(side, fall, seed, longest=1):
    """Repeats; variance 1, amplitudes fall with that power of the frequency. longest: waves a side."""
    frequency = np.hypot(*np.meshgrid(*[np.fft.fftfreq(side) * side] * 2))
    waves = np.fft.fft2(np.random.default_rng(seed).standard_normal((side, side)))
    waves *= np.where(frequency < longest, 0.0, np.maximum(frequency, 1.0) ** -fall)
    waves[0, 0] = 0.0
    heights = np.real(np.fft.ifft2(waves))
    return heights / heights.std()


def step(low, high, value):
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def atoll():
    """Rows from the north. A lagoon round a middle in the north, its rim with a bar of sand, and the reef's face."""
    across = (np.arange(ATOLL) + 0.5 - ATOLL / 2) * PIXEL_M
    east, north = np.meshgrid(across, -across)
    out = np.hypot(east, north - 120.0) + 14.0 * noise(ATOLL, 2.4, 2) + 4.0 * noise(ATOLL, 1.3, 3)
    depth = 6.5 - 4.2 * step(60.0, 150.0, out) - 1.9 * np.exp(-((out - 172.0) / 15.0) ** 2)
    depth += 4.0 * step(188.0, 208.0, out) + 30.0 * step(202.0, 234.0, out)
    depth -= 3.0 * np.clip(noise(ATOLL, 1.35, 9, longest=7) - 1.6, 0.0, 1.1) * (1.0 - step(140.0, 165.0, out))  # shoals
    depth += 0.15 * noise(ATOLL, 1.6, 5)
    # Spurs and grooves of the reef's face, which run outwards.
    along = np.arctan2(east, 120.0 - north) * 180.0
    grooves = np.sin(2.0 * np.pi * along / 16.0 + 0.6 * noise(ATOLL, 1.8, 7)) * (0.6 + 0.4 * noise(ATOLL, 1.2, 8))
    depth += 1.3 * grooves * step(170.0, 190.0, out) * (1.0 - step(215.0, 232.0, out))
    return np.repeat(np.clip(depth, 0.25, 40.0)[..., None], 3, axis=-1)


def beach():
    """Rows from the north, where the land is, below 0: sand at 1:30 in a wide bay, with a bar that a channel cuts, and a point in the east."""
    across = (np.arange(ATOLL) + 0.5 - ATOLL / 2) * PIXEL_M
    east, north = np.meshgrid(across, -across)
    shore = 135.0 + 18.0 * np.cos((east + 60.0) / 75.0) - 70.0 * step(90.0, 190.0, east)
    out = shore - north
    depth = out / 30.0 + 0.12 * noise(ATOLL, 2.2, 21) * step(0.0, 30.0, out)
    bar = np.exp(-(((out - 55.0) / 16.0) ** 2)) * (1.0 - np.exp(-(((east + 45.0) / 18.0) ** 2)))
    depth -= 0.75 * bar
    return np.repeat(np.clip(depth, -2.0, 10.0)[..., None], 3, axis=-1)


def tiles():
    random = np.random.default_rng(4)
    count = TILES // TILE
    bright = 1.0 + 0.06 * random.standard_normal((count, count, 1))
    tint = 0.03 * random.standard_normal((count, count, 1)) * np.array([-1.0, 0.0, 1.0])
    picture = np.kron(np.clip(GLAZE * bright + tint, 0.0, 1.0), np.ones((TILE, TILE, 1)))
    joint = np.isin(np.arange(TILES) % TILE, (0, TILE - 1))
    picture[joint, :] = picture[:, joint] = JOINT
    return picture


def sand(side=128, ripples=14):
    """Rippled across, with grains and darker patches; its mean is about 0.9."""
    across = np.arange(side) / side
    bent = ripples * across[None, :] + 0.45 * noise(side, 2.0, 11)
    bright = 0.9 + 0.10 * np.sin(2.0 * np.pi * bent) * (0.7 + 0.3 * noise(side, 1.8, 12)) + 0.05 * noise(side, 0.3, 13)
    bright -= 0.25 * step(1.2, 2.2, noise(side, 1.5, 14))
    return np.repeat(np.clip(bright, 0.2, 1.2)[..., None], 3, axis=-1)


def save(pixels, path):
    height, width, _ = pixels.shape
    image = bpy.data.images.new(path.stem, width, height, alpha=False, float_buffer=True)
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :3] = pixels[::-1]  # Blender's rows begin at the bottom
    image.pixels.foreach_set(rgba.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "16", "ZIP"
    image.save_render(str(path))


if __name__ == "__main__":
    folder = Path(sys.argv[sys.argv.index("--") + 1])
    save(atoll(), folder / "atoll.exr")
    save(beach(), folder / "beach.exr")
    save(tiles(), folder / "tiles.exr")
    save(sand(), folder / "sand.exr")
