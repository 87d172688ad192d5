#!/usr/bin/env python3
"""The add-on as one zip: a classic add-on for Blender 3.4 to 4.1, an extension for 4.2 and later.

    make_zip.py OUT.zip WRITER.so MODULE.so… ARCHIVE.a…

In it is one folder, pelagic_ocean, with the sources, the compiled module for each Python and the shared libraries that
it needs, and the licences of all of them, and of the archives that the modules have in them. The C library and the C++ runtime are the system's.

WRITER.so is what writes volumes (plugin/format/vdb): the module loads it from beside itself when the first volume is baked.
"""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDER = "pelagic_ocean"
OF_THE_SYSTEM = re.compile(r"(lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)\.so|ld-linux|linux-vdso)")
DATE = (2020, 1, 1, 0, 0, 0)  # of everything: the same contents give the same zip


def shared_libraries(binary):
    """Name → path of what a binary is linked with, directly or not."""
    lines = subprocess.run(["ldd", binary], check=True, capture_output=True, text=True).stdout.splitlines()
    found = {}
    for line in lines:
        name, _, rest = line.strip().partition(" ")
        if OF_THE_SYSTEM.search(name):
            continue
        path = rest.removeprefix("=> ").split(" (")[0]
        if not Path(path).is_file():
            sys.exit(f"{binary} needs {name}, which isn't there")
        found[name] = Path(path)
    return found


def licence_of(library):
    """The copyright file of the Debian package that a library is from."""
    # Packages name files by /lib or by /usr/lib, which are the same folder.
    path = str(library.resolve())
    names = [path, path.removeprefix("/usr")]
    owner = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True).stdout.split(":")[0]
    file = Path("/usr/share/doc") / owner / "copyright"
    if not owner or not file.is_file():
        sys.exit(f"the licence of {library} isn't found: the zip is made where its libraries are Debian's packages")
    return owner, file


def stripped(file):
    """The contents of a binary without what only debuggers need."""
    with tempfile.NamedTemporaryFile() as out:
        subprocess.run(["strip", "--strip-unneeded", "-o", out.name, file.resolve()], check=True)
        return Path(out.name).read_bytes()


def contents(binaries):
    """Path in the zip → bytes."""
    source = HERE / FOLDER
    files = {path.relative_to(HERE).as_posix(): path.read_bytes() for path in sorted(source.rglob("*"))
             if path.is_file() and "__pycache__" not in path.parts and "lib" not in path.relative_to(source).parts}
    files[f"{FOLDER}/LICENSE"] = (HERE.parent / "LICENSE").read_bytes()
    needed = {}
    for binary in binaries:
        if binary.suffix == ".a":
            owner, licence = licence_of(binary)
            files[f"{FOLDER}/lib/licences/{owner}.txt"] = licence.read_bytes()
            continue
        files[f"{FOLDER}/lib/{binary.name}"] = stripped(binary)
        needed |= shared_libraries(binary)
    for name, path in needed.items():
        files[f"{FOLDER}/lib/{name}"] = stripped(path)
        owner, licence = licence_of(path)
        files[f"{FOLDER}/lib/licences/{owner}.txt"] = licence.read_bytes()
    return files


def main():
    out, *binaries = map(Path, sys.argv[1:])
    files = contents(binaries)
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, data in files.items():
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            made.writestr(info, data)


if __name__ == "__main__":
    main()
