"""The add-on without its compiled module, or with one of another Python: a sentence says so, and files keep their settings.

    without_module.py -- FOLDER_OF_THE_MODULE
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

with_module = sys.argv[-1]
folder = Path(tempfile.mkdtemp())
blend = str(folder / "sea.blend")
sources = str(ROOT / "addon")


def with_the_module(script):
    """Runs lines in another Blender, which has the module."""
    start = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\nfrom harness import *\nenable()\n"
    subprocess.run([bpy.app.binary_path, "-b", "--factory-startup", "--python-use-system-env", "--python-exit-code", "1",
                    "--python-expr", start + script], check=True, env={**os.environ, "PYTHONPATH": with_module}, stdout=subprocess.DEVNULL)


with checking("the package registers, and says what is missing"):
    import pelagic_ocean
    pelagic_ocean.register()
    from pelagic_ocean import module
    assert module.pelagic is None and "can't be loaded" in module.problem
    assert refused(bpy.ops.pelagic.add_ocean, "poll()")

with checking("a file with an ocean opens, keeps its settings, and has a marker that says what is missing"):
    with_the_module(f"add_ocean(sea__wind_speed_mps=23.0); bpy.ops.wm.save_as_mainfile(filepath={blend!r})")
    bpy.ops.wm.open_mainfile(filepath=blend)
    obj = bpy.data.objects["Ocean"]
    assert obj.pelagic.is_ocean and len(obj.data.polygons) == 128 and "needs the add-on" in obj["Pelagic Ocean"]
    assert bpy.ops.pelagic.check_farm() == {"FINISHED"}
    assert "can't be loaded" in bpy.data.texts[0].as_string() and "Ocean is a live sea" in bpy.data.texts[0].as_string()
    bpy.context.scene.frame_set(5)
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    with_the_module(f"bpy.ops.wm.open_mainfile(filepath={blend!r})\n"
                    "assert bpy.data.objects['Ocean'].pelagic.sea.wind_speed_mps == 23.0")

with checking("a module of another Python is named, with what would fit"):
    pelagic_ocean.unregister()
    for name in [name for name in sys.modules if name.startswith("pelagic_ocean")]:
        del sys.modules[name]
    shutil.copytree(Path(sources) / "pelagic_ocean", folder / "pelagic_ocean")
    (folder / "pelagic_ocean" / "lib").mkdir(exist_ok=True)
    (folder / "pelagic_ocean" / "lib" / "pelagic.cpython-39-x86_64-linux-gnu.so").write_bytes(b"")
    sys.path.insert(0, str(folder))
    import pelagic_ocean
    pelagic_ocean.register()
    from pelagic_ocean import module
    here = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert module.pelagic is None and "cpython-39" in module.problem and f"Python {here}" in module.problem

with checking("a file that isn't a module at all"):
    pelagic_ocean.unregister()
    for name in [name for name in sys.modules if name.startswith("pelagic_ocean")]:
        del sys.modules[name]
    tag = f"cpython-{sys.version_info.major}{sys.version_info.minor}"
    (folder / "pelagic_ocean" / "lib" / f"pelagic.{tag}-x86_64-linux-gnu.so").write_bytes(b"no library")
    import pelagic_ocean
    pelagic_ocean.register()
    from pelagic_ocean import module
    assert module.pelagic is None and "can't be loaded" in module.problem
