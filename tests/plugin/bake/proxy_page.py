"""The proxy of plugin/format/usd/SOLARIS.md: OpenUSD reads both meshes through the page's own layer, and draws neither for who asks for no purpose.

    proxy_page.py PELAGIC FOLDER
"""

import json
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
SIDES = {"storm": 40, "storm-proxy": 4}


def main(pelagic, folder):
    page = (SOURCE / "plugin/format/usd/SOLARIS.md").read_text()
    layer = textwrap.dedent(re.search(r"^ *```usda\n(.*?)^ *```", page, re.M | re.S)[1])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, side in SIDES.items():
        shot = folder / f"{name}.toml"
        shot.write_text(f'[shot]\nname = "{name}"\nframes = [1, 2]\n[surface]\nresolution = {side}\n')
        subprocess.run([pelagic, "bake", shot, "--out", folder], check=True)
    (folder / "layout.usda").write_text(layer)
    reader = SOURCE / "tests/plugin/format/usd/openusd/read-stage.mjs"
    subprocess.run(["node", reader, folder, "layout.usda", "1", "2", "--json", folder / "read.json", "--flatten", folder / "flat.usda"], check=True)
    frames = json.loads((folder / "read.json").read_text())["frames"]
    found = {}
    for frame, prims in frames.items():
        for path, arrays in prims.items():
            assert "points" not in arrays, f"{path} was drawn"
            found.setdefault(path, []).append(arrays["whitecapCoverage"])
    for path, side in (("/storm/Sea", SIDES["storm"]), ("/storm/SeaProxy", SIDES["storm-proxy"])):
        one, two = found[path]
        assert len(one) == len(two) == (side + 1) ** 2 and one != two, f"{path}: {len(one)}, {len(two)} vertices"
    flat = [line.strip() for line in (folder / "flat.usda").read_text().splitlines()]
    for line in ('uniform token purpose = "render"', "rel proxyPrim = </storm/SeaProxy>", 'uniform token purpose = "proxy"'):
        assert flat.count(line) == 1, line


main(sys.argv[1], Path(sys.argv[2]))
