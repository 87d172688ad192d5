# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module: `pelagic`, and `problem`, a sentence that says why it is None if it is. The add-on's name and version."""

import importlib.util
import re
import sys
import traceback
from pathlib import Path

TITLE, VERSION = "Pelagic Ocean", (0, 1, 0)  # bl_info's, which Blender takes away from an extension
NAME = "pelagic"
LIB = Path(__file__).parent / "lib"
THIS_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"


def _bundled():
    """The module's file in lib/ for this Python; None where lib/ has none at all, ImportError if only others' are there."""
    files = sorted(LIB.glob(NAME + ".*.so")) + sorted(LIB.glob(NAME + ".*.pyd"))
    tag = f"cp{THIS_PYTHON.replace('.', '')}-" if sys.platform == "win32" else f"cpython-{THIS_PYTHON.replace('.', '')}-"
    for file in files:
        if tag in file.name:
            return file
    if files:
        raise ImportError(f"it was built for another Python ({', '.join(file.name for file in files)}), "
                          f"and this Blender's is {THIS_PYTHON}. Install the zip that was built for Python {THIS_PYTHON}")
    return None


def _load():
    file = _bundled()
    if file is None:
        return importlib.import_module(NAME)
    name = f"{__package__}.{NAME}"  # Blender warns of an extension that has a module outside its own package
    if name not in sys.modules:  # enabled again: a compiled module can't be loaded twice
        spec = importlib.util.spec_from_file_location(name, file)
        made = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(made)
        sys.modules[name] = made
    return sys.modules[name]


try:
    pelagic, problem = _load(), ""
except ImportError as error:
    pelagic, problem = None, f"Pelagic's compiled module can't be loaded: {error}."


def without_place(text):
    """What the core says, without a place in a file that nobody wrote."""
    return re.sub(r"^\S*:\d+:\d+: ", "", text, flags=re.MULTILINE)


_on_console = set()


def words_of(error):
    """What panels and operators say of an exception. Where it isn't meant for people the console says where it comes from."""
    if isinstance(error, (ValueError, OSError)) and str(error):
        return without_place(str(error))
    words = f"{type(error).__name__}: {error}. The console says where"
    if words not in _on_console:  # once: a sea that plays asks again in each frame
        _on_console.add(words)
        traceback.print_exception(error)
    return words
