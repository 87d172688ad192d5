#!/usr/bin/env python3
"""Damage to the files of random bakes and renders: `pelagic verify` names each, the next run makes the same bytes again."""

from common import Campaign

campaign = Campaign(__doc__, 300)
DAMAGES = 6  # of a case, one after another; then all of its last ones together


def shot_text(draw):
    """A small shot: any mesh, any maps, cascades or trains, a patch or what a camera sees."""
    name = draw.choice(["sea", "sea-2", "S_1", "7th", "normal"])
    maps = draw.sample(["displacement", "normal", "slope-variance", "whitecaps"], draw.randint(0, 4))
    volumes = draw.sample(["spray", "level-set"], draw.choice([0, 0, 1, 2]))
    mesh = draw.choice(["usda", "usdc", "usdc", "none"]) if maps or volumes else draw.choice(["usda", "usdc"])
    grid = mesh != "none" and draw.random() < 0.3
    lines = ["[shot]", f'name = "{name}"', f"frames = [1, {draw.randint(2, 4)}]", f"seed = {draw.randint(1, 999)}",
             "[sea]", f"wind_speed_mps = {draw.uniform(3, 18):.2f}", "[waves]"]
    if draw.random() < 0.3:
        lines += ['model = "trochoid"', f"trains = {draw.randint(5, 30)}"]
    else:
        lines.append("cascades = [ { size_m = 90.0, resolution = 128 }, { size_m = 23.0, resolution = 32 } ]")
    lines += ["[surface]", 'kind = "projected-grid"\ncell_px = 40' if grid
              else f"size_m = 60\nresolution = {draw.choice([2, 5, 16])}",
              "[effects]", "spray = true", "[camera]", "resolution = [64, 36]", "[quality]", 'level = "draft"',
              "[output]", f'mesh = "{mesh}"', f"maps = {maps}".replace("'", '"'),
              f"map_resolution = {draw.choice([8, 16])}", f"volumes = {volumes}".replace("'", '"'), "voxel_m = 4"]
    if maps and draw.random() < 0.4 and "model" not in "".join(lines):
        lines.append("cascade_tiles = true")
    return name, "\n".join(lines) + "\n"


def flip(draw, data):
    at = draw.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1:]


def zeros(draw, data):
    at, length = draw.randrange(len(data)), draw.choice([1, 8, 64, 512, 4096])
    return data[:at] + b"\0" * len(data[at:at + length]) + data[at + length:]


def header(draw, data):
    length = min(len(data), draw.choice([4, 16, 64, 256]))
    return bytes(draw.randrange(256) for _ in range(length)) + data[length:]


def cut(draw, data):
    return data[:draw.randrange(len(data))]


def append(draw, data):
    return data + bytes(draw.randrange(256) for _ in range(draw.choice([1, 16, 4096])))


def files_below(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def judge(draw, folder):
    name, text = shot_text(draw)
    shot, out = folder / "shot.toml", folder / "out"
    shot.write_text(text, encoding="utf-8")
    runs = [["bake", shot, "--out", out]]
    if draw.random() < 0.5:
        runs.append(["render", shot, "--out", out])
    for run in runs:
        done = campaign.run(*run, timeout=300)
        campaign.ended_well(done, (0,))
    whole = files_below(out)
    done = campaign.run("verify", out)
    campaign.expect(done.status == 0, "a folder that nobody touched isn't whole", done)

    damaged = {}
    for _ in range(DAMAGES):
        path = draw.choice(sorted(whole))
        data = whole[path]
        kind = draw.choice([flip, flip, zeros, header, cut, append, "removed", "swapped"])
        others = [other for other in whole if other != path and other.endswith(path[-5:]) and whole[other] != data]
        if kind == "swapped" and others:
            other = draw.choice(others)
            (out / path).write_bytes(whole[other])
            (out / other).write_bytes(data)
            touched = [path, other]
        elif kind in ("removed", "swapped"):
            kind = "removed"
            (out / path).unlink()
            touched = [path]
        else:
            changed = kind(draw, data)
            if changed == data:
                continue
            (out / path).write_bytes(changed)
            touched = [path]
        campaign.count(kind if isinstance(kind, str) else kind.__name__)
        done = campaign.run("verify", out)
        judge_found(done, out, touched)
        if draw.random() < 0.5:
            damaged.update({path: (out / path).read_bytes() if (out / path).exists() else None for path in touched})
        for path in touched:
            (out / path).write_bytes(whole[path])

    for path, data in damaged.items():
        (out / path).write_bytes(data) if data is not None else (out / path).unlink()
    for run in runs:
        done = campaign.run(*run, timeout=300)
        campaign.ended_well(done, (0,))
    after = files_below(out)
    campaign.expect(after == whole, "made again, these aren't as before: " +
                    ", ".join(path for path in sorted(set(whole) | set(after)) if whole.get(path) != after.get(path)), done)


def judge_found(done, out, touched):
    campaign.expect(done.status == 3, f"unnoticed: {touched}", done)
    for path in touched:
        # Where the record is gone, its files are foreign: nobody knows it.
        known = f" {out}/{path} " in done.out or (path.endswith(".json") and "foreign: " in done.out)
        campaign.expect(known, f"not named: {path}", done)


campaign.go(judge)
