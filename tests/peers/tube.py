"""The scene of the comparison: Table 1's tube, or another glass, above a plane under a lamp."""

from dataclasses import replace

import numpy as np
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Receiver, Scene
from heliform.engines.glass import TABLE_1, glass_object
from light import scenes

LIFT, LAMP, PLANE = 1e-3, 0.22, 0.8
"""Metres from the plane up to the tube, up to the lamp, and along the plane's side."""
IOR = 1.5


def tube(faces: int = TABLE_1["tube"].faces) -> Mesh:
    """The printed tube where it stands, a hair above the plane."""
    shift = np.eye(4)
    shift[2, 3] = LIFT
    return glass_object(replace(TABLE_1["tube"], faces=faces)).moved(shift)


def receiver(size: int) -> Receiver:
    """The plane, of ``size`` × ``size`` texels."""
    return scenes.floor(PLANE, size)


def scene(mesh: Mesh, size: int, ior: float = IOR, lamp: str = "") -> Scene:
    """The glass between the sample lamp, or that of an IES file, and the plane."""
    return scenes.scene(
        Body("Tube", mesh, Material(kind="dielectric", ior=ior)),
        lamp=Luminaire("Lamp", Lamp(file=lamp), scenes.at(z=LAMP)),
        receiver=receiver(size),
    )
