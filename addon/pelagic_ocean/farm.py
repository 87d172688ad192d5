# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render farm needs for a scene: the add-on or not, and which files; said in words, in a text of the text editor. And a bake as a
job for one: the shot, and the scripts of `pelagic farm`."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import bpy

from . import baked, baking, floating, module, ocean, play, volumes
from .exchange import shot_of
from .operators import NeedsOcean
from .panels import draw_words
from .properties import FIELDS, entry_fields

TEXT = "Check for the Farm"
JOB = "farm"  # the folder of a job, in a bake's
ADD_ON = "{} {}.{}.{}".format(module.TITLE, *module.VERSION)


def _rendered(bpy_scene):
    """The scene's objects, and those of collections that it has instances of, by name; what isn't rendered left out."""
    found, left = set(), list(bpy_scene.objects)
    while left:
        obj = left.pop()
        if obj in found or obj.hide_render:
            continue
        found.add(obj)
        if obj.instance_type == "COLLECTION" and obj.instance_collection:
            left += obj.instance_collection.all_objects
    return sorted(found, key=lambda obj: obj.name_full)


def _with_drivers():
    """What has drivers that ask for the water."""
    for collection in (getattr(bpy.data, name) for name in dir(bpy.data)):
        for owner in collection if isinstance(collection, bpy.types.bpy_prop_collection) else ():
            for each in filter(None, (owner, getattr(owner, "node_tree", None), getattr(owner, "shape_keys", None))):
                animation = getattr(each, "animation_data", None)
                if animation and any("pelagic_height" in curve.driver.expression for curve in animation.drivers):
                    yield owner.name_full
                    break


def _path_faults(path, library):
    file = Path(bpy.path.abspath(path, library=library))
    if not file.exists():
        yield f"{file} is missing"
    if not path.startswith("//"):
        yield f"{path} is an absolute path, which other machines may not have; accepted: // (File, External Data, Make Paths Relative)"


def _faults_of_ocean(obj, bpy_scene):
    groups = obj.pelagic
    for field in FIELDS:
        value = getattr(getattr(groups, field.table), field.name)
        named = [value] if field.is_path else [getattr(row, inner.name) for row in value for inner in entry_fields(field)
                                               if inner.is_path] if field.key["type"] == "entries" else []
        for path in named:
            if path and path != field.key["default"]:
                yield from _path_faults(path, obj.library)
    try:
        problem = play.brought_up(obj, bpy_scene, bpy.context.evaluated_depsgraph_get(), True).problem
    except (ValueError, OSError) as error:
        problem = str(error)
    if problem:
        yield f"it stands still: {problem}"


def _faults_of_bake(obj):
    yield from _path_faults(obj.pelagic_baked.path, obj.library)
    try:
        missing = baked.bake_of(obj).missing()
    except (ValueError, OSError) as error:
        yield str(error)
    else:
        if missing:
            yield f"missing on disk: {missing}"


def _faults_of_volume(obj, bpy_scene):
    yield from _path_faults(obj.data.filepath, obj.library)
    frames = {}
    for frame in range(bpy_scene.frame_start, bpy_scene.frame_end + 1):
        frames.setdefault(volumes.problem_of(obj, bpy_scene, frame).replace(f" {frame}", " these frames"), []).append(frame)
    missing = [frame for problem, of in frames.items() if "is missing" in problem for frame in of]
    if missing:
        yield f"missing on disk: {volumes.words_of(sorted(missing))}"
    for problem, of in frames.items():
        if problem and "is missing" not in problem:
            yield f"{problem} (frames {volumes.words_of(of)})"


def check(bpy_scene):
    """What needs the add-on on farm nodes, and what is wrong: two lists of sentences."""
    needs, faults = [], [module.problem] if module.problem else []
    floats = floating.floats(bpy_scene)
    objects = _rendered(bpy_scene)
    for obj in objects:
        told = ()
        if ocean.is_ocean(obj):
            needs.append(f"{obj.name_full} is a live sea")
            told = _faults_of_ocean(obj, bpy_scene)
        elif obj.type == "MESH" and obj.pelagic_baked.path:
            needs.append(f"{obj.name_full} plays a bake, which the add-on reads")
            told = _faults_of_bake(obj)
        elif obj.type == "VOLUME" and obj.pelagic_volume.kind:
            told = _faults_of_volume(obj, bpy_scene)
        elif obj in floats:
            needs.append(f"{obj.name_full} floats")
        if module.pelagic is not None:
            faults += [f"{obj.name_full}: {fault}" for fault in told]
    drivers = list(dict.fromkeys(_with_drivers()))
    needs += [f"{name} has drivers that ask for the water" for name in drivers]
    if drivers:
        faults.append("Drivers that ask for the water run only where Blender may run scripts: start it with --enable-autoexec")
    for library in {obj.library for obj in objects if obj.library}:
        faults += [f"{library.name}: {fault}" for fault in _path_faults(library.filepath, None)]
    if not bpy.data.filepath or (bpy.data.is_dirty and not bpy.app.background):  # Blender 4.3 without a window always is
        faults.append("The file isn't saved, or has changed since")
    return needs, faults


def words(needs, faults):
    """The outcome as lines."""
    if needs:
        lines = [f"Farm nodes need the add-on {ADD_ON}, its module for {sys.platform} and Python {module.THIS_PYTHON}, and it must be "
                 f"enabled there, such as by --addons {__package__.split('.')[-1]}:", *needs]
    else:
        lines = ["Farm nodes don't need the add-on: nothing in this scene is live"]
    return lines + (["To be put right first:", *faults] if faults else ["No file is missing, no path is absolute"])


class PELAGIC_OT_check_farm(bpy.types.Operator):
    """Say whether farm nodes need the add-on for this scene, what for, and which files are missing or have absolute paths"""

    bl_idname = "pelagic.check_farm"
    bl_label = TEXT

    def execute(self, context):
        needs, faults = check(context.scene)
        lines = words(needs, faults)
        text = bpy.data.texts.get(TEXT) or bpy.data.texts.new(TEXT)
        text.from_string("\n".join(lines) + "\n")
        for line in lines:
            self.report({"WARNING" if faults or needs else "INFO"}, line)
        return {"FINISHED"}


def program():
    """The command line's, or None."""
    return shutil.which("pelagic")


def other_version():
    """A sentence where the program is of another version than the add-on; None: it is of the same."""
    said = subprocess.run([program(), "--version"], capture_output=True, text=True, encoding="utf-8", errors="replace").stdout
    theirs, ours = said.partition("\n")[0].strip(), "pelagic {}.{}.{}".format(*module.VERSION)
    if theirs == ours:
        return None
    return f"{program()} is {theirs or 'of no known version'}, and the add-on is of {ours}: the farm's frames may differ from those here"


def write_job(scene, out):
    """The shot and copies of the files that it names, in `out`/farm, where a bake's check looks at nothing. Returns the shot's file."""
    folder = out / JOB
    folder.mkdir(parents=True, exist_ok=True)
    copies = {}

    def copied(match):
        file = Path(json.loads(match[0]))  # TOML's strings of one line are JSON's
        if not (file.is_absolute() and file.is_file()):
            return match[0]
        if file.is_relative_to(folder):  # a body's, written here
            return json.dumps(file.relative_to(folder).as_posix(), ensure_ascii=False)
        if file not in copies:
            copies[file] = f"files/{len(copies)}/{file.name}"
            (folder / copies[file]).parent.mkdir(parents=True, exist_ok=True)
            if not (folder / copies[file]).exists() or not file.samefile(folder / copies[file]):
                shutil.copyfile(file, folder / copies[file])
        return json.dumps(copies[file], ensure_ascii=False)

    text = re.sub(r'"(?:[^"\\]|\\.)*"', copied, scene.shot_text())
    shot = folder / f"{scene.shot.name}.toml"
    shot.write_text(text, encoding="utf-8", newline="\n")
    return shot


class PELAGIC_OT_write_job(NeedsOcean, bpy.types.Operator):
    """Write the bake as a job for a render farm, into its folder, instead of running it: the shot, the files that it names, and scripts"""

    bl_idname = "pelagic.write_job"
    bl_label = "Write a Job for the Farm"

    def execute(self, context):
        try:
            out = baking.folder_of(context.object).absolute()
            scene, remarks = shot_of(context, context.object, out / JOB / "objects")
            shot = write_job(scene, out)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for remark in remarks:
            self.report({"WARNING"}, remark)
        line = ["pelagic", "farm", str(shot), "--out", str(out)]
        if program() is None:
            context.window_manager.clipboard = shlex.join(line)
            self.report({"WARNING"}, f"The shot is written. Where the command line's program is, go on with: {shlex.join(line)}")
            return {"FINISHED"}
        try:
            if (sentence := other_version()):
                self.report({"WARNING"}, sentence)
            ended = subprocess.run([program(), *line[1:]], capture_output=True, text=True, encoding="utf-8", errors="replace")
        except OSError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if ended.returncode:
            self.report({"ERROR"}, ended.stderr.strip() or f"{program()} ended with status {ended.returncode}")
            return {"CANCELLED"}
        self.report({"INFO"}, ended.stdout.strip())
        return {"FINISHED"}


PANELS = ("PELAGIC_PT_object_output", "PELAGIC_PT_view_output")


def _draw(self, _context):
    """The end of the Output panels."""
    layout = self.layout
    layout.operator(PELAGIC_OT_check_farm.bl_idname, icon="CHECKMARK")
    layout.operator(PELAGIC_OT_write_job.bl_idname, icon="FILE_SCRIPT")
    if program() is None:
        draw_words(layout.box(), "The program pelagic isn't in the PATH: a job is the shot then, and the command that goes on is copied")


def register():
    bpy.utils.register_class(PELAGIC_OT_check_farm)
    bpy.utils.register_class(PELAGIC_OT_write_job)
    for name in PANELS:
        getattr(bpy.types, name).append(_draw)


def unregister():
    for name in PANELS:
        getattr(bpy.types, name).remove(_draw)
    bpy.utils.unregister_class(PELAGIC_OT_write_job)
    bpy.utils.unregister_class(PELAGIC_OT_check_farm)
