#!/usr/bin/env python3
"""A shot shared out by `pelagic farm` on a real Slurm is the shot that one bake leaves, byte by byte, whatever happens to its tasks.

  arrays.py PROGRAM             eight frames in four tasks
  arrays.py PROGRAM --nightly   64 frames in eight tasks, twice at once: one killed, one begun again, a node down, the controller
                                restarted, and a disk that fills
Ends with status 77 and says why, where no Slurm can be started.
"""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import slurm

SHOT = """[shot]
name = "small"
frames = [1, {frames}]
[waves]
tiling = "periodic"
cascades = [ {{ size_m = 60.0, resolution = 32 }} ]
[surface]
size_m = 40
resolution = {quads}
[output]
mesh = "usda"
maps = ["displacement", "whitecaps"]
map_resolution = {texels}
"""


def pelagic(*arguments, statuses=(0,)):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=600)
    assert done.returncode in statuses, f"{arguments}: status {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def files_in(folder):
    """The bytes of each file that isn't the farm's."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.relative_to(folder).parts[0] != "farm"}


def expect_same(farmed, whole):
    ours, theirs = files_in(farmed), files_in(whole)
    assert ours.keys() == theirs.keys(), f"other files: {sorted(ours.keys() ^ theirs.keys())}"
    differing = [name for name in ours if ours[name] != theirs[name]]
    assert not differing, f"other bytes: {differing}"


def status_of(out):
    """What --status says of the one job there."""
    lines = [json.loads(line) for line in pelagic("farm", "--status", out, "--json", statuses=(0, 3)).splitlines()]
    return next(line for line in lines if line["event"] == "result")


def submit(shot, out, tasks):
    said = pelagic("farm", shot, "--out", out, "--tasks", tasks, "--submit")
    return re.search(r"array (\d+)\nsubmitted: verify (\d+), after it", said).groups()


def logs_in(out):
    return "".join(f"== {log.name}\n{log.read_text(errors='replace')}" for log in sorted((out / "farm").glob("*.*"))
                   if log.suffix in (".log", ".slurm"))


def short_array(cluster, folder):
    shot, out, whole = folder / "shot.toml", folder / "a shot's 100 %", folder / "whole"
    shot.write_text(SHOT.format(frames=8, quads=8, texels=8))
    pelagic("bake", shot, "--out", whole)
    array, last = submit(shot, out, 4)
    dependency = cluster("squeue", "-h", "-j", last, "-o", "%E")
    assert f"afterany:{array}" in dependency, f"the check waits for {dependency!r}"
    cluster.wait(180)
    assert status_of(out)["whole"] == "1-8", logs_in(out)
    assert "all whole" in (out / "farm/small.bake.verify.log").read_text(), logs_in(out)
    assert len(list((out / "farm").glob("small.bake.*-*.log"))) == 4, "a log a task, by its frames"
    expect_same(out, whole)


def until(there, seconds, what, out):
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end, f"no {what} in {seconds} s\n{logs_in(out)}"
        time.sleep(0.1)


def programs_of(out):
    """The processes of bakes into the folder."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if words[0].decode(errors="replace") == PROGRAM and words[1] == b"bake" and os.fsencode(out) in words:
            found.append(int(process.name))
    return found


def bad_night(cluster, folder):
    frames, tasks = 64, 8
    shot, out, whole = folder / "shot.toml", folder / "out", folder / "whole"
    # About a fifth of a second a frame: time to hit tasks at work.
    shot.write_text(SHOT.format(frames=frames, quads=256, texels=512))
    pelagic("bake", shot, "--out", whole)
    size = sum(len(content) for content in files_in(whole).values())
    out.mkdir()
    # All but four frames fit: the tasks that come to them end with status 75, and are begun again.
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size * (frames - 4) // frames}", "tmpfs", out], check=True)
    first, _ = submit(shot, out, tasks)
    submit(shot, out, tasks)  # the same again, beside it
    until(lambda: len(programs_of(out)) > 1, 180, "task at work", out)
    os.kill(programs_of(out)[0], signal.SIGKILL)
    cluster.stop("slurmctld")  # killed, it would forget jobs of the last seconds: that is Slurm's
    cluster.start_controller()
    until(lambda: "RUNNING" in cluster("squeue", "-h", "-r", "-o", "%T", check=False), 180, "task that runs again", out)
    number = cluster("squeue", "-h", "-r", "-t", "RUNNING", "-o", "%F_%K").split()[0]
    cluster("scontrol", "requeue", number, check=False)  # it may have ended just now
    cluster("scontrol", "update", "NodeName=node4", "State=DOWN", "Reason=test")
    until(lambda: "no space left on the device" in logs_in(out), 600, "full disk", out)
    found = status_of(out)
    assert found["running"] or found["failed"], f"{found}\n{logs_in(out)}"
    subprocess.run(["mount", "-o", f"remount,size={4 * size}", out], check=True)
    cluster("scontrol", "update", "NodeName=node4", "State=RESUME", check=False)  # it may have come back by itself
    cluster.wait(900)
    found = status_of(out)
    assert found["whole"] == f"1-{frames}", f"{found}\n{logs_in(out)}"
    checked = (out / "farm/small.bake.verify.log").read_text().rstrip()
    assert "all whole" in checked and checked.endswith(f"\nwhole: 1-{frames}"), logs_in(out)
    said = logs_in(out)
    for what in ("with status 137, and is begun again", "with status 75, and is begun again"):
        assert what in said, f"nothing ended {what}: the test asked nothing\n{said}"
    expect_same(out, whole)
    assert not list(out.rglob(".*")), "hidden files are left"


def main():
    why = slurm.why_not()
    if why:
        print(f"skipped: {why}")
        sys.exit(77)
    if "PELAGIC_TEST_MOUNTS" not in os.environ:  # of its own, which end with it
        os.environ["PELAGIC_TEST_MOUNTS"] = "1"
        os.execvp("unshare", ["unshare", "--mount", "--kill-child", "--fork", sys.executable, *sys.argv])
    with tempfile.TemporaryDirectory(prefix="pelagic-farm-") as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        (folder / "slurm").mkdir()
        try:
            with slurm.Slurm(folder / "slurm") as cluster:
                (bad_night if "--nightly" in sys.argv else short_array)(cluster, folder)
        finally:
            if os.path.ismount(folder / "out"):
                subprocess.run(["umount", folder / "out"], check=True)
    print("byte by byte what one bake leaves")


PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else ""
if __name__ == "__main__":
    main()
