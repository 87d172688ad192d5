# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own Ocean modifier becomes the nearest Pelagic sea.

The modifier has no physical height: it scales its waves until the highest is `wave_scale` at time 0. So the height is
measured on its mesh, and the wind is the one whose sea is as high, whatever wind the modifier names.
"""

import math

import bpy
import numpy as np

from . import compat, ocean
from .module import pelagic
from .operators import NeedsModule, show_now

SPECTRA = {"PHILLIPS": "phillips", "PIERSON_MOSKOWITZ": "pierson-moskowitz", "JONSWAP": "jonswap",
           "TEXEL_MARSEN_ARSLOE": "tma"}
WIND_MPS = (0.5, 60.0)  # of the search
WIND_STEPS = 16
ALIGNED = 0.5  # from this alignment on the narrower spreading is the nearer one


def find(obj):
    """The object's first Ocean modifier, or None."""
    return next((modifier for modifier in obj.modifiers if modifier.type == "OCEAN"), None) if obj else None


def significant_height(obj, depsgraph):
    """4 standard deviations of the heights of the mesh as it is now, in the object's own units."""
    mesh = obj.evaluated_get(depsgraph).to_mesh()
    places = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", places.ravel())
    obj.evaluated_get(depsgraph).to_mesh_clear()
    return 4.0 * float(places[:, 2].std(dtype=float))


def wind_for(scene, height_m):
    """The wind [m/s] whose sea has this significant height, or the nearest there is."""
    low, high = WIND_MPS
    for _ in range(WIND_STEPS):
        scene.sea.wind_speed_mps = middle = math.sqrt(low * high)
        if scene.significant_height_m() < height_m:
            low = middle
        else:
            high = middle
    return high


def _times(context, obj, name):
    """The modifier's time at the first, the middle and the last frame of the scene."""
    bpy_scene, now = context.scene, (context.scene.frame_current, context.scene.frame_subframe)
    first, last = bpy_scene.frame_start, max(bpy_scene.frame_end, bpy_scene.frame_start + 1)
    times = {}
    for frame in (first, 0.5 * (first + last), last):
        bpy_scene.frame_set(int(frame), subframe=frame % 1)
        times[frame] = obj.evaluated_get(context.evaluated_depsgraph_get()).modifiers[name].time
    bpy_scene.frame_set(now[0], subframe=now[1])
    return times


def scene_from(modifier, height_m, times, frame_rate):
    """The nearest sea to a modifier's settings, as a pelagic.Scene, and sentences about what has no counterpart.

    height_m: significant height that it should have. times: the modifier's time [s] at frames."""
    scene, missing = pelagic.Scene(), []
    scene.sea.spectrum = SPECTRA[modifier.spectrum]
    scene.sea.wind_direction_deg = (180.0 - math.degrees(modifier.wave_direction)) % 360.0
    scene.sea.depth_m = modifier.depth
    if modifier.spectrum in ("JONSWAP", "TEXEL_MARSEN_ARSLOE"):
        scene.sea.fetch_m = 1e3 * modifier.fetch_jonswap
        if modifier.sharpen_peak_jonswap:
            missing.append("the sharpened peak")
    scene.sea.spreading = "donelan-banner" if modifier.wave_alignment >= ALIGNED else "cosine"
    if modifier.wave_alignment == 0.0 or modifier.damping < 1.0:
        missing.append("waves against the wind")
    if modifier.wave_scale_min > 0.0:
        missing.append("a smallest wave: the resolution decides")
    scene.waves.choppiness = modifier.choppiness
    scene.shot.seed = modifier.random_seed
    scene.effects.whitecaps = modifier.use_foam
    if modifier.use_foam and modifier.foam_coverage:
        missing.append("a foam coverage: the wind and Effects’ amount decide")
    if modifier.use_spray:
        missing.append("spray")
    if modifier.is_cached:
        missing.append("the baked cache")
    repeat = max(modifier.repeat_x, modifier.repeat_y)
    if modifier.repeat_x != modifier.repeat_y:
        missing.append("different numbers of repeats: the surface is a square")
    scene.surface.size_m = modifier.spatial_size * modifier.size * repeat
    scene.surface.resolution = min(modifier.resolution**2 * repeat, 8192)

    (first, start), (middle, half), (last, end) = sorted(times.items())
    scene.shot.time_scale = max((end - start) / (last - first) * frame_rate, 0.0)
    scene.shot.time_offset_s = start - scene.shot.time_scale * (first - 1.0) / frame_rate
    if abs(half - 0.5 * (start + end)) > 1e-3 * max(abs(end - start), 1e-3):
        missing.append("a clock that is uneven")
    elif end < start:
        missing.append("a clock that runs backwards: it stands still")

    scene.sea.wind_speed_mps = wind_for(scene, height_m) if height_m > 0.0 else 0.0
    return scene, missing


class PELAGIC_OT_replace_ocean_modifier(NeedsModule, bpy.types.Operator):
    """Make the object's Ocean modifier the nearest Pelagic ocean, in the same place, of the same size and material"""

    bl_idname = "pelagic.replace_ocean_modifier"
    bl_label = "Replace Ocean Modifier"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and find(context.object) is not None

    def execute(self, context):
        obj = context.object
        modifier = find(obj)
        times = _times(context, obj, modifier.name)
        height_m = significant_height(obj, context.evaluated_depsgraph_get())
        scene, missing = scene_from(modifier, height_m, times, ocean.frame_rate(context.scene))
        if modifier.geometry_mode == "DISPLACE":
            missing.append("the mesh that it displaced: use Use Mesh as Ocean for it")
        if len(obj.modifiers) > 1:
            missing.append("a sea under other modifiers, which now get the new one")
        try:
            ocean.set_from(obj, scene)
        except ValueError as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        obj.pelagic.viewport_percentage = min(100, max(1, round(
            100 * (modifier.viewport_resolution / modifier.resolution) ** 2)))
        obj.pelagic.horizon = False
        animation = obj.animation_data
        path = f'modifiers["{modifier.name}"]'
        curves = compat.curves(obj)
        for curve in [curve for curve in curves if curve.data_path.startswith(path)]:
            curves.remove(curve)
        drivers = animation.drivers if animation else []
        for driver in [driver for driver in drivers if driver.data_path.startswith(path)]:
            drivers.remove(driver)
        obj.modifiers.remove(modifier)
        if obj.data.users > 1:
            obj.data = obj.data.copy()
        ocean.mark(obj)
        simulation = show_now(context, obj)
        if simulation.problem:
            self.report({"WARNING"}, simulation.problem)
        wind = scene.sea.wind_speed_mps
        self.report({"INFO"}, f"Waves of {height_m:.2f} m, as {wind:.1f} m/s of wind make them. No counterpart: "
                    + ("; ".join(missing) or "none needed"))
        return {"FINISHED"}


def _draw(self, context):
    """The end of the main panels."""
    if find(context.object):
        self.layout.operator(PELAGIC_OT_replace_ocean_modifier.bl_idname, icon="MODIFIER")


PANELS = ("PELAGIC_PT_object", "PELAGIC_PT_view")


def register():
    bpy.utils.register_class(PELAGIC_OT_replace_ocean_modifier)
    for name in PANELS:
        getattr(bpy.types, name).append(_draw)


def unregister():
    for name in PANELS:
        getattr(bpy.types, name).remove(_draw)
    bpy.utils.unregister_class(PELAGIC_OT_replace_ocean_modifier)
