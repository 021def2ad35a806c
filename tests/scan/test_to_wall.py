"""From a scan to a printed wall in one study: relief, solid, path and verdict belong together."""

import json

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import FileError
from heliform.engines.core.run import run_study
from heliform.engines.glass.profile import Style
from heliform.engines.scan.to_wall import ScannedWall

STUDY = """
heliform = 1
analysis = "scan.to_wall"
[parameters.reading]
repair = false
sides = "outer"
[parameters.print.wall]
height = 0.05
faces = 30000
[parameters.print.wall.plan]
radius = 0.08
"""


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("Wand ä")
    (folder / "study.toml").write_text(STUDY, encoding="utf-8")
    run_study(folder / "study.toml", folder / "out")
    return folder / "out"


def test_the_solid_has_the_layers_of_the_sample(out):
    style = Style.load(out / "relief.npz")
    solid = trimesh.load(out / "wall.3mf", force="mesh")
    assert solid.is_watertight
    crest = 80 + 4  # mm, the wall's own surface
    radius = np.hypot(*solid.vertices[:, :2].T)
    assert radius.max() == pytest.approx(crest, abs=5e3 * style.roughness)
    between = (solid.vertices[:, 2] > 1e-3) & (solid.vertices[:, 2] < 50 - 1e-3)  # not on a rim
    outer = between & (radius > 80)
    depth = crest - radius[outer].min()
    assert depth == pytest.approx(1e3 * style.depth, abs=5e3 * style.roughness)


def test_path_and_relief_have_one_layer_height(out):
    style = Style.load(out / "relief.npz")
    table = json.loads((out / "gate.json").read_text(encoding="utf-8"))
    assert table["parameters"]["spiral"]["layer_height"] == pytest.approx(style.height, rel=1e-6)
    assert table["parameters"]["wall"]["bead"]["height"] == pytest.approx(style.height, rel=1e-6)
    assert not any("layers of" in note for note in table["notes"])


def test_it_loads_as_it_was_saved(out):
    result = ScannedWall.load(out)
    assert result.relief.height == pytest.approx(result.reading.style.height, rel=1e-6)
    assert {"layer_height", "passed", "turns"} <= set(result.figures())
    (out / "relief.json").write_text("{", encoding="utf-8")
    with pytest.raises(FileError, match="cannot be read"):
        ScannedWall.load(out)
