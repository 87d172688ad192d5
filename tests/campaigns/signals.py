#!/usr/bin/python3
"""Bakes and renders that are stopped, killed and put to sleep at random moments, several times over one folder: what has
a name of its own is whole, and the next run leaves what an undisturbed one leaves, byte for byte.

With --kills a case is a farm's folder: up to three tasks at a time, each of some of the frames, and each ended by SIGKILL."""

import concurrent.futures
import json
import re
import shutil
import signal
import subprocess
import time

from common import Campaign, Failure

STOPS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
MAPS = ("displacement", "normal", "slope-variance", "whitecaps")
LONGEST_S = 120


def shot(draw, name, seed):
    frames = draw.randint(2, 6)
    maps = [f'"{each}"' for each in MAPS if draw.random() < 0.3]
    volumes = [f'"{each}"' for each in ("spray", "level-set") if draw.random() < 0.3]
    mesh = draw.choice(("usda", "usdc", "none") if maps or volumes else ("usda", "usdc"))
    trains = draw.random() < 0.25
    return f"""
[shot]
name = "{name}"
frames = [1, {frames}]
seed = {seed}
{"loop_s = 0.125" if draw.random() < 0.2 else ""}
[waves]
{'model = "trochoid"' if trains else "cascades = [ { size_m = 60.0, resolution = 32 } ]"}
{"trains = 12" if trains else ""}
[surface]
kind = "{draw.choice(("patch", "near-far", "projected-grid")) if not maps else "patch"}"
size_m = 40
resolution = {draw.choice((8, 24, 64))}
[camera]
resolution = [{draw.randint(2, 6) * 8}, {draw.randint(2, 4) * 8}]
[effects]
spray = true
[quality]
level = "{draw.choice(("draft", "preview"))}"
[output]
mesh = "{mesh}"
maps = [{", ".join(maps)}]
map_resolution = {draw.choice((8, 32))}
volumes = [{", ".join(volumes)}]
voxel_m = 2
cascade_tiles = {"true" if maps and not trains and draw.random() < 0.3 else "false"}
"""


def files_below(folder):
    return {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}


def is_hidden(name):
    return name.rsplit("/", 1)[-1].startswith(".")


def is_record(name):
    return name.endswith(".json")


def check_whole(campaign, out, wholes, run):
    """Each file is one that an undisturbed run of one of the shots left; records are whole JSON."""
    for name, path in files_below(out).items():
        if is_hidden(name):
            continue
        content = path.read_bytes()
        if is_record(name):
            try:
                json.loads(content)
            except ValueError as error:
                raise Failure(f"{name} is torn: {error}\n{run}") from None
        else:
            campaign.expect(any(content == whole.get(name) for whole in wholes),
                            f"{name}, {len(content)} bytes, is no file of an undisturbed run\n{run}")


def disturb(campaign, draw, arguments, whole_s):
    """One run, and what is sent to it meanwhile. Says how it went."""
    process = subprocess.Popen([campaign.program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    start, sent, story = time.monotonic(), [], []
    asleep = False
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        # Often close to what went before: in the middle of its handling.
        wait_s = draw.uniform(0.0, 0.8 * whole_s) if not sent or draw.random() < 0.5 else draw.uniform(0.0, 0.01)
        time.sleep(wait_s)
        if process.poll() is not None:
            break
        name = draw.choice((*STOPS, "SIGKILL", "SIGKILL", "SIGSTOP"))
        process.send_signal(getattr(signal, name))
        campaign.count("kills" if name == "SIGKILL" else "other signals")
        sent.append(name)
        story.append(f"{name} after {time.monotonic() - start:.3f} s")
        if name == "SIGSTOP":
            asleep = True
            if draw.random() < 0.8:
                time.sleep(draw.uniform(0.0, 0.2))
                process.send_signal(signal.SIGCONT)
                asleep = False
    if asleep:
        process.send_signal(draw.choice((signal.SIGCONT, signal.SIGKILL)))
        sent.append("SIGKILL")
    try:
        out, err = process.communicate(timeout=LONGEST_S)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        raise Failure(f"it didn't end: {arguments}, {story}\n{err.decode()}") from None
    status = process.returncode
    story = f"{' '.join(map(str, arguments))}: {', '.join(story) or 'not disturbed'}: status {status}\n{err.decode()[-1500:]}"
    numbers = [getattr(signal, name) for name in sent]
    # As the program ends, or, before it has begun, as the system ends it.
    campaign.expect(status == 0 or status in [128 + number for number in numbers] or -status in numbers,
                    f"it ended otherwise than by a signal that it got\n{story}")
    stopped = status != 0
    campaign.count("runs stopped" if stopped else "runs that finished before")
    if stopped and status > 0:
        campaign.expect(b"stopped" in err, f"it stopped without a word\n{story}")
        campaign.expect(out == b"", f"it stopped, and said that it was done\n{story}")
    return story


def kill(campaign, draw, arguments, whole_s):
    """One task, ended by SIGKILL. Says how it went, and whether it was done before."""
    process = subprocess.Popen([campaign.program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        _, err = process.communicate(timeout=draw.uniform(0.0, whole_s))
    except subprocess.TimeoutExpired:
        process.kill()
        _, err = process.communicate()
    status = process.returncode
    story = f"{' '.join(map(str, arguments))}: status {status}\n{err.decode()[-1500:]}"
    campaign.expect(status in (0, -signal.SIGKILL), f"it ended by itself\n{story}")
    campaign.count("tasks done before" if status == 0 else "kills")
    return story, status == 0


def kill_tasks(campaign, draw, commands, wholes, whole_s, out):
    """Tasks that share the folder are killed, until there were options.kills; what they leave is looked at each time."""
    kills = 0
    while kills < campaign.options.kills:
        command, last = draw.choice(commands)
        tasks = [[*command, "--threads", str(draw.randint(1, 2)), "--frames", f"{(first := draw.randint(1, last))}-{draw.randint(first, last)}"]
                 for _ in range(draw.randint(1, 3))]
        with concurrent.futures.ThreadPoolExecutor(3) as pool:
            ends = list(pool.map(lambda task: kill(campaign, draw, task, whole_s), tasks))
        kills += sum(not done for _, done in ends)
        if out.exists():
            check_whole(campaign, out, wholes, "\n".join(story for story, _ in ends))
            if all(done for _, done in ends):
                shutil.rmtree(out)  # nothing is left to do: begin again


def main():
    def options(parser):
        parser.add_argument("--kills", type=int, help="tasks that share a folder, and so many kills a case")

    campaign = Campaign(__doc__, 600, options)

    def judge(draw, folder):
        verb = draw.choice(("bake", "bake", "render"))
        # A second shot in the same folder: another one, or the first one changed, whose files take its names.
        shots = [shot(draw, "sea", 1)]
        if draw.random() < 0.5:
            shots.append(shot(draw, draw.choice(("sea", "bay")), 2))
        commands, wholes, whole_s = [], [], 0.1
        for number, text in enumerate(shots):
            (folder / f"{number}.toml").write_text(text)
            whole = folder / f"whole-{number}"
            run = campaign.run(verb, folder / f"{number}.toml", "--out", whole, timeout=LONGEST_S)
            campaign.expect(run.status == 0, "an undisturbed run failed", run)
            whole_s = max(whole_s, run.seconds)
            wholes.append({name: path.read_bytes() for name, path in files_below(whole).items()})
            commands.append([verb, folder / f"{number}.toml", "--out", folder / "out"])
        if campaign.options.kills:
            lasts = [int(re.search(r"frames = \[1, (\d+)\]", text)[1]) for text in shots]
            kill_tasks(campaign, draw, list(zip(commands, lasts)), wholes, whole_s, folder / "out")
        for _ in range(0 if campaign.options.kills else draw.randint(1, 4)):
            command = [*draw.choice(commands), "--threads", str(draw.randint(1, 4))]
            story = disturb(campaign, draw, command, whole_s)
            if (folder / "out").exists():
                check_whole(campaign, folder / "out", wholes, story)
        run = campaign.run(*commands[0], timeout=LONGEST_S)
        campaign.expect(run.status == 0, "the next run failed", run)
        there = files_below(folder / "out")
        for name, content in wholes[0].items():
            campaign.expect(name in there, f"{name} is missing after the next run", run)
            if not is_record(name) or len(shots) == 1:
                campaign.expect(there[name].read_bytes() == content, f"{name} differs after the next run", run)
        for name in there:
            campaign.expect(not is_hidden(name), f"{name} is left over", run)
        check_whole(campaign, folder / "out", wholes, run.words())
        again = campaign.run(*commands[0], timeout=LONGEST_S)
        campaign.expect(again.status == 0 and "kept as they were" in again.out and "0 frames" in again.out,
                        "a whole shot isn't kept", again)

    campaign.go(judge)


if __name__ == "__main__":
    main()
