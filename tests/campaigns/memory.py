#!/usr/bin/env python3
"""What a run says that it needs of memory, and what it takes: surfaces, outputs, cascades, precisions, trains, maps,
tiles and pictures of all sizes. The peak that the system counts lies near what the refusal of the same run names: never
far above, or a machine that runs out isn't warned, nor far below, or shots that would run are refused."""

import os
import re
import signal
import threading

from common import Campaign
import common_shots

ALL_MAPS = ["displacement", "normal", "slope-variance", "whitecaps"]
SMALL_WAVES = {"waves.cascades": [{"size_m": 100.0, "resolution": 128}]}
LARGE_WAVES = {"waves.cascades": [{"size_m": 1000.0, "resolution": 2048}, {"size_m": 60.0, "resolution": 2048}]}
NO_MESH = {"output.mesh": "none"}


STORM = {**NO_MESH, "sea.wind_speed_mps": 24.0, "surface.size_m": 200.0, "effects.spray": True, "output.voxel_m": 0.5}
CAGE = {**SMALL_WAVES, "surface.kind": "cage", "surface.cage_file": "cage.obj"}
NEAR = {"camera.resolution": [200, 112], "camera.position_m": [0.0, -4.0, 4.0], "camera.look_at_m": [0.0, 10.0, 0.0]}


# A camera that looks along the sea, foam that lasts: much of what is held is foam's past, on waves' faces.
LEVEL = {"camera.resolution": [640, 360], "camera.position_m": [0.0, 0.0, 15.0], "camera.look_at_m": [0.0, 100.0, 10.0],
         "quality.level": "draft", "effects.foam_decay_s": 30.0}

# A planet from 30 km, looked at from above: foam's coarsest tiles, and the air's tables once more.
HIGH = {"surface.kind": "planet", "camera.resolution": [320, 180], "camera.position_m": [0.0, 0.0, 3e4],
        "camera.look_at_m": [3e4, 0.0, 0.0]}


def patch(side, **keys):
    return {"surface.resolution": side, "surface.size_m": 200.0, **keys}


# The verb, its options, the frames and the shot's keys.
CASES = [
    ("bake", [], 1, patch(2048)),
    ("bake", [], 4, patch(1024, **SMALL_WAVES)),
    ("bake", [], 4, patch(1024, **SMALL_WAVES, **{"output.mesh": "usda"})),
    ("bake", [], 2, patch(700, **SMALL_WAVES, **{"quality.level": "reference"})),
    ("bake", [], 4, patch(1500, **SMALL_WAVES, **{"output.attributes": []})),
    ("bake", [], 4, patch(1024, **{"waves.model": "trochoid", "output.attributes": ["normal"]})),
    ("bake", [], 1, patch(64, **LARGE_WAVES, **{"surface.size_m": 1.0})),
    ("bake", [], 4, {**NO_MESH, **SMALL_WAVES, "output.maps": ALL_MAPS, "output.map_resolution": 2048}),
    ("bake", [], 4, {**NO_MESH, **SMALL_WAVES, "output.maps": ["displacement"], "output.map_resolution": 2048}),
    ("bake", [], 4, {**NO_MESH, **SMALL_WAVES, "output.maps": ["normal"], "output.map_resolution": 2048}),
    ("bake", [], 4, {**NO_MESH, **SMALL_WAVES, "output.maps": ["whitecaps"], "output.map_resolution": 2048}),
    ("bake", [], 2, {**NO_MESH, **SMALL_WAVES, "output.maps": ALL_MAPS, "output.map_resolution": 1024,
                     "quality.level": "reference"}),
    ("bake", [], 2, {**NO_MESH, **LARGE_WAVES, "output.maps": ["displacement", "whitecaps"],
                     "output.cascade_tiles": True, "output.map_resolution": 64}),
    ("bake", [], 3, {"surface.kind": "projected-grid", "surface.cell_px": 1.0, "camera.resolution": [1280, 720],
                     "quality.level": "draft"}),
    ("bake", [], 3, patch(400, **SMALL_WAVES, **{"surface.kind": "near-far"})),
    ("bake", [], 3, {"surface.kind": "planet"}),
    ("bake", [], 2, {"surface.kind": "planet", "camera.position_m": [0.0, 0.0, 3e3], "camera.look_at_m": [1e4, 0.0, 0.0]}),
    ("bake", [], 8, {**STORM, "output.volumes": ["spray", "level-set"]}),
    ("bake", [], 8, {**STORM, "output.volumes": ["spray"]}),
    ("bake", [], 8, {**STORM, "output.volumes": ["level-set"]}),
    ("bake", [], 4, {**STORM, "output.volumes": ["spray"], "sea.wind_speed_mps": 14.0, "output.voxel_m": 0.2}),
    ("bake", [], 3, {**CAGE, "surface.cage_level": 6}),
    ("bake", [], 3, {**CAGE, **NEAR, "surface.cage_level": "adaptive", "surface.cell_px": 1.0}),
    ("render", ["--samples", 1], 1, {"sea.wind_speed_mps": 20.0, "camera.resolution": [64, 36]}),
    ("render", ["--samples", 1], 1, {"quality.level": "draft", "camera.resolution": [4096, 2304]}),
    ("render", ["--samples", 1], 3, {"quality.level": "draft", "camera.resolution": [2048, 1152]}),
    ("render", ["--samples", 8], 1, {"quality.level": "draft", "camera.resolution": [1024, 128]}),
    ("render", ["--samples", 1], 2, {"quality.level": "draft", "camera.resolution": [1280, 720], "surface.cell_px": 1.0}),
    ("render", ["--samples", 1], 1, {"quality.level": "reference", "camera.resolution": [512, 288],
                                     "camera.position_m": [0.0, -60.0, 40.0], "surface.cell_px": 2.0}),
    # Where little is asked for, the program itself takes most.
    ("bake", [], 1, patch(16, **SMALL_WAVES)),
    ("bake", [], 16, {**NO_MESH, **SMALL_WAVES, "output.maps": ["normal"], "output.map_resolution": 64}),
    ("render", ["--samples", 1], 1, {**SMALL_WAVES, "camera.resolution": [64, 36]}),
    ("render", ["--samples", 1], 1, HIGH),
    ("render", ["--samples", 2], 1, {**HIGH, "camera.resolution": [640, 360]}),
    ("bake", [], 1, HIGH),
    ("bake", ["--threads", 3], 6, {**NO_MESH, **SMALL_WAVES, "output.maps": ["whitecaps"], "output.map_resolution": 2048}),
    ("bake", [], 1, {**CAGE, **LEVEL, "surface.cage_level": 6, "camera.look_at_m": [0.0, 100.0, 150.0]}),
    ("render", ["--samples", 1], 1, LEVEL),
    ("render", ["--samples", 1], 3, LEVEL),
    ("render", ["--samples", 1], 1, {**LEVEL, "camera.look_at_m": [0.0, 0.0, 100.0]}),
    ("preview", [], 1, {"sea.wind_speed_mps": 20.0, "camera.resolution": [640, 360]}),
    ("preview", [], 1, {"quality.level": "draft", "camera.resolution": [4096, 2304]}),
    ("preview", [], 1, {**LARGE_WAVES, "camera.position_m": [0.0, -60.0, 1.0], "camera.look_at_m": [0.0, -59.0, 0.0],
                        "camera.resolution": [320, 180]}),
]
BELOW, ABOVE = 0.80, 1.30
# Of a preview: what the driver takes beside what is known of it.
DRIVER_MIB = 40.0

campaign = Campaign("Memory that runs say they need, and take.", len(CASES))


def write_cage(path):
    """Twenty by twenty faces over 120 m, whose texture has a seam between any two."""
    side = 21
    lines = [f"v {6 * x - 60} {6 * y - 60} {(x * y) % 5}" for y in range(side) for x in range(side)]
    for face in range((side - 1) ** 2):
        x, y = face % (side - 1), face // (side - 1)
        lines += [f"vt {x + u} {y + 0.9 * v}" for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
        corners = (x + side * y, x + 1 + side * y, x + 1 + side * (y + 1), x + side * (y + 1))
        lines.append("f " + " ".join(f"{point + 1}/{4 * face + k + 1}" for k, point in enumerate(corners)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def arguments_of(folder, case):
    verb, options, frames, keys = CASES[case % len(CASES)]
    if "surface.cage_file" in keys:
        write_cage(folder / keys["surface.cage_file"])
    shot = folder / "shot.toml"
    shot.write_text(common_shots.shot_text({"shot.frames": [1, frames], **keys}), encoding="utf-8")
    out = ["--offscreen", folder / "out.exr"] if verb == "preview" else ["--out", folder / "out"]
    threads = [] if "--threads" in options else ["--threads", 2]
    return [verb, shot, *out, *options, *threads]


def peak_mib(folder, arguments):
    """The program's exit status, and its largest resident memory."""
    with open(folder / "words.txt", "wb") as words:
        process = os.posix_spawn(campaign.program, [str(campaign.program), *map(str, arguments)], os.environ,
                                 file_actions=[(os.POSIX_SPAWN_DUP2, words.fileno(), 1),
                                               (os.POSIX_SPAWN_DUP2, words.fileno(), 2)])
        watch = threading.Timer(600, os.kill, (process, signal.SIGKILL))
        watch.start()
        _, status, usage = os.wait4(process, 0)
        watch.cancel()
    return os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024


def mib_of(number, unit):
    return float(number) * {"KiB": 1 / 1024, "MiB": 1, "GiB": 1024}[unit]


def judge(draw, folder):
    arguments = arguments_of(folder, draw.case)
    need, how = 0.0, "at least"
    # A preview looks at little first: what its pixels show decides about the rest, and once it may have that much it says so.
    while how == "at least":
        allowed = "1K" if need == 0.0 else f"{need + 1.0:.0f}M"
        refused = campaign.run(*arguments, "--max-memory", allowed, timeout=600)
        named = re.search(r"needs (about|at least) ([\d.]+) ([KMG]iB) of memory", refused.err)
        campaign.expect(refused.status == 2 and named, "it isn't refused with the memory that it needs", refused)
        campaign.expect(not (folder / "out").exists(), "a refused run left a folder", refused)
        how, more = named[1], mib_of(named[2], named[3])
        campaign.expect(more > need, f"with {allowed} it needs {how} {more:.1f} MiB", refused)
        need = more
    status, peak = peak_mib(folder, arguments)
    words = (folder / "words.txt").read_text(errors="replace")
    campaign.expect(status == 0, f"exit status {status}: {words[-1000:]}")
    line = (f"{arguments[0]} {' '.join(map(str, arguments[4:-2]))} {CASES[draw.case % len(CASES)][3]}: "
            f"needs {need:.0f} MiB by its own words, took {peak:.0f} MiB")
    print(f"  {draw.case}: {line}", flush=True)
    campaign.expect(BELOW * need <= peak <= ABOVE * need + (DRIVER_MIB if arguments[0] == "preview" else 0.0), line)


campaign.go(judge)
