"""A hemisphere cut finely, by which a sky's light is summed apart from the engine's own rules."""

import numpy as np


def fine_dome(rings: int = 360, sectors: int = 720):
    """Directions (D, 3) and what each weighs (D,) in ∫ … cos ζ dω: rings of even weight."""
    sine = np.sqrt((np.arange(rings) + 0.5) / rings)
    turn = 2 * np.pi * (np.arange(sectors) + 0.5) / sectors
    level, turn = np.meshgrid(sine, turn, indexing="ij")
    directions = np.stack([level * np.sin(turn), level * np.cos(turn), np.sqrt(1 - level**2)], -1)
    directions = directions.reshape(-1, 3)
    return directions, np.full(len(directions), np.pi / len(directions))


def towards(azimuth, altitude):
    """Unit vectors (…, 3) at azimuths and altitudes in degrees."""
    turn, height = np.radians(azimuth), np.radians(altitude)
    return np.stack(
        np.broadcast_arrays(
            np.sin(turn) * np.cos(height), np.cos(turn) * np.cos(height), np.sin(height)
        ),
        axis=-1,
    )
