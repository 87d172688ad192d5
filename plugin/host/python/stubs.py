"""Writes pelagic.pyi beside the module: its names, signatures and docstrings for editors and type checkers.

    python3 stubs.py FILE      with the module on PYTHONPATH

Everything comes from the module itself. What pybind11 can only call an object is named here.
"""

import inspect
import re
import sys

import pelagic

ARRAY = "NDArray[np.float32]"
PROGRESS, CANCEL = "Callable[..., object] | None", "Cancel | Callable[[], bool] | None"

# Parameters that are objects to pybind11, by name.
PARAMETERS = {
    "progress": PROGRESS, "cancel": CANCEL, "rest": ARRAY, "xy": "ArrayLike", "directions": ARRAY, "to_eye": ARRAY,
    **{name: "ArrayLike" for name in ("face_counts", "indices")},
    **{name: "ArrayLike | None" for name in ("points", "creases", "crease_sharpness", "corners", "corner_sharpness", "holes", "st",
                                             "st_indices")},
    **{name: f"float | {ARRAY} | None" for name in ("cell_m", "pixel_m", "footprint_m")},
    **{name: f"{ARRAY} | None" for name in ("cell_axis_m", "pixel_axis_m", "rest_normal", "out", "sun_layer", "sky_layer", "sea_layer",
                                            "foam_layer", "displacement", "position", "velocity", "jacobian", "coverage")},
}
# The same where a name means another thing in one place.
PARAMETERS_OF = {("__init__", "points"): "ArrayLike"} | {("shade", name): ARRAY for name in ("normal", "slope_variance")} | {
    (function, name): f"{ARRAY} | None" for function in ("evaluate", "begin")
    for name in ("normal", "slope_variance", "slope_variance_at_rest", "foam_active", "foam_age")} | {
    ("water_albedo", name): f"{ARRAY} | None" for name in ("foam_active", "foam_age", "normal", "crest")}

# Results that are objects, dictionaries and tuples to pybind11, by the name after the last dot.
RESULTS = {
    "patch": f"tuple[{ARRAY}, NDArray[np.int32]]", "grid_quads": "NDArray[np.int32]", "quads": "NDArray[np.int32]",
    "rest_m": ARRAY, "face_counts": "NDArray[np.int32]", "indices": "NDArray[np.int32]", "st": ARRAY, "cell_m": ARRAY, "pixel_m": ARRAY, "cell_axis_m": ARRAY, "pixel_axis_m": ARRAY, "image": ARRAY, "spray_image": ARRAY, "in_air": "dict[str, NDArray[Any]]", "radiance": ARRAY, "faces": "NDArray[np.int32]",
    "evaluate": f"dict[str, {ARRAY}]", "heights": f"dict[str, {ARRAY}]", "shade": f"dict[str, {ARRAY}]",
    "render": "dict[str, NDArray[Any]]", "read_mesh": "dict[str, NDArray[Any]]", "at": f"tuple[dict[str, {ARRAY}], "
    f"list[dict[str, {ARRAY}]]]", "keys": "list[dict[str, Any]]", "presets": "list[dict[str, Any]]",
    "uniforms": "dict[str, Any]", "objects": "dict[str, Any]", "surroundings": "dict[str, Any]", "foam": "dict[str, Any]", "water": "dict[str, Any]", "textures": "dict[str, Any]", "limit": "dict[str, Any]", "take_foam": "dict[str, Any]", "shaders": "dict[str, tuple[str, str]]", "vertices": ARRAY,
    "object_pose": "NDArray[np.float64]", "object_poses": "NDArray[np.float64]", "object_mesh": "dict[str, Any]", "triangles": "NDArray[np.uint32]", "size": "tuple[int, int]", "at_origin": f"tuple[NDArray[np.uint8], {ARRAY} | None]",
    "products": "tuple[str, ...]", "origin_m": "tuple[float, float]", "resolution": "tuple[int, int]", "shift": "tuple[float, float]",
    "foam_picture": f"{ARRAY} | None", "water_albedo": ARRAY, "water_radiance": ARRAY, "air": f"tuple[dict[str, Any], {ARRAY}]", "progress": "tuple[Any, ...] | None", "result": "Any",
    **{name: "tuple[float, float, float]" for name in
       ("position_m", "right", "up", "forward", "sun_direction", "sun_radiance", "sun_irradiance", "sky_irradiance",
        "reflectance", "absorption_per_m", "backscatter_per_m", "lets_through")},
}

# Attributes of a scene's tables that aren't keys and can be set.
SETTABLE = {"cage": "Cage | None"}

HEADER = '''\
"""{doc}"""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
'''


def indented(text, depth):
    return "".join(("    " * depth + line).rstrip() + "\n" for line in text.splitlines())


def docstring(text, depth):
    text = inspect.cleandoc(text or "").replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    if text.endswith('"'):
        text += " "
    return indented(f'"""{text}"""', depth) if text else ""


def split(text):
    """Splits at commas outside brackets and quotes."""
    parts, depth, quoted, start = [], 0, False, 0
    for i, letter in enumerate(text):
        if letter == "'":
            quoted = not quoted
        if quoted:
            continue
        depth += (letter in "[({") - (letter in "])}")
        if letter == "," and depth == 0:
            parts.append(text[start:i])
            start = i + 1
    return [part.strip() for part in [*parts, text[start:]] if part.strip()]


def type_of(text, is_result):
    text = text.replace("pelagic.", "").replace("os.PathLike", "Path" if is_result else "str | PathLike[str]")
    text = re.sub(r"(?<=[\w\]])\[\d+\]", "", text)  # an array of a fixed number
    text = text.replace("Tuple[", "tuple[")
    text = text.replace("List[", "list[" if is_result else "Sequence[")
    text = re.sub(r"numpy\.ndarray\[numpy\.(\w+)\]", r"NDArray[np.\1]", text)
    return text.replace("numpy.ndarray", "NDArray[Any]")


def parameter(text, function):
    if text in ("*", "/"):
        return text
    declared, _, default = text.partition(" = ")
    name, _, kind = declared.partition(": ")
    if name == "self":
        return name
    kind = type_of(kind, False)
    if kind == "object":
        kind = PARAMETERS_OF.get((function, name)) or PARAMETERS.get(name, "object")
    return f"{name}: {kind}" + (" = ..." if default else "")


def result(text, name):
    kind = type_of(text, True)
    return RESULTS.get(name, kind) if kind in ("object", "dict", "tuple", "list", "NDArray[Any]") else kind


def function(name, value, depth, is_static=False):
    """A function from the first line of its docstring, where pybind11 writes the signature."""
    signature, _, doc = value.__doc__.partition("\n")
    match = re.fullmatch(r"\w*\((.*)\) -> (.*)", signature)
    parameters = [parameter(each, name) for each in split(match[1])]
    if depth and not is_static:
        parameters[0] = "self"
    doc = docstring(doc, depth + 1)
    head = f"def {name}({', '.join(parameters)}) -> {result(match[2], name)}:"
    static = indented("@staticmethod", depth) if is_static else ""
    return static + indented(head, depth) + (doc or "    " * (depth + 1) + "...\n")


def read_only(name, kind, doc):
    return indented(f"@property\ndef {name}(self) -> {kind}:", 1) + (docstring(doc, 2) or "        ...\n")


def members(made):
    text = docstring(made.__doc__, 1)
    for name, value in vars(made).items():
        if name.startswith("_") and name not in ("__init__", "__eq__"):
            continue
        if isinstance(value, property):
            if isinstance(made, type) and value.fset is not None:  # a table of a scene, or a list of its own
                text += indented(f"{name}: {LISTS.get(name) or f'{name[0].upper()}{name[1:]}Table'}", 1) + docstring(value.__doc__, 1)
                continue
            signature = value.fget.__doc__.partition("\n")[0]
            text += read_only(name, result(signature.rpartition("-> ")[2], name), value.__doc__)
        elif name == "__eq__":
            text += "    def __eq__(self, other: object) -> bool: ...\n"
        elif name == "__init__" and "->" not in value.__doc__:
            continue  # made by the module only
        elif callable(value) or isinstance(value, staticmethod):
            is_static = isinstance(value, staticmethod)
            text += function(name, value.__func__ if is_static else value, 1, is_static)
    return text


# ---- The table of keys

KINDS = {"truth": "bool", "integer": "int", "number": "float", "text": "str", "words": "tuple[str, ...]",
         "point": "tuple[float, float, float]", "pair": "tuple[int, int]", "data file": "str", "data time": "str"}


def kind_of(key):
    if key["type"] == "entries":
        kind = f"tuple[{key['entry']}, ...]"
    elif key["type"] == "word":
        kind = "Literal[" + ", ".join(f'"{choice}"' for choice in key["choices"]) + "]"
    else:
        kind = KINDS[key["type"]]
    if key["may_have_keys"]:
        kind += " | dict[str, Any]"
    if key["type"] == "integer" and key["other_word"]:
        kind += f' | Literal["{key["other_word"]}"]'
    return kind if key["required"] or key["default"] is not None else f"{kind} | None"


# What a scene has beside its tables: lists of its own.
LISTS = {key["path"]: kind_of(key) for key in pelagic.keys() if "." not in key["path"]}


def entry(key):
    text = indented(f"class {key['entry']}(NamedTuple):", 0) + docstring(f"An entry of {key['path']}.", 1)
    for inner in key["keys"]:
        text += indented(f"{inner['name']}: {kind_of(inner)}" + ("" if inner["required"] else " = ..."), 1)
        text += docstring(getattr(getattr(pelagic, key["entry"]), inner["name"]).__doc__, 1)
    return text


def table(name, made, keys):
    text = indented(f"class {name}(Table):", 0) + docstring(made.__doc__, 1)
    for member, value in vars(made).items():
        key = keys.get(member)
        if key is not None and value.fset is not None:
            text += indented(f"{member}: {kind_of(key)}", 1) + docstring(value.__doc__, 1)
        elif key is not None:
            text += read_only(member, kind_of(key), value.__doc__)
        elif isinstance(value, property) and value.fset is not None:
            text += indented(f"{member}: {SETTABLE[member]}", 1) + docstring(value.__doc__, 1)
        elif isinstance(value, property):
            signature = value.fget.__doc__.partition("\n")[0]
            text += read_only(member, result(signature.rpartition("-> ")[2], member), value.__doc__)
        elif not member.startswith("_"):
            text += function(member, value, 1)
    return text


def stub():
    by_table, entries = {}, {}
    for key in pelagic.keys():
        where, _, name = key["path"].partition(".")
        if name:
            by_table.setdefault(f"{where[0].upper()}{where[1:]}Table", {})[name] = key
        if key["entry"]:
            entries[key["entry"]] = key
    parts = [HEADER.format(doc=inspect.cleandoc(pelagic.__doc__))]
    for name, value in vars(pelagic).items():
        if name.startswith("__"):
            continue
        if name in entries:
            parts.append(entry(entries[name]))
        elif name in by_table:
            parts.append(table(name, value, by_table[name]))
        elif isinstance(value, type) and issubclass(value, BaseException):
            parts.append(f"class {name}({value.__base__.__name__}):\n" + docstring(value.__doc__, 1))
        elif isinstance(value, type):
            parts.append(f"class {name}:\n" + members(value))
        else:
            parts.append(function(name, value, 0))
    return "\n\n".join(parts)


if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(stub())
