#!/usr/bin/env python3
"""The add-on as one zip: a classic add-on for Blender 3.4 to 4.1, an extension for 4.2 and later.

    make_zip.py OUT.zip WRITER.so MODULE.so… ARCHIVE.a…

In it is one folder, pelagic_ocean, with the sources, the compiled module for each Python and the shared libraries that
it needs, and the licences of all of them, and of the archives that the modules have in them. The C library and the C++ runtime are the system's.

WRITER.so is what writes volumes (plugin/format/vdb): the module loads it from beside itself when the first volume is baked.
"""

import re
import struct
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


def licences_of(libraries):
    """Library → name and copyright file of the Debian package that it is from. dpkg reads all its lists anew each time it is asked."""
    # Packages name files by /lib or by /usr/lib, which are the same folder.
    names = {library: (str(library.resolve()), str(library.resolve()).removeprefix("/usr")) for library in libraries}
    lines = subprocess.run(["dpkg", "-S", *sum(names.values(), ())], capture_output=True, text=True).stdout.splitlines()
    owners = {path: owner.split(":")[0] for owner, path in (line.split(": ", 1) for line in lines if ": " in line)
              if not owner.startswith("diversion by ")}
    found = {}
    for library, paths in names.items():
        owner = next((owners[path] for path in paths if path in owners), "")
        file = Path("/usr/share/doc") / owner / "copyright"
        if not owner or not file.is_file():
            sys.exit(f"the licence of {library} isn't found: the zip is made where its libraries are Debian's packages")
        found[library] = owner, file
    return found


COMMON = Path("/usr/share/common-licenses")


def common_licences(licences):
    """Name → text of those that Debian's copyright files only name; licences: their bytes."""
    names = {name.decode().rstrip(".-") for text in licences for name in re.findall(rb"/usr/share/common-licenses/([\w.+-]+)", text)}
    return {name: (COMMON / name).read_bytes() for name in sorted(names) if (COMMON / name).is_file()}


def stripped(file):
    """The contents of a binary without what only debuggers need."""
    with tempfile.NamedTemporaryFile() as out:
        subprocess.run(["strip", "--strip-unneeded", "-o", out.name, file.resolve()], check=True)
        return Path(out.name).read_bytes()


# Versions of the C library and of the C++ runtime that a binary asks for by one function, which has been there for long under an
# older version, too: hypot() and condition_variable::wait(). Without them those of 2021 do: glibc 2.34, GLIBCXX 3.4.29.
OLDER = {b"GLIBC_2.35": b"GLIBC_2.2.5", b"GLIBCXX_3.4.30": b"GLIBCXX_3.4.11"}


NEWEST = {"GLIBC": (2, 34), "GLIBCXX": (3, 4, 29), "CXXABI": (1, 3, 13)}  # that the zip may ask for


def is_too_new(version):
    library, _, number = version.decode().partition("_")
    return library in NEWEST and number[:1].isdigit() and tuple(map(int, number.split("."))) > NEWEST[library]


def elf_hash(name):
    value = 0
    for byte in name:
        value = (value << 4) + byte  # up to 2^32 and a little more: what is above the lower 28 bits goes
        value = (value ^ (value & 0xF0000000) >> 24) & 0x0FFFFFFF
    return value


def for_older_systems(binary):
    """An ELF binary of x86-64, its table of needed versions (.gnu.version_r) with OLDER's names in place of theirs."""
    if binary[:5] != b"\x7fELF\x02" or struct.unpack_from("<H", binary, 18)[0] != 62:
        return binary
    out = bytearray(binary)
    offset, = struct.unpack_from("<Q", binary, 40)
    size, count = struct.unpack_from("<HH", binary, 58)
    sections = [struct.unpack_from("<IIQQQQII", binary, offset + i * size) for i in range(count)]
    for _, kind, _, _, start, _, link, needs in sections:
        if kind != 0x6FFFFFFE:  # SHT_GNU_verneed
            continue
        names = binary[sections[link][4]:sections[link][4] + sections[link][5]]
        for _ in range(needs):
            _, versions, _, first, following = struct.unpack_from("<HHIII", binary, start)
            at = start + first
            for _ in range(versions):
                _, _, _, name, further = struct.unpack_from("<IHHII", binary, at)
                version = names[name:names.index(b"\0", name)]
                older = OLDER.get(version, version)
                place = names.find(b"\0" + older + b"\0")
                if place < 0 or is_too_new(older):
                    sys.exit(f"a library asks for {version.decode()}: the zip's README promises older systems")
                struct.pack_into("<I", out, at, elf_hash(older))
                struct.pack_into("<I", out, at + 8, place + 1)
                at += further
            start += following
    return bytes(out)


def contents(binaries):
    """Path in the zip → bytes."""
    source = HERE / FOLDER
    files = {path.relative_to(HERE).as_posix(): path.read_bytes() for path in sorted(source.rglob("*"))
             if path.is_file() and "__pycache__" not in path.parts and "lib" not in path.relative_to(source).parts}
    files[f"{FOLDER}/LICENSE"] = (HERE.parent / "LICENSE").read_bytes()
    needed, archives = {}, [binary for binary in binaries if binary.suffix == ".a"]
    for binary in binaries:
        if binary in archives:
            continue
        files[f"{FOLDER}/lib/{binary.name}"] = for_older_systems(stripped(binary))
        needed |= shared_libraries(binary)
    for name, path in needed.items():
        files[f"{FOLDER}/lib/{name}"] = for_older_systems(stripped(path))
    for owner, licence in licences_of([*archives, *needed.values()]).values():
        files[f"{FOLDER}/lib/licences/{owner}.txt"] = licence.read_bytes()
    licences = [data for name, data in files.items() if "/lib/licences/" in name]
    files |= {f"{FOLDER}/lib/licences/common-licenses/{name}": data for name, data in common_licences(licences).items()}
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
