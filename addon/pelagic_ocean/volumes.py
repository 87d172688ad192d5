# SPDX-License-Identifier: GPL-3.0-or-later
"""What isn't a surface: spray as a volume to look at, and the sea as a level set, which simulations of water start from.

A bake writes OpenVDB files, one a frame, beside Blender's other work. A volume object shows them, below its ocean in the
outliner: they lie in the ocean's own coordinates.
"""

import re
import zlib
from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.props import EnumProperty, PointerProperty, StringProperty

from . import compat, links, ocean
from .baking import Bakes, draw_progress, folder_of
from .nodes import Tree
from .properties import BY_PATH, FIELDS, PLACE
from .translations import say

MARK = "pelagic_spray"  # on a material of the add-on
FORWARD = 0.85  # mean cosine of what droplets scatter, which are much larger than light's wavelengths (Hansen & Travis 1974)

# A change of keys that feed these makes files that were baked others' than the ocean's.
FEEDS = {"waves", "clock", "volumes", "quality"}
UNFINISHED = "unfinished"  # instead of a signature


@dataclass(frozen=True)
class Kind:
    word: str  # in output.volumes, and in the names of files
    label: str
    grid: str
    help: str
    feeds: frozenset = frozenset()  # besides FEEDS


KINDS = {kind.word: kind for kind in (
    Kind("spray", "Spray", "density", "Droplets over breaking crests: how much they dim light, in 1/m, and how they fly",
         frozenset({"spray", "foam", "gusts"})),
    Kind("level-set", "Level Set", "surface",
         "The distance from the sea's surface, below it negative: what a simulation of water starts from"))}


def words_of(frames):
    """Of sorted numbers: "3, 7-9"."""
    ranges = []
    for frame in frames:
        if ranges and ranges[-1][1] == frame - 1:
            ranges[-1][1] = frame
        else:
            ranges.append([frame, frame])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in ranges)


def files_of(folder, name, kind):
    """{frame: Path} of a bake's volumes."""
    start, end = f"{name}.{kind}.", ".vdb"
    found = {}
    for file in (Path(folder) / "volumes").glob(f"{start}*{end}"):
        number = file.name[len(start):-len(end)]
        if re.fullmatch(r"\d{4,}", number):
            found[int(number)] = file
    return found


def _settings_of(obj, kind):
    """An ocean's settings as a volume takes them: it covers the patch's square in the world, whatever the surface is."""
    settings = list(ocean.settings_of(obj))
    settings[PLACE["surface.kind"]] = "patch"
    for path in ("surface.cage_file", "surface.cage_level"):
        settings[PLACE[path]] = BY_PATH[path].key["default"]
    if kind == "spray":
        settings[PLACE["effects.spray"]] = True
    return tuple(settings)


def scene_of_volume(obj, bpy_scene, depsgraph, kind):
    """The scene whose bake is this volume and nothing else. ValueError for what can't be baked."""
    scene = ocean.scene_of(obj, bpy_scene, depsgraph, _settings_of(obj.evaluated_get(depsgraph), kind))
    scene.output.mesh, scene.output.maps, scene.output.cascade_tiles = "none", (), False
    scene.output.mesh_scheme, scene.output.volumes, scene.output.drops = "none", (kind,), False
    problems = scene.validate()
    if problems:
        raise ValueError("\n".join(problems))
    return scene


def volumes_of(obj):
    """{word of a kind: volume object} of an ocean, or of a bake that is played."""
    return {each.pelagic_volume.kind: each for each in bpy.data.objects
            if each.type == "VOLUME" and each.pelagic_volume.of == obj}


# ---- Objects


def show(obj, kind, files, scene, offset=0, parented=True):
    """Makes the volume object of an ocean, or brings the one that is there to these files. scene: of their bake, offset: by how
    many frames later they are shown. Returns it."""
    first, last = scene.shot.frames
    made = volumes_of(obj).get(kind)
    if made is None:
        label = f"{obj.name} {KINDS[kind].label}"
        made = bpy.data.objects.new(label, bpy.data.volumes.new(label))
        for collection in obj.users_collection:
            collection.objects.link(made)
        made.pelagic_volume.kind, made.pelagic_volume.of = kind, obj
        if parented:
            made.parent = obj
        made.data.render.precision = "FULL"  # nature's own density is too small a number for a half
        made.data.velocity_unit = "SECOND"
        if kind == "level-set":
            _add_surface(obj, made)
    else:
        made.data.grids.unload()  # of files that were written anew
    volume = made.data
    volume.filepath = _shown_path(files[min(files)])
    volume.is_sequence, volume.sequence_mode = True, "CLIP"
    volume.frame_start, volume.frame_duration, volume.frame_offset = first + offset, last - first + 1, first - 1
    made.delta_location = [-compat.voxels_off() * scene.output.voxel_m] * 3  # its location is its user's
    if kind == "spray" and not any(volume.materials):
        volume.materials.clear()
        volume.materials.append(_spray_material())
    return made


def _shown_path(file):
    """Beside the .blend as // where it lies there, so that both can be moved together."""
    if bpy.data.filepath:
        folder = Path(bpy.data.filepath).parent
        if folder in file.parents:
            return bpy.path.relpath(str(file))
    return str(file)


def _add_surface(obj, volume):
    """A level set is nothing to look at: a mesh of its zero stands for it, which Blender makes anew at each frame."""
    volume.hide_render = True
    made = bpy.data.objects.new(f"{volume.name} Surface", bpy.data.meshes.new(f"{volume.name} Surface"))
    for collection in obj.users_collection:
        collection.objects.link(made)
    made.parent = volume
    modifier = made.modifiers.new("Level Set", "VOLUME_TO_MESH")
    modifier.object, modifier.grid_name, modifier.threshold = volume, KINDS["level-set"].grid, 0.0
    modifier.resolution_mode, modifier.use_smooth_shade = "GRID", True


def _spray_material():
    """Droplets scatter light and absorb none; the grid is their extinction in 1/m."""
    found = next((each for each in bpy.data.materials if MARK in each), None)
    if found is not None:
        return found
    material = bpy.data.materials.new("Pelagic Spray")
    material[MARK] = True
    material.use_nodes = True
    tree = Tree(material.node_tree)
    tree.node("ShaderNodeOutputMaterial", {"Volume": tree.add("ShaderNodeVolumePrincipled", {
        "Color": (1.0, 1.0, 1.0, 1.0), "Density": 1.0, "Density Attribute": KINDS["spray"].grid, "Anisotropy": FORWARD,
        "Absorption Color": (0.0, 0.0, 0.0, 1.0)})})
    return material


# ---- What is wrong with them


def signature_of(obj, bpy_scene, kind):
    """What a volume of an ocean depends on. Of an object, original or evaluated, and the scene that gives the frame rate."""
    feeds, settings = FEEDS | KINDS[kind].feeds, _settings_of(obj, kind)
    told = [value for field, value in zip(FIELDS, settings) if feeds & set(field.key["feeds"])]
    return f"{zlib.crc32(repr([ocean.frame_rate(bpy_scene), told]).encode()):08x}"


def problem_of(volume, bpy_scene, frame):
    """What is wrong with a volume object at a frame of the scene, in words; "" if nothing."""
    data = volume.data
    number = frame - data.frame_start + 1 + data.frame_offset
    if not 1 <= frame - data.frame_start + 1 <= data.frame_duration:
        return f"Nothing is baked for frame {frame}"
    path = Path(bpy.path.abspath(data.filepath))
    file = path.with_name(re.sub(r"\d+(?=\.vdb$)", f"{number:04}", path.name))
    if not file.exists():
        return f"{file}: is missing; bake again"
    of, told = links.alive(volume.pelagic_volume.of), volume.pelagic_volume.signature
    if told == UNFINISHED:
        return "The bake wasn't finished: some frames may be of earlier settings. Bake again"
    if told and ocean.is_ocean(of) and told != signature_of(of, bpy_scene, volume.pelagic_volume.kind):
        return f"{of.name}'s settings have changed since this was baked: bake again"
    return ""


# ---- Operator, panel

_read = {}  # folder → signature of the settings of which Blender may have read its files


def _folder_of(volume):
    """Of the bake that a volume object shows."""
    return Path(bpy.path.abspath(volume.data.filepath)).parent.parent


def _folder_to_write(folder, volume, signature):
    """The folder, or one beside it with a number if Blender would go on showing what it has read there of other settings."""
    if not compat.reads_volumes_once():
        return folder
    if volume is not None:
        _read.setdefault(_folder_of(volume), volume.pelagic_volume.signature)
    candidate, number = folder, 1
    while _read.get(candidate, signature) != signature:
        number += 1
        candidate = folder.with_name(f"{folder.name}-{number}")
    return candidate


class PELAGIC_OT_bake_volume(Bakes, bpy.types.Operator):
    """Bake a volume of the ocean for the scene's frames, and show it. Esc stops it; the next bake goes on from there"""

    bl_idname = "pelagic.bake_volume"
    bl_label = "Bake Volume"
    bl_options = {"UNDO"}

    kind: EnumProperty(name="Volume", items=[(kind.word, kind.label, kind.help) for kind in KINDS.values()])

    @classmethod
    def description(cls, _context, properties):
        return say("{}. Baked for the scene's frames, over the patch's square", say(KINDS[properties.kind].help))

    _signature = ""  # of the settings that were ordered: those of the ocean may change before the bake ends

    def order(self, context, obj):
        ocean.check_frames(context.scene)
        depsgraph = context.evaluated_depsgraph_get()
        scene = scene_of_volume(obj, context.scene, depsgraph, self.kind)
        self._signature = signature_of(obj.evaluated_get(depsgraph), context.scene, self.kind)
        folder = folder_of(obj)
        folder = folder.with_name(f"{folder.name}-{self.kind}")
        own = _folder_to_write(folder, volumes_of(obj).get(self.kind), self._signature)
        remarks = []
        if own != folder:
            remarks.append(f"Blender shows files that it has read until it ends, so this one is in {own.name}")
        if obj.animation_data and obj.animation_data.action:
            remarks.append(f"{obj.name} is animated: its volume has its settings at frame {context.scene.frame_current}")
        return scene, own, remarks

    def take(self, context, baking):
        obj = bpy.data.objects.get(baking.ocean)
        if not ocean.is_ocean(obj):
            return f". {baking.ocean} isn't there any more: its volume isn't shown"
        shot = baking.scene.shot
        files = files_of(baking.folder, shot.name, self.kind)
        files = {frame: file for frame, file in files.items() if shot.frames[0] <= frame <= shot.frames[1]}
        if not files:
            return ""
        volume = show(obj, self.kind, files, baking.scene)
        _read[baking.folder] = self._signature
        words = ""
        if len(files) <= baking.report.done + baking.report.kept:
            volume.pelagic_volume.signature = self._signature
        elif self._leave_unfinished(volume, baking):
            words = ". The frames that it hasn't reached are of earlier settings"
        missing = words_of(frame for frame in range(shot.frames[0], shot.frames[1] + 1) if frame not in files)
        return f"{words}. Missing on disk: {missing}" if missing else words


    def fail(self, context, baking):
        obj = bpy.data.objects.get(baking.ocean)
        volume = volumes_of(obj).get(self.kind) if obj else None
        if volume is not None:
            self._leave_unfinished(volume, baking)

    def _leave_unfinished(self, volume, baking):
        """Returns whether some of its frames may be of other settings than those that were ordered."""
        if volume.pelagic_volume.signature == self._signature or _folder_of(volume) != baking.folder:
            return False
        volume.pelagic_volume.signature = UNFINISHED
        return True


class PELAGIC_PG_volume(bpy.types.PropertyGroup):
    kind: StringProperty()
    of: PointerProperty(type=bpy.types.Object)
    signature: StringProperty()  # of the settings that it was baked with


class PELAGIC_PT_volume(bpy.types.Panel):
    bl_label = "Pelagic Volume"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "VOLUME" and bool(context.object.pelagic_volume.kind)

    def draw(self, context):
        volume = context.object
        kind = KINDS[volume.pelagic_volume.kind]
        of = links.alive(volume.pelagic_volume.of)
        self.layout.label(text=f"{kind.label} of {of.name}" if of else kind.label)
        problem = problem_of(volume, context.scene, context.scene.frame_current)
        if problem:
            self.layout.label(text=problem, icon="ERROR")


def _draw_one(layout, context, kind):
    if draw_progress(layout):
        return
    text = f"Bake {KINDS[kind].label} Volume"
    layout.operator(PELAGIC_OT_bake_volume.bl_idname, text=text, icon="VOLUME_DATA").kind = kind
    volume = volumes_of(context.object).get(kind)
    problem = problem_of(volume, context.scene, context.scene.frame_current) if volume else ""
    if problem:
        layout.label(text=problem, icon="ERROR")


def _draw_spray(self, context):
    """The end of the Effects panels."""
    if context.object.pelagic.effects.spray:
        _draw_one(self.layout, context, "spray")


def _draw_level_set(self, context):
    """The end of the Output panels."""
    _draw_one(self.layout, context, "level-set")


CLASSES = (PELAGIC_PG_volume, PELAGIC_OT_bake_volume, PELAGIC_PT_volume)
PANELS = (("effects", _draw_spray), ("output", _draw_level_set))
PLACES_OF_PANELS = ("object", "view")


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic_volume = PointerProperty(type=PELAGIC_PG_volume, name="Pelagic Volume")
    for where in PLACES_OF_PANELS:
        for title, draw in PANELS:
            getattr(bpy.types, f"PELAGIC_PT_{where}_{title}").append(draw)


def unregister():
    for where in PLACES_OF_PANELS:
        for title, draw in PANELS:
            getattr(bpy.types, f"PELAGIC_PT_{where}_{title}").remove(draw)
    del bpy.types.Object.pelagic_volume
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
