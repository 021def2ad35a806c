"""The crew: every task answered once, errors told, and nobody left behind."""

import time

import pytest
from heliform.engines.core.crew import Crew
from heliform.engines.core.errors import HeliformError, WorkerDied


def answers(crew, tasks):
    return dict(news for news in crew.work(tasks) if news is not None)


def test_every_task_is_answered_once_whoever_does_it():
    with Crew("operator:mul", 3, 2) as crew:
        assert answers(crew, range(500)) == {i: 3 * i for i in range(500)}
        assert answers(crew, [7]) == {0: 21}
        assert answers(crew, []) == {}


def test_what_a_task_prints_does_not_get_among_the_answers():
    with (
        Crew("builtins:print", '{"bytes": 3}', 1) as crew,
        pytest.raises(RuntimeError, match="Object arrays"),  # print itself answers None
    ):
        answers(crew, ["said"])


def test_a_users_mistake_in_a_task_is_raised_as_it_is():
    with (
        Crew("heliform.engines.core.analysis:find_form", "glass.vase", 1) as crew,
        pytest.raises(HeliformError, match=r"^Here asks for “glass.vase”, which there is not"),
    ):
        answers(crew, ["Here"])


def test_a_bug_in_a_task_keeps_its_traceback():
    with (
        Crew("operator:truediv", 1, 2) as crew,
        pytest.raises(RuntimeError, match="ZeroDivisionError"),
    ):
        answers(crew, [1, 2, 0])


def test_a_process_that_dies_is_told():
    with Crew("operator:mul", 1, 1) as crew:
        assert answers(crew, [1]) == {0: 1}
        crew._members[0].kill()
        with pytest.raises(WorkerDied, match="run it again"):
            answers(crew, [1])


def test_leaving_early_ends_every_process():
    started = time.monotonic()
    with Crew("operator:pow", 7, 2) as crew:
        members = crew._members
        for _ in crew.work([1, 2, 10**8]):
            break
    assert all(member.poll() is not None for member in members)
    assert time.monotonic() - started < 60
