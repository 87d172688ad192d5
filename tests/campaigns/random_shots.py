#!/usr/bin/env python3
"""Random shots over the whole table of keys, baked and rendered by the program: they end well, every number in every
file is finite and what it may be, and nothing depends on threads, on other frames or on what lies there already."""

import statistics
import threading

from common import Campaign
import common_files
import common_shots

campaign = Campaign(__doc__.splitlines()[0], 1000)
pelagic = common_files.module(campaign.program)
common_shots.learn(pelagic)
_heights, _lock = [], threading.Lock()


def number_of(path):
    """The frame that a file is of, or none: NAME.0007.exr."""
    parts = path.split(".")
    return int(parts[-2]) if len(parts) > 2 and parts[-2].lstrip("-").isdigit() else None


def judge(draw, folder):
    shot = folder / "shot.toml"
    keys = common_shots.shot(draw, folder)
    shot.write_text(common_shots.shot_text(keys), encoding="utf-8")
    valid = campaign.run("validate", shot)
    campaign.ended_well(valid, (0, 2, 75))
    out = folder / "out"
    first = campaign.run("bake", shot, "--out", out, "--threads", "2", timeout=300)
    campaign.ended_well(first, (0, 2, 75))
    if first.status:
        campaign.expect(str(shot) in first.err, "refused without the file's name", first)
        campaign.expect(not out.exists(), "refused, and something was written", first)
        campaign.count("shots refused")
    else:
        campaign.expect(valid.status == 0, "baked although it isn't valid", valid)
        campaign.count("baked")
        judge_bake(draw, folder, keys, shot, out)
    if valid.status == 0 and draw.random() < 0.5:
        judge_pictures(draw, folder, keys, shot)


def judge_bake(draw, folder, keys, shot, out):
    held = common_files.check_folder(pelagic, out)
    made = common_files.bytes_below(out)
    name = keys.get("shot.name", "sea")
    record = held[f"{name}.json"]
    frames = range(keys["shot.frames"][0], keys["shot.frames"][1] + 1)
    campaign.expect([int(frame) for frame in record["frames"]] == list(frames), "the record has other frames")
    judge_heights(held, record)

    def written_at():
        return {path: (out / path).stat().st_mtime_ns for path in made if number_of(path) is not None}

    before = written_at()
    again = campaign.run("bake", shot, "--out", out, timeout=300)
    campaign.ended_well(again, (0,))
    campaign.expect(written_at() == before, "baked again, and frames were made again", again)
    campaign.expect(not (wrong := common_files.differences(made, common_files.bytes_below(out))),
                    f"baked again: {wrong}", again)

    if draw.random() < 0.3:
        campaign.count("compared on one thread")
        one = folder / "one"
        alone = campaign.run("bake", shot, "--out", one, "--threads", "1", timeout=300)
        campaign.ended_well(alone, (0,))
        campaign.expect(not (wrong := common_files.differences(made, common_files.bytes_below(one))),
                        f"on one thread: {wrong}", alone)
    if draw.random() < 0.3:
        campaign.count("compared with a frame alone")
        frame, part = draw.choice(list(frames)), folder / "part"
        alone = campaign.run("bake", shot, "--out", part, "--frames", str(frame), timeout=300)
        campaign.ended_well(alone, (0,))
        of_frame = {path: data for path, data in made.items() if number_of(path) in (frame, None)}
        found = common_files.bytes_below(part)
        for files in (of_frame, found):
            files.pop(f"{name}.json")  # holds the frames that are there
        campaign.expect(not (wrong := common_files.differences(of_frame, found)), f"frame {frame} alone: {wrong}", alone)


def judge_heights(held, record):
    """The sea's height beside the spectrum's, where the mesh shows nearly all of it."""
    expected = record["spectrum"]["hs_m"]
    for frame in record["frames"].values():
        if "hs_m" in frame and expected > 0:
            # Twice the height is four times the energy: a realisation of a few modes comes near it.
            campaign.expect(0 <= frame["hs_m"] < 3 * expected, f"waves of {frame['hs_m']} m, expected are {expected} m")
        if "mesh_hs_m" in frame and "hs_m" in frame:
            campaign.expect(frame["mesh_hs_m"] < 4 * frame["hs_m"] + 1e-6, f"a mesh of {frame['mesh_hs_m']} m, its sea "
                            f"has {frame['hs_m']} m")
    settings = record["settings"]
    peak_m = 1.56 * record["spectrum"]["tm_minus1_0_s"] ** 2
    texel_m = settings["surface.size_m"] / settings["surface.resolution"]
    if (settings["surface.kind"] == "patch" and settings["waves.model"] == "fft" and not settings["waves.cascades"]
            and settings["output.mesh"] != "none" and expected > 0.01 and texel_m < peak_m / 10):
        first = next(iter(record["frames"].values()))
        if "hs_m" in first:  # a record leaves out what nobody paid for
            with _lock:
                _heights.append(first["hs_m"] / expected)


def judge_pictures(draw, folder, keys, shot):
    out = folder / "pictures"
    size = draw.choice(["24x16", "33x9", "1x1"])
    arguments = ("render", shot, "--size", size, "--samples", "1", "--frames", str(keys["shot.frames"][0]), "--out")
    done = campaign.run(*arguments, out, "--threads", "2", timeout=300)
    campaign.ended_well(done, (0, 2, 75))
    if done.status:
        campaign.expect(not out.exists(), "refused, and something was written", done)
        campaign.count("pictures refused")
        return
    campaign.count("rendered")
    held = common_files.check_folder(pelagic, out)
    picture = next(value for path, value in held.items() if path.endswith(".exr"))
    for channel in "RGB":
        parts = sum(picture[f"{layer}.{channel}"].astype("f8") for layer in ("sun", "sky", "sea", "foam", "air"))
        error = abs(parts - picture[channel])
        campaign.expect((error <= 5e-3 * parts + 1e-6).all(), f"layers add up to another {channel}, by {error.max()}")
    if draw.random() < 0.3:
        campaign.count("rendered on one thread as well")
        one = folder / "pictures on one"
        alone = campaign.run(*arguments, one, "--threads", "1", timeout=300)
        campaign.ended_well(alone, (0,))
        wrong = common_files.differences(common_files.bytes_below(out), common_files.bytes_below(one))
        campaign.expect(not wrong, f"on one thread: {wrong}", alone)


def all_together():
    if len(_heights) < 10:
        return None
    mean = statistics.fmean(_heights)
    print(f"significant height beside the spectrum's: {mean:.3f} over {len(_heights)} seas that show nearly all of it")
    return None if 0.85 < mean < 1.05 else f"seas of {mean:.3f} of the height that the spectrum says"


campaign.go(judge, all_together)
