"""For the tests in the real Blender: the add-on from the sources, numbers of meshes, and what was checked.

    from harness import *       in the scripts of this folder
    with checking("what"):      says that it was checked; a failed assert or an exception ends Blender with an error
"""

import ctypes
import os
import sys
import tempfile
import threading
import traceback
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))


def enable(sky_width=128):
    """The add-on, registered from the sources; the compiled module comes from PYTHONPATH. sky_width: of the sky's picture in pixels,
    which each new light makes anew; None: the add-on's own, for tests of light."""
    import pelagic_ocean
    from pelagic_ocean import light, nodes
    light.SKY_WIDTH = sky_width or light.SKY_WIDTH
    nodes._shared_group = _keeping_groups(nodes._shared_group, nodes.MARK)
    pelagic_ocean.register()
    return pelagic_ocean


def _keeping_groups(shared_group, mark):
    """shared_group(), which makes each node group once a process: a file that is new gets those of the files before. Of the
    second that the first ocean of a file takes, they are most."""
    file, kept = Path(tempfile.mkdtemp()) / "groups.blend", set()

    def marked():
        return {group for group in bpy.data.node_groups if mark in group}

    def shared(name, build, inputs):
        if kept and not marked():
            with bpy.data.libraries.load(str(file)) as (source, target):
                target.node_groups = list(source.node_groups)
        before = marked()
        group = shared_group(name, build, inputs)
        if group not in before and name not in kept:
            kept.update(each.name for each in marked())
            bpy.data.libraries.write(str(file), marked())
        return group

    return shared


def at_night():
    """Whether there is time to ask at length."""
    return "PELAGIC_AT_NIGHT" in os.environ


def fresh_file():
    """Blender's start-up file, its cube taken away."""
    bpy.ops.wm.read_factory_settings()
    bpy.data.objects.remove(bpy.data.objects["Cube"])


def add_ocean(horizon=False, how="EXEC_DEFAULT", **settings):
    """A small ocean without a horizon, with all attributes, whose foam has no past to be found at each jump, all before its sea is
    first built; settings are keys with their dots as __, such as sea__wind_speed_mps. how: INVOKE_DEFAULT is as an artist does it."""
    from pelagic_ocean import ocean

    make = ocean.make

    def make_small(name, collection):
        obj = make(name, collection)
        obj.pelagic.horizon = horizon
        obj.pelagic.surface.resolution = 32
        obj.pelagic.uv_map = obj.pelagic.velocity = True
        obj.pelagic.effects.foam_decay_s = 0.0
        return obj

    ocean.make = make_small
    try:
        bpy.ops.pelagic.add_ocean(how)
    finally:
        ocean.make = make
    obj = bpy.context.object
    if settings:
        change(obj, **settings)
    return obj


def change(obj, **settings):
    for path, value in settings.items():
        table, name = path.split("__")
        setattr(getattr(obj.pelagic, table), name, value)
    bpy.context.view_layer.update()


def numbers(mesh, name="position"):
    """float32 (n, 3) or (n,) of positions or of a point attribute."""
    if name == "position":
        out = np.empty((len(mesh.vertices), 3), np.float32)
        mesh.vertices.foreach_get("co", out.ravel())
        return out
    attribute = mesh.attributes[name]
    out = np.empty((len(mesh.vertices), 3) if attribute.data_type == "FLOAT_VECTOR" else len(mesh.vertices), np.float32)
    attribute.data.foreach_get("vector" if attribute.data_type == "FLOAT_VECTOR" else "value", out.ravel())
    return out


def crease_edges(mesh, creases):
    """creases: 0 … 1, one for each edge."""
    if "crease" in bpy.types.MeshEdge.bl_rna.properties:  # before 4.0
        mesh.edges.foreach_set("crease", creases)
    else:
        (mesh.attributes.get("crease_edge") or mesh.attributes.new("crease_edge", "FLOAT", "EDGE")).data.foreach_set("value", creases)


def evaluated_mesh(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def resident_mib():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def is_alone_in_python():
    """Whether no thread beside this one has ever entered Python and may do so again."""
    return set(sys._current_frames()) == {threading.get_ident()}


def _processor_s():
    """Of this process and those it waited for: what else runs on the machine doesn't count."""
    return sum(os.times()[:4])


@contextmanager
def checking(what):
    start = _processor_s()
    try:
        yield
    except BaseException:
        print(f"FAILED: {what}", flush=True)
        raise
    print(f"checked: {what} ({_processor_s() - start:.1f} s of a processor)", flush=True)


def refused(call, words):
    """Whether an operator ends with an error that says so."""
    try:
        call()
    except RuntimeError as error:
        assert words in str(error), f"{error!r} doesn't say {words!r}"
        return True
    return False


class _XImage(ctypes.Structure):
    """The beginning of Xlib's XImage."""

    _fields_ = [(name, ctypes.c_int) for name in ("width", "height", "xoffset", "format")] + [("data", ctypes.c_void_p)] + [
        (name, ctypes.c_int) for name in ("byte_order", "unit", "bit_order", "pad", "depth", "bytes_per_line", "bits_per_pixel")]


def window_pixels(window):
    """What the screen shows where Blender's window is: float32 (height, width, 3), rows from the bottom, display values. Read from the X server:
    under Xvfb Blender's own screenshots are black from 4.x on."""
    x11 = ctypes.CDLL("libX11.so.6")
    for function in (x11.XOpenDisplay, x11.XDefaultRootWindow, x11.XGetImage):
        function.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    screen_height = x11.XDisplayHeight(display, 0)
    wide, high = window.width, window.height
    root = ctypes.c_void_p(x11.XDefaultRootWindow(display))
    image = x11.XGetImage(display, root, window.x, screen_height - window.y - high, wide, high, ctypes.c_ulong(2**32 - 1), 2)
    made = ctypes.cast(image, ctypes.POINTER(_XImage)).contents
    pixels = np.frombuffer(ctypes.string_at(made.data, made.bytes_per_line * high), np.uint8).reshape(high, -1, 4)[:, :wide]
    x11.XCloseDisplay(display)
    return pixels[::-1, :, 2::-1].astype(np.float32) / 255.0


def _may_write():
    """Whether scripts may write properties: not while Blender draws, also in another thread, as after a render."""
    try:
        bpy.data.window_managers[0]["harness"] = True
    except AttributeError:
        return False
    return True


def in_window(steps):
    """Runs steps(), a generator that yields functions: between two of its steps the window works until the function is
    true. Then Blender ends, with an error if a step failed."""
    running = steps()
    waiting_for = [lambda: True]

    @bpy.app.handlers.persistent
    def go_on():
        try:
            if _may_write() and waiting_for[0]():
                waiting_for[0] = next(running)
            return 0.1
        except StopIteration:
            code = 0
        except BaseException:
            traceback.print_exc()
            code = 1
        sys.stdout.flush()
        os._exit(code)

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(go_on, first_interval=0.5, persistent=True)
