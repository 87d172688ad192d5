#!/usr/bin/env python3
"""Command lines of anything: verbs, options and files in any number and order, with values at the edges and none.

Each run ends with a status that is promised, and not 1, within a minute, and with a message that has no control characters where it isn't 0. One
that ends with 2, an error on the command line, has written nothing.
"""

import re
import sys

from common import Campaign

SHOT = """[shot]
name = "small"
frames = [1, 3]
[waves]
cascades = [ { size_m = 50.0, resolution = 16 } ]
[surface]
size_m = 20.0
resolution = 4
[camera]
resolution = [16, 9]
[quality]
level = "draft"
"""
WORDS = ["", " ", "-", "--", "---", "-h", "--help", "--version", "=", "--=", "-1", "0", "nan", "inf", "1e999", "0x10", "18446744073709551616",
         "-9223372036854775809", "true", "*", "..", ".", "/", "/dev/null", "/dev/null/x", "/proc/self/mem", "@small.toml", "a\nb", "\x1b[2J",
         "\u202e", "🌊", "%n%s", "--out", "x" * 300, "x" * 5000, "\udcff\udcfe", "'", '"', "\\", "{}", "[1,2]", "config=small.toml"]
NUMBERS = ["0", "1", "2", "-1", "1.5", "16", "17", "256", "257", "+1", "01", "1e3", "", " 1", "1 ", "4294967297", "nan", "٣"]
VALUES = {
    "--out": ["out", "out/deep/er", "", ".", "small.toml", "small.toml/x", "/dev/null", "/proc/nothing", "x" * 300, "a\nb", "🌊", "\udcff"],
    "--frames": ["1", "2-3", "1-3x2", "3-1", "0", "4", "1-", "-1", "1-3x0", "1-3x-1", "1-2147483648", "1--3", "x", "", "1,2", "1-3x4294967297"],
    "--size": ["16x9", "1x1", "0x9", "16x", "x9", "16", "-1x-1", "65537x1", "4294967297x1", "16X9", "16x9x2", "1e1x9", "", "٣x٤"],
    "--exposure": [*NUMBERS, "-1e308", "1e308", "inf", "1000"],
    "--samples": NUMBERS,
    "--sky-quality": ["one", "nine", "integral", "two", ""],
    "--terms": ["sun", "sun,sky", "sun,,sky", "sun,sun", ",", "all", "", "spray,air"],
    "--overscan": ["10%", "0%", "50%", "51%", "3", "0", "9", "-1", "1.5", "1.5%", "nan%", "%", "", "1e9", "4294967297"],
    "--region": ["0,0,16,9", "2,3,9,8", "-2,-1,8,4", "0,0,0,0", "8,0,4,4", "0,0,4", "0,0,4,4,4", ",,,", "", "0;0;4;4", "0,0,4294967297,4", "1.5,0,4,4"],
    "--shutter": ["0", "0.5", "4", "4.1", "-1", "nan", "1e-320", ""],
    "--layers": ["all", "none", "depth", "depth,depth", "all,none", ",", "", "x"],
    "--threads": NUMBERS, "--instruction-set": ["sse4", "avx2", "avx512", "avx3", "", "AVX2"],
    "--max-memory": ["8G", "1", "0", "-1", "1e3G", "512M", "G", "8g", "8 G", "18446744073709551616", "16777216T", "nan", ""],
    "--verb": ["bake", "render", "paint", ""], "--status": ["out", ".", "nothing", "small.toml", ""], "--tasks": [*NUMBERS, "1000", "1001"],
    "--minutes": [*NUMBERS, "0.1", "1440", "1e9"], "--sbatch": ["--partition=night", "", "a\nb"], "--json": None,
    "--chosen": ["quality.max_error = 0.1: x", "", "x"],
    "--alpha": None, "--trust-times": None, "--measure": None, "--list": None,
    "--offscreen": ["a.png", "a.exr", "a.jpg", "", "small.toml", "nowhere/a.png"],
    "--screenshot": ["b.png", ""], "--after": NUMBERS, "--scale": ["1", "2", "4", "3", ""], "--quality": ["draft", "final", "best", ""],
    "--frame": [*NUMBERS, "100000000", "2147483648"], "--rows": ["sky", "nothing", ",", ""], "--repeats": ["0", "1001", "x"],
}
OPTIONS = {
    "bake": ["--out", "--frames", "--trust-times", "--threads", "--max-memory", "--instruction-set", "--json", "--chosen"],
    "render": ["--out", "--frames", "--size", "--exposure", "--samples", "--sky-quality", "--terms", "--overscan", "--region", "--shutter", "--alpha", "--layers",
               "--trust-times", "--threads", "--max-memory", "--instruction-set"],
    "preview": ["--frame", "--size", "--quality", "--scale", "--threads", "--max-memory", "--offscreen", "--after"],
    "explain": ["--threads", "--json"],
    "farm": ["--out", "--frames", "--verb", "--status", "--tasks", "--minutes", "--sbatch", "--json", "--chosen", "--samples", "--threads", "--instruction-set"],
    "accuracy": ["--rows", "--repeats", "--threads"],
    "verify": ["--threads", "--json", "--instruction-set"],
    "validate": [], "keys": [], "presets": [],
}
FILES = {"verify": ["out", "small", ".", "nothing", "small.toml"], "presets": ["beaufort-7", "beaufort-99", "calm"], "keys": ["sea"]}
SHOTS = ["small.toml", "small.toml", "small.toml", "empty.toml", "nothing.toml", "folder"]


def argument_list(draw):
    verb = draw.choice([*OPTIONS, "bake", "render", "render", "bak", "Bake", *draw.sample(WORDS, 1)])
    options, arguments = OPTIONS.get(verb, list(VALUES)), []
    for _ in range(draw.choice((0, 1, 1, 2, 3, 6))):
        option = draw.choice(options if options and draw.random() < 0.8 else list(VALUES))
        values = VALUES[option]
        if draw.random() < 0.05:
            option = option[:draw.randrange(len(option))] if draw.random() < 0.5 else option + "x"
        # Its first values are the usual ones: most lists have something wrong in one place alone.
        value = None if values is None else draw.choice(values[:3] if draw.random() < 0.6 else [*values, *WORDS])
        if value is None or draw.random() < 0.05:
            arguments.append([option])
        elif isinstance(value, str) and draw.random() < 0.3:
            arguments.append([f"{option}={value}"])
        else:
            arguments.append([option, value])
    for _ in range(draw.choice((0, 1, 1, 1, 1, 2))):
        arguments.append([draw.choice(FILES.get(verb, SHOTS))])
    if draw.random() < 0.2:
        arguments.append([draw.choice(WORDS)])
    draw.shuffle(arguments)
    # These two measure for minutes; what is wrong with their arguments is said before that.
    if verb == "accuracy":
        arguments.append(["--list"])
    arguments = [word for part in arguments for word in part]
    if verb == "explain":
        arguments = [word for word in arguments if word != "--measure"]
    return [verb, *(word for word in arguments if word != "/")]  # no test writes beside its folder


def files_in(folder):
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


class Arguments:
    def __init__(self, campaign):
        self.campaign = campaign

    def judge(self, draw, folder):
        (folder / "small.toml").write_text(SHOT)
        (folder / "empty.toml").write_text('[quality]\nlevel = "draft"\n[surface]\nresolution = 8\n[camera]\nresolution = [16, 9]\n[shot]\nframes = [1, 1]\n')
        (folder / "folder").mkdir()
        before = files_in(folder)
        arguments = argument_list(draw)
        run = self.campaign.run(*arguments, cwd=folder, timeout=60, stdin=b"")
        if arguments[0] == "verify":  # prints what it finds
            run.err += run.out
        self.campaign.ended_well(run)
        self.campaign.count(f"with status {run.status}")
        self.campaign.expect(not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]", run.err), f"control characters in {run.err[:500]!r}", run)
        self.campaign.expect(len(run.err) < 64 << 10, f"{len(run.err)} bytes of messages")
        if "\nSee: pelagic" in run.err:
            self.campaign.expect(files_in(folder) == before, "a command line that is wrong changed files", run)


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="backslashreplace")  # arguments need not be UTF-8
    campaign = Campaign(__doc__.split("\n")[0], 2000)
    campaign.go(Arguments(campaign).judge)
