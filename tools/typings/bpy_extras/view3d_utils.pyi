"""Not typed: whatever Blender offers is taken as it is."""

from typing import Any

def __getattr__(name: str) -> Any: ...
