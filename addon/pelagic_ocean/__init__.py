# SPDX-License-Identifier: GPL-3.0-or-later
"""Pelagic Ocean: the open sea, animated, lit and rendered in Blender.

Each part of the add-on is a module with register() and unregister(). They are named here in the order in which they
depend on each other.
"""

bl_info = {
    "name": "Pelagic Ocean",
    "description": "The open sea: waves, foam and light from physics",
    "author": "The Pelagic authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Add > Mesh > Pelagic Ocean",
    "category": "Add Mesh",
}

import importlib

PARTS = ("properties", "translations", "play", "look", "drops", "operators", "painted", "presets", "panels", "floating", "courses", "catcher", "in_light", "sampling", "exchange", "baking",
         "baked", "volumes", "native", "farm", "menu", "viewport", "links", "saving")

_registered = []


def register():
    """May be called again: what an earlier call, or one that failed half-way, left behind is taken away first."""
    unregister()
    for name in PARTS:
        part = importlib.import_module("." + name, __package__)
        part.register()
        _registered.append(part)


def unregister():
    while _registered:
        _registered.pop().unregister()
