"""Tables come back as they were saved, and other programs read them."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.core.table import load_csv, save_csv

COLUMNS = {
    "Distance (m)": np.linspace(0, 1, 5),
    "Illuminance, direct (lx)": np.array([1e-9, np.nan, np.inf, 123456.7, 2e20], dtype=np.float32),
    "Number": np.array([1, 2, 3, 4, 2**40]),
    "Shape": np.array(["Vase ä/1", "plain, “quoted”", 'a "b"', "x", ""]),
}
META = {
    "quantity": "Illuminance: on the floor",
    "seed": 3,
    "number in words": "3",
    "seconds": 0.25,
    "empty": "",
    "lines": "one\ntwo",
    "spaced": " x ",
    "parameters": {"landed": 2_000_000, "names": ["ä", "b"]},
    "quick": False,
    "nothing": None,
}


def test_a_table_comes_back(tmp_path):
    save_csv(tmp_path / "Vase ä 1.csv", COLUMNS, META)
    columns, meta = load_csv(tmp_path / "Vase ä 1.csv")
    assert meta == META
    assert list(columns) == list(COLUMNS)
    for name in list(COLUMNS)[:3]:
        assert columns[name].dtype == np.float64
        np.testing.assert_allclose(columns[name], COLUMNS[name], rtol=1e-6)
    assert columns["Number"][-1] == 2**40
    assert columns["Shape"].tolist() == COLUMNS["Shape"].tolist()


def test_the_file_reads_as_a_person_expects(tmp_path):
    save_csv(tmp_path / "a.csv", {"x (m)": np.array([0.1, 2 / 3])}, {"unit": "lx", "seed": 3})
    text = (tmp_path / "a.csv").read_text(encoding="utf-8")
    assert text == "# unit: lx\n# seed: 3\nx (m)\n0.1\n0.6666667\n"


def test_numpy_reads_it_too(tmp_path):
    save_csv(tmp_path / "a.csv", {"x (m)": np.arange(4.0), "E (lx)": np.arange(4.0) ** 2}, META)
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=len(META) + 1)
    np.testing.assert_array_equal(rows[:, 1], [0, 1, 4, 9])


def test_a_table_without_rows_comes_back(tmp_path):
    save_csv(tmp_path / "a.csv", {"x (m)": np.zeros(0)}, {})
    columns, meta = load_csv(tmp_path / "a.csv")
    assert columns["x (m)"].shape == (0,)
    assert meta == {}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no row of column names"),
        (b"# seed: 3\n", "no row of column names"),
        (b"a,b\n1,2\n3\n", "Row 3 of .* has 1 cells under 2 names"),
        (b"\xff\xfe\x00", "UTF-8"),
    ],
)
def test_a_damaged_table_is_told(tmp_path, content, said):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(FileError, match=said):
        load_csv(tmp_path / "a.csv")


def test_a_missing_table_is_told(tmp_path):
    with pytest.raises(FileError, match="no table"):
        load_csv(tmp_path / "a.csv")
    with pytest.raises(FileError, match="nowhere"):
        save_csv(tmp_path / "nowhere" / "a.csv", COLUMNS, {})
