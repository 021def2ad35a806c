"""Answers to scenes that change: what is kept of the one before, and what the worker gives back."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines import light, sun
from heliform.engines.core.client import Worker
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.export import save_study
from heliform.engines.core.live import answer_study, kept, same
from heliform.engines.core.scene import Body, Material, Mesh, Receiver, Scene
from heliform.engines.sun.periods import Period

QUICK = sun.Radiation(period=Period(span="summer solstice"), subdivision=1, accuracy=10.0)


def roof(height: float) -> Body:
    corners = np.array([[-9.0, -9, height], [9, -9, height], [9, 9, height], [-9, 9, height]])
    return Body("Roof", Mesh(corners, np.array([[0, 1, 2, 3]], np.int32)), Material(kind="diffuse"))


def floor() -> Receiver:
    return Receiver("Floor", np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), 2, 2)


def test_what_is_the_same_is_the_very_object_that_it_was():
    before = Scene((roof(3.0), Body("Wall", *astuple(roof(2.0)))), (), (floor(),))
    now = Scene((roof(3.5), Body("Wall", *astuple(roof(2.0)))), (), (floor(),))
    found = kept(now, before)
    assert found.bodies[0] is now.bodies[0]
    assert found.bodies[1] is before.bodies[1]
    assert found.receivers[0] is before.receivers[0]


def astuple(body: Body) -> tuple[Mesh, Material]:
    return body.mesh, body.material


def test_two_values_are_the_same_to_the_last_bit_and_kind():
    assert same(roof(3.0), roof(3.0))
    assert not same(roof(3.0), roof(np.nextafter(3.0, 4.0)))
    assert not same(roof(3.0), replace(roof(3.0), name="Dach"))
    assert same((roof(1.0), QUICK), (roof(1.0), QUICK))
    assert not same((roof(1.0),), (roof(1.0), QUICK))
    assert not same(None, (roof(1.0), QUICK))


def test_the_worker_answers_one_scene_after_another(tmp_path):
    with Worker() as worker:
        for index, bodies in enumerate(((), (roof(3.0),), (roof(0.5),))):
            scene = Scene(bodies, (), (floor(),))
            study = save_study(tmp_path / f"{index}", "Live", scene, sun.SUN_RADIATION, QUICK, 0)
            ended = worker.wait(worker.ask(study, tmp_path / f"{index}" / "out"), timeout=120)
            assert ended.outcome == "done", ended.text
            answer = sun.SunMaps.load(ended.out).maps[0].maps
            truth = sun.study_radiation(scene, QUICK).maps[0].maps
            np.testing.assert_allclose(answer["total"], truth["total"], rtol=1e-5)


def test_a_question_that_cannot_be_answered_is_a_sentence(tmp_path):
    study = save_study(tmp_path, "Photons", Scene(), light.TRACE_PHOTONS, light.PhotonTracing(), 0)
    with pytest.raises(ParameterError, match="does not answer live"):
        answer_study(study, tmp_path / "out")
    study = save_study(tmp_path, "Nothing", Scene(), sun.SUN_RADIATION, QUICK, 0)
    with Worker() as worker:
        ended = worker.wait(worker.ask(study, tmp_path / "out"), timeout=120)
    assert ended.outcome == "error"
    assert "receiver" in ended.text
    assert not (tmp_path / "out").exists()
