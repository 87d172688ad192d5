# SPDX-License-Identifier: GPL-3.0-or-later
"""Plays a bake: an object that shows a baked sequence of meshes from disk, without simulating.

Blender need not read USD for it: pelagic.read_mesh does. The mesh is put together as that of a live ocean is.
"""

import json
import re
import zlib
from functools import lru_cache
from pathlib import Path

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, FloatVectorProperty, IntProperty, PointerProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from mathutils import Vector

from . import fitted, handlers, light, look, material, meshes, ocean, surfaces, volumes
from .module import pelagic
from .operators import NeedsModule
from .properties import OVERRIDABLE, overridable
from .query import first_ocean
from .surfaces import Surface

ENTRIES = {key["path"]: getattr(pelagic, key["entry"]) for key in pelagic.keys() if key["entry"]} if pelagic else {}
DATA = {key["path"] for key in pelagic.keys() if key["type"].startswith("data")} if pelagic else set()
UV_M = 100.0  # of a camera's grid: the length that is 1 in its UV map
# Far out rest positions begin again after this length, so that they stay fine: a multiple of UV_M and of the longest step
# of a mesh's origin.
WRAP_M = 102400.0
MOST_QUADS, EASY_QUADS = 8192, 2048  # a side, of a fitted cage's refined mesh: at all, and unless more are asked for
ACCEPTED = "accepted: a bake's folder, or NAME.json or NAME.usda in it"


class Bake:
    """The files of a bake: DIR/NAME.json and DIR/mesh/NAME.####.usdc."""

    def __init__(self, path):
        """path: NAME.json, NAME.usda, or the folder of a single bake. OSError or ValueError, in words."""
        path = Path(path)
        if path.is_dir():
            records = sorted(path.glob("*.json"))
            if len(records) != 1:
                raise ValueError(f"{path}: {len(records) or 'no'} bakes in this folder; {ACCEPTED}")
            path = records[0]
        self.record = path.with_suffix(".json")
        self.name, self.folder = self.record.stem, self.record.parent / "mesh"
        try:
            told = json.loads(self.record.read_text(encoding="utf-8"))
            shot = _scene_of(told["settings"])
            self.scene, self.changing = shot.at(shot.shot.frames[0]), ocean.changing(shot)
            self.is_patch = told["settings"].get("surface.kind", "patch") == "patch"
            dense = told.get("dense_foam")  # since records tell it
            self.dense_foam = (float(dense["active"]), float(dense["left"])) if dense else None
        except FileNotFoundError:
            raise ValueError(f"{self.record}: is not there; {ACCEPTED}") from None
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise ValueError(f"{self.record}: is not the record of a bake ({error})") from None
        self.first, self.last = self.scene.shot.frames
        self.files = {int(match[1]): file for file in self.folder.glob(f"{self.name}.*.usd?")
                      if (match := re.fullmatch(re.escape(self.name) + r"\.(-?\d{3,})\.usd[ac]", file.name))}
        self.files = {frame: file for frame, file in self.files.items() if self.first <= frame <= self.last}
        if not self.files:
            raise ValueError(f"{self.folder}: has no frames of {self.name}; accepted: a bake with a mesh")

    def missing(self):
        """The frames of the shot that aren't on disk, in words: "3, 7-9", "" if none."""
        return volumes.words_of(frame for frame in range(self.first, self.last + 1) if frame not in self.files)

    def nearest(self, frame):
        """The last frame on disk up to this one, or the first there is."""
        return max((each for each in self.files if each <= frame), default=min(self.files))

    @property
    def is_fitted(self):
        """Whether the mesh on disk is a cage whose limit surface is the sea."""
        return self.scene.output.mesh_scheme == "catmullClark"

    def smoothed(self, arrays, halvings):
        """A cage's arrays on its limit surface, each quad's sides halved so often, and the surface()."""
        quads = self.scene.surface.resolution
        halvings = _at_most(halvings, quads, MOST_QUADS)
        try:
            made = fitted.refined(arrays, quads, 1 << halvings)
        except ValueError as error:
            raise ValueError(f"{self.folder}: {error}") from None
        return made, surfaces.patch(self.scene.surface.size_m, quads << halvings, False)

    def surface(self, arrays):
        """What meshes.put_surface() takes, for a frame's arrays."""
        told = arrays if "face_corners" in arrays else self._topology()
        corners = told["face_corners"]
        points = len(arrays["position"])
        if len(told["st"]) != points if self.is_patch else corners.max() >= points:
            raise ValueError(f"{self.folder}: a frame has {points} points, and its faces are of others")
        starts = np.concatenate([[0], np.cumsum(told["face_counts"])[:-1]]).astype(np.int32)
        signature = f"baked {points} {zlib.crc32(corners):08x} {zlib.crc32(starts):08x}"
        if not self.is_patch:  # where the points rest nobody knows any more
            origin_m = arrays.get("origin_m", np.zeros(3))[:2]
            rest = arrays["position"][:, :2] + (origin_m - WRAP_M * np.round(origin_m / WRAP_M)).astype(np.float32)
            return Surface(signature, rest, 1.0, lambda: (corners, starts), uv_m=UV_M, moves=True)
        size_m = np.float32(self.scene.surface.size_m)
        return Surface(signature, (told["st"] - np.float32(0.5)) * size_m, 1.0, lambda: (corners, starts), uv_m=size_m)

    def _topology(self):
        for file in sorted(self.folder.glob(f"{self.name}.topology.usd?")):
            return _read(str(file), file.stat().st_mtime_ns)
        raise ValueError(f"{self.folder}: {self.name}.topology.usdc is missing")


def _at_most(halvings, quads, most):
    """As many halvings as make no more quads a side."""
    while halvings and quads << halvings > most:
        halvings -= 1
    return halvings


def _scene_of(settings):
    """Of a record's."""
    scene = pelagic.Scene()
    for path, value in settings.items():
        table, name = path.split(".")
        if isinstance(value, list) and value and isinstance(value[0], dict):
            value = tuple(ENTRIES[path](**entry) for entry in value)
        # A bake's frames hold the surface; who looks at its scene sees sea and light, and needs no cage.
        if value is not None and path not in DATA and (path, value) != ("surface.kind", "cage"):
            setattr(getattr(scene, table), name, value)
    return scene


@lru_cache(2)
def _read(path, _changed_ns):
    return pelagic.read_mesh(path)


@lru_cache(8)
def _bake(path, _changed_ns, _folder_changed_ns):
    return Bake(path)


def bake_of(obj):
    """The Bake that an object plays. OSError or ValueError, in words."""
    record = Path(bpy.path.abspath(obj.pelagic_baked.path))
    folder = record.parent / "mesh"
    try:
        return _bake(str(record), record.stat().st_mtime_ns, folder.stat().st_mtime_ns)
    except FileNotFoundError as error:
        raise ValueError(f"{error.filename}: is not there; {ACCEPTED}") from None


def _is_fitted(obj):
    try:
        return bake_of(obj).is_fitted
    except (OSError, ValueError):
        return False


def _move(obj, origin_m):
    """Puts the object where its points' origin is, by a delta transform: its location stays its user's. Returns what must
    be added to its points, since it couldn't be moved, or None."""
    turned = obj.matrix_basis.to_3x3()
    step = turned @ Vector(origin_m) - Vector(obj.pelagic_baked.origin_m)
    if not step.length:
        return None
    try:
        obj.pelagic_baked.origin_m = Vector(obj.pelagic_baked.origin_m) + step
        obj.delta_location = obj.delta_location + step
    except AttributeError:  # while Blender draws a window no script may write properties: meshes._sign()
        return np.array(turned.inverted_safe() @ step, np.float32)
    return None


problems = {}  # object's name → why it doesn't show the frame


def show(obj, frame):
    """Puts the bake's mesh of a Blender frame into the object. Returns its origin; None, and what is wrong in problems, if
    it couldn't."""
    problems.pop(obj.name_full, None)
    try:
        bake = bake_of(obj)
        wanted = min(max(frame - obj.pelagic_baked.offset, bake.first), bake.last)
        nearest = bake.nearest(wanted)
        if nearest != wanted:
            problems[obj.name_full] = f"Missing on disk: {bake.missing()}. Shown instead of {wanted}: {nearest}"
        file = bake.files[nearest]
        arrays = _read(str(file), file.stat().st_mtime_ns)
        if bake.is_fitted:
            arrays, surface = bake.smoothed(arrays, obj.pelagic_baked.halvings)
        else:
            surface = bake.surface(arrays)
        if "wet" in arrays:  # meshes without hulls have no such attribute, which Blender's nodes read as 0
            arrays = {**arrays, "dry": 1 - arrays["wet"]}
        if not meshes.holds(obj.data, surface):
            meshes.put_surface(obj.data, surface)
        elif surface.moves:
            meshes.move_rest(obj.data, surface)
        left_m = _move(obj, arrays["origin_m"])
        meshes.put_frame(obj.data, arrays if left_m is None else {**arrays, "position": arrays["position"] + left_m})
        return arrays["origin_m"]
    except (OSError, ValueError) as error:
        problems[obj.name_full] = str(error)
        return None


@persistent
def _on_data(*_):
    """Another file, undo, redo."""
    _on_frame(bpy.context.scene)


@persistent
def _on_frame(bpy_scene, _depsgraph=None):
    frame = round(bpy_scene.frame_current_final)  # a shutter's ends are half a frame away: the same mesh
    origins_m = {}
    for obj in bpy_scene.objects:
        if not obj.pelagic_baked.path or obj.type != "MESH":
            continue
        if obj.data not in origins_m:
            origins_m[obj.data] = show(obj, frame)
        elif origins_m[obj.data] is not None:
            _move(obj, origins_m[obj.data])


def _show_volumes(obj, bake):
    """The volumes that were baked with the mesh, at its frames. Returns the frames that are missing, in words."""
    missing = []
    for kind in bake.scene.output.volumes:
        files = volumes.files_of(bake.record.parent, bake.name, kind)
        if files:
            # A mesh that isn't a patch is moved to where its points' origin is: volumes lie in the world.
            volumes.show(obj, kind, files, bake.scene, obj.pelagic_baked.offset, bake.is_patch)
        missing += [frame for frame in range(bake.first, bake.last + 1) if frame not in files]
    return volumes.words_of(sorted(set(missing)))


def _changed(settings, context):
    if not settings.path:
        return
    obj = settings.id_data
    show(obj, context.scene.frame_current)
    for volume in volumes.volumes_of(obj).values():
        volume.data.frame_start = volume.data.frame_offset + 1 + settings.offset


@overridable
class PELAGIC_PG_baked(bpy.types.PropertyGroup):
    path: StringProperty(name="Bake", subtype="FILE_PATH", update=_changed,
                         description="NAME.json in the folder of the bake that this object plays")
    offset: IntProperty(name="Offset", update=_changed,
                        description="Frames by which it is later than in the bake")
    halvings: IntProperty(name="Halvings", default=2, min=0, max=6, update=_changed,
                          description="Of a fitted cage: how often each of its quads' sides is halved. Every vertex lies "
                                      "on the sea; more of them follow it between those of the cage")
    origin_m: FloatVectorProperty(size=3, subtype="TRANSLATION", options={"HIDDEN"})  # its part of the delta location


class PELAGIC_OT_play_bake(NeedsModule, ImportHelper, bpy.types.Operator):
    """Show a baked ocean from disk: nothing is simulated"""

    bl_idname = "pelagic.play_bake"
    bl_label = "Play Pelagic Bake"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json;*.usda", options={"HIDDEN"})
    light: BoolProperty(name="Material, Sun and Sky", default=True,
                        description="Give it the ocean's material, and a scene without oceans the bake's sun and sky")

    def execute(self, context):
        try:
            bake = Bake(bpy.path.abspath(self.filepath))
        except (OSError, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.scene.render.use_lock_interface = True  # in a render frames change on its own thread
        obj = bpy.data.objects.new(bake.name, bpy.data.meshes.new(bake.name))
        context.collection.objects.link(obj)
        obj.pelagic_baked.halvings = _at_most(obj.pelagic_baked.halvings, bake.scene.surface.resolution, EASY_QUADS)
        obj.pelagic_baked.path = str(bake.record)
        if obj.name_full in problems:
            self.report({"WARNING"}, problems[obj.name_full])
        if bake.changing:
            self.report({"WARNING"}, bake.changing)
        if bake.missing():
            self.report({"WARNING"}, f"Missing on disk: {bake.missing()}")
        missing = _show_volumes(obj, bake)
        if missing:
            self.report({"WARNING"}, f"Of its volumes missing on disk: {missing}")
        if abs(ocean.frame_rate(context.scene) / bake.scene.shot.fps - 1.0) > 1e-6:
            self.report({"WARNING"}, f"The bake has {bake.scene.shot.fps:g} frames a second, this scene "
                                     f"{ocean.frame_rate(context.scene):g}")

        def give_look():
            if self.light:
                water = material.ensure_material(obj, bake.scene, bake.dense_foam)
                if water is not None and "dry" in obj.data.attributes:
                    material.cut_hulls(water)
            if self.light and first_ocean(context.scene) is None:
                light.ensure_light(context.scene, bake.scene)

        look.try_to(self, give_look)
        ocean.select_only(context, obj)
        return {"FINISHED"}


class PELAGIC_PT_baked(bpy.types.Panel):
    bl_label = "Pelagic Bake"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and bool(context.object.pelagic_baked.path)

    def draw(self, context):
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.prop(obj.pelagic_baked, "path")
        layout.prop(obj.pelagic_baked, "offset")
        if _is_fitted(obj):
            layout.prop(obj.pelagic_baked, "halvings")
        if obj.name_full in problems:
            layout.label(text=problems[obj.name_full], icon="ERROR")


CLASSES = (PELAGIC_PG_baked, PELAGIC_OT_play_bake, PELAGIC_PT_baked)
HANDLERS = (("frame_change_post", _on_frame), ("load_post", _on_data), ("undo_post", _on_data), ("redo_post", _on_data))


def _menu(self, _context):
    self.layout.operator(PELAGIC_OT_play_bake.bl_idname, text="Pelagic Bake (.json, .usda)")


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic_baked = PointerProperty(type=PELAGIC_PG_baked, name="Pelagic Bake", override=OVERRIDABLE)
    if pelagic is not None:
        handlers.add(HANDLERS)
    bpy.types.TOPBAR_MT_file_import.append(_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(_menu)
    handlers.remove(HANDLERS)
    del bpy.types.Object.pelagic_baked
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
