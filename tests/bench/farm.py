#!/usr/bin/env python3
"""What a farm and a host live with, as a table with targets: records where locks don't lock, the cost of tasks, kills, arrays, the library.

    farm.py BUILD [--kills N] [--arrays N]

N: how many kills of tasks that share a folder (default 100) and arrays on a Slurm of this machine with tasks killed and a node down
(default 1; skipped where it can't be started); 0 leaves their row out. A row in which a command fails is missed, and the table goes on. Frames are written to /dev/shm, where that is: a disk's time isn't asked about.
"""

import argparse
import filecmp
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
SHORT = """[shot]
name = "short"
frames = [1, {frames}]
[waves]
cascades = [ {{ size_m = 60.0, resolution = 32 }} ]
[surface]
size_m = 40
resolution = 8
"""
MIDDLING = """[shot]
name = "middling"
frames = [1, 256]
[surface]
resolution = 512
"""


LOCKS = "400 frames in 4 tasks with locks that don't lock, 20 times: frames in the record; folders of one bake's bytes"
LONG = "a one-frame task beside 9998 others of a shot over one in an empty folder: CPU, clock"
SHARED = "256 frames in 8 tasks over one process: CPU"
KILLS = "tasks killed, and shots of whose frames any was lost or differs"
ARRAYS = "arrays with a SIGKILL and a node down: whole; whose files differ; that didn't end (a time that ran out, a disk that stayed in use)"
FRAME = "default frame of the C interface: memory; CPU"
UNLOADED = "dlopen … dlclose, 100 times, threads 1, 2, 8: growth in the last 90"


def row(what, measured, target, met):
    print(f"| {what} | {measured} | {target} | {'' if met is None else 'met' if met else '**missed**'} |", flush=True)


class Failed(Exception):
    """A command that ended with another status than 0."""


def run(*command, **more):
    """Its output, the seconds of its processors, and those of the clock. Raises Failed."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **more)
    clock, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        print(f"{command}: status {done.returncode}\n{done.stdout}{done.stderr}", file=sys.stderr)
        raise Failed(f"{Path(str(command[0])).name} {command[1]}: status {done.returncode}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, clock


def rows(what, measure):
    """measure() prints the row `what`; where a command fails, that stands in it."""
    try:
        measure()
    except Failed as failed:
        row(what, failed, "", False)


def same(one, other):
    files = [{path.relative_to(at) for path in at.rglob("*") if path.is_file()} for at in (one, other)]
    return files[0] == files[1] and all(filecmp.cmp(one / file, other / file, shallow=False) for file in files[0])


def tasks(pelagic, shot, out, frames, count, together, **more):
    each = frames // count
    lines = [[pelagic, "bake", shot, "--out", out, "--threads", "1", "--frames", f"{first}-{first + each - 1}"] for first in range(1, frames + 1, each)]
    if not together:
        return sum(run(*line, **more)[1] for line in lines)
    running = [subprocess.Popen(list(map(str, line)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more) for line in lines]
    statuses = [process.wait() for process in running]
    if any(statuses):
        raise Failed(f"tasks at the same time: status {max(statuses, key=abs)}")
    return None


def locks(pelagic, shim, folder):
    shot, whole, out, rounds = folder / "short.toml", folder / "whole", folder / "out", 20
    shot.write_text(SHORT.format(frames=400))
    run(pelagic, "bake", shot, "--out", whole)
    frames, equal = set(), 0
    for _ in range(rounds):
        shutil.rmtree(out, ignore_errors=True)
        tasks(pelagic, shot, out, 400, 4, True, env={**os.environ, "LD_PRELOAD": str(shim)})
        run(pelagic, "verify", out)
        frames.add(len(json.loads((out / "short.json").read_text())["frames"]))
        equal += same(out, whole)
    row(LOCKS, f"{min(frames)}; {equal} of {rounds}", "400, same bytes", frames == {400} and equal == rounds)


def long_record(pelagic, folder):
    shot, out, empty = folder / "short.toml", folder / "long", folder / "empty"
    shot.write_text(SHORT.format(frames=10000))
    run(pelagic, "bake", shot, "--out", out, "--frames", "1-9998")
    least = {}
    for _ in range(9):
        shutil.rmtree(empty, ignore_errors=True)
        for at in (out, empty):
            _, *took = run(pelagic, "bake", shot, "--out", at, "--frames", "9999")
            least[at] = [min(pair) for pair in zip(took, least.get(at, took))]
            shutil.rmtree(at / "record", ignore_errors=True)
            for file in (at / "mesh").glob("*.9999.*"):
                file.unlink()
    cpu, clock = (long / short for long, short in zip(least[out], least[empty]))
    row(LONG, f"{cpu:.2f}, {clock:.2f} ×", "≤ 1.3",
        max(cpu, clock) <= 1.3)


def shared_out(pelagic, folder):
    shot, out, frames, count = folder / "middling.toml", folder / "out256", 256, 8
    shot.write_text(MIDDLING)
    found = []
    for _ in range(3):
        _, one, _ = run(pelagic, "bake", shot, "--out", out, "--threads", "1")
        shutil.rmtree(out)
        several = tasks(pelagic, shot, out, frames, count, False)
        shutil.rmtree(out)
        found.append((several / one, 1000 * one / frames, (several - one) / (count - 1)))
    ratio, frame_ms, begin_s = sorted(found)[1]
    row(SHARED, f"{ratio:.2f} ×: frames of {frame_ms:.0f} ms, {begin_s:.2f} s a task to begin", "≤ 1.1", ratio <= 1.1)


def kills(pelagic, count):
    done = subprocess.run([sys.executable, TESTS / "campaigns/signals.py", "--count", str(-(-count // 12)), "--kills", "12", "--program", pelagic],
                          capture_output=True, text=True)
    said = (done.stdout.strip().splitlines() or [""])[-1]
    found = [re.search(rf"(\d+) {word}", said) for word in ("kills", "cases", "failed")]
    if not all(found):
        print(done.stderr[-2000:], file=sys.stderr)
        raise Failed(f"signals.py: status {done.returncode}")
    killed, shots, failed = (int(each[1]) for each in found)
    row(KILLS, f"{killed}, {failed} of {shots}", "0 in 1000 kills", done.returncode == 0)


def arrays(pelagic, count):
    whole = differ = not_ended = 0
    for _ in range(count):
        done = subprocess.run([sys.executable, TESTS / "farm/arrays.py", pelagic, "--nightly"], capture_output=True, text=True)
        if done.returncode == 77:
            return row(ARRAYS, done.stdout.strip(), "0 of 10 differ", None)
        has_other_files = any(f"AssertionError: other {what}: " in done.stderr for what in ("files", "bytes"))
        whole, differ = whole + (done.returncode == 0), differ + has_other_files
        not_ended += done.returncode != 0 and not has_other_files
        if done.returncode:
            print(done.stderr[-2000:], file=sys.stderr)
    row(ARRAYS, f"{whole}; {differ}; {not_ended}", "none differs of 10, all end", differ == not_ended == 0)


def default_frame(build, folder):
    shot = folder / "default.toml"
    shot.write_text("[shot]\n")
    found = []
    for _ in range(5):  # processes: where memory lies in pieces, the first waits for the system to clear huge pages
        said, _, _ = run(build / "bench/bench_procedural", shot)
        _, _, first, mib = (cell.strip() for cell in next(line for line in said.splitlines() if "frame_create" in line).strip("|").split("|"))
        found.append(float(first.split()[0]))
    ms = sorted(found)[2]
    row(FRAME, f"{mib} MiB; {ms / 1000:.2f} s (of five processes {min(found) / 1000:.2f} … {max(found) / 1000:.2f})", "≤ 256 MB; ≤ 0.3 s",
        int(mib) * 1.048576 <= 256 and ms <= 300)


def unloaded(build):
    with tempfile.NamedTemporaryFile(suffix=".json") as told:
        run(build / "tests/test_procedural_unload", "--gtest_filter=Threads/UnloadRounds.*", f"--gtest_output=json:{told.name}")
        suites = json.loads(Path(told.name).read_text())["testsuites"]
    grown = [int(test["grown_kib"]) for suite in suites for test in suite["testsuite"]]
    frame = min((int(test["frame_kib"]) for suite in suites for test in suite["testsuite"]), default=0)
    # A frame's samples are one block, which the allocator may keep at one of the two moments and not at the other.
    row(UNLOADED, f"{', '.join(f'{kib / 1024:.1f}' for kib in grown)} MiB", f"less than two frames of the 90: {2 * frame / 1024:.1f} MiB",
        bool(grown) and max(grown) < 2 * frame)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--arrays", type=int, default=1)
    options = parser.parse_args()
    build = options.build.resolve()
    pelagic = build / "pelagic"
    if os.access("/dev/shm", os.W_OK):
        os.environ["TMPDIR"] = "/dev/shm"
    print("| What | Measured | Target | |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        rows(LOCKS, lambda: locks(pelagic, next(build.rglob("libpelagic_test_no_locks.so")), folder))
        rows(LONG, lambda: long_record(pelagic, folder))
        rows(SHARED, lambda: shared_out(pelagic, folder))
        rows(FRAME, lambda: default_frame(build, folder))
        rows(UNLOADED, lambda: unloaded(build))
    if options.kills:
        rows(KILLS, lambda: kills(pelagic, options.kills))
    if options.arrays:
        arrays(pelagic, options.arrays)


if __name__ == "__main__":
    main()
