#!/usr/bin/env python3
"""Damaged shots, buoy files, skies and records: each is taken or refused, and nothing else happens.

A mutation flips, deletes, repeats, swaps or truncates bytes and lines, puts in huge numbers, deep brackets, characters
that terminals obey and words of the table of keys. Each case is one run of `pelagic validate` over several damaged
shots (each named once, as fine or refused), or one over a damaged buoy file, sky or record; some of what was taken
is baked or rendered, small. Each run ends with status 0, 2 or 75 within seconds and bounded memory, with messages of at
most 64 KiB that name the file and hold no control characters; what it writes is whole and finite.
"""

import json
import pathlib
import re
import shutil
import struct
import sys
import tempfile
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from common import ROOT, Campaign, Failure  # noqa: E402
from common_files import read_exr, write_exr  # noqa: E402

import numpy as np  # noqa: E402

SHOTS_IN_A_RUN = 10
SECONDS = 60  # also of a machine that does much else
MOST_OF_MESSAGES = 64 << 10
BUOY = ROOT / "tests/plugin/format/shot/data"

SHOT = """# A sea of everything that a shot can say, small enough to be baked in a moment.
[shot]
name = "small"
frames = [1, 2]
fps = 24
seed = 7
loop_s = 10.0
[sea]
wind_speed_mps = 14.0
wind_direction_deg = 20.0
fetch_m = 300e3
depth_m = inf
spectrum = "file"
spectrum_file = "made-99001w2021.txt"
spectrum_time = 2021-03-01T00:50:00Z
swell = [ { height_m = 1.5, period_s = 11.0, direction_deg = 80.0 } ]
[waves]
choppiness = 1
cascades = [ { size_m = 200.0, resolution = 96 }, { size_m = 50.0, resolution = 32 } ]
[surface]
size_m = 100.0
resolution = 8
[camera]
position_m = [0.0, -60.0, 30.0]
keys = [ { frame = 1, position_m = [0, 1, 20], look_at_m = [3, 4, 5] }, { frame = 2, position_m = [0, 1, 30], look_at_m = [3, 4, 5] } ]
resolution = [16, 9]
[light]
sky = "sky.exr"
[effects]
whitecaps = true
[quality]
level = "draft"
[output]
attributes = ["normal", "velocity"]
maps = ["displacement"]
map_resolution = 8
"""
NUMBERS = ["0", "-1", "1e308", "-1e308", "1e-320", "nan", "-inf", "inf", "9223372036854775807", "-9223372036854775808",
           "9223372036854775808", "0x7fffffffffffffff", "1e999", "2147483648", "4294967296", "0.1e", "1_000", "99999"]
NASTY = ["\u202e", "\u200b", "\ufeff", "\u0000", "\x1b[2J", "\x07", "\u2028", "\U0001f30a", "e\u0301", "\u009b", "\ud7ff",
         "\\u0000", "\\ud800", "\\U00110000", "\u00ad", "\uffff", "水" * 100, "%n%s", "../" * 50, "\r", "\r\n", "\x7f"]
DEEP = ["[", "{a=", "a.", "'", '"""', "[[", "a.b=[{", "{", "}", "]", "[a]\n", "#", "\\"]


def words_of_keys(campaign):
    """Names of keys, and words that they take."""
    return sorted(set(re.findall(r"[a-z_0-9-]{3,}", campaign.run("keys").out)))


def mutated(draw, data, words):
    """The bytes with a few of the mutations."""
    data = bytearray(data)

    def at():
        return draw.randrange(len(data) + 1)

    def piece():
        start = at()
        return start, min(len(data), start + draw.choice((1, 2, 8, 40, 200)))

    def put_in(text):
        start, end = piece()
        data[start:draw.choice((start, end))] = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text

    def number():
        found = list(re.finditer(rb"[0-9.eE+-]*[0-9][0-9.eE+-]*", data))
        if found:
            one = draw.choice(found)
            data[one.start():one.end()] = draw.choice(NUMBERS).encode()

    def lines():
        split = bytes(data).split(b"\n")
        a, b = draw.randrange(len(split)), draw.randrange(len(split))
        kind = draw.randrange(3)
        if kind == 0:
            split[a], split[b] = split[b], split[a]
        elif kind == 1:
            split.insert(a, split[b])
        else:
            del split[a]
        data[:] = b"\n".join(split)

    def flip():
        if data:
            data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)

    def byte():
        if data:
            data[draw.randrange(len(data))] = draw.randrange(256)

    def delete():
        start, end = piece()
        del data[start:end]

    def repeat():
        start, end = piece()
        where = at()
        data[where:where] = data[start:end] * draw.choice((1, 1, 3, 1000))

    def cut():
        del data[at():]

    def swap():
        (a, b), where = piece(), at()
        part = data[a:b]
        del data[a:b]
        data[where:where] = part

    changes = (flip, flip, byte, delete, repeat, swap, number, number, lines, lines,
               lambda: put_in(draw.choice(NASTY)), lambda: put_in(draw.choice(words)),
               lambda: put_in(draw.choice(DEEP) * draw.choice((1, 20, 300, 20000))),
               lambda: put_in(draw.choice(words) + " = " + draw.choice(NUMBERS + words) + "\n"),
               lambda: put_in(bytes(draw.randrange(256) for _ in range(draw.randrange(1, 20)))))
    for _ in range(draw.choice((1, 1, 2, 4, 12))):
        draw.choice(changes)()
    if draw.random() < 0.05:
        cut()
    return bytes(data)


def judge_run(campaign, run, names, statuses=(0, 2, 75)):
    """What holds for every run."""
    campaign.ended_well(run, statuses)
    campaign.expect(len(run.err) <= MOST_OF_MESSAGES, f"{len(run.err)} bytes of messages", run)
    for line in run.err.split("\n"):
        campaign.expect(line.isprintable() or not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e]", line),
                        f"control characters in a message: {line[:200]!r}", run)
    for name in names if run.status == 2 else ():
        campaign.expect(str(name) in run.err, f"its messages don't name {name}", run)


def is_small(text):
    """Whether a shot that was taken is baked in a moment: not if a mutation made it large."""
    shot = tomllib.loads(text)

    def numbers(value):
        if isinstance(value, dict):
            for inner in value.values():
                yield from numbers(inner)
        elif isinstance(value, list):
            for inner in value:
                yield from numbers(inner)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield value

    of = {table: {key: max(map(abs, numbers(value)), default=0) for key, value in keys.items()}
          for table, keys in shot.items()}
    frames = shot.get("shot", {}).get("frames", [1, 48])
    return (frames[1] - frames[0] < 8 and of.get("surface", {}).get("resolution", 256) <= 64
            and of.get("surface", {}).get("kind", 0) == 0
            and shot.get("surface", {}).get("kind", "patch") == "patch"
            and of.get("output", {}).get("map_resolution", 512) <= 64
            and of.get("camera", {}).get("resolution", 1280) <= 64
            and shot.get("waves", {}).get("model", "fft") == "fft"
            and isinstance(shot.get("waves", {}).get("cascades"), list)
            and all(cascade["resolution"] <= 128 for cascade in shot["waves"]["cascades"]))


def expect_finite(campaign, folder):
    """Every file that a run left holds numbers only."""
    def refuse(word):
        raise Failure(f"{word} in {folder}")

    for path in folder.rglob("*"):
        if path.suffix == ".json":
            json.loads(path.read_text(), parse_constant=refuse)
        elif path.suffix == ".usda":
            # The page that people read says how deep the sea is: inf.
            word = "nan" if path.parent == folder else "nan|inf"
            campaign.expect(not re.search(rf"[\s(,\[-]({word})[\s,)\]]", path.read_text()), f"{word} in {path}")
        elif path.suffix == ".exr":
            for level in read_exr(path):
                for name, values in level.items():
                    campaign.expect(np.isfinite(values).all(), f"{name} of {path} isn't finite")
        else:
            campaign.expect(path.is_dir() or path.stat().st_size > 0, f"{path} is empty")


def bake_or_render(campaign, draw, folder, shot):
    """What was taken works, or is refused before anything is written."""
    verb = draw.choice(("bake", "render"))
    out = folder / "out"
    run = campaign.run(verb, shot, "--out", out, cwd=folder, timeout=4 * SECONDS, memory_gib=8)
    judge_run(campaign, run, [])
    campaign.count(f"{verb}d" if verb == "bake" else "rendered")
    if run.status == 0:
        expect_finite(campaign, out)


class Mutations:
    def __init__(self, campaign):
        self.campaign, self.words = campaign, words_of_keys(campaign)
        self.shots = [SHOT] + [path.read_text() for path in sorted((ROOT / "examples").glob("*.toml"))]
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="pelagic-mutations-"))
        rows = np.linspace(2, 1, 8, dtype=np.float32)[:, None] * np.ones((1, 16), np.float32)
        write_exr(self.base / "sky.exr", {"R": rows, "G": rows, "B": rows})
        for path in BUOY.glob("made-*"):
            shutil.copy(path, self.base)
        (self.base / "shot.toml").write_text(SHOT)
        baked = campaign.run("bake", "shot.toml", "--out", "baked", cwd=self.base)
        campaign.expect(baked.status == 0, "the shot itself isn't baked", baked)
        rendered = campaign.run("render", "shot.toml", "--out", "rendered", cwd=self.base)
        campaign.expect(rendered.status == 0, "the shot itself isn't rendered", rendered)
        # A sky of the program's own as well: tiles or packed lines, and attributes.
        self.skies = [self.base / "sky.exr", *sorted((self.base / "rendered").glob("*.0001.exr")),
                      *sorted((self.base / "baked").rglob("*sky*.exr"))]

    def judge(self, draw, folder):
        kind = draw.choices((self.shot, self.buoy, self.sky, self.record), (6, 4, 4, 3))[0]
        kind(draw, folder)

    def lay_out(self, folder):
        for path in self.base.iterdir():
            if path.is_file():
                shutil.copy(path, folder)

    def shot(self, draw, folder):
        self.lay_out(folder)
        names = [f"shot{i}.toml" for i in range(SHOTS_IN_A_RUN)]
        for name in names:
            # Most of the small one: what can be said is all in it.
            source = SHOT if draw.random() < 0.7 else draw.choice(self.shots)
            (folder / name).write_bytes(mutated(draw, source.encode(), self.words))
        run = self.campaign.run("validate", *names, cwd=folder, timeout=SECONDS, memory_gib=4)
        judge_run(self.campaign, run, [])
        fine = [name for name in names if f"{name}: fine" in run.out]
        refused = [name for name in names if re.search(rf"^{name}:(?! note:)", run.err, re.M)]
        self.campaign.expect(sorted(fine + refused) == sorted(names), "not each file is named once", run)
        self.campaign.expect((run.status == 0) == (not refused), "the status isn't that of the files", run)
        for _ in names:
            self.campaign.count("mutated shots")
        for name in fine:
            self.campaign.count("shots taken")
            if draw.random() < 0.3 and is_small((folder / name).read_text()):
                shutil.rmtree(folder / "out", ignore_errors=True)
                bake_or_render(self.campaign, draw, folder, name)

    def one(self, draw, folder, what, chance):
        """A run over the shot, one of whose files is damaged."""
        run = self.campaign.run("validate", "shot.toml", cwd=folder, timeout=SECONDS, memory_gib=4)
        judge_run(self.campaign, run, ["shot.toml:"])
        self.campaign.count(f"mutated {what}")
        if run.status == 0:
            self.campaign.count(f"{what} taken")
            if draw.random() < chance:
                bake_or_render(self.campaign, draw, folder, "shot.toml")

    def buoy(self, draw, folder):
        self.lay_out(folder)
        file = folder / f"made-99001{draw.choice('wdijk')}2021.txt"
        file.write_bytes(mutated(draw, file.read_bytes(), self.words))
        self.one(draw, folder, "buoy files", 0.2)

    def sky(self, draw, folder):
        self.lay_out(folder)
        data = draw.choice(self.skies).read_bytes()
        head = draw.choice((64, 400, len(data)))  # most of what can go wrong is in the header
        if draw.random() < 0.2:  # values that are damaged as such
            data = bytearray(data)
            for _ in range(3):
                where = draw.randrange(max(1, len(data) - 4))
                data[where:where + 4] = struct.pack("<f", draw.choice((float("nan"), float("inf"), -1.0, 3e38, 1e-40)))
            data = bytes(data)
        elif draw.random() < 0.5:
            data = bytearray(data)
            for _ in range(draw.choice((1, 3))):
                data[draw.randrange(min(head, len(data)))] = draw.randrange(256)
            data = bytes(data)
        else:
            data = mutated(draw, data[:head], self.words) + data[head:]
        (folder / "sky.exr").write_bytes(data)
        self.one(draw, folder, "skies", 0.4)

    def record(self, draw, folder):
        self.lay_out(folder)
        shutil.copytree(self.base / "baked", folder / "baked")
        record = folder / "baked/small.json"
        record.write_bytes(mutated(draw, record.read_bytes(), self.words))
        run = self.campaign.run("bake", "shot.toml", "--out", "baked", cwd=folder, timeout=4 * SECONDS)
        judge_run(self.campaign, run, [])
        self.campaign.count("mutated records")
        if run.status == 0:
            self.campaign.count("records taken")
            for path in (self.base / "baked").rglob("*"):
                name = path.relative_to(self.base / "baked")
                if path.is_file() and path.suffix != ".json":
                    self.campaign.expect((folder / "baked" / name).read_bytes() == path.read_bytes(),
                                         f"{name} isn't what an undisturbed bake has", run)
            expect_finite(self.campaign, folder / "baked")


def main():
    campaign = Campaign(__doc__.split("\n")[0], 3200)
    mutations = Mutations(campaign)
    try:
        campaign.go(mutations.judge)
    finally:
        shutil.rmtree(mutations.base, ignore_errors=True)


if __name__ == "__main__":
    main()
