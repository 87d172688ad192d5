#!/usr/bin/env python3
"""Bakes and pictures under tight limits of address space, of data and of stacks. Each is done, refused before any work, or
ended with a sentence: no hang, no signal, no word of a bug, no torn file."""

import itertools
import resource

from common import Campaign
import common_shots

KEYS = {"shot.frames": [1, 3], "surface.size_m": 32.0, "surface.resolution": 32, "camera.resolution": [64, 36],
        "sea.wind_speed_mps": 15.0, "effects.spray": True, "output.voxel_m": 1.0}
SHOTS = {"bake with volumes": ("bake", {"output.volumes": ["spray", "level-set"], "output.mesh": "none"}), "bake": ("bake", {}),
         "render": ("render", {"shot.frames": [1, 2], "quality.level": "draft", "effects.spray": False})}
SPACES = {"address space": resource.RLIMIT_AS, "data": resource.RLIMIT_DATA}
# From where the system's loader has room, to where all is done.
SIZES_MB = {"address space": range(50, 402, 2), "data": range(10, 402, 2)}
TIMES = 3
SPACE_CASES = [(what, space, size_mb, time) for what in SHOTS for space in SPACES for size_mb in SIZES_MB[space]
               for time in range(TIMES)]
STACK_CASES = list(itertools.product(["bake with volumes", "render", "explain", "preview"], [64, 256]))
# A prime that doesn't divide their number: so that the first few cases are of all kinds. Those where memory may run out come
# first: with more, all is done, which takes longest and is asked at night.
STRIDE, TIGHT_MB = 997, {"address space": 200, "data": 110}
SPACE_CASES = sorted((SPACE_CASES[i * STRIDE % len(SPACE_CASES)] for i in range(len(SPACE_CASES))),
                     key=lambda case: case[2] > TIGHT_MB[case[1]])

CASES = len(STACK_CASES) + len(SPACE_CASES)

campaign = Campaign(__doc__.split(":")[0].replace("\n", " "), CASES)
outcomes = {}  # (shot, kind of limit): {outcome: [sizes]}


def arguments_of(what, folder):
    verb, keys = SHOTS.get(what, (what, {}))
    shot = folder / "shot.toml"
    shot.write_text(common_shots.shot_text({**KEYS, **keys}), encoding="utf-8")
    places = {"explain": [], "preview": ["--offscreen", folder / "out.png"]}
    return [verb, shot, *places.get(verb, ["--out", folder / "out", "--threads", 2])]


def is_under_its_name(path):
    return path.is_file() and not path.name.startswith(".")


def judge(draw, folder):
    case = draw.case
    if case >= CASES:  # in another order, so that a night's have some of all
        case = case * 331 % CASES
    if case < len(STACK_CASES):
        what, kib = STACK_CASES[case]
        run = campaign.run(*arguments_of(what, folder), limits={resource.RLIMIT_STACK: kib << 10}, timeout=120)
        campaign.ended_well(run, (0, 75))
        return
    number = case - len(STACK_CASES)
    what, space, size_mb, time = SPACE_CASES[number]
    # The last time past the check of memory, so that it runs out in the middle of the work.
    unchecked = ["--max-memory", "8G"] if time == TIMES - 1 else []
    run = campaign.run(*arguments_of(what, folder), *unchecked, limits={SPACES[space]: size_mb * 1000 * 1000}, timeout=60)
    campaign.ended_well(run, (0, 75))
    campaign.expect("bug in the program" not in run.err, "lack of memory is said to be a bug", run)
    out = folder / "out"
    has_files = out.exists() and any(map(is_under_its_name, out.rglob("*")))
    outcome = "done" if run.status == 0 else "ended" if has_files else "refused"
    if run.status == 0 and number % 8 == 0:
        verified = campaign.run("verify", out)
        campaign.expect(what == "render" or verified.status == 0, "what it says is done isn't whole", verified)
    if outcome != "done":
        campaign.expect(any(word in run.err for word in ("memory", "ulimit", "thread")),
                        "its sentence doesn't say what it lacks", run)
    campaign.count(outcome)
    outcomes.setdefault((what, space), {}).setdefault(outcome, []).append(size_mb)


def table():
    """Prints of each shot and limit how many runs ended which way, and from which to which size [MB]."""
    for (what, space), ends in sorted(outcomes.items()):
        print(f"{what}, {space}: " + "; ".join(f"{end} {len(sizes)} at {min(sizes)} … {max(sizes)} MB"
                                               for end, sizes in sorted(ends.items())))
    return None


if __name__ == "__main__":
    campaign.go(judge, table)
