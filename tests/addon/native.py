"""A native Ocean modifier becomes the nearest sea."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import compat, native, ocean, play


def native_ocean(**settings):
    fresh_file()
    bpy.ops.mesh.primitive_plane_add(location=(3, 4, 0.5))
    obj = bpy.context.object
    modifier = obj.modifiers.new("Waves", "OCEAN")
    modifier.resolution = modifier.viewport_resolution = 12
    for name, value in settings.items():
        setattr(modifier, name, value)
    obj.data.materials.append(bpy.data.materials.new("Mine"))
    bpy.context.view_layer.update()
    return obj, modifier


def height(obj):
    """4 standard deviations of the mesh's heights, over frames."""
    variances = []
    for frame in range(1, 200, 40):
        bpy.context.scene.frame_set(frame)
        variances.append(numbers(evaluated_mesh(obj))[:, 2].astype(float).var())
    return 4 * np.sqrt(np.mean(variances))


for spectrum in native.SPECTRA:
    with checking(f"{spectrum}: waves as high, in the same place, of the same size and material"):
        obj, modifier = native_ocean(spectrum=spectrum, wave_scale=1.5, spatial_size=120, wind_velocity=12.0,
                                     use_foam=True)
        before = native.significant_height(obj, bpy.context.evaluated_depsgraph_get())
        assert bpy.ops.pelagic.replace_ocean_modifier() == {"FINISHED"}
        assert ocean.is_ocean(obj) and not obj.modifiers
        assert tuple(obj.location) == (3, 4, 0.5) and obj.data.materials[0].name == "Mine"
        simulation = play.simulation_of(obj)
        made = simulation.sea.significant_height_m
        assert abs(made / before - 1) < 0.01, (made, before)
        assert abs(height(obj) / before - 1) < 0.5, (height(obj), before)  # of one moment on 120 m
        assert simulation.scene.surface.size_m == 120 and simulation.scene.surface.resolution == 144
        assert simulation.scene.effects.whitecaps

with checking("its clock: keyframes, a driver, none"):
    for clock in ("keys", "driver", "none"):
        obj, modifier = native_ocean()
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end = 1, 101
        if clock == "keys":
            for frame, time in ((1, 2.0), (101, 12.0)):
                modifier.time = time
                modifier.keyframe_insert("time", frame=frame)
            for curve in compat.curves(obj):
                for point in curve.keyframe_points:
                    point.interpolation = "LINEAR"
        elif clock == "driver":
            modifier.driver_add("time").driver.expression = "2 + (frame - 1) / 10"
        else:
            modifier.time = 2.0
        bpy.ops.pelagic.replace_ocean_modifier()
        shot = ocean.scene_of(obj, scene).shot
        for frame in (1, 51, 101):
            expected = 2.0 if clock == "none" else 2 + (frame - 1) / 10
            assert abs(shot.time_s(frame) - expected) < 1e-4, (clock, frame, shot.time_s(frame))
        assert not compat.curves(obj) and not (obj.animation_data and obj.animation_data.drivers)

with checking("the waves travel the same way"):
    def direction(before, after, side):
        """Where the energy goes: the phase of the cross-spectrum of two moments."""
        a, b = (np.fft.fft2(each[:side * side].reshape(side, side)) for each in (before, after))
        k = np.fft.fftfreq(side)
        weight = np.abs(a) ** 2 * np.sign(-np.angle(b * a.conj()))
        return np.degrees(np.arctan2((weight * k[:, None]).sum(), (weight * k[None, :]).sum()))

    for degrees in (0.0, 60.0):
        obj, modifier = native_ocean(wave_alignment=1.0, damping=1.0, choppiness=0.0, spatial_size=60,
                                     wind_velocity=6.0, wave_direction=np.radians(degrees))
        moments = []
        for time in (1.0, 1.1):
            modifier.time = time
            bpy.context.view_layer.update()
            moments.append(numbers(evaluated_mesh(obj))[:, 2])
        was = direction(*moments, 145)
        bpy.ops.pelagic.replace_ocean_modifier()
        now = obj.pelagic.sea.wind_direction_deg
        assert abs((now - was + 180) % 360 - 180) < 20, (degrees, was, now)

with checking("a still modifier without waves, and an object without one"):
    obj, modifier = native_ocean(wave_scale=0.0)
    bpy.ops.pelagic.replace_ocean_modifier()
    assert obj.pelagic.sea.wind_speed_mps == 0.0 and np.abs(numbers(obj.data)[:, 2]).max() < 1e-3
    assert not bpy.ops.pelagic.replace_ocean_modifier.poll()
