# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of an ocean, `Object.pelagic`: a group for each table of a shot file, made from pelagic.keys().

Key sea.wind_speed_mps is obj.pelagic.sea.wind_speed_mps, in the key's own unit. Where a key may be absent, infinite or a word,
the property use_NAME beside it says whether it has a number. What Blender itself knows (frames, the camera but for its exposure) has none.
"""

import itertools
import math
import re
import zlib
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty,
                       IntVectorProperty, PointerProperty, StringProperty)

from . import cages
from .module import pelagic

VERSION = 7  # of the settings in a file; ocean.migrate() brings older ones here

FROM_BLENDER = {"shot.name", "shot.frames", "shot.fps",  # and the camera's: they come from the scene
                "shot.edition"}  # the newest: all settings have values, and a file keeps those of its time (ocean.migrate)
OF_CAMERA = {"camera.exposure_ev", "camera.ev100"}  # what Blender's camera hasn't: the add-on exposes the scene's view

# Keys that the core refuses unless another key has one of some values: they are shown, and count, only then.
ONLY_WITH = {"sea.spectrum_file": ("sea.spectrum", ("file",)), "sea.spectrum_time": ("sea.spectrum", ("file",)),
             "surface.cage_file": ("surface.kind", ("cage",)), "surface.cage_level": ("surface.kind", ("cage",)),
             "waves.trains": ("waves.model", ("trochoid",)), "waves.shortest_m": ("waves.model", ("trochoid",)),
             "waves.longest_m": ("waves.model", ("trochoid",)),
             "water.chlorophyll_mg_m3": ("water.type", ("ocean", "coastal", "turbid"))}

# A unit of the table → arguments of a property. Degrees stay degrees: Blender's angles would be radians in scripts.
UNITS = {"m": {"subtype": "DISTANCE", "unit": "LENGTH"}, "m/s": {"unit": "VELOCITY"},
         "s": {"subtype": "TIME_ABSOLUTE", "unit": "TIME"}, "pixels": {"subtype": "PIXEL"}}
ABBREVIATIONS = {"fft", "jonswap", "tma", "usda", "usdc"}
SIGNS = {"degrees": "°"}  # shorter in a label
LABELS = {"sea.fetch_m": "Wind fetch", "light.visibility_km": "Visibility", "effects.sea_minus_air_c": "Sea warmer than air",
          "camera.exposure_ev": "Exposure", "camera.ev100": "Light meter"}  # where a key's name makes none, or one that Blender knows of another thing
INTEGER_LIMIT = 2**31 - 1  # of Blender's


def shortest(number):
    """The decimal that Blender's float32 was set from, as a double: 0.1, not 0.10000000149."""
    return float(str(np.float32(number)))


def shortest_for(value, encode, stored):
    """The shortest decimal near value that encode() turns into this float32; value itself if none does."""
    for digits in range(1, 17):
        short = float(f"{value:.{digits}g}")
        if np.float32(encode(short)) == np.float32(stored):
            return short
    return value


# ---- Keys


@dataclass(frozen=True)
class Field:
    """A key that has a property, with how its value goes in and out of it."""

    path: str
    name: str
    table: str
    key: dict
    absent: object = 0  # what the key is without a number, None, inf or a word; 0: it always has one

    @property
    def switch(self):
        """The name of the property that says whether there is a number, or ""."""
        return "" if self.absent == 0 else "use_" + self.name

    @property
    def is_path(self):
        return self.key["type"] != "entries" and "path" in self.key["accepted"]

    def read(self, group):
        """The value as the module takes it, of a group: plain numbers, strings, tuples."""
        if self.switch and not getattr(group, self.switch):
            return self.absent
        return READERS[self.key["type"]](self, getattr(group, self.name))

    def check(self, value):
        """ValueError if a property of Blender's can't hold the value."""
        if self.key["type"] == "integer" and isinstance(value, int) and value > INTEGER_LIMIT:
            raise ValueError(f"{self.path} = {value}: Blender's integers end at {INTEGER_LIMIT}")

    def write(self, group, value):
        if self.switch:
            setattr(group, self.switch, value is not None and value != self.absent)
            if value is None or value == self.absent:
                return
        if self.key["type"] == "entries":
            rows = getattr(group, self.name)
            rows.clear()
            for entry in value:
                row = add_row(rows)
                for inner in entry_fields(self):
                    given = getattr(entry, inner.name)
                    inner.write(row, str(Path(given).absolute()) if inner.is_path and given else given)
            return
        if self.key["type"] == "words":
            value = set(value)
        setattr(group, self.name, "" if value is None else value)


def add_row(rows):
    """A new entry of a list. It has a name, or of several in a library override Blender would keep the first."""
    names, row = {row.name for row in rows}, rows.add()
    row.name = next(name for name in map(str, itertools.count(1)) if name not in names)
    return row


def _text(field, value):
    return value if value or field.key["default"] is not None or field.key["required"] else None


READERS = {
    "truth": lambda field, value: value,
    "integer": lambda field, value: value,
    "number": lambda field, value: shortest(value),
    "point": lambda field, value: tuple(shortest(number) for number in value),
    "pair": lambda field, value: tuple(value),
    "word": lambda field, value: value,
    "words": lambda field, value: tuple(choice for choice in field.key["choices"] if choice in value),
    "text": _text,
    "data file": _text,
    "data time": _text,
    "entries": lambda field, rows: tuple(tuple(inner.read(row) for inner in entry_fields(field)) for row in rows),
}


def _field(key):
    key = key | {"label": LABELS.get(key["path"], key["label"])}
    table = key["path"].split(".")[0]
    absent = 0
    if key["type"] in ("number", "integer"):
        if key["default"] is None and not key["required"]:
            absent = None
        elif key["type"] == "integer" and key["other_word"]:
            absent = key["other_word"]
        elif key["default"] is not None and math.isinf(key["default"]):
            absent = math.inf
    return Field(key["path"], key["name"], table, key, absent)


def _has_property(key):
    if key["choices"] and len(key["choices"]) < 2:
        return False  # nothing to choose
    if "." not in key["path"]:
        return False  # bodies: Blender has its own
    return key["path"] in OF_CAMERA or key["path"] not in FROM_BLENDER and not key["path"].startswith("camera.")


FIELDS = tuple(_field(key) for key in pelagic.keys() if _has_property(key)) if pelagic else ()
TABLES = tuple(dict.fromkeys(field.table for field in FIELDS))
BY_PATH = {field.path: field for field in FIELDS}
PLACE = {field.path: place for place, field in enumerate(FIELDS)}  # in ocean.settings_of()
_ENTRY_FIELDS = {field.path: tuple(_field(key) for key in field.key["keys"]) for field in FIELDS}


def counts(field, settings):
    """Whether a key counts with the other settings of an ocean, obj.pelagic."""
    picture = BY_PATH.get(field.key["of_picture"])
    if picture is not None:
        path = picture.read(getattr(settings, picture.table))
        if path == picture.key["default"] or path.lower().endswith(".obj"):
            return False
    other, values = ONLY_WITH.get(field.path, (None, ()))
    return other is None or getattr(getattr(settings, BY_PATH[other].table), BY_PATH[other].name) in values


def entry_fields(field):
    """The fields of a list's entries."""
    return _ENTRY_FIELDS[field.path]


# ---- Properties out of them


def _touched(group, _context):
    """A setting was changed, by hand or by a script: its object is evaluated again, and play.py sees it then."""
    group.id_data.update_tag()


def _chosen_by_hand(settings, context):
    settings.see_through_by_hand = True
    _touched(settings, context)


def _sentence(text):
    return text[:1].upper() + text[1:]


def unit_of(key):
    """The sign of a unit that Blender doesn't write itself, or ""."""
    return "" if key["unit"] in UNITS else SIGNS.get(key["unit"], key["unit"])


def label_of(key):
    return key["label"] + (f" ({unit_of(key)})" if unit_of(key) else "")


# ---- What a tooltip says: a shot file's words, with what an artist sees in place of keys


def _all_keys():
    for key in pelagic.keys() if pelagic else ():
        yield from (key, *key["keys"])


NAMES = {key["name"]: LABELS.get(key["path"], key["label"]) for key in _all_keys()} | {
    key["path"]: LABELS.get(key["path"], key["label"]) for key in _all_keys()}
WORDS = {choice for key in _all_keys() for choice in key["choices"] if choice in ABBREVIATIONS or re.search("[^a-z]", choice)}
EITHER = re.compile(r'(\w+) = "([\w-]+)"')
A_NAME = re.compile(r"[A-Za-z][\w-]*(?:\.[a-z]\w*)*")
WIDE = 1e6  # no end for an artist


def _of_artists(text):
    """A sentence in the words of the panels."""
    def seen(found):
        name = found[0]
        if name in WORDS:
            return _spoken(name)
        return NAMES.get(name, name) if "_" in name or "." in name else name

    return _sentence(A_NAME.sub(seen, EITHER.sub(lambda found: f"{NAMES.get(found[1], found[1])} {_spoken(found[2])}", text)))


def _parts_of(key):
    """Its help without what it says of each word, and that: {word: text}."""
    text, of_words = key["help"], {}
    for choice in key["choices"]:
        found = re.search(rf"(?:(?<=^)|(?<=[.;] )){re.escape(choice)}: (.*?)(?:; |(?=\. [A-Z])|$)", text)
        if found:
            of_words[choice] = _of_artists(found[1])
            text = text[:found.start()] + text[found.end():]
    return _of_artists(re.sub(r"(\. )+$", "", text.replace(". . ", ". ")).rstrip(". ")), of_words


def _limits(key, say):
    """From where to where a number goes, in its unit; "" where an artist meets no end."""
    if key["type"] not in ("number", "integer"):
        return ""
    low, high = key["range"]
    unit = SIGNS.get(key["unit"], " " + say(key["unit"]) if key["unit"] else "")
    if abs(low) >= WIDE and abs(high) >= WIDE:
        return ""
    return say("{} or more").format(f"{low:g}{unit}") if high >= WIDE else say("{} to {}").format(f"{low:g}", f"{high:g}{unit}")


FORM = re.compile(r"^(a string, )?|,? from the shot file's folder")


def tooltip(key, say=lambda text: text):
    """What Blender shows of a key. say: into another language."""
    parts = [say(_parts_of(key)[0] or key["label"]), _limits(key, say)]
    if key["type"] in ("text", "data file", "data time"):
        accepted = FORM.sub("", key["accepted"])  # a word in quotes is to be typed as it stands
        parts.append(say(accepted.replace('"', "") if accepted.startswith('"') else _sentence(accepted).replace('"', "")))
    return ". ".join(filter(None, parts))


def switch_tooltip(field, say=lambda text: text):
    what = {None: "Whether {} is given; otherwise it is chosen", math.inf: "Whether {} is finite; otherwise it is infinite"}.get(
        field.absent, "Whether {} is a number; otherwise it is " + str(field.absent))
    return say(what).format(say(field.key["label"]))


def _common(key):
    return {"name": label_of(key), "description": tooltip(key), "update": _touched}


def _numeric(key, limit=math.inf):
    low, high = key["range"]
    soft_low, soft_high = key["soft_range"] or key["range"]
    kind = int if key["type"] == "integer" else float
    low, high, soft_low, soft_high = (kind(max(min(bound, limit), -limit)) for bound in (low, high, soft_low, soft_high))
    start = key["default"]
    if start is None or math.isinf(start):  # a number to begin with, once it is switched on
        start = math.sqrt(soft_low * soft_high) if key["logarithmic"] else 0.5 * (soft_low + soft_high)
        start = kind(float(f"{start:.1g}"))
    return {"min": low, "max": high, "soft_min": soft_low, "soft_max": soft_high, "default": start}


def _spoken(word):
    return word.upper() if word in ABBREVIATIONS else _sentence(word.replace("-", " "))


def number_of(choice, bits=23):
    """A word's number in a file. Blender hands it on in single precision, and its F-curves add a half to that before they round it down:
    so 23 bits are exact."""
    return zlib.crc32(choice.encode()) & ((1 << bits) - 1)


def _choices(key, flags):
    """Items whose numbers, which are what a file keeps, don't change when the core gets another word."""
    of_words = _parts_of(key)[1]
    return [(choice, _spoken(choice), of_words.get(choice, ""), 1 << place if flags else number_of(choice))
            for place, choice in enumerate(key["choices"])]


def word_before(field, number):
    """The word that had this number before version 7 of the settings, None: none. It had 31 bits until version 5, which a drop-down rounded,
    and then 24."""
    return next((choice for choice in field.key["choices"]
                 if number in (number_of(choice, 24), number_of(choice, 31), int(np.float32(number_of(choice, 31))))), None)


def _number(key):
    return FloatProperty(**_common(key), **_numeric(key), precision=1 if key["unit"] in SIGNS else 3, **UNITS.get(key["unit"], {}))


def _integer(key):
    subtype = {"subtype": "PIXEL"} if key["unit"] == "pixels" else {}
    return IntProperty(**_common(key), **_numeric(key, INTEGER_LIMIT), **subtype)


def _string(key):
    subtype = {"subtype": "FILE_PATH"} if _field(key).is_path else {}
    return StringProperty(**_common(key), default=key["default"] or "", **subtype)


MAKERS = {
    "truth": lambda key: BoolProperty(**_common(key), default=key["default"]),
    "integer": _integer,
    "number": _number,
    "point": lambda key: FloatVectorProperty(**_common(key), size=3, default=key["default"] or (0, 0, 0),
                                             **({"subtype": "XYZ"} if key["unit"] else {"subtype": "COLOR", "min": 0, "max": 1})),
    "pair": lambda key: IntVectorProperty(**_common(key), size=2, default=key["default"] or (0, 0)),
    "word": lambda key: EnumProperty(**_common(key), items=_choices(key, False), default=key["default"]),
    "words": lambda key: EnumProperty(**_common(key), items=_choices(key, True), default=set(key["default"]),
                                      options={"ENUM_FLAG", "ANIMATABLE"}),
    "text": _string,
    "data file": _string,
    "data time": _string,
}


OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


def overridable(group):
    """Lets a library override keep these properties."""
    for each in group.__annotations__.values():
        each.keywords["override"] = OVERRIDABLE | ({"USE_INSERTION"} if each.function is CollectionProperty else set())
    return group


def _group(name, annotations, doc):
    return overridable(type("PELAGIC_PG_" + name, (bpy.types.PropertyGroup,), {"__annotations__": annotations, "__doc__": doc}))


def _annotations(fields, classes):
    """Properties for these fields; classes gets the groups that they need."""
    made = {}
    for field in fields:
        if field.switch:
            made[field.switch] = BoolProperty(
                name=field.key["label"], default=field.key["default"] not in (None, field.absent), update=_touched,
                description=switch_tooltip(field))
        if field.key["type"] == "entries":
            entry = _group(field.path.replace(".", "_"), _annotations(entry_fields(field), classes), tooltip(field.key))
            classes.append(entry)
            made[field.name] = CollectionProperty(type=entry, name=field.key["label"],
                                                  description=tooltip(field.key))
        else:
            made[field.name] = MAKERS[field.key["type"]](field.key)
    return made


def _can_be_cage(_group, other):
    return cages.can_be(other)


BUDGETS = ("quality.max_error", "quality.frame_ms")
CUSTOM = "custom"  # in place of a level: a budget


def _quality_items():
    level = BY_PATH["quality.level"].key if "quality.level" in BY_PATH else {"choices": (), "help": ""}
    return [(choice, _spoken(choice), _parts_of(level)[1].get(choice, ""), number) for number, choice in enumerate(level["choices"])] + [
        (CUSTOM, "Custom budget", "The cheapest settings within an error, or the most accurate within a time", len(level["choices"]))]


def _budget_switches():
    return [BY_PATH[path].switch for path in BUDGETS]


def _quality(settings):
    words = [item[0] for item in _quality_items()]
    quality = settings.quality
    return words.index(CUSTOM if any(getattr(quality, switch) for switch in _budget_switches()) else quality.level)


def _set_quality(settings, number):
    word = _quality_items()[number][0]
    error, time = _budget_switches()
    setattr(settings.quality, error, word == CUSTOM)
    setattr(settings.quality, time, False)
    if word != CUSTOM:
        settings.quality.level = word


def _ocean_annotations():
    """What an ocean has in Blender alone. These don't need the module."""
    return {
        "is_ocean": BoolProperty(name="Ocean", options={"HIDDEN"}, update=_touched),
        "version": IntProperty(name="Settings' version", options={"HIDDEN"}),
        "own_mesh": BoolProperty(
            name="Own mesh", options={"HIDDEN"}, update=_touched,
            description="The object's own vertices are the sea at rest; their places are in the attribute rest_position"),
        "cage": PointerProperty(
            name="Cage", type=bpy.types.Object, update=_touched, poll=_can_be_cage,
            description="The mesh whose smooth limit surface the sea lies on, with its creases. Without one it is the cage's file"),
        "horizon": BoolProperty(
            name="To the horizon", default=True, update=_touched,
            description="Rings of ever larger quads round the patch, out to 90 km. A bake leaves them out"),
        "uv_map": BoolProperty(
            name="UV Map", default=False, update=_touched,
            description="Texture coordinates for image textures. Pelagic's own materials read rest_position instead: "
                        "with the map a large mesh takes a third more memory, and Blender copies it more slowly"),
        "velocity": BoolProperty(
            name="Velocity", default=False, update=_touched,
            description="The attribute velocity [m/s], for materials and modifiers of your own. With the scene's motion blur it is "
                        "there in any case"),
        "see_through": BoolProperty(
            name="See Through", default=False, update=_chosen_by_hand,
            description="What is under the surface shows in Cycles, dimmed and coloured by the water: absorption and scattering "
                        "as a volume, which takes longer to render. Off, the water is opaque, with the same light from below"),
        "see_through_by_hand": BoolProperty(
            name="See Through by Hand", default=False, update=_touched,
            description="Whether you choose if the water is seen through; otherwise it is where its floor is near enough to show, "
                        "and while the camera is under water"),
        "quality_menu": EnumProperty(
            name="Quality", items=_quality_items(), get=_quality, set=_set_quality, update=_touched,
            description="How much time accuracy may take: a level, or a budget of error or of time that chooses the settings"),
        "viewport_percentage": IntProperty(
            name="Viewport", default=100, min=1, max=100, subtype="PERCENTAGE", update=_touched,
            description="Vertices a side while you work, as a share of what a render has"),
        "viewport_vertices": IntProperty(
            name="Viewport at Most", default=500_000, min=0, soft_max=5_000_000, update=_touched,
            description="Vertices while you work: a patch or a projected grid that would have more is coarser than in a render. "
                        "0: as many as there are"),
    }


_classes = []


def register():
    annotations = _ocean_annotations()
    for table in TABLES:
        group = _group(table, _annotations([field for field in FIELDS if field.table == table], _classes), table)
        _classes.append(group)
        annotations[table] = PointerProperty(type=group)
    _classes.append(_group("ocean", annotations, "The settings of an ocean"))
    for made in _classes:
        bpy.utils.register_class(made)
    bpy.types.Object.pelagic = PointerProperty(type=_classes[-1], name="Pelagic Ocean", override=OVERRIDABLE)


def unregister():
    del bpy.types.Object.pelagic
    while _classes:
        bpy.utils.unregister_class(_classes.pop())
