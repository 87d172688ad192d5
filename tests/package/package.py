"""Installs the build, moves the prefix, and uses it as others do: by CMake, by pkg-config, with their compilers and flags.

    package.py CMAKE BUILD-FOLDER FOLDER [python]      FOLDER is made anew; python: the build has the module
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CONSUMER = SOURCE / "tests/package/consumer"
cmake, build, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
prefix = folder / "moved/elsewhere"
OWN_FLAGS = ("-Werror", "-Wconversion", "-march=", "-fsanitize", "-ffp-contract", "GLM_FORCE")


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], text=True, capture_output=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def expect(truth, what):
    if not truth:
        sys.exit(what)


def by_cmake(name, *options):
    run(cmake, "-S", CONSUMER, "-B", folder / name, "-G", "Ninja", *options)
    return folder / name


# Staged by DESTDIR, as packagers do, and then moved: nothing in it may know where it was.
shutil.rmtree(folder, ignore_errors=True)
run(cmake, "--install", build, "--prefix", "/opt/pelagic", env={**os.environ, "DESTDIR": str(folder / "stage")})
prefix.parent.mkdir(parents=True)
(folder / "stage/opt/pelagic").rename(prefix)
expect(not list((folder / "stage").rglob("*.*")), "something was installed outside the prefix")
for text in [*prefix.rglob("*.cmake"), *prefix.rglob("*.pc")]:
    said = text.read_text()
    for word in (*OWN_FLAGS, str(SOURCE), str(build), "/opt/pelagic"):
        expect(word not in said, f"{text} says {word}")

# The program, the module, and the headers, each of which compiles by itself, without a warning of its own.
expect(run(prefix / "bin/pelagic", "--version").startswith("pelagic "), "the program doesn't run")
expect((prefix / "share/doc/pelagic/LICENSE").is_file(), "no licence")
shot = folder / "volumes.toml"
shot.write_text('[shot]\nframes = [1, 1]\n[surface]\nsize_m = 40.0\n[output]\nmesh = "none"\nvolumes = ["level-set"]\nvoxel_m = 2.0\n')
run(prefix / "bin/pelagic", "bake", shot, "--out", folder / "volumes")
expect(len(list((folder / "volumes").rglob("*.vdb"))) == 1, "the program writes no volume")
if "python" in sys.argv[4:]:
    expect(run("/usr/bin/python3", "-c", "import pelagic; print(pelagic.__file__)", cwd="/",
               env={**os.environ, "PYTHONPATH": str(prefix / "lib/python3/dist-packages")}).startswith(str(prefix)),
           "the module isn't the installed one")
    run("/usr/bin/python3", "-c", "import pelagic, sys; pelagic.bake(pelagic.Scene.from_file(sys.argv[1]), sys.argv[2])", shot, folder / "by_python",
        cwd="/", env={**os.environ, "PYTHONPATH": str(prefix / "lib/python3/dist-packages")})
    expect(len(list((folder / "by_python").rglob("*.vdb"))) == 1, "the module writes no volume")
headers = sorted(str(p.relative_to(prefix / "include")) for p in (prefix / "include").rglob("*") if p.is_file())
expect(headers == [f"pelagic/{name}.h" for name in ("cage", "depth_map", "mask_picture", "object_mesh", "ocean", "procedural", "scene", "version")], f"the headers are {headers}")
pc = {**os.environ, "PKG_CONFIG_PATH": str(next(prefix.rglob("pkgconfig")))}
cflags = run("pkg-config", "--cflags", "pelagic-core", env=pc).split()
libs = run("pkg-config", "--libs", "pelagic-core", env=pc).split()
expect(str(prefix) in " ".join(cflags), f"pkg-config doesn't say where it was moved to: {cflags}")
for header in headers:
    alone = folder / "alone.cpp"
    alone.write_text(f"#include <{header}>\n")
    run("g++", "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *cflags, alone)

# One number, whoever is asked; and names of C++ that other versions' libraries don't have.
version = re.search(r'^set\(PACKAGE_VERSION "(.*)"\)', next(prefix.rglob("pelagic-config-version.cmake")).read_text(), re.M)[1]
expect(run("pkg-config", "--modversion", "pelagic-core", env=pc).strip() == version, "pkg-config has another version")
expect(run(prefix / "bin/pelagic", "--version").startswith(f"pelagic {version}\n"), "the program has another version")
if "python" in sys.argv[4:]:
    expect(run("/usr/bin/python3", "-c", "import pelagic; print(pelagic.__version__)", cwd="/",
               env={**os.environ, "PYTHONPATH": str(prefix / "lib/python3/dist-packages")}).strip() == version, "the module has another version")
expect("osd" not in " ".join(libs), f"OpenSubdiv is forced on who asks for no cages: {libs}")
major, minor, patch = version.split(".")
expect(f"pelagic::v{major}_{minor}::Ocean::water_at" in run("nm", "-C", "--defined-only", next(prefix.rglob("libpelagic_core.a"))),
       "the library's names have no version")

# Three users, with their own compilers and flags, get the bits that our own build gets.
own = run(build / "tests/package_consumer")
expect(len(own.splitlines()) == 9 and own.endswith(f"{version} {major} {minor} {patch}\n"), f"the consumer says\n{own}")
run("clang++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-O1", *cflags, CONSUMER / "consumer.cpp", "-o", folder / "by_pkg_config", *libs)
expect(run(folder / "by_pkg_config") == own, "other bits by clang++ and pkg-config")
found = by_cmake("found", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release",
                 "-DCMAKE_CXX_COMPILER=g++", "-DCMAKE_CXX_FLAGS=-march=native -Wall -Wextra -Wpedantic -Werror")
run(cmake, "--build", found)
expect("osd" not in run("ninja", "-C", found, "-t", "commands"), "OpenSubdiv is linked by who asks for no cages")
expect(run(found / "consumer") == own, "other bits by g++ -march=native and find_package")

# The first programs.
EXAMPLES = SOURCE / "examples"
run("g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", *cflags, EXAMPLES / "first_sea.cpp", "-o", folder / "first_sea", *libs)
expect(" m high" in run(folder / "first_sea"), "the first sea says nothing")

# The shared library, from C, without any other library's package: the example by pkg-config and by CMake, the same mesh.
example, shot = SOURCE / "examples/procedural.c", SOURCE / "tests/plugin/host/procedural/small_picture.toml"
procedural = [run("pkg-config", flag, "pelagic", env=pc).split() for flag in ("--cflags", "--libs")]
STRICT = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror")
run("cc", *STRICT, *procedural[0], example, "-o", folder / "procedural", *procedural[1])
run("c++", "-x", "c++", "-fsyntax-only", "-std=c++11", "-Wall", "-Wextra", "-pedantic", "-Werror",
    prefix / "include/pelagic/procedural.h")
run("cc", *STRICT, *procedural[0], EXAMPLES / "first_sea.c", "-o", folder / "first_sea_in_c", *procedural[1])
renderer = folder / "renderer"
run(cmake, "-S", SOURCE / "tests/package/renderer", "-B", renderer, "-G", "Ninja", f"-DEXAMPLE={example}",
    f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_C_FLAGS={' '.join(STRICT)}", "-DCMAKE_CXX_COMPILER=/none/is/needed")
run(cmake, "--build", renderer)
(lib,) = {p.parent for p in prefix.rglob("libpelagic.so")}
expect(" m high" in run(folder / "first_sea_in_c", shot, env={**os.environ, "LD_LIBRARY_PATH": str(lib)}), "the first sea in C says nothing")
meshes = []
for program in (folder / "procedural", renderer / "renderer"):
    meshes.append(folder / f"{program.name}.obj")
    said = run(program, shot, "3", meshes[-1], env={**os.environ, "LD_LIBRARY_PATH": str(lib)})
    expect("two peak waves round the origin" in said and " quads of " in said and "the sea " in said, f"the example says\n{said}")
expect(meshes[0].stat().st_size > 1000000 and meshes[0].read_bytes() == meshes[1].read_bytes(), "the example's meshes differ")
expect(set(run("nm", "-D", "--defined-only", "--format=posix", lib / "libpelagic.so").split()[::4]) ==
       set(re.findall(r"^PELAGIC_API [^;(]*?(pelagic_\w+)\(", (prefix / "include/pelagic/procedural.h").read_text(), re.M)),
       "the library shows other names than its header")

# As a part of another build: the core alone is wanted, so no window, Python, tests or rules of ours.
part = by_cmake("part", f"-DPELAGIC_SOURCE={SOURCE}", "-DCMAKE_BUILD_TYPE=Release")
cache = (part / "CMakeCache.txt").read_text()
for option in ("PREVIEW", "PYTHON", "TESTS", "BLENDER_TESTS", "INSTALL"):
    expect(f"PELAGIC_{option}:BOOL=OFF" in cache, f"PELAGIC_{option} is on inside another project")
for word in ("GLFW", "IMGUI", "EPOXY", "EGL", "GTest", "pybind11", "PELAGIC_BLENDER:", "PELAGIC_CLANG_FORMAT"):
    expect("\n" + word not in cache, f"{word} is looked for inside another project")  # a line's begin: not in help texts
without = folder / "without_cages"
said = run(cmake, "-S", CONSUMER, "-B", without, "-G", "Ninja", f"-DPELAGIC_SOURCE={SOURCE}", "-DOPENSUBDIV_INCLUDE_DIR=", "-DOPENSUBDIV_CPU_LIBRARY=")
expect("without cages" in said, f"nobody says what is left out without OpenSubdiv:\n{said}")
targets = run("ninja", "-C", without, "-t", "targets", "all")
expect("libpelagic.so" in targets and "pelagic_accuracy" not in targets, "without OpenSubdiv there is no libpelagic to build, or what can't be linked")
commands = json.loads((part / "compile_commands.json").read_text())
(theirs,) = [c["command"] for c in commands if c["file"].endswith("consumer.cpp")]
expect(not any(flag in theirs for flag in OWN_FLAGS), f"our rules in their build: {theirs}")
print(f"{len(headers)} headers, {prefix}: by CMake, pkg-config and as a part, the same bits")
