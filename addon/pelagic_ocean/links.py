# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that name another object: an ocean's cage, a volume's and a floating object's ocean.

Such a name is a user of its object. So one that an artist deletes leaves the scene and stays in the file, as the cage or
the ocean of somebody. It counts as gone from then on, and no file is saved with it.
"""

import bpy
from bpy.app.handlers import persistent

from . import handlers

# The groups of an object's settings that have one, and its property.
NAMES = (("pelagic", "cage"), ("pelagic_volume", "of"), ("pelagic_float", "ocean"))


def alive(obj):
    """The object; None of one that is in no scene and no collection, and of None."""
    return obj if obj is not None and (obj.users_scene or obj.users_collection) else None


@persistent
def let_go(*_):
    """Nobody's settings name a deleted object any more; what only they kept is gone."""
    deleted = {}
    for obj in bpy.data.objects:
        for group, name in NAMES:
            other = getattr(getattr(obj, group), name)
            if other is None or obj.library:
                continue
            if other not in deleted:
                deleted[other] = alive(other) is None
            if deleted[other]:
                setattr(getattr(obj, group), name, None)
    for obj in [obj for obj, is_gone in deleted.items() if is_gone and not obj.users]:
        data = obj.data
        bpy.data.objects.remove(obj)
        if isinstance(data, bpy.types.Mesh) and not data.users:
            bpy.data.meshes.remove(data)


HANDLERS = (("save_pre", let_go),)


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
