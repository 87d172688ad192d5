"""What the campaigns share: many runs of the program, each judged, a case that can be run again, and a last line with
the counts.

A campaign is a script whose cases have numbers, each drawn from its own: `--only 17` runs that one again and keeps its
files, and `--first 5000` begins there.
"""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import traceback

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Failure(Exception):
    """What was wrong with a case, as a sentence."""


class Run:
    """A finished run of the program: status (negative: the signal that ended it), out, err, seconds."""

    def __init__(self, arguments, status, out, err, seconds):
        self.arguments, self.status, self.out, self.err, self.seconds = arguments, status, out, err, seconds

    def words(self):
        return f"{' '.join(map(str, self.arguments))}\nstatus {self.status}\n{self.out[-2000:]}{self.err[-2000:]}"


class Campaign:
    """Cases first … first + count − 1, each judged by judge(random, folder), which raises Failure where something is wrong.
    random.case is the case's number, in a list of cases modulo its length."""

    def __init__(self, description, count, arguments=None):
        parser = argparse.ArgumentParser(description=description)
        parser.add_argument("--count", type=int, default=count, help=f"cases (default {count})")
        parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
        parser.add_argument("--only", type=int, help="run this case alone, and keep its files")
        parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases side by side (default: processors)")
        parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/pelagic")
        if arguments:
            arguments(parser)
        self.options = parser.parse_args()
        self.program = self.options.program.resolve()
        program = self.program.read_bytes()
        # Sanitizers reserve terabytes of addresses.
        self._limits_memory = not any(name in program for name in (b"__asan_init", b"__tsan_init"))
        self._counts, self._lock = collections.Counter(), threading.Lock()
        if not self.program.exists():
            parser.error(f"{self.program} isn't there: build it first, or say --program")

    def run(self, *arguments, timeout=60, memory_gib=8, limits=None, cwd=None, env=None, stdin=None):
        """Runs the program. A run that takes longer than `timeout` seconds is a failure; one that wants more memory
        is told so by the system. limits: more of them, {resource.RLIMIT_…: bytes}."""

        def set_limits():
            for kind, most in {resource.RLIMIT_AS: memory_gib << 30, resource.RLIMIT_CORE: 0, **(limits or {})}.items():
                resource.setrlimit(kind, (most, most))

        command = [str(self.program), *map(str, arguments)]
        start = time.monotonic()
        try:
            done = subprocess.run(command, capture_output=True, timeout=timeout, cwd=cwd, env=env, input=stdin,
                                  preexec_fn=set_limits if memory_gib and self._limits_memory else None)
        except subprocess.TimeoutExpired:
            raise Failure(f"more than {timeout} s: {' '.join(command)}") from None
        return Run(command, done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"),
                   time.monotonic() - start)

    def count(self, what):
        """One more of these: the last line says how many there were."""
        with self._lock:
            self._counts[what] += 1

    def expect(self, true, sentence, run=None):
        if not true:
            raise Failure(sentence + (f"\n{run.words()}" if run else ""))

    def ended_well(self, run, statuses=(0, 2, 3, 75)):
        """No signal, no sanitizer's report, no exception's bare text, and a message with every failure."""
        self.expect(run.status in statuses, f"exit status {run.status}", run)
        for bad in ("AddressSanitizer", "ThreadSanitizer", "runtime error:", "terminate called", "std::", "basic_string"):
            self.expect(bad not in run.err, f"{bad!r} in its messages", run)
        self.expect(run.status == 0 or run.err.strip(), "it failed without a word", run)

    def go(self, judge, all_together=None):
        """Judges the cases and ends the process: exit status 0 only if none failed. all_together() is asked after them:
        a sentence if what it gathered is wrong."""
        first = self.options.first
        cases = [self.options.only] if self.options.only is not None else range(first, first + self.options.count)
        failures, start = [], time.monotonic()

        def case(number):
            folder = pathlib.Path(tempfile.mkdtemp(prefix=f"pelagic-{number}-"))
            draw = random.Random(number)
            draw.case = number
            try:
                judge(draw, folder)
            except Failure as failure:
                return number, str(failure)
            except Exception:  # a fault of the campaign's own, or an answer that it doesn't know: the others go on
                return number, traceback.format_exc()
            finally:
                if self.options.only is None:
                    shutil.rmtree(folder, ignore_errors=True)
                else:
                    print(f"case {number}: its files are in {folder}")
            return None

        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            for done, failed in enumerate(pool.map(case, cases), 1):
                if failed:
                    failures.append(failed)
                    again = shlex.join([sys.executable, *sys.argv, "--only", str(failed[0])])
                    print(f"case {failed[0]}: {failed[1]}\nagain: {again}", flush=True)
                if done % max(1, len(cases) // 10) == 0:
                    print(f"{done} of {len(cases)}, {len(failures)} failed, {time.monotonic() - start:.0f} s", flush=True)
        if all_together and (wrong := all_together()):
            failures.append((None, wrong))
            print(wrong)
        counts = "".join(f", {number} {what}" for what, number in sorted(self._counts.items()))
        print(f"{pathlib.Path(sys.argv[0]).name}: {len(cases)} cases, {len(failures)} failed{counts}")
        sys.exit(1 if failures else 0)
