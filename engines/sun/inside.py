"""Sensors that lie inside a solid, where they see nothing."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from .occlusion import Occluders
from .rays import BATCH
from .soup import Soup

_LEAN = 0.6  # how far the two further rays lean from the normal: 37°


def inside(
    occluders: Occluders, origins: NDArray[np.float32], normals: NDArray[np.float32]
) -> Counter[str]:
    """How many of the sensors are inside of which solid, by its name. As `holders` tells."""
    return Counter(name for name in holders(occluders, origins, normals) if name)


def holders(
    occluders: Occluders, origins: NDArray[np.float32], normals: NDArray[np.float32]
) -> list[str]:
    """The solid that each of the sensors is inside of, by its name, “” where there is none.

    ``origins``, ``normals`` (N, 3) are as in `rays.Rays`. Three rays a sensor, within 37° of its
    normal, meet a solid from behind, all three of them. Only closed bodies that block light are
    solids here; one that is inside out is one as well.
    """
    names = [""] * len(origins)
    for soup in (occluders.still, occluders.moving):
        if soup.scene is None:
            continue
        for start in range(0, len(origins), BATCH):
            rows = slice(start, start + BATCH)
            owner = _owner(soup, origins[rows], normals[rows])
            for row in np.flatnonzero(owner >= 0).tolist():
                body = int(owner[row])
                if not names[start + row] and soup.solid(body):
                    names[start + row] = soup.bodies[body].name
    return names


def _owner(
    soup: Soup, origins: NDArray[np.float32], normals: NDArray[np.float32]
) -> NDArray[np.int32]:
    """The body that all three rays of each sensor meet from behind, −1 where there is none."""
    mi = runtime.mitsuba()
    axis = np.eye(3, dtype=np.float32)[np.abs(normals).argmin(axis=1)]
    side = np.cross(normals, axis)
    side *= _LEAN / np.linalg.norm(side, axis=1, keepdims=True)
    upright = np.sqrt(1 - _LEAN**2) * normals
    owners = []
    for direction in (normals, upright + side, upright - side):
        ray = mi.Ray3f(
            mi.Point3f(np.ascontiguousarray(origins.T)),
            mi.Vector3f(np.ascontiguousarray(direction.T.astype(np.float32))),
        )
        hit = soup.scene.ray_intersect_preliminary(ray)
        met, triangle = np.asarray(hit.is_valid()), np.asarray(hit.prim_index)
        triangle = np.where(met, triangle, 0)
        owner = soup.owner[triangle]
        along = np.einsum("ij,ij->i", soup.normals(triangle), direction)
        behind = met & (along * soup.orientation[owner] > 0)
        owners.append(np.where(behind, owner, -1))
    agreed = (owners[0] == owners[1]) & (owners[1] == owners[2])
    return np.where(agreed, owners[0], -1)
