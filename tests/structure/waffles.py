"""Small structures for tests: waffles over a rectangle, chains, and closed prisms."""

import numpy as np
from heliform.engines.structure.frame import HINGED, Frame
from heliform.engines.structure.model import NO_NODE, Model


def model(nodes, members, cells, normals=None, groups=None, names=("ribs",), held=(0,)):
    """A model on hinged supports; the surface is everywhere."""
    count = len(members)
    supports = np.zeros((len(nodes), 6), dtype=bool)
    supports[list(held)] = HINGED
    normals = np.tile([0.0, 0.0, 1.0], (count, 1)) if normals is None else normals
    frame = Frame(np.asarray(nodes, float), np.asarray(members, np.int32), normals, supports)
    groups = np.zeros(count, np.int32) if groups is None else np.asarray(groups, np.int32)
    cells = np.asarray(cells, np.int32).reshape(-1, 4)
    return Model(frame, cells, np.full((count, 2), 0.5), groups, names)


def waffle(along=6, across=4, length=30.0, width=20.0, height=None, triangles=False):
    """A grid of ribs over length × width from the origin, at z = ``height`` (x, y)."""
    x, y = np.meshgrid(
        np.linspace(0, length, along + 1), np.linspace(0, width, across + 1), indexing="ij"
    )
    z = np.zeros_like(x) if height is None else height(x, y)
    at = np.arange(x.size).reshape(x.shape)
    members = np.concatenate(
        [
            np.stack([at[:-1], at[1:]], -1).reshape(-1, 2),
            np.stack([at[:, :-1], at[:, 1:]], -1).reshape(-1, 2),
        ]
    )
    a, b, c, d = (p.ravel() for p in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    cells = np.stack([a, b, c, d], -1)
    if triangles:
        none = np.full_like(a, NO_NODE)
        cells = np.concatenate([np.stack([a, b, c, none], -1), np.stack([a, c, d, none], -1)])
        members = np.concatenate([members, np.stack([a, c], -1)])
    corners = (at[0, 0], at[-1, 0], at[-1, -1], at[0, -1])
    nodes = np.stack([x, y, z], -1).reshape(-1, 3)
    return model(nodes, members, cells, held=corners)


def prism(sides=7, storeys=3, radius=5.0, height=4.0, turn=0.2):
    """A tower over a regular polygon, with verticals, rings, and a roof and a floor of fans."""
    angle = turn + np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], -1)
    up = np.array([0.0, 0.0, height])
    nodes = np.concatenate([ring + k * up for k in range(storeys + 1)])
    bottom, top = len(nodes), len(nodes) + 1
    nodes = np.concatenate([nodes, [[0, 0, 0], [0, 0, storeys * height]]])
    at = np.arange(sides * (storeys + 1)).reshape(storeys + 1, sides)
    after = np.roll(at, -1, axis=1)
    pairs = [
        np.stack([at[:-1], at[1:]], -1).reshape(-1, 2),
        np.stack([at, after], -1).reshape(-1, 2),
        np.stack([at[0], np.full(sides, bottom)], -1),
        np.stack([at[-1], np.full(sides, top)], -1),
    ]
    groups = np.repeat([0, 1, 0, 0], [len(p) for p in pairs])
    walls = np.stack([at[:-1], after[:-1], after[1:], at[1:]], -1).reshape(-1, 4)
    none = np.full(sides, NO_NODE)
    roof = np.stack([at[-1], after[-1], np.full(sides, top), none], -1)
    floor = np.stack([after[0], at[0], np.full(sides, bottom), none], -1)
    members = np.concatenate(pairs)
    outward = nodes[members].mean(axis=1) - (0, 0, storeys * height / 2)
    return model(
        nodes,
        members,
        np.concatenate([walls, roof, floor]),
        normals=outward,
        groups=groups,
        names=("verticals", "rings"),
        held=at[0],
    )
