"""In a window: a bake runs beside it, shows how far it is, is stopped by Esc, and goes on the next time.

    xvfb-run blender --factory-startup --enable-event-simulate --python baking_window.py
"""

import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import baking

MANY = 5000  # however fast they are, a key is pressed before the last
MORE = 30
folder = Path(tempfile.mkdtemp())


def frames():
    """The numbers of those that are baked, in order."""
    numbered = (file.name.split(".")[-2] for file in folder.rglob("*.usdc"))
    return sorted(int(number) for number in numbered if number.isdigit())


def steps():
    """Each yield lets the window work until the function is true."""
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        sea = add_ocean(surface__resolution=64)
        scene = bpy.context.scene
    sea.pelagic_bake.folder = str(folder)
    scene.frame_start, scene.frame_end = 1, MANY
    with bpy.context.temp_override(window=window):
        assert bpy.ops.pelagic.bake("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    assert not bpy.ops.pelagic.bake.poll()
    yield lambda: len(frames()) >= 3
    with checking("the window works meanwhile, and knows how far the bake is"):
        scene.frame_set(7)
        assert f"of {MANY} frames" in baking._baking.text, baking._baking.text
        assert is_alone_in_python()
    window.event_simulate(type="ESC", value="PRESS")
    window.event_simulate(type="ESC", value="RELEASE")
    yield lambda: baking._baking is None
    with checking("Esc stops it, and what is there is whole"):
        first = {file: file.stat().st_mtime_ns for file in folder.rglob("*.usdc")}
        assert 3 <= len(frames()) < MANY, len(frames())
    with bpy.context.temp_override(window=window):
        scene.frame_end = last = frames()[-1] + MORE
        bpy.ops.pelagic.bake("INVOKE_DEFAULT")
    yield lambda: baking._baking is None
    with checking("the next one goes on from there"):
        assert frames() == list(range(1, last + 1))
        kept = [file for file, when in first.items() if file.stat().st_mtime_ns == when]
        assert len(kept) >= len(first) - 1, (len(kept), len(first))
    with checking("closing the window that it began in stops it"):
        with bpy.context.temp_override(window=window):
            scene.frame_end = last + MANY
            bpy.ops.wm.window_new()
        other = bpy.context.window_manager.windows[-1]
        with bpy.context.temp_override(window=other):
            bpy.ops.pelagic.bake("INVOKE_DEFAULT")
            bpy.ops.wm.window_close()
        assert baking._baking is None and len(frames()) < last + MANY
    with bpy.context.temp_override(window=window):
        there = len(frames())
        bpy.ops.pelagic.bake("INVOKE_DEFAULT")
    yield lambda: len(frames()) >= there + 2
    with checking("another file stops it"):
        bpy.ops.wm.read_homefile()
        assert baking._baking is None
    shutil.rmtree(folder)


in_window(steps)
