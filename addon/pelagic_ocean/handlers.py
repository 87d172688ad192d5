# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lists of handlers. rows: pairs of a list's name in bpy.app.handlers and a handler."""

import bpy


def add(rows):
    for where, handler in rows:
        if hasattr(bpy.app.handlers, where):  # save_post_fail is since 3.6
            getattr(bpy.app.handlers, where).append(handler)


def remove(rows):
    """Those that are there: without the module none was added."""
    for where, handler in rows:
        there = getattr(bpy.app.handlers, where, ())
        if handler in there:
            there.remove(handler)
