# SPDX-License-Identifier: GPL-3.0-or-later
"""A .blend holds no generated surface. While Blender writes one, a marker is in each such mesh's place; then the mesh, which
nobody has touched, is back. What is loaded has the marker until play.py has made the surface anew.

What an artist has put on a generated mesh can't be made anew: such a mesh is saved as it is. Autosaves and undo are
Blender's own: they call no handler, and hold the whole mesh.
"""

from contextlib import suppress

import bpy
from bpy.app.handlers import persistent

from . import drops, handlers, meshes, ocean, play
from .module import TITLE, VERSION, pelagic

# The custom property of oceans of the name TITLE, which everybody can read.
WORDS = ("This sea needs the add-on {} {}.{}.{}. Without it, a chequered square is in its place, or the sea of one "
         "frame").format(TITLE, *VERSION)
SQUARES = 16  # a side of the marker

_away = []  # what isn't in the file that is being written: pairs of a mesh, and the marker in its place


def _marker(mesh, size_m):
    """What stands for a mesh: with all that is its own but the geometry, a square that nobody takes for water, every other
    field of it. Faster than a copy that is emptied: an ocean's mesh may have hundreds of MB."""
    made = bpy.data.meshes.new(mesh.name)
    for material in mesh.materials:
        made.materials.append(material)
    for setting in mesh.bl_rna.properties:
        if not setting.is_readonly and setting.type in {"BOOLEAN", "ENUM", "INT", "FLOAT"}:
            with suppress(AttributeError):  # what another setting rules
                setattr(made, setting.identifier, getattr(mesh, setting.identifier))
    for key in mesh.keys():
        made[key] = mesh[key]
    row = SQUARES + 1
    places = [(place / SQUARES - 0.5) * size_m for place in range(row)]
    made.from_pydata([(x, y, 0.0) for y in places for x in places], [],
                     [(i, i + 1, i + row + 1, i + row) for i in range(row * SQUARES) if i % row < SQUARES and i % 2])
    made[meshes.SIGNATURE] = meshes.MARKER
    return made


def _emptied(mesh):
    """The same for the drops of spray: nothing."""
    made = bpy.data.meshes.new(mesh.name)
    made[drops.MARK] = True
    return made


def _can_go(mesh, users):
    """Whether the add-on makes this mesh anew by itself. users: the objects that have it."""
    return (any(map(ocean.is_ocean, users)) and meshes.is_generated(mesh)
            and not (mesh.library or mesh.override_library or mesh.animation_data or mesh.asset_data)
            and not any(obj.pelagic.own_mesh or obj.vertex_groups or obj.mode != "OBJECT" for obj in users))


def _swap(one, other):
    """The one mesh takes the other's place and name."""
    name, keeps = other.name, other.use_fake_user
    other.use_fake_user = False  # or it would be in the file
    other.user_remap(one)
    other.name = "Pelagic Away"  # another base, or Blender 4.3 gives it the number that it has
    one.name, one.use_fake_user = name, keeps


@persistent
def _before_save(*_):
    put_back()
    users = {}
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            users.setdefault(obj.data, []).append(obj)
        if ocean.is_ocean(obj) and not obj.library:
            obj[TITLE] = WORDS
    if play.is_rendering():  # on another thread
        return
    for mesh, objects in users.items():
        is_drops = drops.MARK in mesh and not mesh.library
        if is_drops or _can_go(mesh, objects):
            marker = _emptied(mesh) if is_drops else _marker(mesh, objects[0].pelagic.surface.size_m)
            _swap(marker, mesh)
            _away.append((mesh, marker))
    if _away:
        play.is_saving = True
        bpy.app.timers.register(put_back, first_interval=0.0)  # Blender 3.4 doesn't tell of a file that can't be written


@persistent
def put_back(*_):
    while _away:
        mesh, marker = _away.pop()
        _swap(mesh, marker)
        bpy.data.meshes.remove(marker)
    play.is_saving = False


HANDLERS = (("save_pre", _before_save), ("save_post", put_back), ("save_post_fail", put_back),
            ("frame_change_pre", put_back), ("undo_pre", put_back),
            ("load_pre", put_back))


def register():
    if pelagic is not None:
        handlers.add(HANDLERS)


def unregister():
    put_back()
    handlers.remove(HANDLERS)
