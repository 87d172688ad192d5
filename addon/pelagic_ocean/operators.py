# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with oceans: add one, take a mesh as one, change its lists."""

import bpy
from bpy.props import BoolProperty, IntProperty, StringProperty

from . import cages, compat, keyed, look, meshes, ocean, play
from .module import pelagic, problem
from .properties import BY_PATH, add_row

CLIP_END_M = 100e3  # beyond the horizon, for cameras and views that would cut the sea off


class NeedsModule:
    @classmethod
    def poll(cls, context):
        if pelagic is None:
            cls.poll_message_set(problem)
        return pelagic is not None and context.mode == "OBJECT"


class NeedsOcean(NeedsModule):
    @classmethod
    def poll(cls, context):
        return super().poll(context) and ocean.is_ocean(context.object)


class GivesLook(NeedsModule):
    light: BoolProperty(name="Sun and Sky", default=True, options={"SKIP_SAVE"},
                        description="Give the scene the ocean's sun and sky. Unless asked for, a world of your own stays")

    by_hand = False

    def invoke(self, context, _event):
        self.by_hand = not bpy.app.background
        return self.execute(context)

    def show(self, context, obj):
        """The sea is in the mesh when the operator returns, and has its look. By hand in a window its waves are there, and
        foam and look follow from timers. Returns its Simulation."""
        if not self.properties.is_property_set("light"):
            self.light = look.is_untouched(context.scene.world)
        simulation = show_now(context, obj, foam_later=self.by_hand)
        if self.by_hand:
            look.give_soon(obj, self.light)
        else:
            look.try_to(self, lambda: look.give(obj, context.scene, self.light))
        return simulation


def show_now(context, obj, foam_later=False):
    """The sea is in the mesh when the operator returns."""
    context.scene.render.use_lock_interface = True  # in a render frames change on its own thread
    play.forget(obj)
    depsgraph = context.evaluated_depsgraph_get()  # without a window this shows it already
    play.show(obj, context.scene, depsgraph, foam_later)
    return play.simulation_of(obj)


def _see_far(context):
    """Lets the camera and the views of the window see the horizon."""
    if context.scene.camera and context.scene.camera.type == "CAMERA":
        camera = context.scene.camera.data
        camera.clip_end = max(camera.clip_end, CLIP_END_M)
    for area in context.screen.areas if context.screen else ():
        if area.type == "VIEW_3D":
            space = area.spaces.active
            space.clip_end = max(space.clip_end, CLIP_END_M)


class PELAGIC_OT_add_ocean(GivesLook, bpy.types.Operator):
    """Add the open sea: its surface, water, sun and sky, moving with the timeline"""

    bl_idname = "pelagic.add_ocean"
    bl_label = "Pelagic Ocean"
    bl_options = {"REGISTER", "UNDO"}

    see_far: BoolProperty(name="See the horizon", default=True,
                          description="Raise the clipping distance of the camera and of the views")
    def execute(self, context):
        obj = ocean.make("Ocean", context.collection)
        ocean.select_only(context, obj)
        if self.see_far:
            _see_far(context)
        if hasattr(context.scene, "cycles") and not compat.can_denoise():
            context.scene.cycles.use_denoising = False  # or the first render ends in an error
        simulation = self.show(context, obj)
        if simulation.problem:
            self.report({"ERROR"}, simulation.problem)
            return {"CANCELLED"}
        wrong_size = ocean.unit_warning(obj, context.scene)
        if wrong_size:
            self.report({"WARNING"}, wrong_size)
        return {"FINISHED"}


class PELAGIC_OT_use_mesh(GivesLook, bpy.types.Operator):
    """Make the active mesh a sea: its vertices are the surface at rest"""

    bl_idname = "pelagic.use_mesh"
    bl_label = "Use Mesh as Ocean"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return (super().poll(context) and context.object is not None and context.object.type == "MESH"
                and not ocean.is_ocean(context.object))

    def execute(self, context):
        obj = context.object
        if not obj.data.vertices:
            self.report({"ERROR"}, f"{obj.name} has no vertices: a sea needs some, such as those of a grid")
            return {"CANCELLED"}
        if obj.data.library:
            self.report({"ERROR"}, f"{obj.name}'s mesh is linked from another file: make it local first")
            return {"CANCELLED"}
        if obj.data.shape_keys:
            self.report({"ERROR"}, f"{obj.name} has shape keys, which would put its vertices back: delete or apply them first")
            return {"CANCELLED"}
        meshes.forget_rest(obj.data)
        meshes.capture(obj.data)
        obj.pelagic.own_mesh = True
        ocean.mark(obj)
        simulation = self.show(context, obj)
        if simulation.problem:
            self.report({"WARNING"}, simulation.problem)
        return {"FINISHED"}


class PELAGIC_OT_use_cage(GivesLook, bpy.types.Operator):
    """Add a sea on the smooth surface of the active mesh, its creases kept: the mesh is its cage, and can go on changing"""

    bl_idname = "pelagic.use_cage"
    bl_label = "Use Mesh as Cage of an Ocean"
    bl_options = {"REGISTER", "UNDO"}

    poll = PELAGIC_OT_use_mesh.poll

    def execute(self, context):
        cage = context.object
        depsgraph = context.evaluated_depsgraph_get()
        try:
            cages.of_mesh(cage, cage.evaluated_get(depsgraph).matrix_world, depsgraph)  # the new ocean is at the origin
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        obj = ocean.make(f"{cage.name} Sea", context.collection)
        obj.pelagic.surface.kind, obj.pelagic.cage = "cage", cage
        simulation = self.show(context, obj)
        if simulation.problem:
            self.report({"ERROR"}, simulation.problem)
            bpy.data.meshes.remove(obj.data)  # and with it the object
            return {"CANCELLED"}
        cages.hide_from_pictures(cage)
        if context.scene.render.engine != "CYCLES":
            self.report({"WARNING"}, f"{cage.name} is hidden from Cycles alone: {cages.OTHER_ENGINES}")
        ocean.select_only(context, obj)
        return {"FINISHED"}


class PELAGIC_OT_release_mesh(NeedsOcean, bpy.types.Operator):
    """Make the ocean an ordinary mesh again: its own vertices go back to rest, another's stay as they are"""

    bl_idname = "pelagic.release_mesh"
    bl_label = "Release Mesh"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        obj = context.object
        if obj.pelagic.own_mesh:
            meshes.restore(obj.data)
        obj.pelagic.is_ocean = obj.pelagic.own_mesh = False
        return {"FINISHED"}


class ListOperator(NeedsOcean):
    path: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def rows(self, context):
        field = BY_PATH[self.path]
        return getattr(getattr(context.object.pelagic, field.table), field.name)


# What an entry begins with, where the middle of its numbers' ranges makes no sea or too much of one.
STARTS = {"waves.band_gains": {"from_m": 1.0, "to_m": 4.0, "gain": 1.0}, "sea.swell": {"height_m": 1.0, "period_s": 10.0}}


class PELAGIC_OT_list_add(ListOperator, bpy.types.Operator):
    """Add an entry; of a hero wave and a gust's front, at the 3D cursor in the current frame; of a mask, a calm at the 3D cursor; of a vessel, a course across it"""

    bl_idname = "pelagic.list_add"
    bl_label = "Add"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    def execute(self, context):
        row, obj = add_row(self.rows(context)), context.object
        at = obj.matrix_world.inverted_safe() @ context.scene.cursor.location
        for name, value in STARTS.get(self.path, {}).items():
            setattr(row, name, value)
        if self.path == "waves.masks":
            row.east_m, row.north_m, row.waves = at.x, at.y, 0.5
        if self.path == "waves.vessels":  # for a start: across the cursor, along +x
            row.path = f"{context.scene.frame_start} {at.x - 50.0:.9g} {at.y:.9g}, {context.scene.frame_start + 480} {at.x + 50.0:.9g} {at.y:.9g}"
        if self.path in ("waves.heroes", "sea.gust_fronts"):
            row.frame, row.east_m, row.north_m = context.scene.frame_current_final, at.x, at.y
        if self.path == "sea.gust_fronts":  # for a start: along the wind
            row.direction_deg = obj.pelagic.sea.wind_direction_deg
        if self.path == "waves.heroes":
            simulation = play.simulation_of(obj)
            if simulation.sea and simulation.significant_height_m > 0.0:  # of crests one in three thousand is as high
                row.height_m = simulation.significant_height_m
        obj.update_tag()
        return {"FINISHED"}


class PELAGIC_OT_list_remove(ListOperator, bpy.types.Operator):
    """Remove this entry"""

    bl_idname = "pelagic.list_remove"
    bl_label = "Remove"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: IntProperty(options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context):
        rows = self.rows(context)
        if not 0 <= self.index < len(rows):
            return {"CANCELLED"}
        rows.remove(self.index)
        keyed.remove_row(context.object, self.path, self.index)
        context.object.update_tag()
        return {"FINISHED"}


CLASSES = (PELAGIC_OT_add_ocean, PELAGIC_OT_use_mesh, PELAGIC_OT_use_cage, PELAGIC_OT_release_mesh, PELAGIC_OT_list_add, PELAGIC_OT_list_remove)


def _menu(self, _context):
    self.layout.operator(PELAGIC_OT_add_ocean.bl_idname, icon="MOD_OCEAN")


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    bpy.types.VIEW3D_MT_mesh_add.append(_menu)


def unregister():
    bpy.types.VIEW3D_MT_mesh_add.remove(_menu)
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
