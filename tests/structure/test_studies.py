"""The studies of this room: they are read, run, and find what the thesis found."""

import json
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core.run import run_study
from heliform.engines.core.study import load_study

STUDIES = Path(__file__).resolve().parents[2] / "studies"
NAMES = ("structure-roof", "structure-shell", "structure-facade", "shading-a")


def figures_of(name: str, out: Path, **how) -> dict:
    run_study(STUDIES / f"{name}.toml", out, **how)
    summary = json.loads((out / "result.json").read_text(encoding="utf-8"))
    return {key: figure["value"] for key, figure in summary["figures"].items()}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("quick", [False, True])
def test_studies_are_read(name, quick):
    assert load_study(STUDIES / f"{name}.toml", quick=quick).cases


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_studies_run_quickly(name, tmp_path):
    figures = figures_of(name, tmp_path / "out", quick=True)
    assert all(value == value for value in figures.values())
    assert (tmp_path / "out" / "report.html").stat().st_size > 10_000


@pytest.mark.slow
def test_a_quarter_of_the_material_as_in_figure_29(tmp_path):
    figures = figures_of("shading-a", tmp_path / "out")
    assert figures["share"] == pytest.approx(0.25, abs=0.04)
    assert figures["failing"] == 0


@pytest.mark.slow
def test_timber_fails_and_a_mixture_saves_energy_as_in_figure_30(tmp_path):
    figures = figures_of("structure-roof", tmp_path / "out")
    assert figures["timber.failing"] > figures["timber-held.failing"] == 0
    assert figures["steel.failing"] == figures["mixed.failing"] == 0
    saved = 1 - figures["mixed.embodied_energy"] / figures["steel.embodied_energy"]
    assert saved == pytest.approx(0.3, abs=0.07)


@pytest.mark.slow
def test_turned_facades_need_more_as_in_figure_36(tmp_path):
    figures = figures_of("structure-facade", tmp_path / "out")
    assert figures["straight.mass"] < figures["graded.mass"] < figures["turned.mass"]
    assert figures["turned.failing"] == 0


def test_light_can_meet_a_structure_that_a_study_names(tmp_path):
    (tmp_path / "shade.toml").write_text(
        """
        analysis = "light.trace"
        [bodies.Roof]
        form = "structure.sized"
        preset = "roof"
        shape.roof.spacing = 5.0
        material.kind = "diffuse"
        [lamps.Lamp]
        source = "disk"
        flux = 100.0
        [receivers.Floor]
        """,
        encoding="utf-8",
    )
    (case,) = load_study(tmp_path / "shade.toml").cases
    mesh = case.scene.bodies[0].mesh
    assert 30 < np.ptp(mesh.vertices[:, 0]) < 31
    assert mesh.vertices[:, 2].min() < 0.1
