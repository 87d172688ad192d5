# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels: a table of them, their rows from the table of keys. The same ones in the object's properties and in the
sidebar of the 3D view."""

import math

import bpy

from . import depths, ocean, play
from .look import PELAGIC_OT_add_light, PELAGIC_OT_add_material, problem_of
from .module import pelagic, problem
from .operators import PELAGIC_OT_list_add, PELAGIC_OT_list_remove, PELAGIC_OT_release_mesh, PELAGIC_OT_use_mesh
from .presets import PELAGIC_MT_presets
from .properties import BUDGETS, BY_PATH, CUSTOM, FIELDS, VERSION, counts, entry_fields, unit_of
from .query import first_ocean
from .translations import CONTEXT, say

# Title → tables of keys. Water is short, and found above the sea's many rows.
PANELS = {"Water": (), "Sea": ("sea", "shot"), "Waves": ("waves",), "Surface": ("surface",), "Effects": ("effects",),
          "Light": ("light", "camera"), "Output": ("output", "quality")}
# The artist's few of the water; what else its table has is in a panel below them.
WATER = ("water.type", "water.chlorophyll_mg_m3", "sea.depth_m", "water.floor_colour", "water.crest_light", "water.bubbles")
MORE = "More"
OPEN = ("Sea", "Water")
CLEAR_CLIP_M, NEAR_SURFACE_M = 0.02, 2.0  # what a camera may clip without a gap that shows; how deep one is that waves reach


def draw_words(layout, text, *values):
    """A message, with its names, in lines that fit."""
    line = ""
    for word in say(text, *values).split():
        if len(line) + len(word) > 40:
            layout.label(text=line, translate=False)
            line = ""
        line += (" " if line else "") + word
    layout.label(text=line, translate=False)


def _draw_list(layout, group, field):
    head = layout.row()
    head.label(text=say(field.key["label"]), translate=False)
    head.operator(PELAGIC_OT_list_add.bl_idname, text="", icon="ADD").path = field.path
    for index, row in enumerate(getattr(group, field.name)):
        box = layout.row()
        column = box.column(align=True)
        for inner in entry_fields(field):
            _draw_field(column, row, inner)
        remove = box.operator(PELAGIC_OT_list_remove.bl_idname, text="", icon="X")
        remove.path, remove.index = field.path, index


def _labelled(layout, text):
    """A row beside its label, which has more than Blender's own two fifths of the width: that cuts most."""
    parts = layout.split(factor=0.57)
    name = parts.row()
    name.alignment = "RIGHT"
    name.label(text=say(text), translate=False)
    return parts.row(align=True)


def _draw_own(layout, settings, *names):
    """What an ocean has in Blender alone."""
    for name in names:
        _labelled(layout, settings.bl_rna.properties[name].name).prop(settings, name, text="")


def _draw_switch(row, group, switch, otherwise):
    """A pencil after a value of the artist's own, or after the word that says what it is without one: an empty tick box beside that
    word reads as what is off. Returns where the value is to be drawn; None where there is none."""
    value = row.row(align=True)
    row.prop(group, switch, text="", icon="GREASEPENCIL")
    if getattr(group, switch):
        return value
    value.label(text=otherwise)
    return None


def _draw_field(layout, group, field):
    if field.key["type"] == "entries":
        _draw_list(layout, group, field)
        return
    row = _labelled(layout, field.key["label"])
    if field.switch:
        row = _draw_switch(row, group, field.switch, "automatic" if field.absent is None else "infinite")
        if row is None:
            return
    unit = unit_of(field.key)
    if field.key["type"] == "words":
        row.column().prop(group, field.name, text="", expand=True)
    elif unit:
        parts = row.split(factor=1.0 - 0.12 * len(unit))
        parts.prop(group, field.name, text="")
        parts.label(text=unit, translate=False)
    else:
        row.prop(group, field.name, text="")


def _matters(field, settings):
    """Whether a key does anything for the kind of surface that is chosen. The size is that of maps and volumes, too."""
    kind, sized = settings.surface.kind, settings.output.maps or settings.output.volumes or settings.effects.spray or settings.uv_map
    has_size = kind in ("patch", "near-far")
    has_body = settings.water.body
    has_picture = settings.waves.coast and not settings.sea.depth_file.lower().endswith(".obj")
    return {"water.floor_colour": has_body and settings.sea.use_depth_m, "water.crest_light": has_body,
            "water.bubbles": has_body and settings.effects.whitecaps,
            "surface.size_m": has_size or sized, "surface.resolution": has_size, "surface.cell_px": kind not in ("patch", "near-far"),
            "surface.earth_curvature": kind in ("projected-grid", "near-far"),
            # Of Pelagic's own pictures: here beyond is horizon, and the floor is level, of one colour and evenly lit.
            "surface.beyond": False, "water.caustics": False, "water.floor_pattern": False, "water.floor_pattern_m": False,
            # Here only waves feel that floor; a mesh lies where it lies.
            "sea.depth_size_m": has_picture, "sea.depth_east_m": has_picture, "sea.depth_north_m": has_picture}.get(field.path, True)


def _draw_tables(layout, settings, tables, title):
    for table in tables:
        column = layout.column()
        if table != title.lower():
            column.label(text=table.title())
        if table == "quality":
            _draw_quality(column, settings)
            continue
        for field in FIELDS:
            if field.table == table and counts(field, settings) and _matters(field, settings):
                _draw_field(column, getattr(settings, table), field)


def _draw_water(layout, obj):
    settings, scene, layout = obj.pelagic, play.simulation_of(obj).scene, layout.column()
    for path in WATER:
        if path in BY_PATH and counts(BY_PATH[path], settings) and _matters(BY_PATH[path], settings):
            _draw_field(layout, getattr(settings, BY_PATH[path].table), BY_PATH[path])
    row = _labelled(layout, settings.bl_rna.properties["see_through"].name)
    value = _draw_switch(row, settings, "see_through_by_hand", "automatic")
    if value is not None:
        value.prop(settings, "see_through", text="")
    clear_m = depths.clear_to_m(scene) if scene else None
    if clear_m:
        layout.label(text=say("Clear down to {:.0f} m", clear_m) if clear_m >= 3.0 else say("Clear down to {:.1f} m", clear_m), translate=False)
        if not settings.see_through_by_hand and scene.water.body and (depths.UNDER in obj or not math.isinf(scene.sea.depth_m)):
            draw_words(layout.box(), _why_seen_through(obj, scene, clear_m))


def _why_seen_through(obj, scene, clear_m):
    if depths.UNDER in obj:
        camera = bpy.context.scene.camera
        if camera is not None and camera.type == "CAMERA" and camera.data.clip_start > CLEAR_CLIP_M and obj[depths.UNDER] < NEAR_SURFACE_M:
            return "The camera is under water. Where the surface comes close, the camera's Clip Start cuts it away: 0.01 m leaves it there"
        return "The camera is under water: for Cycles it is a volume. EEVEE shows it without caustics or shadows"
    if scene.sea.depth_m >= clear_m:
        return "The floor is too deep to show: the water is opaque in Cycles"
    if not depths.reaches_far(obj):
        return "The floor gives the water its colour. A patch to the horizon would show the floor itself"
    return "The floor is near enough to show: for Cycles the water is a volume, which takes longer"


def _draw_rest_of_water(layout, settings):
    for field in FIELDS:
        if field.table == "water" and field.path not in WATER and counts(field, settings) and _matters(field, settings):
            _draw_field(layout, settings.water, field)


def _draw_quality(layout, settings):
    """One menu; a custom budget is of error or of time."""
    _draw_own(layout, settings, "quality_menu")
    if settings.quality_menu == CUSTOM:
        for path in BUDGETS:
            _draw_field(layout, settings.quality, BY_PATH[path])


class Main:
    bl_label = "Pelagic Ocean"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        layout = self.layout
        if pelagic is not None and ocean.is_ocean(context.object):
            layout.menu(PELAGIC_MT_presets.bl_idname, icon="PRESET")
        if pelagic is None:
            draw_words(layout.box(), problem)
        elif not ocean.is_ocean(context.object):
            layout.operator(PELAGIC_OT_use_mesh.bl_idname, icon="MOD_OCEAN")
        else:
            if context.object.pelagic.version > VERSION:
                draw_words(layout.box(), "This ocean was made by a newer Pelagic: what is new in it is missing here")
            if context.object.data.library:
                draw_words(layout.box(), "The mesh is linked, which plays slowly. Object, Relations, Make Local plays fast")
            wrong_size = ocean.unit_warning(context.object, context.scene)
            if wrong_size:
                draw_words(layout.box(), wrong_size)
            simulation = play.simulation_of(context.object)
            if simulation.problem:
                draw_words(layout.box(), simulation.problem)
            elif simulation.is_building or simulation.sea:
                _draw_state(layout, context.object, simulation)
            if not simulation.problem and problem_of(context.object):  # one of the sea's is of the same settings
                draw_words(layout.box(), problem_of(context.object))


def _draw_state(layout, obj, simulation):
    """Two rows in any state, and warnings: a row that comes and goes while a sea plays would push the panels below it to and fro."""
    if simulation.is_building:
        layout.label(text="Building the sea…", icon="SORTTIME")
    else:
        height = f"{simulation.significant_height_m:.2g}"
        text = say("Waves of {} m; foam follows…", height) if simulation.is_behind else say("Waves of {} m (significant height)", height)
        layout.label(text=text, icon="SORTTIME" if simulation.is_behind else "NONE", translate=False)
    _draw_vertices(layout, obj)
    for warning in () if simulation.is_building else simulation.warnings:
        draw_words(layout.box(), warning)


class Sub:
    tables = ()
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return pelagic is not None and ocean.is_ocean(context.object)

    def draw(self, context):
        layout = self.layout
        settings = context.object.pelagic
        if self.bl_label == "Light":
            row = layout.row(align=True)
            row.operator(PELAGIC_OT_add_light.bl_idname, icon="LIGHT_SUN")
            row.operator(PELAGIC_OT_add_material.bl_idname, icon="MATERIAL")
            first = first_ocean(context.scene)
            if first not in (None, context.object):
                draw_words(layout.box(), "The scene's sun and sky are those of {}, its first ocean by name. What is set here counts in this ocean's own shots and bakes", first.name)
        if self.bl_label == "Surface":
            _draw_surface(layout, settings)
            if settings.own_mesh:
                return
        if self.bl_label == "Water":
            _draw_water(layout, context.object)
        if self.bl_label == MORE:
            _draw_rest_of_water(layout, settings)
        _draw_tables(layout, settings, self.tables, self.bl_label)


def _draw_vertices(layout, obj):
    count, whole = (f"{number:,}".replace(",", " ") for number in play.vertices_of(obj))
    text = say("Vertices: {}", count) if count == whole else say("Viewport: {} of {} vertices", count, whole)
    layout.label(text=text, translate=False)


def _draw_surface(layout, settings):
    _draw_vertices(layout, settings.id_data)
    if settings.own_mesh:
        layout.label(text="The object's own mesh")
        layout.operator(PELAGIC_OT_release_mesh.bl_idname)
        return
    if settings.surface.kind == "patch":
        _draw_own(layout, settings, "horizon")
    if settings.surface.kind == "cage":
        _draw_own(layout, settings, "cage")
    if settings.surface.kind != "cage":
        _draw_own(layout, settings, "viewport_percentage", "viewport_vertices")
    _draw_own(layout, settings, "uv_map", "velocity")


PLACES = {"object": {"bl_space_type": "PROPERTIES", "bl_region_type": "WINDOW", "bl_context": "object"},
          "view": {"bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Pelagic"}}


def _classes():
    for where, place in PLACES.items():
        main = type(f"PELAGIC_PT_{where}", (Main, bpy.types.Panel), {**place, "__doc__": None})
        yield main
        for title, tables in PANELS.items():
            options = set() if title in OPEN else {"DEFAULT_CLOSED"}
            yield type(f"PELAGIC_PT_{where}_{title.lower()}", (Sub, bpy.types.Panel),
                       {**place, "bl_label": title, "bl_parent_id": main.__name__, "tables": tables,
                        "bl_options": options, "__doc__": None})
        yield type(f"PELAGIC_PT_{where}_water_more", (Sub, bpy.types.Panel),
                   {**place, "bl_label": MORE, "bl_parent_id": f"{main.__name__}_water", "tables": (),
                    "bl_options": {"DEFAULT_CLOSED"}, "__doc__": None})


_registered = []


def register():
    for made in _classes():
        bpy.utils.register_class(made)
        _registered.append(made)


def unregister():
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
