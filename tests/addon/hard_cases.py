"""Each shot of tests/hard_cases through the add-on: refused with the reader's words and nothing left behind, or a mesh in Blender that is
finite and at its limit, also at the next frame. By day a third of those that are shown: the core's own tests have them all."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import play

SHOTS = ROOT / "tests" / "hard_cases" / "shots"


def promises(path):
    """What the first lines of a shot say must come of it (tests/hard_cases/hard_cases.h)."""
    promised = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            break
        name, colon, value = line[2:].partition(": ")
        if colon:
            promised[name] = value
    return promised


def import_shot(path):
    return bpy.ops.pelagic.import_shot(filepath=str(path), light=True)


def all_numbers(mesh):
    """Every number that the mesh holds at its points, by name."""
    held = {"position": numbers(mesh)}
    for attribute in mesh.attributes:
        if attribute.domain == "POINT" and attribute.data_type in ("FLOAT", "FLOAT_VECTOR") \
                and attribute.name != "position":
            held[attribute.name] = numbers(mesh, attribute.name)
    return held


def expect_limit(obj, limit, shot):
    held = all_numbers(obj.data)
    assert len(held["position"]) > 0, shot
    for name, values in held.items():
        assert np.isfinite(values).all(), f"{shot}: {name} isn't finite"
    heights = held["position"][:, 2]
    if limit == "flat":
        assert (heights == 0.0).all(), f"{shot}: {np.abs(heights).max()} m high"
    elif limit == "calm":
        assert np.abs(heights).max() < 0.1, f"{shot}: {np.abs(heights).max()} m high"


# What isn't shown, with the words that say so.
NOT_SHOWN = {"cage-eye": "An adaptive cage is baked, not shown",
             "far-near-far": "A mesh from near to far is baked, not shown"}


def expect_shown(obj, limit, shot):
    problem = play.simulation_of(obj).problem
    if shot in NOT_SHOWN:
        assert NOT_SHOWN[shot] in problem, problem
        assert len(obj.data.vertices) == 0
        return
    assert not problem, problem
    expect_limit(obj, limit, shot)


cases = sorted(SHOTS.glob("*.toml"))
assert len(cases) >= 60, len(cases)
if not at_night():
    fine = [path for path in cases if promises(path)["load"] == "fine"]
    cases = [path for path in cases if path not in fine or path in fine[::3]]
refusals = 0
fresh_file()  # once: the water's and the sky's groups of nodes stay, which take longer than most seas
for path in cases:
    promised = promises(path)
    with checking(path.stem):
        before = {obj.name for obj in bpy.data.objects}
        if promised["load"] != "fine":
            assert refused(lambda: import_shot(path), promised["load"]), f"{path.name} isn't refused"
            assert {obj.name for obj in bpy.data.objects} == before
            refusals += 1
            continue
        assert import_shot(path) == {"FINISHED"}
        obj = bpy.context.object
        expect_shown(obj, promised["limit"], path.stem)
        bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1)
        expect_shown(obj, promised["limit"], path.stem)
        for made in [made for made in bpy.data.objects if made.name not in before]:
            bpy.data.objects.remove(made)
        bpy.ops.outliner.orphans_purge()
assert refusals >= 10, refusals
