"""The installed extension in a real window, driven by clicks."""

import pytest

pytestmark = pytest.mark.ui
GEOMETRY = ("--enable-event-simulate", "--window-geometry", "0", "0", "1600", "1000")


@pytest.mark.parametrize(
    "script",
    [
        *("press.py", "trouble.py"),
        *(pytest.param(f"{n}.py", marks=pytest.mark.slow) for n in ("wall", "structure", "sun")),
    ],
)
def test_a_person_in_the_window(installed_blender, scripts, tmp_path, script):
    said = installed_blender(
        *GEOMETRY, "--python", scripts / script, "--", tmp_path / "shots", timeout=480.0
    )
    print(said.stdout)
