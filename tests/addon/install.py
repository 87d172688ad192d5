"""The zip is installed as a user does it, in a home of its own: enabled, disabled, enabled again; and it bakes a volume.

    install.py -- ZIP
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

sys.path.insert(0, str(ROOT / "addon"))
import make_zip

archive = sys.argv[-1]
folder = Path(bpy.utils.user_resource("SCRIPTS", path="addons", create=True))
assert Path(os.environ["HOME"]) in folder.parents, f"{folder} isn't in the test's own home"
sys.path[:] = [path for path in sys.path if path != str(ROOT / "addon")]

with checking("the zip's form: one folder, with the manifest of an extension and the same version as bl_info"):
    with zipfile.ZipFile(archive) as opened:
        names = opened.namelist()
        manifest = tomllib.loads(opened.read("pelagic_ocean/blender_manifest.toml").decode())
    assert {name.split("/")[0] for name in names} == {"pelagic_ocean"}
    assert len(manifest["tagline"]) <= 64 and not manifest["tagline"].endswith(".")
    assert all(len(why) <= 64 and not why.endswith(".") for why in manifest["permissions"].values())
    assert not any("__pycache__" in name for name in names)

with checking("installing and enabling"):
    bpy.ops.preferences.addon_install(filepath=archive, overwrite=True)
    bpy.ops.preferences.addon_enable(module="pelagic_ocean")
    import pelagic_ocean
    from pelagic_ocean import module
    assert folder in Path(pelagic_ocean.__file__).parents
    assert folder in Path(module.pelagic.__file__).parents, module.pelagic.__file__
    assert manifest["version"] == ".".join(map(str, module.VERSION)) == module.pelagic.__version__
    assert (pelagic_ocean.bl_info["name"], pelagic_ocean.bl_info["version"]) == (module.TITLE, module.VERSION)
    bpy.ops.pelagic.add_ocean()
    assert np.ptp(numbers(bpy.context.object.data)[:1000, 2]) > 0.1

with checking("the module is part of the add-on's package, as Blender wants it, and a script's own `pelagic` is another beside it"):
    assert not [name for name, found in sys.modules.items()
                if str(folder) in (getattr(found, "__file__", None) or "") and not name.startswith("pelagic_ocean")]
    with tempfile.TemporaryDirectory() as own:
        shutil.copytree(Path(module.pelagic.__file__).parent, own, dirs_exist_ok=True)
        sys.path.insert(0, own)
        import pelagic
        sys.path.remove(own)
    assert pelagic is not module.pelagic
    for each in (pelagic, module.pelagic):
        scene = each.Scene()
        scene.sea.swell = [each.Swell(1.0, 9.0, 110.0)]
        assert type(scene.sea.swell[0]) is each.Swell and each.Swell.__module__ == each.__name__
        try:
            scene.surface.kind = "nowhere"
        except each.ShotError:
            continue
        raise AssertionError("no such surface, and it is taken")

with checking("the module's libraries come from the zip"):
    needed = make_zip.shared_libraries(module.pelagic.__file__)
    assert needed and all(folder in path.parents for path in needed.values()), needed
    # Those that Blender itself has loaded already, by the same name, are shared with it.
    loaded = {line.split()[-1] for line in open("/proc/self/maps", encoding="utf-8") if str(folder) in line}
    assert any("libtomlplusplus" in path for path in loaded), loaded

with checking("a volume is baked, and what writes it comes from the zip, also where nothing else has loaded OpenVDB"):
    work = tempfile.mkdtemp()
    sea = bpy.context.object
    sea.pelagic_bake.folder = work
    sea.pelagic.surface.size_m, sea.pelagic.output.voxel_m = 40.0, 2.0
    bpy.context.scene.frame_start = bpy.context.scene.frame_end = 1
    assert bpy.ops.pelagic.bake_volume(kind="level-set") == {"FINISHED"}
    assert list(Path(work).rglob("*.vdb"))
    # Blender itself has one, which is shared by its name. Another program has none.
    script = """
import sys
def libraries():
    return {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
sys.path.insert(0, sys.argv[1])
before = libraries()
from pelagic_ocean import module
pelagic = module.pelagic
scene = pelagic.Scene()
scene.shot.frames, scene.surface.size_m, scene.output.voxel_m = (1, 1), 40.0, 2.0
scene.output.mesh, scene.output.volumes = "none", ("level-set",)
pelagic.bake(scene, sys.argv[2])
print(*libraries() - before, sep="\\n")
"""
    told = subprocess.run(["/usr/bin/python3", "-c", script, str(folder), f"{work}/alone"], check=True, capture_output=True,
                          text=True, cwd=work).stdout.splitlines()
    assert list(Path(work, "alone").rglob("*.vdb"))
    there = Path(module.pelagic.__file__).parent
    packed = tuple(name.split(".so")[0] for name in os.listdir(there))
    ours = [Path(path) for path in told if Path(path).name.startswith(packed)]
    assert len(ours) > 15 and any("libopenvdb" in path.name for path in ours)
    assert not [path for path in ours if there not in path.parents], ours

with checking("disabling: nothing is left, and the file stays usable"):
    bpy.ops.preferences.addon_disable(module="pelagic_ocean")
    assert not hasattr(bpy.types.Object, "pelagic") and not hasattr(bpy.types, "PELAGIC_PT_object")
    assert not any("pelagic" in handler.__module__ for name in dir(bpy.app.handlers)
                   if isinstance(getattr(bpy.app.handlers, name), list)
                   for handler in getattr(bpy.app.handlers, name))
    bpy.context.scene.frame_set(5)

with checking("enabling again: the ocean plays on"):
    before = numbers(bpy.context.object.data)
    bpy.ops.preferences.addon_enable(module="pelagic_ocean")
    bpy.context.scene.frame_set(6)
    assert not np.array_equal(numbers(bpy.context.object.data), before)

if bpy.app.version >= (4, 2):
    with checking("as an extension: valid, installed, enabled, with a sea and a folder of its own"):
        home = {**os.environ, "HOME": f"{work}/home"}
        os.makedirs(home["HOME"])
        use = ("import bpy; bpy.ops.pelagic.add_ocean(); assert len(bpy.context.object.data.vertices) > 1000; "
               "from bl_ext.user_default.pelagic_ocean import module, presets; "
               "import addon_utils; assert not dict(addon_utils._extensions_warnings_get()), addon_utils._extensions_warnings_get(); "
               f"assert module.__file__.startswith({home['HOME']!r}) and 'extensions' in str(presets.folder(create=True))")
        for arguments in (["--command", "extension", "validate", archive],
                          ["--command", "extension", "install-file", "--repo", "user_default", "--enable", archive],
                          ["-b", "--python-exit-code", "1", "--python-expr", use]):
            told = subprocess.run([bpy.app.binary_path, *arguments], capture_output=True, text=True, env=home)
            assert told.returncode == 0, (arguments, told.stdout, told.stderr)

with checking("the module shows Blender one function, and nothing that one of its libraries may have as well"):
    if shutil.which("nm"):
        told = subprocess.run(["nm", "-DC", "--defined-only", module.pelagic.__file__], check=True, capture_output=True,
                              text=True).stdout.splitlines()
        names = [line.split(maxsplit=2)[1:] for line in told]
        assert [name for kind, name in names if kind.isupper() and kind not in "VW"] == ["PyInit_pelagic"]
        # Weak ones, of the C++ runtime's templates, are in many a library; those of other libraries would be theirs or ours by chance.
        others = ("tbb::", "openvdb::", "OpenSubdiv::", "Imf_", "Imath_", "hwy::", "fftw")
        assert not [name for _, name in names if any(other in name for other in others)]
