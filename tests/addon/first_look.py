"""examples/blender-first-look.py: pictures of a shot come out, with a sky, a sea that moves, and nothing black or burnt."""

import runpy
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

folder = Path(tempfile.mkdtemp())
shot = folder / "tiny.toml"
shot.write_text('[shot]\nname = "tiny"\nframes = [1, 8]\nfps = 4\n[surface]\nsize_m = 80.0\nresolution = 16\n'
                '[camera]\nposition_m = [0, -30, 6]\n', encoding="utf-8")

with checking("two pictures"):
    sys.argv = ["blender", "--", str(shot), "--out", str(folder / "out"), "--samples", "1", "--size", "64x36"]
    runpy.run_path(str(ROOT / "examples" / "blender-first-look.py"), run_name="__main__")
    files = sorted(path.name for path in (folder / "out").iterdir())
    assert files == ["tiny.0001.png", "tiny.0005.png"], files

with checking("they show a sky over a sea, and differ"):
    pictures = []
    for name in files:
        image = bpy.data.images.load(str(folder / "out" / name))
        assert tuple(image.size) == (64, 36)
        pictures.append(np.array(image.pixels[:]).reshape(36, 64, 4)[..., :3])
    for picture in pictures:
        assert picture[-6:].mean() > 0.1 and picture[:18].mean() > 0.05
        assert (picture > 0.99).all(axis=2).mean() < 0.2
    assert np.abs(pictures[0] - pictures[1]).mean() > 0.01
