"""Where light comes from in a period, and how much: suns, sky and ground as weighted directions."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .clear_sky import clear_weather
from .hourly import HourlySkies, hourly_skies
from .patches import patches_of
from .periods import Period, season_notes, selected
from .position import sun_position
from .read_weather import read_weather
from .site import Site, check_site, place_text, to_model
from .sky import Patches, Suns
from .sky_matrix import ground_radiance, matrix_blocks
from .suns import merged_suns
from .weather import Weather

GROUND = 1
"""The subdivision of the ground's patches: they are as bright as one another."""
_FAR = 0.5  # deg that a site may be off its weather's without a word


@dataclass(frozen=True, slots=True)
class Sources:
    """D directions that light comes from in T intervals: S suns, P patches of sky, G of ground.

    ``directions`` (D, 3) float64 unit vectors in the model's axes, in that order. ``direct`` and
    ``diffuse`` (D,) in kWh/m²: what comes from each, normal to it, in all of the period; ``hours``
    (D,): how long the sun stands there, whatever the weather. ``suns`` and ``patches``: where they
    are in the world; ``ground`` (G,) in sr: their solid angles, none where no sensor sees the
    ground. ``hourly``: the T intervals' sun and sky, whose middles are ``times`` (T,), UTC.
    ``ground_radiance`` (T,) in W/(m² sr). ``site``: where that is, and ``source`` what the weather
    is from. ``notes``: what a reader must know of all this.
    """

    directions: Vector
    direct: Vector
    diffuse: Vector
    hours: Vector
    suns: Suns
    patches: Patches
    ground: Vector
    hourly: HourlySkies
    times: NDArray[np.datetime64]
    ground_radiance: Vector
    site: Site
    source: str
    notes: tuple[str, ...]

    def course(self, arriving: Vector) -> tuple[Vector, Vector]:
        """Direct and diffuse irradiance (K, T) in W/m², hour by hour.

        ``arriving`` (K, D, 3): visibility × normal for each direction, at a sensor or as a mean
        over some. Merged suns lend what is seen of them; the cosine is each true sun's own.
        """
        count, sky = len(self.suns.directions), len(self.patches.directions)
        shares = self.suns.weights
        assert shares is not None
        sun = to_model(self.hourly.sun, self.site)
        direct = np.stack([np.einsum("ti,ti->t", shares.T @ one[:count], sun) for one in arriving])
        direct = np.maximum(direct, 0.0) * self.hourly.direct
        cosines = np.einsum("kdi,di->kd", arriving[:, count:], self.directions[count:])
        diffuse = np.outer(cosines[:, sky:] @ self.ground, self.ground_radiance)
        cosines = (cosines[:, :sky] * self.patches.solid_angles).T
        for which, block in matrix_blocks(self.hourly, self.patches, "none"):
            diffuse[:, which] += (block @ cosines).T
        return direct, diffuse


def weather_of(site: Site, weather_file: str, parts: int = 1) -> tuple[Weather, Site]:
    """The weather in a file, or a cloudless year where none is named; and where that is.

    A file's own place counts, with the ``site``'s orientation. Each interval is cut into ``parts``.
    Raises ParameterError for a site out of bounds and FileError as `read_weather` does.
    """
    check_site(site)
    if not weather_file:
        weather = clear_weather(site, hours=1 / parts)
        note = "No weather file is given: a cloudless year is assumed, which has more sun."
        return replace(weather, notes=(note, *weather.notes)), site
    weather = read_weather(weather_file)
    there = replace(weather.site, north=site.north)
    turn = abs((there.longitude - site.longitude + 180) % 360 - 180)
    if max(abs(there.latitude - site.latitude), turn * np.cos(np.radians(there.latitude))) > _FAR:
        note = (
            f"The weather is that of {place_text(there)}; the sun stands as it does there, not as "
            "at the site that is set."
        )
        weather = replace(weather, notes=(*weather.notes, note))
    return finer(weather, parts), there


def finer(weather: Weather, parts: int) -> Weather:
    """Each interval of a weather cut into ``parts`` of the same means.

    Direct light goes to those parts in whose middle the sun is up, in an hour of sunrise too.
    """
    if parts == 1:
        return weather
    steps = (np.arange(parts) + 0.5) / parts - 0.5
    shifts = np.round(weather.hours[:, None] * 3600 * steps).astype("timedelta64[s]")
    times = (weather.times.astype("datetime64[s]")[:, None] + shifts).ravel()

    def each(values: Vector) -> Vector:
        return np.repeat(values, parts)

    pressure, temperature = each(weather.pressure), each(weather.temperature)
    sun = sun_position(times, weather.site, pressure=pressure, temperature=temperature)
    up = sun.direction[:, 2].reshape(-1, parts) > 0
    count = up.sum(axis=1, keepdims=True)
    share = np.where(count > 0, up * parts / np.maximum(count, 1), 1.0).ravel()
    return replace(
        weather,
        times=times,
        hours=each(weather.hours) / parts,
        global_horizontal=each(weather.global_horizontal),
        direct_normal=each(weather.direct_normal) * share,
        diffuse_horizontal=each(weather.diffuse_horizontal),
        temperature=temperature,
        dew_point=each(weather.dew_point),
        pressure=pressure,
    )


def sources_of(
    weather: Weather,
    site: Site,
    period: Period,
    *,
    subdivision: int = 2,
    accuracy: float = 1.0,
    ground_reflectance: float = 0.2,
) -> Sources:
    """The light of a ``period``, from suns merged to ``accuracy`` in deg and a sky of patches.

    The ground is a level plane that is lit as in an open field and returns its share of that as
    Lambert's law has it; without a share there are no directions to it.

    Raises ParameterError as `selected`, `hourly_skies`, `patches_of` and `merged_suns` do.
    """
    if not 0 <= ground_reflectance <= 1:
        raise ParameterError(
            f"The ground returns a share of 0 to 1 of the light, not {ground_reflectance:g}."
        )
    mask = selected(weather, period, site)
    hourly = hourly_skies(weather, site, "radiation", mask)
    energy = hourly.direct * hourly.hours / 1000
    suns = merged_suns(hourly.sun, energy, accuracy)
    assert suns.weights is not None
    patches = patches_of(subdivision)
    sky = np.zeros(len(patches.directions))
    for which, block in matrix_blocks(hourly, patches, "none"):
        sky += hourly.hours[which] @ block
    below, ground = _ground() if ground_reflectance else (np.zeros((0, 3)), np.zeros(0))
    returned = ground_radiance(hourly, ground_reflectance)
    parts = (len(suns.directions), len(sky), len(ground))
    none = [np.zeros(count) for count in parts]
    off_ground = ground * float(hourly.hours @ returned)
    return Sources(
        directions=to_model(np.concatenate([suns.directions, patches.directions, below]), site),
        direct=np.concatenate([suns.weights @ energy, *none[1:]]),
        diffuse=np.concatenate([none[0], sky * patches.solid_angles, off_ground]) / 1000,
        hours=np.concatenate([suns.weights @ hourly.hours, *none[1:]]),
        suns=suns,
        patches=patches,
        ground=ground,
        hourly=hourly,
        times=weather.times[mask],
        ground_radiance=returned,
        site=site,
        source=weather.source,
        notes=(
            *weather.notes,
            *season_notes(period, site),
            *hourly.notes,
            *_notes(suns, ground_reflectance),
        ),
    )


def _ground() -> tuple[Vector, Vector]:
    """Directions (G, 3) below the horizon and their solid angles, which light a ceiling exactly."""
    patches = patches_of(GROUND)
    projected = float(patches.solid_angles @ patches.directions[:, 2])
    return patches.directions * [1, 1, -1], patches.solid_angles * np.pi / projected


def _notes(suns: Suns, reflectance: float) -> list[str]:
    notes = []
    assert suns.weights is not None
    many, few = suns.weights.nnz, len(suns.directions)
    if few < many:
        notes.append(
            f"{many:,} suns are merged into {few:,} directions, none farther than "
            f"{np.degrees(suns.accuracy):.2g}° from where the sun is."
        )
    if reflectance:
        notes.append(
            f"The ground is level, returns {100 * reflectance:g} % of the light evenly and is "
            "nowhere shaded."
        )
    return notes
