"""Writing whole or not at all, and names that every system takes."""

import re

import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.core.files import safe_name, written
from hypothesis import given
from hypothesis import strategies as st


def test_the_file_is_there_whole_and_nothing_else_is(tmp_path):
    with written(tmp_path / "Vase ä 1.txt") as temporary:
        temporary.write_text("whole")
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".txt"
    assert [f.name for f in tmp_path.iterdir()] == ["Vase ä 1.txt"]
    assert (tmp_path / "Vase ä 1.txt").read_text() == "whole"


def interrupt(temporary):
    temporary.write_text("half")
    raise KeyboardInterrupt


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "result.txt"
    path.write_text("old")

    with pytest.raises(KeyboardInterrupt), written(path) as temporary:
        interrupt(temporary)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def write_something(path):
    with written(path) as temporary:
        temporary.write_text("something")


def test_a_missing_folder_is_named_with_the_remedy(tmp_path):
    with pytest.raises(FileError, match=r"“a\.exr” in the folder “.*nowhere” .* make the folder"):
        write_something(tmp_path / "nowhere" / "a.exr")


def test_a_file_in_the_place_of_the_folder_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="file"):
        write_something(tmp_path / "file" / "a.exr")


def test_a_folder_in_the_place_of_the_file_is_an_error(tmp_path):
    (tmp_path / "a.exr").mkdir()
    with pytest.raises(FileError, match="choose"):
        write_something(tmp_path / "a.exr")
    assert [f.name for f in tmp_path.iterdir()] == ["a.exr"]


def test_a_name_too_long_is_an_error(tmp_path):
    with pytest.raises(FileError, match="choose"):
        write_something(tmp_path / ("x" * 300))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["Vase", "Glass 2 (copy)", "Väschen", "花瓶", "wall.001", "a-b_c"])
def test_good_names_stay(name):
    assert safe_name(name) == name


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("Vase ä/1", "Vase ä_1"),
        ("a:b", "a_b"),
        ("..", "unnamed"),
        ("", "unnamed"),
        ("CON", "_CON"),
        ("com1.exr", "_com1.exr"),
        (" Vase. ", "Vase"),
        ("line\nbreak", "line_break"),
        ("lone \udcff surrogate", "lone _ surrogate"),
        ("a\u0308", "ä"),
    ],
)
def test_bad_names_are_mended_and_marked(name, kept):
    assert re.fullmatch(re.escape(kept) + "-[0-9a-f]{6}", safe_name(name))


def test_names_that_differ_stay_different():
    names = ["a/b", "a:b", "a_b", "a?b", "", ".", "..", "x" * 300, "x" * 301, "CON", "_CON"]
    assert len({safe_name(name) for name in names}) == len(names)


@given(st.text(st.characters(), max_size=200))
def test_every_name_becomes_a_file_on_this_system(text):
    name = safe_name(text)
    assert name
    assert len(name.encode()) <= 100
    assert name[0] not in " ."
    assert name[-1] not in " ."
    assert not re.search(r'[<>:"/\\|?*\x00-\x1f]', name)
    assert safe_name(name) == name


def test_a_name_of_every_script_can_be_written(tmp_path):
    for text in ("Vase ä/1", "花瓶" * 60, "ваза\t2", "..", "🏺"):
        write_something(tmp_path / f"{safe_name(text)}.exr")
    assert len(list(tmp_path.iterdir())) == 5
