"""Puts pictures of one size side by side, row by row from the top, on one JPEG: run inside Blender, which reads and
writes pictures already.

    blender -b --python examples/contact-sheet.py -- --columns 2 --out SHEET.jpg PICTURE…
"""

import argparse
import sys

import bpy
import numpy as np

GAP = 6  # pixels between pictures


def pixels_of(path):
    """(height, width, 4) floats as stored, bottom row first."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Raw"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--columns", type=int, default=2)
    parser.add_argument("--out", required=True)
    args = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])

    pictures = [pixels_of(path) for path in args.pictures]
    height, width, _ = pictures[0].shape
    if any(picture.shape != pictures[0].shape for picture in pictures):
        sys.exit("the pictures must all have one size")
    rows = -(-len(pictures) // args.columns)
    sheet = np.ones((rows * (height + GAP) - GAP, args.columns * (width + GAP) - GAP, 4), np.float32)
    for i, picture in enumerate(pictures):
        row, column = divmod(i, args.columns)
        bottom = (rows - 1 - row) * (height + GAP)
        sheet[bottom:bottom + height, column * (width + GAP):column * (width + GAP) + width] = picture

    image = bpy.data.images.new("sheet", sheet.shape[1], sheet.shape[0])
    image.colorspace_settings.name = "Raw"
    image.pixels.foreach_set(sheet.ravel())
    image.filepath_raw = args.out
    image.file_format = "JPEG"
    image.save()


main()
