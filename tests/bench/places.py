#!/usr/bin/env python3
"""Prints one table of waves at a place and weather in time: what, measured, target.
  places.py BUILD [ROUNDS [FRAMES]]

What the waves are is measured by tests, which record their figures; what they cost by bench_places.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SEEDS = 100  # of heroes; their test asks a dozen by day

# Program, test, property, what it is, largest value, its unit and factor.
FIGURES = [
    ("evaluate", "Vessels.MakeKelvinsWaves", "off_deg_at_10", "wake: loudest angle at 10 λ against the integral's", 0.3, "°", 1),
    ("evaluate", "Vessels.MakeKelvinsWaves", "off_deg_at_20", "at 20 λ", 0.3, "°", 1),
    ("evaluate", "Vessels.MakeKelvinsWaves", "off_deg_at_28", "at 28 λ (the tile ends at 32; the target is at 40)", 0.3, "°", 1),
    ("evaluate", "Vessels.DragWavesOfTheirOwnSpeed", "length_off", "transverse wavelength over 2πU²/g", 1, " %", 100),
    ("evaluate", "Vessels.LeaveANarrowWakeWhenFast", "integral_off", "angle against Fr, by the integral", 6, " %", 100),
    ("evaluate", "Vessels.LeaveANarrowWakeWhenFast", "froude_off_from_1.2", "angle ∝ 1/Fr, from Fr 1.2 to 2.2", 6, " %", 100),
    ("evaluate", "Vessels.LeaveANarrowWakeWhenFast", "froude_off_from_0.8", "angle ∝ 1/Fr, from Fr 0.8 to 2.2", 6, " %", 100),
    ("evaluate", "Masks.ShowAndHideWhatTheySayAcrossAnEdge", "variance_off", "shown + hidden variance across a mask's edge", 1, " %", 100),
    ("evaluate", "Masks.ShowAndHideWhatTheySayAcrossThatOfAPicture", "variance_off", "across that of a picture", 1, " %", 100),
    ("waves", "Weather.HasTheHeightOfItsSpectrumAtEachFrame", "height_off", "keyed wind: Hs of each frame against its spectrum", 2, " %", 100),
    ("waves", "Weather.VelocitiesHoldTheAmplitudesOwnChange", "velocity_off", "keyed wind: velocity against differences", 1e-3, "", 1),
    ("waves", "HeroWaves.StandWhereTheyAreAskedForInAnySea", "height_off", f"hero: height at its place and time, {SEEDS} seeds, the worst", 1, " %", 100),
    ("waves", "HeroWaves.HaveTheShapeOfTheSeasCorrelation", "shape_off", "hero: mean shape against theory, of its height", 2, " %", 100),
    ("evaluate", "FloatingResponse.OfABargeIsThatOfItsEquationsInTime", "rms_off", "float by response against integration in time, box barge, 3 seas", 5, " %", 100),
    ("waves", "CoastTest.APlaneBeachIsSnells", "height_off", "plane beach: √(c_g0 cos α₀/c_g cos α)", 2, " %", 100),
    ("waves", "CoastTest.APlaneBeachIsSnells", "off_deg", "Snell's angle", 1, "°", 1),
    ("waves", "CoastTest.APlaneBeachIsSnells", "flux_off", "energy flux", 2, " %", 100),
    ("evaluate", "Coast.OneTrainBreaksAtItsLimit", "limit_off", "breaking of one train at H/d, off 0.78", 0.05, "", 1),
    ("waves", "CoastTest.ASeaBreaksByThorntonAndGuza", "height_off", "H_rms/d of a sea against the sheet's", 10, " %", 100),
]
# What must be the same to the bit.
SAME = [
    ("a keyed sun: each frame's sky is its own bake's (target 1 %)", "render", ["KeyedPictures.AreThoseOfThePlainNumbers"]),
    ("frame N alone, of a run, 1 and 2 threads", "evaluate",
     ["Vessels.AreTheSameAloneInARunAndOnOneThread", "Vessels.LeaveTheSameStripAloneInARunAndOnOneThread",
      "MaskPictures.AreTheSameToTheBitInEveryFrameHoweverItIsMade",
      "Coast.IsTheSameOnOneThreadAndTwoAndFinite", "CoastTiles.AreTheSameOnOneThreadAndTwoAndAloneAsInARun"]),
    ("frame N alone, of a run, of numbers with keys", "waves",
     ["Weather.AFrameAloneIsThatOfARun", "Weather.DisplacementOfAFrameAloneIsThatOfARun",
      "Weather.OverADepthThatChangesEachTimeIsItsOwn"]),
    ("a front that moves is a still one that is placed there", "evaluate", ["GustFronts.AreToTheBitWhereAStillOneWouldBe"]),
    ("heroes' trains, whatever is asked of the sea", "waves", ["HeroWaves.AreTheSameWhateverIsAskedOfTheSea"]),
    ("a shot without any of it, or where it doesn't reach", "evaluate",
     ["Masks.LeaveTheSeaBeyondThemAsItIsToTheBit", "Masks.ThatChangeNothingAreNone", "GustFronts.LeaveWhatLiesBeyondThemAsItIs",
      "GustFronts.ArentSaidWhereThereAreNone", "Coast.ChangesNothingOverALevelFloor", "CoastTiles.ChangeNothingWhereItIsDeep"]),
]


def tests_of(build, program, names):
    """Runs some tests; by name: whether one ran to its end and passed, and what it recorded."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        subprocess.run([build / "tests" / f"test_{program}", f"--gtest_filter={':'.join(names)}", f"--gtest_output=json:{report}"],
                       stdout=subprocess.DEVNULL, env=os.environ | {"PELAGIC_SEEDS": str(SEEDS)})
        suites = json.loads(report.read_text())["testsuites"]
    return {f"{suite['name']}.{test['name']}": (test["result"] == "COMPLETED" and "failures" not in test, test)
            for suite in suites for test in suite["testsuite"]}


def main():
    build = pathlib.Path(sys.argv[1])
    wanted = {}
    for program, test, *_ in FIGURES:
        wanted.setdefault(program, set()).add(test)
    for _, program, tests in SAME:
        wanted.setdefault(program, set()).update(tests)
    found = {program: tests_of(build, program, sorted(names)) for program, names in wanted.items()}
    rows = []
    for program, test, name, what, target, unit, factor in FIGURES:
        has_passed, test_report = found[program].get(test, (False, {}))
        recorded = test_report.get(name)
        measured = "not measured" if recorded is None else f"{factor * float(recorded):.2g}{unit}"
        is_met = has_passed and recorded is not None and factor * float(recorded) <= target
        rows.append((what, measured if has_passed else f"{measured}: {test} didn't pass", f"≤ {target:g}{unit}",
                     "met" if is_met else "missed"))
    for what, program, tests in SAME:
        failed = [test for test in tests if not found[program].get(test, (False,))[0]]
        rows.append((what, "same bits" if not failed else "didn't pass: " + ", ".join(failed), "same bits", "missed" if failed else "met"))
    costs = subprocess.run([build / "bench" / "bench_places", *sys.argv[2:]], stdout=subprocess.PIPE, text=True, check=True).stdout
    rows += [tuple(line.split("\t")) for line in costs.splitlines()]
    print("| what | measured | target | |\n|---|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
