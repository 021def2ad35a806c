"""A small grid shell with everything: rolled, released and offset members, loads anywhere."""

import numpy as np
from heliform.engines.structure.frame import Frame, Rigidities
from heliform.engines.structure.loads import Loads


def shell(side=3, seed=0, special=True):
    """Frame, rigidities and two load cases of (side + 1)² nodes, held at the corners."""
    rng = np.random.default_rng(seed)
    t = np.arange(side + 1.0)
    x, y = np.meshgrid(t, t, indexing="ij")
    z = 0.5 * np.sin(np.pi * x / side) + 0.3 * np.sin(np.pi * y / side)
    nodes = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    nodes = nodes + 0.1 * rng.normal(size=nodes.shape)
    number = np.arange((side + 1) ** 2).reshape(side + 1, side + 1)
    lines = ((number[:-1], number[1:]), (number[:, :-1], number[:, 1:]))
    members = np.concatenate([np.stack(ends, axis=-1).reshape(-1, 2) for ends in lines])
    count = len(members)
    held = np.zeros((len(nodes), 6), dtype=bool)
    held[number[[0, 0, -1, -1], [0, -1, 0, -1]]] = True
    normals = (0.0, 0.0, 1.0) + 0.3 * rng.normal(size=(count, 3))
    releases = offsets = springs = None
    if special:
        releases = np.zeros((count, 12), dtype=bool)
        releases[2, [4, 10]] = releases[5, [4, 5]] = True
        offsets = 0.05 * rng.normal(size=(count, 2, 3))
        springs = np.zeros((len(nodes), 6))
        springs[5, 2] = 3.0
    frame = Frame(nodes, members.astype(np.int32), normals, held, releases, offsets, springs)
    sizes = np.array([1e3, 10, 5, 3, 40, 30, 2, 0.1])
    rigidities = Rigidities(*(sizes[:, None] * rng.uniform(1, 2, (8, count))))
    nodal, line = rng.normal(size=(2, len(nodes), 6)), rng.normal(size=(2, count, 2, 3))
    gravity = rng.normal(size=(2, 3))
    return frame, rigidities, Loads(("one", "two"), ("permanent", "snow"), gravity, nodal, line)
