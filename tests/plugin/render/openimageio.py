"""A picture's Cryptomatte and its deep file as another program reads them: OpenImageIO.

usage: openimageio.py pelagic folder
"""
import json
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy
import OpenImageIO as oiio

PROGRAM, FOLDER = Path(sys.argv[1]), Path(sys.argv[2])

SHOT = """
[sea]
wind_speed_mps = 14.0

[waves]
cascades = [{ size_m = 300.0, resolution = 128 }, { size_m = 40.0, resolution = 64 }]

[quality]
level = "draft"

[effects]
spray = true

[camera]
position_m = [0.0, -45.0, 9.0]
look_at_m = [0.0, 0.0, 5.0]
"""

OBJECT = """
[[objects]]
name = "{name}"
file = "box.obj"
east_m = {x}
holdout = {holdout}
"""


def number_of(identifier):
    """The manifest's hexadecimal digits as the float whose bits they are."""
    return struct.unpack(">f", bytes.fromhex(identifier))[0]


def channel(pixels, names, name):
    return pixels[:, :, names.index(name)]


shutil.rmtree(FOLDER, ignore_errors=True)
FOLDER.mkdir(parents=True)
(FOLDER / "box.obj").write_text(
    "".join(f"v {x} {y} {z}\n" for z in (-4, 12) for y in (-3, 3) for x in (-3, 3))
    + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
)
shot = SHOT + "".join(
    OBJECT.format(name=name, x=x, holdout=holdout)
    for name, x, holdout in (("barge", -9, "false"), ("buoy no. 2", 0, "false"), ("held out", 9, "true"))
)
(FOLDER / "shot.toml").write_text(shot)
subprocess.run(
    [PROGRAM, "render", FOLDER / "shot.toml", "--out", FOLDER, "--frames", "1", "--size", "128x72", "--samples", "2",
     "--alpha", "--deep", "--layers", "object,cryptomatte,depth"],
    check=True,
)
(deep_file,) = FOLDER.glob("*.deep.*.exr")
(flat_file,) = set(FOLDER.glob("*.exr")) - {deep_file}

flat = oiio.ImageBuf(str(flat_file))
names = list(flat.spec().channelnames)
pixels = flat.get_pixels(oiio.FLOAT)
manifests = [a for a in flat.spec().extra_attribs if a.name.startswith("cryptomatte/") and a.name.endswith("/manifest")]
assert len(manifests) == 1, manifests
layer = manifests[0].name.rsplit("/", 1)[0]
assert flat.spec().get_string_attribute(layer + "/name") == "CryptoObject"
assert flat.spec().get_string_attribute(layer + "/hash") == "MurmurHash3_32"
assert flat.spec().get_string_attribute(layer + "/conversion") == "uint32_to_float32"
manifest = json.loads(manifests[0].value)
assert set(manifest) == {"sea", "barge", "buoy no. 2", "held out"}, manifest
id_of = {name: number_of(digits) for name, digits in manifest.items()}

# Each rank's identifier is a name's, and each name is somewhere most of a pixel.
shares = {name: numpy.zeros(pixels.shape[:2]) for name in manifest}
for rank in range(6):
    group = f"CryptoObject{rank // 2:02d}."
    ids = channel(pixels, names, group + "rb"[rank % 2])
    parts = channel(pixels, names, group + "ga"[rank % 2])
    known = numpy.zeros(ids.shape, bool)
    for name, number in id_of.items():
        shares[name] += numpy.where(ids == number, parts, 0.0)
        known |= ids == number
    assert numpy.all(known | (parts == 0.0)), rank
for name, share in shares.items():
    assert (share > 0.99).sum() > 50, name

deep = oiio.ImageBuf(str(deep_file))
spec = deep.spec()
assert spec.deep and sorted(spec.channelnames) == sorted(["R", "G", "B", "A", "Z", "ZBack", "id"]), spec.channelnames
assert json.loads(spec.get_string_attribute("manifest")) == manifest
at = {name: spec.channelnames.index(name) for name in spec.channelnames}
names_by_id = {number: name for name, number in id_of.items()}
deep_shares = {name: numpy.zeros(pixels.shape[:2]) for name in manifest}
veils = 0
for y in range(spec.height):
    for x in range(spec.width):
        left = 1.0
        for s in range(deep.deep_samples(x, y)):
            value = {name: deep.deep_value(x, y, 0, c, s) for name, c in at.items()}
            part = left * value["A"]
            left -= part
            veils += value["ZBack"] > value["Z"]
            if value["id"] != 0.0:
                deep_shares[names_by_id[value["id"]]][y, x] += part
assert veils > 100, veils
assert not deep_shares["held out"].any()
# The veil of spray takes some of each, and gives each what of it is too thin to be told.
for name in ("sea", "barge", "buoy no. 2"):
    assert (deep_shares[name] <= shares[name] + 1e-3).all(), name
    assert (deep_shares[name] > 0.9).sum() > 50, name

laid = oiio.ImageBufAlgo.flatten(deep)
assert not laid.has_error, laid.geterror()
laid_names = list(laid.spec().channelnames)
laid_pixels = laid.get_pixels(oiio.FLOAT)
peak = max(channel(pixels, names, c).max() for c in "RGB")
for c in "RGBA":
    error = numpy.abs(channel(laid_pixels, laid_names, c) - channel(pixels, names, c)).max()
    print(c, "differs by", error)
    assert error <= 1e-3 * (1.0 if c == "A" else peak), (c, error)
print("flattened by OpenImageIO", oiio.VERSION_STRING, "it is the picture;", veils, "samples of spray")
