"""The zip that people get: installed into a real Blender, it traces light and knows itself."""

import json
import zipfile

import pytest

pytestmark = pytest.mark.ui


def test_the_zip_holds_what_ships_and_nothing_else(blender, extension):
    with zipfile.ZipFile(extension) as zipped:
        names = [name for name in zipped.namelist() if not name.endswith("/")]
    tops = {name.partition("/")[0] for name in names}
    rooms = {"addon", "operators", "panels", "engines", "studies", "wheels"}
    assert tops == rooms | {"__init__.py", "blender_manifest.toml", "LICENSE", "README.md"}
    wheels = [name for name in names if name.endswith(".whl")]
    assert any("mitsuba-" in name for name in wheels)
    assert not any("/numpy-" in name for name in wheels)


def test_the_installed_extension_traces_its_demo(installed_blender, scripts, tmp_path):
    file = tmp_path / "ein Test ä.blend"
    use = scripts / "use_installed.py"
    script = ("--background", "--python-exit-code", "3", "--python", use, "--", file)
    assert "picture: " in installed_blender(*script).stdout
    assert file.stat().st_size > 100_000


def test_blender_runs_a_study_from_the_command_line(installed_blender, tmp_path):
    out = tmp_path / "ein Ergebnis ä"
    installed_blender("--command", "heliform", "run", "demo", "--quick", "--out", out)
    files = json.loads((out / "result.json").read_text(encoding="utf-8"))["files"]
    assert {"irradiance.exr", "report.html"} <= set(files)
    assert all((out / file).is_file() for file in [*files, "scene.blend"])


def test_the_doctor_finds_nothing_missing(installed_blender):
    said = installed_blender("--command", "heliform", "doctor").stdout
    assert "ok       Tracing" in said
    assert "MISSING" not in said
