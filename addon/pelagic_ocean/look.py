# SPDX-License-Identifier: GPL-3.0-or-later
"""Oceans' materials and the scene's sun and sky follow the settings they come from."""

import bpy
from bpy.app.handlers import persistent

from . import depths, drops, handlers, light, material, meshes, ocean, play
from .module import pelagic, problem, words_of
from .properties import FIELDS
from .query import camera_depth_m, first_ocean

# Of settings_of(): what light and materials depend on.
PLACES = [place for place, field in enumerate(FIELDS)
          if field.table in ("light", "water", "camera") or "clock" in field.key["feeds"]
          or field.path in ("sea.wind_direction_deg", "sea.wind_speed_mps", "sea.depth_m", "surface.earth_curvature", "shot.loop_s",
                            "effects.whitecaps", "effects.foam_structure", "effects.foam_streaks", "effects.foam_pattern", "effects.foam_pattern_m", "effects.foam_new_albedo", "effects.foam_old_albedo",
                            "effects.foam_new_opaque", "effects.foam_old_opaque")
          or "spray" in field.key["feeds"]]

STARTUP_GREY = 0.05087609  # of the world in Blender's start-up file

DUE = "pelagic_look_due"  # on an ocean that has no look yet: with sun and sky or not

_problems = {}  # an ocean's name → why it hasn't the look of its settings, in words
_shown = {}  # an ocean's name, and the scene's: the settings that they were brought to last, and how the picture is seen


def is_untouched(world):
    """Whether a world is Blender's own grey one, or none: nobody misses it."""
    if world is None:
        return True
    if not world.use_nodes:
        return False
    backgrounds = [node for node in world.node_tree.nodes if node.type == "BACKGROUND"]
    return (len(world.node_tree.nodes) <= 2 and len(backgrounds) == 1
            and all(abs(channel - STARTUP_GREY) < 1e-4 for channel in backgrounds[0].inputs["Color"].default_value[:3]))


def give(obj, bpy_scene, sun_and_sky):
    """An ocean's material; if wanted, sun and sky for a scene whose first ocean it is. ValueError if the sky can't be made."""
    scene = ocean.scene_of(obj, bpy_scene)
    _shown.pop((obj.name_full, bpy_scene.name), None)
    _mark_under(obj, camera_depth_m(obj, bpy_scene))
    material.ensure_material(obj, scene)
    if sun_and_sky and first_ocean(bpy_scene) == obj:
        light.ensure_light(bpy_scene, scene)
    material.put_air(obj, scene, light.sky_picture(bpy_scene))
    drops.put_light(obj, scene, light.sky_picture(bpy_scene))


def _mark_under(obj, under):
    """Says in an ocean's file how deep the scene's camera is in its water [m], None: it isn't."""
    if obj.library is not None:
        return  # as it was saved
    if under is not None:
        obj[depths.UNDER] = under
    elif depths.UNDER in obj:
        del obj[depths.UNDER]


def try_to(operator, give):
    """Calls give(). What is to have the look is there without it: whatever goes wrong is a warning of the operator's."""
    try:
        give()
    except Exception as error:  # a missing picture, another Blender's nodes
        operator.report({"WARNING"}, f"The look isn't complete. {words_of(error)}")


def give_soon(obj, sun_and_sky):
    """give() from a timer. Undo steps keep that it is due, and who goes back to one is given the look again."""
    obj[DUE] = sun_and_sky
    _give_due_soon()


def _give_due_soon():
    if not bpy.app.timers.is_registered(_give_due):
        bpy.app.timers.register(_give_due, first_interval=0.02)


def _give_due():
    if play.is_rendering():
        return 0.5
    for obj in ocean.oceans():
        if DUE in obj:
            sun_and_sky = obj.pop(DUE)
            for bpy_scene in obj.users_scene[:1]:
                try:
                    give(obj, bpy_scene, sun_and_sky)
                except Exception as error:
                    _say(obj, words_of(error))
    return None


def problem_of(obj):
    """Why an ocean hasn't the look of its settings, in words; "" where it has."""
    return _problems.get(obj.name_full, "")


def _say(obj, words):
    if words == problem_of(obj):
        return
    _problems[obj.name_full] = words
    if bpy.app.background and words not in ("", play.simulation_of(obj).problem):  # nobody sees the panel
        print(f"Error: {obj.name_full} hasn't its look: {words}", flush=True)
    if not play.is_rendering():
        play.redraw()


@persistent
def _follow(bpy_scene, depsgraph):
    for obj in ocean.oceans():
        if bpy_scene not in obj.users_scene:
            continue
        settings = play.settings_read(obj, depsgraph)
        simulation = play.simulation_of(obj)
        of_sea = (simulation.significant_height_m, simulation.sea.dense_foam) if simulation.sea else (None, None)
        key = obj.name_full, bpy_scene.name
        under = camera_depth_m(obj, bpy_scene, depsgraph)
        wanted = [under, of_sea, ocean.frame_rate(bpy_scene), ocean.files_of(settings), settings if problem_of(obj) else (), depths.reaches_far(obj), obj.pelagic.see_through, obj.pelagic.see_through_by_hand] + [settings[place] for place in PLACES]
        is_first = first_ocean(bpy_scene) == obj
        view = light.metered_view(obj, bpy_scene, depsgraph) if is_first else None
        seen = view, bpy_scene.view_settings.view_transform
        before, _shown[key] = _shown.get(key, (None, None)), (wanted, seen)
        if before == (wanted, seen):
            continue
        try:
            scene = ocean.scene_of(obj, bpy_scene, depsgraph, settings)
            light.see_by(view, scene)
            if before[0] == wanted:
                if is_first:
                    light.meter(bpy_scene, scene)
                continue  # whatever was wrong with the rest still is
            _mark_under(obj, under)
            material.update_material(obj, scene, *of_sea)
            if is_first:
                dives = before[0] is not None and before[0][1:] == wanted[1:]  # which changes the water, not sun and sky
                (light.meter if dives else light.update_light)(bpy_scene, scene)
            material.put_air(obj, scene, light.sky_picture(bpy_scene))
            drops.put_light(obj, scene, light.sky_picture(bpy_scene))
            _say(obj, "")
        except Exception as error:
            _say(obj, words_of(error))


@persistent
def _follow_updates(bpy_scene, depsgraph):
    """A setting, the frame rate, the camera, a sea that came into its mesh: without any of them nothing here changes."""
    for update in depsgraph.updates:
        changed = update.id
        if (isinstance(changed, (bpy.types.Scene, bpy.types.Camera)) or isinstance(changed, bpy.types.Object)
                and (ocean.is_ocean(changed) or changed.type == "CAMERA") or isinstance(changed, bpy.types.Mesh) and meshes.SIGNATURE in changed):
            _follow(bpy_scene, depsgraph)
            return


@persistent
def _forget(*_):
    _shown.clear()
    _problems.clear()
    light.forget()
    if any(DUE in obj for obj in ocean.oceans()):
        _give_due_soon()


class PELAGIC_OT_add_light(bpy.types.Operator):
    """Make the ocean's sun and sky the scene's: a world, a lamp, and the exposure for them"""

    bl_idname = "pelagic.add_light"
    bl_label = "Sun and Sky"
    bl_options = {"REGISTER", "UNDO"}

    exposure: bpy.props.BoolProperty(name="Exposure", default=True, description="Set the picture's exposure for the light")

    @classmethod
    def poll(cls, context):
        if pelagic is None:
            cls.poll_message_set(problem)
        return pelagic is not None and ocean.is_ocean(context.object)

    def execute(self, context):
        first = first_ocean(context.scene)
        if first != context.object:
            self.report({"ERROR"}, f"A scene has one sun and sky, those of its first ocean by name: select {first.name}")
            return {"CANCELLED"}
        try:
            scene = ocean.scene_of(context.object, context.scene)
            light.ensure_light(context.scene, scene, self.exposure)
            material.put_air(context.object, scene, light.sky_picture(context.scene))
            drops.put_light(context.object, scene, light.sky_picture(context.scene))
        except (ValueError, pelagic.ShotError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class PELAGIC_OT_add_material(bpy.types.Operator):
    """Give the ocean its own material in place of the one it has"""

    bl_idname = "pelagic.add_material"
    bl_label = "Water Material"
    bl_options = {"REGISTER", "UNDO"}

    poll = PELAGIC_OT_add_light.poll

    def execute(self, context):
        context.object.data.materials.clear()
        give(context.object, context.scene, False)
        return {"FINISHED"}


CLASSES = (PELAGIC_OT_add_light, PELAGIC_OT_add_material)
HANDLERS = (("frame_change_post", _follow), ("depsgraph_update_post", _follow_updates), ("undo_post", _forget),
            ("redo_post", _forget), ("load_post", _forget))


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    if pelagic is not None:
        handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
    if bpy.app.timers.is_registered(_give_due):
        bpy.app.timers.unregister(_give_due)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
    _shown.clear()
