"""Triangular factors of a frame's stiffness: of a band by LAPACK, or sparse by SuperLU."""

from dataclasses import dataclass
from typing import Protocol

from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.sparse.linalg import splu

from ..core.scene import Vector
from .assembly import Pattern


class Factor(Protocol):
    """A factorised stiffness matrix of n unknowns."""

    def solve(self, right: Vector) -> Vector:
        """Displacements (n, C) for the forces ``right`` (n, C)."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class BandFactor:
    """Cholesky's factor of a band."""

    band: Vector

    def solve(self, right: Vector) -> Vector:
        """Displacements (n, C) for the forces ``right`` (n, C)."""
        return cho_solve_banded((self.band, True), right, check_finite=False)


def factor_of(pattern: Pattern, members: Vector, springs: Vector | None = None) -> Factor | None:
    """The factor of members (M, 12, 12) in world axes and springs (N, 6).

    None where the matrix is not positive definite.
    """
    if pattern.band:
        band = pattern.banded(members, springs)
        try:
            return BandFactor(cholesky_banded(band, True, lower=True, check_finite=False))
        except LinAlgError:  # not positive definite
            return None
    try:
        factor = splu(
            pattern.matrix(members, springs),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # exactly singular
        return None
    return factor if (factor.U.diagonal() > 0.0).all() else None
