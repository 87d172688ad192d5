"""Libraries under names of their own (packages/apart.py): they are loaded beside others of their first names, and what can't be
renamed is refused by its name.

    apart.py FOLDER      FOLDER is made anew
"""

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "packages"), str(ROOT / "addon")]
import apart  # noqa: E402
import make_zip  # noqa: E402

folder = Path(sys.argv[1])
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)


def expect(truth, what):
    if not truth:
        sys.exit(what)


def library(name, source, *flags):
    (folder / f"{name}.c").write_text(source)
    subprocess.run(["gcc", "-shared", "-fPIC", f"{name}.c", f"-Wl,-soname,{name}.so", "-Wl,--disable-new-dtags", *flags, "-o", f"{name}.so"],
                   cwd=folder, check=True)
    return (folder / f"{name}.so").read_bytes()


# As the loader computes it, of a name whose sums pass 32 bits.
expect(make_zip.elf_hash(b"iihxxsnesiew") == 0x4C9FC7, f"elf_hash gives {make_zip.elf_hash(b'iihxxsnesiew'):#x}")

# That name is looked up by the new table, and the other library of the first name answers whoever asks for that.
LENT = "int iihxxsnesiew(void) {{ return {}; }} int other(void) {{ return iihxxsnesiew(); }}"
USER = "int iihxxsnesiew(void); int other(void); int user(void) { return 10 * iihxxsnesiew() + other(); }"
lent, user = library("lent", LENT.format(4), "-Wl,--hash-style=gnu"), library("user", USER, "lent.so", "-Wl,--hash-style=gnu")
made, own_user = apart.apart({"lent.so": lent}, user, "$ORIGIN/own")
expect(list(made) == ["lent-pelagic.so"], f"the files are {list(made)}")
(folder / "own").mkdir()
(folder / "own/lent-pelagic.so").write_bytes(made["lent-pelagic.so"])
(folder / "user.so").write_bytes(own_user)
library("lent", LENT.format(7))
theirs = ctypes.CDLL(folder / "lent.so", os.RTLD_NOW | os.RTLD_GLOBAL)
ours = ctypes.CDLL(folder / "user.so", os.RTLD_NOW)
expect((theirs.other(), ours.user()) == (7, 44), f"theirs says {theirs.other()}, ours {ours.user()}")

# What can't be renamed.
ALONE = "int alone(void) { return 1; }"
for why, flags in {"DT_GNU_HASH": ["-Wl,--hash-style=sysv"], "DT_GNU_HASH alone": ["-Wl,--hash-style=both"],
                   "PT_NOTE": ["-Wl,--build-id=none", "-fcf-protection=none", "-nostdlib", "-Wl,--hash-style=gnu"]}.items():
    data = library("alone", ALONE, *flags)
    try:
        apart.apart({"alone.so": data}, user, "$ORIGIN/own")
    except SystemExit as refused:
        expect(str(refused).startswith("alone.so ") and why in str(refused), f"{flags}: {refused}")
    else:
        sys.exit(f"{flags} are taken")
both = bytearray(library("alone", ALONE, "-Wl,-rpath,/here"))
read = apart.Library("alone.so", bytes(both))
spare = read._entry(apart.NULL)
both[spare:spare + 8] = apart.RUNPATH.to_bytes(8, "little")
try:
    apart.apart({"alone.so": bytes(both)}, user, "$ORIGIN/own")
except SystemExit as refused:
    expect(str(refused).startswith("alone.so has both an RPATH and a RUNPATH"), str(refused))
else:
    sys.exit("an RPATH beside a RUNPATH is taken")
try:
    apart.Library("text.so", b"text")
except SystemExit as refused:
    expect("text.so is no ELF library" in str(refused), str(refused))
else:
    sys.exit("text is taken for a library")
print("apart: loaded beside others of its name; what can't be renamed is refused")
