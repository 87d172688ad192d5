# SPDX-License-Identifier: GPL-3.0-or-later
"""Sun and sky in Blender, the core's: a world with its picture of the sky, and a sun lamp.

Units: a world's radiance and a sun lamp's irradiance (its strength, across the rays) are the core's numbers, in kcd/m²
and klx; Blender has no units of its own for light. Both put the middle column of a picture of the sky at +x, and let
azimuth grow to the left.
"""

import math
import struct
import zlib

import bpy
import numpy as np
from mathutils import Vector

from .module import pelagic
from .ocean import Pinhole, pinhole_of
from .nodes import Tree

MARK = "pelagic_light"  # on the world and the lamp that are the add-on's
EXPOSURE = "pelagic_exposure"  # on the world: the stops that were set last
VIEW = "pelagic_view"  # on the world: the camera that they were metered by, Pinhole.numbers()
# By how much a view transform has to be exposed more for a sea that is as bright as by the program's own: of the two shots of a day's
# tests/addon/displays.py. Filmic shows a grey of 0.18 as 0.214.
VIEW_STOPS = {"Filmic": -0.05, "AgX": 0.25}
# The core's camera is in air, behind its front glass, and sees 1/n² of the light in the water; Blender's is in it.
BEHIND_GLASS = 2.0 * math.log2(1.34)
SKY_WIDTH = 1024
ALL = -2.0  # below each direction's z
STARTUP_LAMP_M = (4.0762, 1.0055, 5.9039)  # where Blender's start-up file has its lamp
# Where Cycles clamps indirect light: ten times white, which is 1 in the start-up file, and here a sunlit white of some 25 kcd/m². With the
# former a lagoon's floor is a third too dark.
STARTUP_CLAMP, CLAMP = 10.0, 250.0
PICTURE, DISC = "Pelagic Sky", "Pelagic Sun Disc"  # the world's nodes


def ensure_light(bpy_scene, scene, exposure=True):
    """The scene's sky becomes the Blender scene's world, its sun a lamp, and the picture is exposed for them. A world
    that was there before stays in the file."""
    world = bpy_scene.world
    if world is None or MARK not in world:
        if world is not None:
            world.use_fake_user = True
        world = bpy.data.worlds.new("Pelagic Sky")
        world[MARK] = True
        bpy_scene.world = world
    world.use_nodes = True
    if not {PICTURE, DISC} <= set(world.node_tree.nodes.keys()):
        _make_nodes(world)
    looked_up = world.node_tree.nodes[PICTURE].inputs["Vector"]
    if not looked_up.is_linked:  # of an older file
        world.node_tree.links.new(_looked_up(Tree(world.node_tree, keeps=True)).socket, looked_up)
    if own_sun(bpy_scene) is None:
        lamp = bpy.data.objects.new("Pelagic Sun", bpy.data.lights.new("Pelagic Sun", "SUN"))
        lamp[MARK] = True
        bpy_scene.collection.objects.link(lamp)
        _hide_startup_lamp(bpy_scene)
    if exposure:
        world[EXPOSURE] = bpy_scene.view_settings.exposure
    cycles = getattr(bpy_scene, "cycles", None)
    if cycles and cycles.sample_clamp_indirect == STARTUP_CLAMP:
        cycles.sample_clamp_indirect = CLAMP
    update_light(bpy_scene, scene)


def _hide_startup_lamp(bpy_scene):
    """The lamp of Blender's start-up file, which nobody chose, goes as its grey world does; one that somebody touched stays."""
    lamp = bpy_scene.objects.get("Light")
    if (lamp and lamp.type == "LIGHT" and lamp.data.type == "POINT" and lamp.data.energy == 1000.0 and not lamp.animation_data
            and (lamp.location - Vector(STARTUP_LAMP_M)).length < 1e-3):
        lamp.hide_render = True
        for layer in bpy_scene.view_layers:
            if lamp.name in layer.objects:
                lamp.hide_set(True, view_layer=layer)


_put = None  # the image's name and the pelagic.Sky that was put into it last
_daylights = {}  # text of a scene's light → its pelagic.Sky: the last few, for undo and for several who ask


def sky_of(scene):
    """The pelagic.Sky of a scene. A picture of a sky is read anew each time, for it may have changed."""
    if scene.light.sky != pelagic.Scene().light.sky:
        return pelagic.Sky(scene)
    key = repr(scene.light)
    if key not in _daylights:
        while len(_daylights) >= 4:
            del _daylights[next(iter(_daylights))]
        _daylights[key] = pelagic.Sky(scene)
    return _daylights[key]


def forget():
    """Images may be of another moment now."""
    global _put
    _put = None


def update_light(bpy_scene, scene):
    """Brings what ensure_light() made up to the scene; what an artist took away or put in its place stays so."""
    world, lamp = bpy_scene.world, own_sun(bpy_scene)
    if lamp is None and (world is None or MARK not in world):
        return
    sky = sky_of(scene)
    if world is not None and MARK in world:
        _put_sky(world, sky)
        meter(bpy_scene, scene)
    if lamp is not None:
        _put_sun(lamp, sky)


def meter(bpy_scene, scene):
    """Exposes the picture for a scene in its light and before its camera, where the add-on's world does that."""
    world = bpy_scene.world
    if world is not None and EXPOSURE in world and math.isclose(world[EXPOSURE], bpy_scene.view_settings.exposure, abs_tol=1e-4):
        stops = exposure_stops(sky_of(scene), scene) + VIEW_STOPS.get(bpy_scene.view_settings.view_transform, 0.0)
        if pelagic.is_metered_in_water(scene):
            stops -= BEHIND_GLASS
        bpy_scene.view_settings.exposure = world[EXPOSURE] = stops


def metered_view(obj, bpy_scene, depsgraph):
    """Pinhole.numbers() of the camera that the exposure is metered by, None without one: as it is now; where frames move it, as
    it last was at the first one. So the order of work doesn't matter, and a shot has one exposure."""
    world, pinhole = bpy_scene.world, pinhole_of(obj, bpy_scene, depsgraph)
    if world is None or EXPOSURE not in world or pinhole is None:
        return None
    if VIEW in world and bpy_scene.frame_current != bpy_scene.frame_start and _moves(bpy_scene.camera):
        return kept_view(bpy_scene)
    view = pinhole.numbers()
    if view != kept_view(bpy_scene):
        world[VIEW] = view
    return view


def kept_view(bpy_scene):
    """What metered_view() said last."""
    return tuple(bpy_scene.world[VIEW]) if bpy_scene.world and VIEW in bpy_scene.world else None


def see_by(view, scene):
    """Makes a metered view the scene's camera."""
    if view is not None:
        Pinhole.from_numbers(view).put_in(scene)


def _moves(obj, known=()):
    """Whether an object may go from frame to frame by itself."""
    above = [obj.parent] + [getattr(each, "target", None) for each in obj.constraints]
    return bool(obj.animation_data or obj.data and obj.data.animation_data or obj.rigid_body or obj.pelagic_float.enabled
                or any(_moves(each, (*known, obj)) for each in above if each and each not in known))


def sky_picture(bpy_scene):
    """The image of the scene's sky, None where that isn't the add-on's."""
    world = bpy_scene.world
    picture = world.node_tree.nodes.get(PICTURE) if world is not None and MARK in world else None
    return picture and picture.image


def extinction_per_m(scene):
    """(r, g, b) of the air at sea level: of a picture's visibility (Koschmieder 1924); of daylight linear in its turbidity, a fit to the
    core's table of air for 1.7 … 10 to 2 %."""
    light = scene.light
    if light.sky != pelagic.Scene().light.sky:
        return (3.912e-3 / light.visibility_km if light.visibility_km else 0.0,) * 3
    return tuple(1e-3 * (slope * light.turbidity - clear) for slope, clear in ((0.0695, 0.0631), (0.0815, 0.0692), (0.1009, 0.0711)))


def own_sun(bpy_scene):
    return next((obj for obj in bpy_scene.objects if MARK in obj and obj.type == "LIGHT"), None)


def _put_sky(world, sky):
    global _put
    picture, disc = (world.node_tree.nodes.get(name) for name in (PICTURE, DISC))
    if picture is not None and (picture.image is None or _put != (picture.image.name_full, sky)):
        picture.image = _sky_image(picture.image, sky)
        _put = picture.image.name_full, sky
    if disc is not None:
        disc.inputs["Direction"].default_value = sky.sun_direction
        disc.inputs["Radiance"].default_value = sky.sun_radiance
        disc.inputs["Angular Radius"].default_value = sky.sun_angular_radius


def _make_nodes(world):
    """The picture of the sky, and before it the sun's disc for those who look at it: for all else there is the lamp."""
    tree = Tree(world.node_tree)
    picture = tree.node("ShaderNodeTexEnvironment", {"Vector": _looked_up(tree)})
    picture.name = PICTURE
    seen = tree.call(DISC, _disc, {"Direction": (0.0, 0.0, 1.0), "Radiance": (0.0, 0.0, 0.0), "Angular Radius": 0.0})
    tree.node("ShaderNodeOutputWorld", {"Surface": tree.add("ShaderNodeAddShader", {
        0: tree.add("ShaderNodeBackground", {"Color": tree.value(picture, "Color")}),
        1: tree.add("ShaderNodeBackground", {"Color": seen["Radiance"]})})})
    if hasattr(world, "cycles"):  # its own choice is finer than the picture, and costs each render seconds
        world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", SKY_WIDTH


def _looked_up(tree):
    """The direction in which a ray has the picture: its own, and for the camera's below the horizon the lowest of the sky. Otherwise the
    picture goes over from there into the dark ground, a line along the horizon; and it shows that wherever the sea ends before the horizon."""
    x, y, z = tree.add("ShaderNodeTexCoord", output="Generated").parts()
    half_row = math.pi / SKY_WIDTH
    is_seen = tree.add("ShaderNodeLightPath", output="Is Camera Ray")
    return tree.vector(x, y, z.at_least(is_seen * ((x * x).plus_product(y, y).sqrt() * half_row - ALL) + ALL))


def _disc(tree, asked):
    # The chord, since the cosine of a small angle has no precision.
    towards = tree.add("ShaderNodeTexCoord", output="Generated").normalized()
    inside = asked["Angular Radius"].above((towards - asked["Direction"]).length())
    return {"Radiance": asked["Radiance"] * (inside * tree.add("ShaderNodeLightPath", output="Is Camera Ray"))}


def _sky_image(image, sky):
    return packed_image("Pelagic Sky", sky.image(SKY_WIDTH), image)


def packed_image(name, picture, image=None, is_data=False):
    """An image, made again from a picture, float32 (height, width, 3), rows from the top."""
    height, width, _ = picture.shape
    if image is None or tuple(image.size) != (width, height):
        image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=is_data)
    file = openexr(picture)
    image.pack(data=file, data_len=len(file))
    image.source = "FILE"  # the packed one
    image.buffers_free()  # of the picture before
    image.update_tag()
    return image


def openexr(picture):
    """A picture, float32 (height, width, 3), as the bytes of an OpenEXR file: half floats, off by 1/2048 at most, ZIP, which
    for a sky take a fortieth of what Blender's own packing does. https://openexr.com/en/latest/OpenEXRFileLayout.html"""
    height, width, _ = picture.shape

    def attribute(name, kind, value):
        return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<4i", 1, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = (struct.pack("<2i", 20000630, 2) + attribute("channels", "chlist", channels) + attribute("compression", "compression", b"\3")
            + attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
            + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0))
            + attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1.0))
            + b"\0")
    planes = np.minimum(picture, np.finfo(np.float16).max).astype("<f2")[..., ::-1].transpose(0, 2, 1)  # rows, channels, columns
    blocks = []
    for row in range(0, height, 16):
        raw = np.ascontiguousarray(planes[row:row + 16]).view(np.uint8).ravel()
        split = np.concatenate([raw[::2], raw[1::2]])
        split[1:] = np.diff(split) + np.uint8(128)
        packed = zlib.compress(split.tobytes())
        if len(packed) >= len(raw):  # then it stands there as it was
            packed = raw.tobytes()
        blocks.append(struct.pack("<2i", row, len(packed)) + packed)
    places = len(head) + 8 * len(blocks) + np.cumsum([0] + [len(block) for block in blocks[:-1]])
    return head + places.astype("<u8").tobytes() + b"".join(blocks)


def _put_sun(lamp, sky):
    across = [radiance * math.pi * sky.sun_angular_radius**2 for radiance in sky.sun_radiance]  # irradiance
    strongest = max(across)
    lamp.data.energy = strongest
    if strongest > 0:
        lamp.data.color = [value / strongest for value in across]
    lamp.data.angle = 2 * sky.sun_angular_radius
    lamp.rotation_mode = "QUATERNION"
    lamp.rotation_quaternion = Vector(sky.sun_direction).to_track_quat("Z", "Y")  # a lamp shines along its -z


def exposure_stops(sky, scene):
    """The stops at which the core shows the scene in its light: radiance · 2^stops = 0.18 is middle grey."""
    return math.log2(sky.exposure(scene))


def stops_by_hand(bpy_scene):
    """How many stops brighter the picture is than the exposure that was metered has it."""
    world = bpy_scene.world
    own = world[EXPOSURE] if world is not None and EXPOSURE in world else 0.0
    return bpy_scene.view_settings.exposure - own
