"""Cuts a sheet of all presets into the thumbnails of the add-on's preset menu: run inside Blender, which reads and writes
pictures already.

    pelagic presets --sheet SHEET.png
    blender -b --python examples/preset-thumbnails.py -- SHEET.png addon/pelagic_ocean/thumbnails NAME…

NAMEs: the presets, in the order of `pelagic presets`.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

ACROSS, WIDTH, HEIGHT, GAP = 4, 320, 180, 4  # of the sheet

sheet, folder, *names = sys.argv[sys.argv.index("--") + 1:]
image = bpy.data.images.load(str(Path(sheet).resolve()))
image.colorspace_settings.name = "Raw"
pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
image.pixels.foreach_get(pixels)
pixels = pixels.reshape(image.size[1], image.size[0], 4)[::-1]  # from the top
if image.size[1] != -(-len(names) // ACROSS) * (HEIGHT + GAP) - GAP:
    sys.exit(f"{sheet} doesn't show {len(names)} presets")
Path(folder).mkdir(exist_ok=True)
bpy.context.scene.render.image_settings.quality = 85
for i, name in enumerate(names):
    y, x = i // ACROSS * (HEIGHT + GAP), i % ACROSS * (WIDTH + GAP)
    small = pixels[y:y + HEIGHT, x:x + WIDTH].reshape(HEIGHT // 2, 2, WIDTH // 2, 2, 4).mean(axis=(1, 3))
    made = bpy.data.images.new(name, WIDTH // 2, HEIGHT // 2)
    made.colorspace_settings.name = "Raw"
    made.pixels.foreach_set(small[::-1].ravel())
    made.filepath_raw, made.file_format = str(Path(folder).resolve() / f"{name}.jpg"), "JPEG"
    made.save()
