"""An image that holds one value a member and station, to colour members with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector

LARGEST = 8192  # side of an image that every graphics card takes


@dataclass(frozen=True, slots=True)
class TextureLayout:
    """Where members stand in an image: one texel a member and station along it.

    Member m is in row m modulo ``rows``, row 0 at v = 0; its ``stations`` lie side by side along u,
    and more members than rows go on in the next block of columns. ``columns`` and ``rows`` are the
    image's texels.
    """

    members: int
    stations: int
    columns: int
    rows: int

    def coordinates(self, member: NDArray[np.integer], along: Vector) -> Vector:
        """Texture coordinates (..., 2) at ``along`` 0..1 of the members' lengths, both broadcast.

        They reach from the middle of a member's first texel to that of its last, in the middle of
        its row, so that nothing of the neighbours shows where the image is drawn interpolated.
        """
        block, row = np.divmod(member, self.rows)
        places = np.empty((*np.broadcast_shapes(member.shape, along.shape), 2))
        start = (block * self.stations + 0.5) / self.columns
        places[..., 0] = start + along * ((self.stations - 1) / self.columns)
        places[..., 1] = (row + 0.5) / self.rows
        return places


def layout_of(members: int, stations: int) -> TextureLayout:
    """The image for so many members and stations, no side of it above LARGEST.

    Raises ParameterError where there are more than fit.
    """
    rows = max(min(members, LARGEST), 1)
    blocks = max(-(-members // rows), 1)
    if blocks * stations > LARGEST:
        most = LARGEST // stations * LARGEST
        raise ParameterError(
            f"{members} members at {stations} stations are more than an image of {LARGEST} by "
            f"{LARGEST} texels holds; show at most {most} members, or fewer stations."
        )
    return TextureLayout(members, stations, blocks * stations, rows)


def image_of(values: Vector, layout: TextureLayout) -> Vector:
    """The image (rows, columns) of ``values`` (M, S), one a member and station, row 0 at v = 0.

    It is 0 where no member is.
    """
    blocks = layout.columns // layout.stations
    padded = np.zeros((blocks * layout.rows, layout.stations), dtype=values.dtype)
    padded[: layout.members] = values
    image = padded.reshape(blocks, layout.rows, layout.stations).swapaxes(0, 1)
    return image.reshape(layout.rows, layout.columns)
