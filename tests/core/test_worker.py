"""Jobs in the worker process: what they report, how they end, and what outlives what."""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType

import pytest
from heliform.engines.core import client
from heliform.engines.core.client import Progressed, Worker
from heliform.engines.core.errors import WorkerDied

FAKE = [sys.executable, str(Path(__file__).with_name("fake_worker.py"))]
KILL = getattr(signal, "SIGKILL", signal.SIGTERM)


@pytest.fixture
def worker():
    with Worker(command=FAKE) as worker:
        yield worker


def until(worker, what):
    """Poll until ``what`` holds for the events so far, as a window would."""
    events = []
    while not what(events):
        time.sleep(0.01)
        events += worker.poll()
    return events


def test_a_job_reports_its_steps_and_its_folder(worker, tmp_path):
    seen = []
    job = worker.submit("steps", tmp_path / "out")
    ended = worker.wait(job, lambda event: seen.append((event.fraction, event.text)))
    assert seen == [(n / 5, f"Step {n}") for n in range(5)]
    assert (ended.outcome, ended.out) == ("done", tmp_path / "out")


def test_jobs_queue_and_poll_tells_of_each_in_turn(worker, tmp_path):
    first, second = worker.submit("steps", tmp_path / "a"), worker.submit("ping", tmp_path / "b")
    events = until(worker, lambda events: len(events) == 7)
    assert [event.job for event in events] == [first] * 6 + [second]
    assert [event.outcome for event in (events[5], events[6])] == ["done", "done"]


def test_waiting_for_one_job_keeps_the_events_of_others(worker, tmp_path):
    first, second = worker.submit("steps", tmp_path), worker.submit("ping", tmp_path)
    assert worker.wait(second).outcome == "done"
    assert [event.job for event in worker.poll()] == [first] * 6
    with pytest.raises(ValueError, match="has ended before"):
        worker.wait(first)


def test_paths_and_options_arrive_as_they_are(worker, tmp_path):
    folder = tmp_path / "Häuser & “Glas” 日本"
    folder.mkdir()
    ended = worker.wait(worker.submit(folder / "echo.toml", folder / "out ä", True, 7, ["a.b=1"]))
    assert ended.out == folder / "out ä"
    text = (ended.out / "echo.txt").read_text(encoding="utf-8")
    assert text == f"{folder / 'echo.toml'}\nTrue 7 ['a.b=1']"


def test_a_mistake_is_one_sentence_and_a_bug_keeps_its_traceback(worker, tmp_path):
    ended = worker.wait(worker.submit("mistake", tmp_path))
    assert (ended.outcome, ended.text[:19]) == ("error", "Tube “Vase ä/1” is ")
    ended = worker.wait(worker.submit("bug", tmp_path))
    assert ended.outcome == "bug"
    assert "ZeroDivisionError" in ended.text
    assert "fake_worker.py" in ended.text
    assert worker.wait(worker.submit("ping", tmp_path)).outcome == "done"


def test_what_a_job_prints_stays_out_of_the_replies(worker, tmp_path):
    seen = []
    ended = worker.wait(worker.submit("chatter", tmp_path / "out"), seen.append)
    assert [event.text for event in seen] == ["stdin holds ''"]
    assert (ended.outcome, ended.out) == ("done", tmp_path / "out")


def test_a_job_that_is_asked_stops_and_the_process_stays(worker, tmp_path):
    job = worker.submit("endless", tmp_path)
    until(worker, lambda events: events)
    pid = worker.pid
    worker.cancel(job)
    assert worker.wait(job).outcome == "cancelled"
    assert worker.wait(worker.submit("ping", tmp_path)).outcome == "done"
    assert worker.pid == pid


def test_a_stuck_job_is_ended_with_its_process_and_the_next_one_runs(worker, tmp_path):
    job = worker.submit("stuck", tmp_path / "out")
    queued = worker.submit("ping", tmp_path)
    until(worker, lambda events: events)
    pid = worker.pid
    worker.cancel(job)
    assert worker.wait(job).outcome == "cancelled"
    assert list(tmp_path.iterdir()) == []
    assert worker.wait(queued).outcome == "done"
    assert worker.pid != pid


def test_a_job_that_waits_its_turn_is_cancelled_at_once(worker, tmp_path):
    first, second = worker.submit("endless", tmp_path), worker.submit("ping", tmp_path)
    worker.cancel(second)
    worker.cancel(first)
    assert worker.wait(second).outcome == "cancelled"
    assert worker.wait(first).outcome == "cancelled"


def test_a_process_killed_from_outside_is_told_and_replaced(worker, tmp_path):
    job = worker.submit("stuck", tmp_path / "out")
    until(worker, lambda events: events)
    os.kill(worker.pid, KILL)
    ended = worker.wait(job)
    assert ended.outcome == "died"
    assert "stuck” was done. Run it again" in ended.text
    assert list(tmp_path.iterdir()) == []
    assert worker.wait(worker.submit("ping", tmp_path)).outcome == "done"

    os.kill(worker.pid, KILL)
    until(worker, lambda events: worker.pid is None)
    assert worker.wait(worker.submit("ping", tmp_path)).outcome == "done"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows numbers its crashes otherwise")
def test_a_crash_is_told_with_its_signal_and_the_last_words(tmp_path):
    with Worker(command=[FAKE[0], "-X", "faulthandler", FAKE[1]]) as worker:
        ended = worker.wait(worker.submit("crash", tmp_path))
    assert ended.outcome == "died"
    assert "signal 11 (Segmentation fault)" in ended.text
    assert "in crash" in ended.text


def test_an_interpreter_that_does_not_exist_is_named(tmp_path):
    worker = Worker(str(tmp_path / "no python"))
    assert "no python” cannot be started" in worker.wait(worker.submit("ping", tmp_path)).text
    with pytest.raises(WorkerDied, match="choose a Python"):
        worker.start()


def test_stopping_cancels_what_is_not_done_and_submitting_starts_anew(worker, tmp_path):
    jobs = [worker.submit(name, tmp_path) for name in ("endless", "ping")]
    worker.stop()
    assert worker.pid is None
    ends = [event for event in worker.poll() if not isinstance(event, Progressed)]
    assert {event.job: event.outcome for event in ends} == dict.fromkeys(jobs, "cancelled")
    assert worker.wait(worker.submit("ping", tmp_path)).outcome == "done"


def test_waiting_can_be_given_up_while_the_job_runs_on(worker, tmp_path):
    job = worker.submit("endless", tmp_path)
    with pytest.raises(TimeoutError):
        worker.wait(job, timeout=0.05)
    worker.cancel(job)
    assert worker.wait(job).outcome == "cancelled"


PARENT = """
import sys, time
from heliform.engines.core.client import Worker
worker = Worker(command=sys.argv[1:3])
worker.submit(sys.argv[3], "out")
while not worker.poll():
    time.sleep(0.01)
print("busy", flush=True)
time.sleep(60)
"""


@pytest.mark.parametrize("study", ["endless", "ping"])
def test_the_death_of_the_parent_ends_the_worker(study, tmp_path):
    goodbye = tmp_path / "goodbye"
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, *FAKE, study],
        stdout=subprocess.PIPE,
        cwd=tmp_path,
        env={**os.environ, "GOODBYE": str(goodbye)},
    )
    with parent:
        assert parent.stdout
        parent.stdout.readline()
        assert not goodbye.exists()
        parent.kill()
    latest = time.monotonic() + 10
    while not goodbye.exists() and time.monotonic() < latest:
        time.sleep(0.02)
    assert goodbye.exists()


def test_the_worker_starts_whatever_the_package_is_called_and_wherever_it_lies(
    tmp_path, monkeypatch
):
    """In Blender the package's name has parents that no other process can import."""
    home = Path(client.__file__).parents[2]
    copy = tmp_path / "Häuser und Glas" / "form 1"
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(home / "engines" / "core", copy / "engines" / "core", ignore=ignore)
    for init in ("__init__.py", "engines/__init__.py"):
        shutil.copy(home / init, copy / init)
    for parent in ("house", "house.user"):
        monkeypatch.setitem(sys.modules, parent, ModuleType(parent))
    spec = importlib.util.spec_from_file_location("house.user.form", copy / "__init__.py")
    assert spec
    assert spec.loader
    package = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "house.user.form", package)
    spec.loader.exec_module(package)
    renamed = importlib.import_module("house.user.form.engines.core.client")

    with renamed.Worker() as worker:
        worker.warm("no such room")
        ended = worker.wait(worker.submit(tmp_path / "none.toml", tmp_path / "out"))
    assert ended.outcome in ("error", "bug"), ended.text
    for name in [name for name in sys.modules if name.startswith("house.user.form.")]:
        monkeypatch.delitem(sys.modules, name)
