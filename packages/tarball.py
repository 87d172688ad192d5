#!/usr/bin/env python3
"""Pelagic for other distributions: the program with everything that it needs, the C library included, and libpelagic with what it
needs under names of its own.

    tarball.py BUILD OUT.tar.gz

BUILD: a build's folder, with pelagic_without_preview, libpelagic, the modules and man.sh's pages. Made on Debian 12, whose libraries go in.

The program is run by the C library's own loader, which bin/pelagic starts: so it needs nothing of the system but its kernel and a
shell. The library lives in others' processes, whose C library and C++ runtime it takes; it needs those of 2021 (make_zip.NEWEST).
"""

import gzip
import io
import subprocess
import sys
import tarfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "addon"))

import apart  # noqa: E402
import make_zip  # noqa: E402

LOADER = "ld-linux-x86-64.so.2"
LAUNCHER = f"""#!/bin/sh
# Pelagic, run by the C library that it was built with (lib/pelagic/lib): nothing here needs the system's.
self=$(readlink -f -- "$0") || exit 127
program=${{self%/bin/*}}/lib/pelagic
exec "$program/lib/{LOADER}" --inhibit-cache --argv0 "$self" "$program/pelagic" "$@"
"""
README = """Pelagic {version} for Linux on x86-64. https://www.gnu.org/licenses/gpl-3.0.html (LICENSE); licences of what is beside it: share/doc/pelagic/licences.

  bin/pelagic                   the command line, on any distribution with a kernel of 3.2 or later. All but "pelagic preview", which
                                needs the system's window and drivers: no other C library can load those.
  lib/libpelagic.so             the library for renderers and C (include/pelagic, lib/pkgconfig): glibc {glibc} and the C++ runtime of
                                GCC 11 (GLIBCXX_{glibcxx}) or later, which are the system's. What else it needs (lib/libpelagic) has names
                                of its own, so that a host may bring another oneTBB, OpenSubdiv or OpenEXR.
  share/man, share/bash-completion
  examples                      shots, C, and procedurals for renderers

Anywhere: the folder may be moved. bin/pelagic may be linked to from a folder on PATH.
"""


def everything_needed(binary):
    """Name → path of all the libraries of a binary, the C library's as well."""
    lines = subprocess.run(["ldd", binary], check=True, capture_output=True, text=True).stdout.splitlines()
    found = {}
    for line in lines:
        words = line.split()
        path = words[2] if "=>" in words else words[0]
        if path.startswith("/"):
            found[Path(path).name] = Path(path)
    return found


def for_hosts(binary):
    return make_zip.for_older_systems(make_zip.stripped(binary))


def contents(build):
    """Path → bytes, or a str: a link to it."""
    files = {"bin/pelagic": LAUNCHER.encode()}
    program = build / "pelagic_without_preview"
    files["lib/pelagic/pelagic"] = make_zip.stripped(program)
    modules = [build / "lib" / f"pelagic_{name}.so" for name in ("openvdb", "ocio", "rays")]
    of_the_program = {module.name: module for module in modules}
    for binary in (program, *modules):
        of_the_program |= everything_needed(binary)
    files |= {f"lib/pelagic/lib/{name}": make_zip.stripped(path) for name, path in of_the_program.items()}

    (library,) = (build / "plugin/host/procedural").glob("libpelagic.so.*.*.*")
    of_the_library = make_zip.shared_libraries(library)
    renamed, library_bytes = apart.apart({name: for_hosts(path) for name, path in of_the_library.items()}, for_hosts(library),
                                         "$ORIGIN/libpelagic")
    files |= {f"lib/libpelagic/{name}": data for name, data in renamed.items()}
    for path in {*of_the_program.values(), *of_the_library.values()} - {*modules}:
        owner, licence = make_zip.licence_of(path)
        files[f"share/doc/pelagic/licences/{owner}.txt"] = licence.read_bytes()
    version = library.name.removeprefix("libpelagic.so.")
    short = version.rpartition(".")[0]
    files[f"lib/{library.name}"] = library_bytes
    files[f"lib/libpelagic.so.{short}"] = library.name
    files["lib/libpelagic.so"] = f"libpelagic.so.{short}"

    files["lib/pkgconfig/pelagic.pc"] = (build / "plugin/host/procedural/pelagic.pc").read_bytes()
    files["include/pelagic/procedural.h"] = (SOURCE / "plugin/host/procedural/include/pelagic/procedural.h").read_bytes()
    files["include/pelagic/version.h"] = (build / "core/include/pelagic/version.h").read_bytes()
    files["share/bash-completion/completions/pelagic"] = (SOURCE / "packages/pelagic.bash").read_bytes()
    for page in sorted((build / "man").glob("*.1")):
        files[f"share/man/man1/{page.name}"] = page.read_bytes()
    examples = [*SOURCE.glob("examples/*.toml"), *SOURCE.glob("examples/*.obj"), *SOURCE.glob("examples/data/*"),
                *SOURCE.glob("examples/renderers/*"), SOURCE / "examples/first_sea.c", SOURCE / "examples/procedural.c"]
    for example in sorted(examples):
        files[example.relative_to(SOURCE).as_posix()] = example.read_bytes()
    files["LICENSE"] = (SOURCE / "LICENSE").read_bytes()
    files["README"] = README.format(version=version, glibc=".".join(map(str, make_zip.NEWEST["GLIBC"])),
                                    glibcxx=".".join(map(str, make_zip.NEWEST["GLIBCXX"]))).encode()
    return files


def main():
    build, out = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    top = out.name.removesuffix(".tar.gz")
    programs = {"bin/pelagic", "lib/pelagic/pelagic", f"lib/pelagic/lib/{LOADER}"}
    # The same contents give the same file.
    with open(out, "wb") as file, gzip.GzipFile("", "wb", 9, file, 0) as packed, tarfile.open(fileobj=packed, mode="w") as tar:
        for name, data in sorted(contents(build).items()):
            entry = tarfile.TarInfo(f"{top}/{name}")
            if isinstance(data, str):
                entry.type, entry.linkname = tarfile.SYMTYPE, data
                tar.addfile(entry)
                continue
            entry.size, entry.mode = len(data), 0o755 if name in programs else 0o644
            tar.addfile(entry, io.BytesIO(data))


if __name__ == "__main__":
    main()
