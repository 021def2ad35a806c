"""What stands in the way of sun and sky: bodies that block it, and panes that let it through."""

import hashlib
from collections.abc import Iterable

import numpy as np

from ..core.errors import SceneError
from ..core.scene import Body, Material, Mesh, Receiver, Scene, Surface, Vector
from .soup import Soup

_FAR = 4.0  # times the first reach: from there the centre is chosen anew


class Occluders:
    """Bodies in three heaps: ``still`` and ``moving`` ones, which block, and ``panes``.

    Smooth glass (`Material.kind` "dielectric", no roughness) is a pane; all else blocks. ``update``
    makes anew only the heaps in which something changed. A body that it finds changed is among the
    moving from then on, so that what the still ones hide need not be traced again; name those that
    will move as ``moving``, and the first update is as fast as the later ones.

    Raises SceneError for a body without faces or with vertices that are not finite.
    """

    def __init__(self, bodies: Iterable[Body], moving: Iterable[str] = ()) -> None:
        self._moving = {(name, 0) for name in moving}
        self._meshes: dict[tuple[str, int], tuple[Mesh, Material]] = {}
        self._digests: dict[tuple[str, int], bytes] = {}
        self.centre = np.zeros(3)
        self._first_reach = np.inf
        self.still = self.moving = self.panes = Soup((), self.centre)
        self.digests = {"still": b"", "moving": b"", "panes": b""}
        self.update(bodies)

    def update(self, bodies: Iterable[Body]) -> None:
        """Take ``bodies`` in place of those before; what is the same is told by its content.

        The very same `Mesh` is taken to be as it was: give a new one where its arrays have changed.
        """
        named = _numbered(bodies)
        first = not self._digests
        digests = {key: self._digest(key, body) for key, body in named.items()}
        changed = {
            key
            for key in digests.keys() | self._digests.keys()
            if digests.get(key) != self._digests.get(key)
        }
        if not first:
            self._moving |= changed
        self._digests = digests
        self._meshes = {key: (body.mesh, body.material) for key, body in named.items()}
        heaps: dict[str, list[tuple[str, int]]] = {"still": [], "moving": [], "panes": []}
        for key, body in named.items():
            heaps[_heap(body.material, key in self._moving)].append(key)
        if first or self._strayed(named.values()):
            self._centre(named.values())
        for name, keys in heaps.items():
            parts = b"".join(digests[key] for key in keys)
            digest = _hash(parts, self.centre.tobytes())
            if digest == self.digests[name]:
                continue
            within = tuple(named[key] for key in keys)
            soup: Soup = getattr(self, name)
            if soup.bodies and np.array_equal(soup.centre, self.centre):
                soup.put(within)
            else:
                setattr(self, name, Soup(within, self.centre))
            self.digests[name] = digest

    @property
    def digest(self) -> bytes:
        """Tells one state of the bodies from another."""
        return b"".join(self.digests.values())

    @property
    def reach(self) -> float:
        """The largest coordinate about the centre, in m."""
        return max(self.still.reach, self.moving.reach, self.panes.reach)

    def _digest(self, key: tuple[str, int], body: Body) -> bytes:
        mesh, material = self._meshes.get(key, (None, None))
        if mesh is body.mesh and material == body.material:
            return self._digests[key]
        _check(body)
        parts = (body.mesh.vertices, body.mesh.faces)
        return _hash(*map(np.ascontiguousarray, parts), repr(body.material).encode())

    def _centre(self, bodies: Iterable[Body]) -> None:
        low, high = _box(bodies)
        self.centre = (low + high) / 2
        self._first_reach = float((high - low).max() / 2)

    def _strayed(self, bodies: Iterable[Body]) -> bool:
        low, high = _box(bodies)
        return np.abs([low - self.centre, high - self.centre]).max() > _FAR * self._first_reach


def bodies_of(scene: Scene) -> tuple[Body, ...]:
    """A scene's bodies, and its receivers as bodies that block light as well."""
    return (*scene.bodies, *map(body_of, scene.receivers))


def body_of(receiver: Receiver | Surface) -> Body:
    """A receiver as a body that blocks light and returns it as a matte one."""
    matte = Material(kind="diffuse", reflectance=receiver.reflectance)
    if isinstance(receiver, Surface):
        return Body(receiver.name, receiver.mesh, matte)
    o, u, v = receiver.origin, receiver.u, receiver.v
    corners = np.array([o, o + u, o + u + v, o + v])
    return Body(receiver.name, Mesh(corners, np.array([[0, 1, 2, 3]], np.int32)), matte)


def is_pane(material: Material) -> bool:
    """Whether the sun shines straight through it: clear glass does, ground glass scatters."""
    return material.kind == "dielectric" and material.roughness == 0


def _check(body: Body) -> None:
    if not len(body.mesh.faces):
        raise SceneError(f"“{body.name}” has no faces; delete it or give it a mesh.")
    # A sum is finite only where all of them are, and needs no array of its own.
    if not np.isfinite(body.mesh.vertices.sum()):
        raise SceneError(
            f"“{body.name}” has vertices that are not finite numbers; rebuild its mesh."
        )


def _heap(material: Material, moving: bool) -> str:
    if is_pane(material):
        return "panes"
    return "moving" if moving else "still"


def _numbered(bodies: Iterable[Body]) -> dict[tuple[str, int], Body]:
    """Each body by its name and how many of that name came before."""
    counts: dict[str, int] = {}
    named = {}
    for body in bodies:
        number = counts.get(body.name, 0)
        counts[body.name] = number + 1
        named[body.name, number] = body
    return named


def _box(bodies: Iterable[Body]) -> tuple[Vector, Vector]:
    boxes = [
        (b.mesh.vertices.min(axis=0), b.mesh.vertices.max(axis=0))
        for b in bodies
        if len(b.mesh.vertices)
    ]
    if not boxes:
        return np.zeros(3), np.zeros(3)
    low, high = (np.array(ends) for ends in zip(*boxes, strict=True))
    return low.min(axis=0), high.max(axis=0)


def _hash(*parts: bytes | np.ndarray) -> bytes:
    told = hashlib.blake2b(digest_size=16)
    for part in parts:
        told.update(len(part).to_bytes(8, "little"))
        told.update(part if isinstance(part, bytes) else part.data.cast("B"))
    return told.digest()
