"""Floors, sensors and records that tests of radiation share."""

import numpy as np
from heliform.engines.core.scene import Plane, plane_receiver
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site

BOSTON = Site()
SUMMER = Period(span="summer solstice")
QUICK = Radiation(subdivision=1, accuracy=3.0)


def floor(resolution=4, size=1.0, at=(0, 0, 0), **named):
    """A level receiver about ``at``."""
    pose = np.eye(4)
    pose[:3, 3] = at
    plane = Plane(width=size, length=size, resolution=resolution, **named)
    return plane_receiver("Floor", plane, pose)


def facing(tilt, azimuth):
    """A sensor that looks ``tilt`` off the zenith towards ``azimuth``, in degrees."""
    lean, turn = np.radians([tilt, azimuth])
    normal = [np.sin(lean) * np.sin(turn), np.sin(lean) * np.cos(turn), np.cos(lean)]
    return at_points([[0, 0, 0]], [normal], offset=1e-6)


def total(result, name="total", receiver=0):
    """One map of a result, in double precision."""
    return result.maps[receiver].maps[name].astype(float)
