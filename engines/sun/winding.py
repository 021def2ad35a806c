"""Meshes that gather light on the side that their faces look to, and whether that is the outer."""

from ..core.scene import Surface
from ..core.solid import inspect

_REMEDY = "recalculate its normals (in Edit Mode, Mesh › Normals › Recalculate Outside)."


def wound(surface: Surface) -> tuple[str, ...]:
    """A sentence where its faces look different ways, or inward though they enclose something.

    A mesh that gathers on both sides may look inward.
    """
    name, report = surface.name, inspect(surface.mesh)
    if report.twisted_edges:
        number = report.twisted_edges
        edges = "edge has" if number == 1 else "edges have"
        return (
            f"“{name}”: {number:,} {edges} faces that look opposite ways, so part of it is "
            f"measured on its wrong side; {_REMEDY}",
        )
    if report.inside_out and surface.sides == "front":
        share = f" in {report.inside_out:,} of its {report.parts:,} parts"
        return (
            f"“{name}” is closed and looks inward{share if report.parts > 1 else ''}, so it is "
            f"measured on its inner side; {_REMEDY}",
        )
    return ()
