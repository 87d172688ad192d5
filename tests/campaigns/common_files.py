"""Reads every file that the program leaves, independently of its own writers where that is short, and says what is
wrong with one."""

import json
import pathlib
import re
import struct
import sys
import zlib

import numpy as np

from common import Failure


def module(program):
    """The Python module that was built beside the program."""
    folder = str(program.parent / "python")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        import pelagic
    except ImportError as error:
        raise SystemExit(f"{error}: build the target pelagic_python first ({folder})") from None
    return pelagic


_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
_ROWS = {0: 1, 2: 1, 3: 16}  # of a block, by compression: none, a row packed by zlib, sixteen rows


def read_exr(path):
    """A list of levels, the full picture first, each a dict of float arrays (rows from the top, columns) by channel.
    Single-part files of scan lines or mip-mapped tiles; uncompressed, ZIPS or ZIP. Failure where the file is short,
    has bytes that nothing points to, or isn't such a one."""
    data = pathlib.Path(path).read_bytes()
    try:
        return _levels(data)
    except (struct.error, ValueError, IndexError, KeyError, zlib.error) as error:
        raise Failure(f"{path} isn't whole: {error!r}") from None


def _header(data):
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0xff != 2 or version & 0x1800:
        raise ValueError("not a single-part OpenEXR image")
    attributes, at = {}, 8
    while data[at]:
        name, kind, rest = data[at:at + 600].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1, bool(version & 0x200)


def _unpacked(block, size):
    if len(block) == size:
        return block  # stored as it is where packing doesn't pay
    packed = np.frombuffer(zlib.decompress(block), np.uint8)
    if len(packed) != size:
        raise ValueError(f"a block of {len(packed)} bytes instead of {size}")
    # Each byte is the difference from the one before, plus 128; even bytes first, then the odd ones.
    steps = packed.astype(np.int64)
    steps[1:] -= 128
    values = (np.cumsum(steps) & 0xff).astype(np.uint8)
    out, half = np.empty(size, np.uint8), (size + 1) // 2
    out[0::2], out[1::2] = values[:half], values[half:]
    return out.tobytes()


def _levels(data):
    attributes, at, tiled = _header(data)
    channels, rest = [], attributes["channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        kind, _, x, y = struct.unpack_from("<iiii", rest)
        if x != 1 or y != 1:
            raise ValueError("fewer samples than pixels")
        channels.append((name.decode(), _TYPES[kind]))
        rest = rest[16:]
    compression = attributes["compression"][0]
    left, top, right, bottom = struct.unpack("<iiii", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    a_pixel = sum(kind.itemsize for _, kind in channels)
    if tiled:
        tile, tile_y, mode = struct.unpack("<IIB", attributes["tiles"])
        count = max(width, height).bit_length() if mode == 1 else 1
        sizes = [(max(1, width >> level), max(1, height >> level)) for level in range(count)]
        blocks = [(level, x, y) for level, (w, h) in enumerate(sizes) for y in range(-(-h // tile_y))
                  for x in range(-(-w // tile))]
    else:
        tile, tile_y, sizes = width, _ROWS[compression], [(width, height)]
        blocks = [(0, 0, y) for y in range(-(-height // tile_y))]
    levels = [{name: np.empty((h, w), np.float32) for name, _ in channels} for w, h in sizes]
    offsets = struct.unpack_from(f"<{len(blocks)}Q", data, at)
    used = at + 8 * len(blocks)
    for (level, x, y), offset in zip(blocks, offsets):
        if tiled:
            found = struct.unpack_from("<iiiii", data, offset)
            start, expected = offset + 20, (x, y, level, level)
        else:
            found = struct.unpack_from("<ii", data, offset)
            start, expected = offset + 8, (top + y * tile_y,)
        if found[:-1] != expected:
            raise ValueError(f"the table of blocks points to {found[:-1]} instead of {expected}")
        w, h = min(tile, sizes[level][0] - x * tile), min(tile_y, sizes[level][1] - y * tile_y)
        block = _unpacked(data[start:start + found[-1]], w * h * a_pixel)
        used += start - offset + found[-1]
        rows = np.frombuffer(block, np.uint8).reshape(h, w * a_pixel)
        column = 0
        for name, kind in channels:
            part = np.ascontiguousarray(rows[:, column:column + w * kind.itemsize]).view(kind)
            levels[level][name][y * tile_y:y * tile_y + h, x * tile:x * tile + w] = part
            column += w * kind.itemsize
    if used != len(data):
        raise ValueError(f"{len(data)} bytes, of which its blocks are {used}")
    return levels


def write_exr(path, channels):
    """A picture of float channels (rows from the top, columns), uncompressed scan lines."""
    names = sorted(channels)
    height, width = channels[names[0]].shape

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    box = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", 20000630, 2) + b"".join((
        attribute("channels", "chlist",
                  b"".join(name.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in names) + b"\0"),
        attribute("compression", "compression", b"\0"), attribute("dataWindow", "box2i", box),
        attribute("displayWindow", "box2i", box), attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    rows = [struct.pack("<ii", y, 4 * width * len(names))
            + b"".join(channels[name][y].astype("<f4").tobytes() for name in names) for y in range(height)]
    first = len(header) + 8 * height
    pathlib.Path(path).write_bytes(header + b"".join(struct.pack("<Q", first + y * len(rows[0])) for y in range(height))
                                   + b"".join(rows))


def read_png(path):
    """(height, width, channels) of an 8-bit picture without a palette. Failure where a check sum is wrong or it isn't
    whole."""
    data = pathlib.Path(path).read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise Failure(f"{path} isn't a PNG")
    at, packed, header, kind = 8, b"", None, b""
    while at < len(data) and kind != b"IEND":
        if at + 12 > len(data):
            raise Failure(f"{path} is cut short")
        (size,) = struct.unpack_from(">I", data, at)
        kind, value = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        if data[at + 8 + size:at + 12 + size] != struct.pack(">I", zlib.crc32(kind + value)):
            raise Failure(f"{path}: the check sum of {kind} is wrong")
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", value)
        elif kind == b"IDAT":
            packed += value
        at += 12 + size
    if kind != b"IEND" or at != len(data) or header is None or header[2] != 8:
        raise Failure(f"{path}: ends in {kind}, with {len(data) - at} bytes after it")
    width, height = header[:2]
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[header[3]]
    raw = zlib.decompress(packed)
    if len(raw) != height * (1 + width * channels):
        raise Failure(f"{path}: {len(raw)} bytes of pixels for {width} x {height}")
    rows = np.frombuffer(raw, np.uint8).reshape(height, 1 + width * channels)
    return _unfiltered(rows[:, 0], rows[:, 1:].astype(np.int64), channels).reshape(height, width, channels)


def _unfiltered(filters, rows, channels):
    """The bytes that a PNG's rows stand for: each is the difference from what its row's filter foretells from its
    neighbours a (left), b (above) and c (above left)."""
    above = np.zeros(rows.shape[1], np.int64)
    for kind, row in zip(filters, rows):
        if kind == 2:
            row += above
        elif kind:
            for i in range(len(row)):
                a, c = (row[i - channels] & 0xff, above[i - channels]) if i >= channels else (0, 0)
                b = above[i]
                if kind == 4:
                    guess = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
                else:
                    guess = a if kind == 1 else (a + b) // 2
                row[i] += guess
        row &= 0xff
        above = row
    return rows.astype(np.uint8)


def _finite(path, name, values):
    bad = ~np.isfinite(values)
    if bad.any():
        raise Failure(f"{path}: {name} has {bad.sum()} of {bad.size} numbers that aren't finite")


def _within(path, name, values, low, high):
    if values.size and not (values.min() >= low and values.max() <= high):
        raise Failure(f"{path}: {name} goes from {values.min()!r} to {values.max()!r}; it may from {low} to {high}")


def _units(path, name, vectors, tolerance):
    length = np.linalg.norm(vectors.astype(np.float64), axis=-1)
    _within(path, f"the length of {name}", length, 1 - tolerance, 1 + tolerance)


def _variances(path, xx, yy, xy):
    """Symmetric tensors that are positive semi-definite, but for the rounding to single precision."""
    xx, yy, xy = (np.asarray(v, np.float64) for v in (xx, yy, xy))
    _within(path, "slope variance xx", xx, 0, np.inf)
    _within(path, "slope variance yy", yy, 0, np.inf)
    slack = xx * yy * (1 + 1e-5) + 1e-30 - xy * xy
    if (slack < 0).any():
        raise Failure(f"{path}: a slope variance isn't positive semi-definite, {slack.min()}")


def check_mesh(pelagic, path):
    """A mesh file of a bake, read by the module; what it holds."""
    mesh = pelagic.read_mesh(path)
    for name, values in mesh.items():
        if values.dtype.kind == "f":
            _finite(path, name, values)
    if "normal" in mesh:
        _units(path, "normals", mesh["normal"], 1e-4)
    if "coverage" in mesh:
        _within(path, "coverage", mesh["coverage"], 0, 1)
    if "slope_variance" in mesh:
        _variances(path, *mesh["slope_variance"].T)
    if "face_corners" in mesh and "position" in mesh:
        _within(path, "corners", mesh["face_corners"], 0, len(mesh["position"]) - 1)
    return mesh


def check_exr(path):
    """A map, a tile, a sky or a picture: by its name. Its full level."""
    levels = read_exr(path)
    for number, level in enumerate(levels):
        for name, values in level.items():
            _finite(path, f"channel {name} of level {number}", values)
        if ".whitecaps." in path.name:
            _within(path, "coverage", level["R"], 0, 1)
            _within(path, "variance of J", level["jacobianVariance"], 0, np.inf)
        elif ".slope-variance." in path.name:
            _variances(path, level["R"], level["G"], level["B"])
        elif ".normal." in path.name:
            _units(path, "normals", np.stack([level[c] for c in "RGB"], axis=-1), 2e-3)  # halves
        elif ".displacement." not in path.name:
            for name, values in level.items():
                _within(path, f"light, channel {name},", values, 0, np.inf)
    return levels[0]


_NOT_A_NUMBER = re.compile(r"(?<![\w.\"/-])[-+]?(nan|inf)(?![\w.])", re.IGNORECASE)


def check_text(path):
    text = path.read_text(encoding="utf-8")
    for line in text.splitlines():
        # The one key that may be infinite: water without a floor.
        if _NOT_A_NUMBER.search(line) and "depth_m = inf" not in line:
            raise Failure(f"{path}: {line.strip()[:200]}")
    for opening, closing in ("()", "[]", "{}"):
        if text.count(opening) != text.count(closing):
            raise Failure(f"{path}: {text.count(opening)} {opening} but {text.count(closing)} {closing}")


def _no_constant(word):
    raise ValueError(f"{word} is no JSON")


def read_json(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"), parse_constant=_no_constant)
    except ValueError as error:
        raise Failure(f"{path}: {error}") from None


def check_volume(path):
    """Its grids as OpenVDB's own module reads them: finite, spray never below 0."""
    import pyopenvdb  # most campaigns need none

    held = {}
    for grid in pyopenvdb.readAllGridMetadata(str(path)):
        full = pyopenvdb.read(str(path), grid.name)
        low, high = full.evalMinMax()
        numbers = np.array([low, high], "f8")
        if not np.isfinite(numbers).all():
            raise Failure(f"{path}: {grid.name} from {low} to {high}")
        if grid.name == "density" and low < 0:
            raise Failure(f"{path}: a density of {low}")
        held[grid.name] = full.activeVoxelCount()
    if sorted(held) not in (["density", "velocity"], ["surface"]):
        raise Failure(f"{path} holds {sorted(held)}")
    return held


def check_folder(pelagic, folder):
    """Every file of a bake or of pictures. Returns what the meshes and the full levels hold, by path below."""
    held = {}
    for path in sorted(folder.rglob("*")):
        if path.is_dir():
            continue
        name = str(path.relative_to(folder))
        if path.suffix == ".exr":
            held[name] = check_exr(path)
        elif path.suffix == ".png":
            held[name] = read_png(path)
        elif path.suffix == ".json":
            held[name] = read_json(path)
        elif path.suffix == ".vdb":
            held[name] = check_volume(path)
        elif path.suffix == ".usda" and re.search(r"^mesh/.*\.-?\d+\.usda$|^mesh/.*\.topology\.usda$", name):
            check_text(path)
            held[name] = check_mesh(pelagic, path)
        elif path.suffix in (".usda", ".mtlx"):
            check_text(path)
        elif path.suffix == ".usdc" and name.startswith("mesh/"):
            held[name] = check_mesh(pelagic, path)
        elif path.suffix == ".usdc":
            if path.read_bytes()[:8] != b"PXR-USDC":
                raise Failure(f"{path} isn't a crate")
        else:
            raise Failure(f"{path}: a file that nothing is known of")
    return held


def bytes_below(folder):
    """All files of a folder: their bytes, by path below it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def differences(expected, found):
    """What is missing, more, or other, as a sentence; empty if they are the same."""
    missing, more = sorted(expected.keys() - found.keys()), sorted(found.keys() - expected.keys())
    other = sorted(path for path in expected.keys() & found.keys() if expected[path] != found[path])
    return "; ".join(f"{what}: {', '.join(paths[:5])}" for what, paths in
                     (("missing", missing), ("more", more), ("other bytes", other)) if paths)
