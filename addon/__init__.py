"""Registration: everything that Blender is to know of, in order, and taken back in reverse."""

import importlib
from types import ModuleType
from typing import Final

MODULES: Final = (
    "addon.model",
    "addon.preferences",
    "addon.bridge.showing",
    "addon.sun_overlay",
    "addon.overlays",
    "addon.live",
    "addon.structures",
    "addon.jobs",
    "addon.live_sun",
    "addon.command",
    "operators.objects",
    "operators.work_plane",
    "operators.relief",
    "operators.glass",
    "operators.printing",
    "operators.run",
    "operators.light",
    "operators.scan",
    "operators.structure",
    "operators.sun",
    "panels.scene",
    "panels.glass",
    "panels.printing",
    "panels.structure",
    "panels.light",
    "panels.sun",
    "panels.scan",
)


def register() -> None:
    """Register every module; where one fails, those before it are taken back."""
    done: list[ModuleType] = []
    try:
        for module in _modules():
            module.register()
            done.append(module)
    except Exception:
        for module in reversed(done):
            module.unregister()
        raise


def unregister() -> None:
    """Unregister every module, the last one first."""
    for module in reversed(_modules()):
        module.unregister()


def _modules() -> list[ModuleType]:
    return [importlib.import_module(f"..{name}", __package__) for name in MODULES]
