"""The pieces of C on the page for authors of renderers' plug-ins, one after another, are a program:
    hosts_page.py CC INCLUDE-FOLDER PAGE
"""

import pathlib
import re
import subprocess
import sys

cc, include, page = sys.argv[1:]
first, *pieces = re.findall(r"```c\n(.*?)```", pathlib.Path(page).read_text(encoding="utf-8"), re.S)
assert len(pieces) >= 4, "the page has other pieces than this knows"
# What the page leaves to its reader.
OWN = """
#include <stdlib.h>
void fail(const char *message);
void tell_the_user(const char *sentence, void *user);
extern void *plugin;
extern double frame_number, shutter_open, shutter_close;
extern size_t n, n_hits;
extern float *direction, *spread, *position, *normal, *distance, *rest, *footprint, *rest_of_hits, *footprint_of_hits;
void page(void) {
"""
done = subprocess.run([cc, "-x", "c", "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", include, "-"],
                      input=first + OWN + "".join(pieces) + "}\n", text=True, capture_output=True)
sys.exit(done.stderr if done.returncode else 0)
