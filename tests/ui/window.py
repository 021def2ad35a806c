"""Driving Heliform in a real Blender window, step after step, as a person would.

A script for ``blender --python`` makes a generator of steps and hands it to `play`; each step
yields the seconds until the next one. Pictures are taken of the whole screen, by ImageMagick.
"""

import importlib
import importlib.util
import shutil
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Generator
from pathlib import Path
from types import ModuleType

import bpy

ROOT = Path(__file__).resolve().parents[2]

bpy.context.preferences.view.show_splash = False


INSTALLED = "bl_ext.user_default.heliform"


def package() -> str:
    """Heliform's name here: that of the installed extension, else of the checkout once loaded."""
    return INSTALLED if INSTALLED in sys.modules else "heliform"


def jobs() -> ModuleType:
    """Heliform's jobs, whose state tells what runs."""
    return importlib.import_module(f"{package()}.addon.jobs")


def load() -> None:
    """Unless Heliform is installed, import the checkout and register it as Blender would."""
    if package() == INSTALLED:
        return
    spec = importlib.util.spec_from_file_location(
        "heliform", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    sys.modules["heliform"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["heliform"])
    sys.modules["heliform"].register()


def folder() -> Path:
    """Where pictures go: the first argument after ``--``."""
    out = Path(sys.argv[sys.argv.index("--") + 1])
    out.mkdir(parents=True, exist_ok=True)
    return out


def view() -> dict:
    """What a person points at: window, area and region of the first 3D view."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region}


def call(operator, *args, **options):
    """An operator as from a button in the 3D view."""
    with bpy.context.temp_override(**view()):
        return operator(*args, **options)


def open_sidebar() -> Generator[float]:
    """Show the sidebar's Heliform tab."""
    area = view()["area"]
    area.spaces.active.show_region_ui = True
    yield 0.5
    next(r for r in area.regions if r.type == "UI").active_panel_category = "Heliform"
    yield 0.5


def picture(name: str) -> None:
    """Save what the screen shows, where ImageMagick is there to do it."""
    path = folder() / f"{name}.png"
    if shutil.which("import"):
        subprocess.run(["import", "-window", "root", str(path)], check=True)


def click(x: int, y: int) -> Generator[float]:
    """Click where a person would, in pixels from the lower left; needs --enable-event-simulate."""
    target = view()["window"]
    for _ in range(2):
        target.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y)
        yield 0.2
    for value in ("PRESS", "RELEASE"):
        target.event_simulate("LEFTMOUSE", value, x=x, y=y)
        yield 0.5


def press(place: tuple[int, int], happened: Callable[[], object]) -> Generator[float]:
    """Click until it happened; a busy machine loses a click."""
    for _ in range(6):
        yield from click(*place)
        for _ in range(20):
            if happened():
                return
            yield 0.1
    picture("not pressed")
    raise AssertionError(f"Nothing came of a click at {place}.")


def scroll(steps: int) -> Generator[float]:
    """Turn the wheel over the sidebar."""
    here = view()
    sidebar = next(r for r in here["area"].regions if r.type == "UI")
    with bpy.context.temp_override(**here | {"region": sidebar}):
        for _ in range(abs(steps)):
            (bpy.ops.view2d.scroll_down if steps > 0 else bpy.ops.view2d.scroll_up)()
    yield 1.0


class Gaps:
    """How long the window did not answer: times between the calls of a quick timer."""

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self._last = time.perf_counter()
        bpy.app.timers.register(self._tick, persistent=True)

    def _tick(self) -> float:
        now = time.perf_counter()
        self.gaps.append(now - self._last)
        self._last = now
        return 0.005

    def say(self, what: str) -> float:
        """Print median, 95th percentile and longest, begin anew, and return the percentile in s."""
        gaps, self.gaps = sorted(self.gaps) or [float("nan")], []
        marks = (gaps[len(gaps) // 2], gaps[int(0.95 * len(gaps))], gaps[-1])
        print(f"gaps {what}: " + " ".join(f"{1000 * gap:.0f}" for gap in marks), "ms", flush=True)
        return marks[1]


def play(steps: Generator[float]) -> None:
    """Play the steps, then quit: exit code 0 where all went well."""

    def tick() -> float:
        try:
            return next(steps)
        except StopIteration:
            sys.exit(0)
        except BaseException:
            traceback.print_exc()
            sys.exit(1)

    bpy.app.timers.register(tick, first_interval=1.0, persistent=True)
