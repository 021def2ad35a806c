"""The drawing of the members' axes."""

import ezdxf
import numpy as np
import pytest
from ezdxf import units
from heliform.engines.core.errors import FileError
from heliform.engines.core.scene import Scene
from heliform.engines.structure.dxf import save_dxf
from heliform.engines.structure.structure import size_structure

from .sized_roofs import TIMBER, roof


@pytest.fixture(scope="module")
def result():
    return size_structure(Scene(), roof(TIMBER))


def test_every_member_is_a_line_on_the_layer_of_its_section(result, tmp_path):
    path = tmp_path / "members.dxf"
    save_dxf(path, result.model.frame, result.rows)
    drawing = ezdxf.readfile(path)
    assert not drawing.audit().errors
    assert drawing.units == units.M
    lines = list(drawing.modelspace())
    ends = np.array([(tuple(line.dxf.start), tuple(line.dxf.end)) for line in lines])
    assert ends == pytest.approx(result.model.frame.ends(), abs=1e-9)
    layers = [line.dxf.layer for line in lines]
    expected = [f"{row['material']} {row['name']}" for row in result.rows]
    assert layers == expected
    red = np.array([line.dxf.get("color") == 1 for line in lines])
    assert np.array_equal(red, result.rows["failing"])


def test_a_folder_that_is_not_there_is_told(result, tmp_path):
    with pytest.raises(FileError, match="make the folder first"):
        save_dxf(tmp_path / "nowhere" / "members.dxf", result.model.frame, result.rows)
