#!/usr/bin/env python3
"""Pelagic for other distributions: the program with everything that it needs, the C library included, and libpelagic with what it
needs under names of its own.

    tarball.py BUILD OUT.tar.gz

BUILD: a build's folder, with pelagic_without_preview, libpelagic, the modules and man.sh's pages. Made on Debian 12, whose libraries go in.

The program is run by the C library's own loader, which bin/pelagic starts: so it needs nothing of the system but its kernel and a
shell with readlink. The library lives in others' processes, whose C library and C++ runtime it takes; it needs those of 2021 (make_zip.NEWEST).
"""

import gzip
import io
import re
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path
from urllib.parse import quote

SOURCE = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "addon"))

import apart  # noqa: E402
import make_zip  # noqa: E402

LOADER = "ld-linux-x86-64.so.2"
LAUNCHER = f"""#!/bin/sh
# Pelagic, run by the C library that it was built with (lib/pelagic/lib): nothing here needs the system's.
unset LD_PRELOAD LD_AUDIT LD_LIBRARY_PATH  # of the system's libraries, which this C library can't load
self=$(readlink -f -- "$0") || exit 127
program=${{self%/bin/*}}/lib/pelagic
exec "$program/lib/{LOADER}" --inhibit-cache --argv0 "$self" "$program/pelagic" "$@"
"""
README = """Pelagic {version} for Linux on x86-64. https://www.gnu.org/licenses/gpl-3.0.html (LICENSE); licences of what is beside it: share/doc/pelagic/licences; where its
sources are: share/doc/pelagic/SOURCES.

  bin/pelagic                   the command line, with a C library of its own: it needs a kernel of 3.2 or later, /bin/sh and readlink.
                                Run on Debian 11, on Debian 12 and in a root without a C library. All but "pelagic preview", which
                                needs the system's window and drivers: no other C library can load those. Before it begins it unsets
                                LD_PRELOAD, LD_AUDIT and LD_LIBRARY_PATH.
  lib/libpelagic.so             the library for renderers and C (include/pelagic, lib/pkgconfig). It takes the system's glibc and C++
                                runtime, and asks for none newer than {glibc} and GCC 11's (GLIBCXX_{glibcxx}); run with those of Debian 12
                                (2.36). What else it needs (lib/libpelagic) has names of its own, so that a host may bring another
                                oneTBB, OpenSubdiv or OpenEXR.
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


SOURCES = """The libraries beside Pelagic are Debian 12's, and so are those of which headers or archives are compiled into it. Each line: the
package, its version, and where Debian keeps its source. Changed: debugging symbols are stripped; in libraries of lib/libpelagic, and in
libpelagic, names of files, of functions and of the versions of glibc and GCC that are asked for, by Pelagic's packages/apart.py and
addon/make_zip.py.
Pelagic's own source: the repository from which this was made, version {version}.

Libraries:
{libraries}

Of which headers or archives may be compiled in:
{compiled}
"""


def packages_to_compile():
    """What the program is built with by examples/packages.txt, and the headers that those packages bring."""
    text = (SOURCE / "examples/packages.txt").read_text()
    section = text[text.index("[program]"):].split("\n[")[0]
    named = [line for line in section.splitlines() if line.endswith("-dev")]
    depends = subprocess.run(["dpkg-query", "-W", "-f", "${Depends}\n", *named], check=True, capture_output=True, text=True).stdout
    return {*named, *re.findall(r"\b(lib[\w.+-]+-dev)\b", depends)} - {"libc6-dev"}


def source_lines(packages):
    lines = subprocess.run(["dpkg-query", "-W", "-f", "${Package}=${Version} ${source:Package} ${source:Version}\n", *packages],
                           capture_output=True, text=True).stdout.splitlines()
    found = [line.split() for line in sorted({*lines}) if len(line.split()) == 3 and not line.split()[0].endswith("=")]
    return "\n".join(f"{package}  https://snapshot.debian.org/package/{quote(source)}/{quote(version)}/" for package, source, version in found)


def expect_to_load(files):
    """Every name that the finished library asks for is there, in one of its own libraries or the system's."""
    with tempfile.TemporaryDirectory() as folder:
        for name, data in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(data, str):
                path.symlink_to(data)
            else:
                path.write_bytes(data)
        script = "import ctypes, os, sys; ctypes.CDLL(sys.argv[1], os.RTLD_NOW)"
        done = subprocess.run([sys.executable, "-c", script, f"{folder}/lib/libpelagic.so"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"the finished libpelagic.so can't be loaded: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}")


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
    owners = dict(make_zip.licences_of({*of_the_program.values(), *of_the_library.values()} - {*modules}).values())
    compiled = packages_to_compile() - {*owners}
    licences = owners | {package: Path(f"/usr/share/doc/{package}/copyright") for package in compiled}
    licences = {package: file.read_bytes() for package, file in licences.items() if file.is_file()}
    files |= {f"share/doc/pelagic/licences/{package}.txt": text for package, text in licences.items()}
    files |= {f"share/doc/pelagic/licences/common-licenses/{name}": text
              for name, text in make_zip.common_licences(licences.values()).items()}
    version = library.name.removeprefix("libpelagic.so.")
    short = version.rpartition(".")[0]
    files[f"lib/{library.name}"] = library_bytes
    files[f"lib/libpelagic.so.{short}"] = library.name
    files["lib/libpelagic.so"] = f"libpelagic.so.{short}"
    expect_to_load({name: data for name, data in files.items() if name.startswith("lib/libpelagic")})
    files["share/doc/pelagic/SOURCES"] = SOURCES.format(version=version, libraries=source_lines(owners),
                                                        compiled=source_lines(compiled)).encode()

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
