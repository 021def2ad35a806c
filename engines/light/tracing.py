"""Photon tracing as an analysis: its parameters, when it stops, and what it hands back."""

import hashlib
import os
import tempfile
import time
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .. import VERSION
from ..core import runtime, solid
from ..core.errors import SceneError
from ..core.parameters import param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Body, Scene
from . import finish, interval, spectrum
from .grid import Grid, grid_of
from .irradiance import Irradiance
from .luminaires import Source, source
from .media import require_outside
from .tally import Tally

BATCH = 1 << 20
SMALLEST, FEWEST = 1 << 16, 1 << 10
"""Photons of the smallest batch: less costs as much; and where their count is what is asked."""
PILOT = 1 << 17
HOPELESS = 16
"""Batches after which a scene in which nothing lands is given up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PhotonTracing:
    """How photons are traced, and when there are enough."""

    until: Literal["error", "landed", "time"] = param(
        "error", help="Stop at the asked error, at a count of landed photons, or after a time"
    )
    error: float = param(
        0.5, "", 0.005, 1.0, "95 % half-width ÷ mean of the traced light, over texels above 5 %"
    )
    landed: int = param(1_000_000, "", 1000, 200_000_000, "Photons to land on the receiver")
    seconds: float = param(30.0, "s", 0.1, 86400.0, "Time to trace for")
    at_most: float = param(
        3600.0, "s", 1.0, 604800.0, "Stop after this time in any case, with what was reached"
    )
    fresnel: Literal["averaged", "polarised"] = param(
        "averaged",
        help="Reflectance averaged over polarisations at each surface as Radiance does, or exact "
        "(6 to 8 % slower)",
    )
    direct: Literal["computed", "traced"] = param(
        "computed", help="Light that meets no body: closed form with shadow rays, or by photons too"
    )
    kernel: Literal["adaptive", "none"] = param(
        "adaptive", help="Smooth map beside the texel means: gathered photons, or no smoothing"
    )
    colour: Literal["none", "equal-energy", "incandescent", "daylight", "led"] = param(
        "none", help="Trace colours, with glass that disperses, in this spectrum of all lamps"
    )
    keep_sums: bool = param(
        False, help="Keep the sums of the photons beside the result, to add more photons later"
    )
    repair: bool = param(False, help="Mend open or inside-out glass before tracing")


def trace(
    scene: Scene,
    tracing: PhotonTracing,
    *,
    seed: int = 0,
    progress: Progress = SILENT,
    sums: Path | None = None,
) -> Irradiance:
    """Illuminance on the scene's receivers by photon tracing.

    Photons leave the luminaires toward the bodies, refract and reflect until they land on a
    receiver, escape or are absorbed. Texel means are unfiltered and unbiased [Jensen, Realistic
    Image Synthesis Using Photon Mapping, 2001, ch. 2]; the interval is `interval.interval`.

    Light that a receiver returns goes on. ``sums`` is a file of sums that an earlier result of the
    same scene kept (`Irradiance.sums`): its photons count, and new ones are added to them, the same
    ones that a longer run would have traced.

    Raises SceneError when a lamp or a receiver is missing, a glass is open, or the sums are of
    another scene, FileError for a photometric file or sums that cannot be read, RuntimeMissing
    where Mitsuba cannot run, Cancelled when ``progress`` is asked to stop.
    """
    started = time.perf_counter()
    if not scene.receivers:
        raise SceneError("There is no receiver to trace onto; add one in Heliform › Light.")
    if not scene.luminaires:
        raise SceneError("There is no lamp to trace from; add one in Heliform › Light.")
    notes: list[str] = []
    progress(0.0, "Reading lamps")
    sources = [source(luminaire) for luminaire in scene.luminaires]
    notes += [note for lamp in sources for note in lamp.notes]
    grid = grid_of(scene)
    key = _key(scene, sources, tracing, seed) if tracing.keep_sums or sums else ""
    bands = None
    if tracing.colour != "none":
        bands = spectrum.Bands(spectrum.spectrum(tracing.colour))
    everything = tracing.direct == "traced"
    tally = Tally(grid.area.size, everything, bands.table() if bands else None)
    if sums and not tally.load(sums, key):
        raise SceneError("The scene has changed since it was traced; trace it anew.")
    if tracing.repair:
        scene = _repaired(scene, notes)
    require_outside(scene.luminaires, scene.bodies)
    progress(0.02, "Starting Mitsuba")
    runtime.mitsuba()
    from . import emission, stage

    progress(0.05, "Building the scene")
    staged = stage.build(scene, None if tally.bands is None else tally.bands[:, 0])
    light = np.zeros(grid.area.size), np.zeros(grid.area.size)
    if not everything:
        light = _direct_light(staged, grid, sources, seed, progress)
    progress(0.2, "Aiming at the glass")
    emissions = [emission.emission(s, staged, everywhere=everything) for s in sources]
    emitters = [emission.Emitter(e, staged) for e in emissions if e.aimed > 0]
    error: float | None = 0.0
    if emitters:
        share = part(progress, 0.2, 1.0)
        error = _batches(tally, grid, staged, emitters, tracing, seed, share, notes)
    elif not scene.bodies:
        notes.append("There is no glass or other body in the scene: direct light only.")
    else:
        notes.append("No light of the lamps can meet a body: direct light only.")
    meta = {
        "parameters": to_table(tracing),
        "seed": seed,
        "version": VERSION,
        "backend": runtime.choose().backend,
        "error": error,
        "photons": {"emitted": tally.emitted, "landed": tally.landed},
        "flux": tally.account(sum(s.flux for s in sources), grid.staying(light[0])),
        "seconds": time.perf_counter() - started,
        "notes": notes,
    }
    white = bands.white if bands else None
    maps = finish.maps_of(tally, grid, light, white, tracing.kernel == "adaptive", meta)
    return Irradiance(maps, meta, _kept(tally, key) if tracing.keep_sums or sums else None)


def _direct_light(
    staged: Any, grid: Grid, sources: list[Source], seed: int, progress: Progress
) -> finish.Light:
    """Direct light of all lamps on all texels (T,) in lx, and its 95 % half-width."""
    from . import direct

    light, doubt = np.zeros(grid.area.size), np.zeros(grid.area.size)
    for index, lamp in enumerate(sources):
        progress(0.1, f"Direct light of “{lamp.name}”")
        for number, (side, chart) in enumerate(zip(grid.sides, grid.charts, strict=True)):
            value, spread = direct.direct_light(staged, side, chart, lamp, (seed, index, number))
            light[side.texels] += value.ravel()
            doubt[side.texels] = np.hypot(doubt[side.texels], spread.ravel())
    return light, doubt


def _key(scene: Scene, sources: list[Source], tracing: PhotonTracing, seed: int) -> str:
    """What sums of photons are sums of: the scene, the physics and the random numbers."""
    digest = hashlib.sha256()
    physics = {n: getattr(tracing, n) for n in ("fresnel", "direct", "colour", "repair")}
    digest.update(repr((seed, physics, VERSION)).encode())
    for thing in (*scene.bodies, *map(_told, sources), *scene.receivers):
        _fed(digest, thing)
    return digest.hexdigest()


def _told(lamp: Source) -> Source:
    """A lamp by the light that it gives: its file may lie elsewhere, under another name."""
    light = lamp.distribution
    if light is not None:
        light = replace(light, name="", keywords={}, notes=())
    return replace(lamp, distribution=light, notes=())


def _fed(digest: Any, thing: Any) -> None:
    """Add all that a record of the scene holds to a digest."""
    for item in fields(thing):
        value = getattr(thing, item.name)
        if is_dataclass(value):
            _fed(digest, value)
        elif isinstance(value, np.ndarray):
            digest.update(np.ascontiguousarray(value).tobytes())
        else:
            digest.update(repr(value).encode())


def _kept(tally: Tally, key: str) -> Path:
    """The sums in a file that `Irradiance.save` moves to its place."""
    handle, path = tempfile.mkstemp(prefix="heliform-", suffix=".npz")
    os.close(handle)
    tally.save(Path(path), key)
    return Path(path)


def _repaired(scene: Scene, notes: list[str]) -> Scene:
    bodies = []
    for body in scene.bodies:
        mesh = body.mesh
        if body.material.kind == "dielectric" and solid.inspect(mesh).problem:
            mesh, done = solid.repair(mesh)
            notes.extend(f"“{body.name}”: {step}" for step in done)
        bodies.append(Body(body.name, mesh, body.material))
    return Scene(tuple(bodies), scene.luminaires, scene.receivers)


def _batches(
    tally: Tally,
    grid: Grid,
    staged: Any,
    emitters: list[Any],
    tracing: PhotonTracing,
    seed: int,
    progress: Progress,
    notes: list[str],
) -> float | None:
    """Trace batch after batch until there is enough; the error reached, None without a landing."""
    from . import photons

    share = np.array([e.emission.aimed for e in emitters])
    share /= share.sum()
    polarised = tracing.fresnel == "polarised"
    began = time.perf_counter()
    progress(0.0, "Compiling")
    error = _error(tally, grid)
    if tally.emitted == 0:
        count = min(PILOT, tracing.landed) if tracing.until == "landed" else PILOT
    else:
        count = _next(tally, tracing, _times_more(tally, tracing, error, 0.0))
    while count:
        sent = np.random.default_rng((0, seed, tally.batches)).multinomial(count, share)
        for index in np.flatnonzero(sent):
            key = (seed, tally.batches, int(index))
            landing = photons.trace_batch(staged, emitters[index], int(sent[index]), polarised, key)
            tally.add(landing, share[index])
        tally.batches += 1
        error = _error(tally, grid)
        elapsed = time.perf_counter() - began
        more = _times_more(tally, tracing, error, elapsed)
        if more <= 1.0 or (tally.landed == 0 and tally.batches >= HOPELESS):
            break
        if elapsed > tracing.at_most:
            notes.append(f"Stopped after {elapsed:.0f} s, before what was asked was reached.")
            break
        progress(1.0 / more, _said(tally, error))
        count = _next(tally, tracing, more)
    if tally.landed == 0:
        notes.append(
            f"None of {tally.emitted:,} photons landed on a receiver: no caustic light is known, "
            "only its upper bound."
        )
        return None
    return error


def _error(tally: Tally, grid: Grid) -> float:
    return interval.error(grid.gathered(tally.total), grid.gathered(tally.square), grid.area)


def _next(tally: Tally, tracing: PhotonTracing, more: float) -> int:
    """How many photons to send next, when ``more`` times those so far are needed in all."""
    if more <= 1.0:
        return 0
    least = FEWEST if tracing.until == "landed" else SMALLEST
    return int(np.clip(1.02 * tally.emitted * (more - 1.0), least, BATCH))


def _times_more(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> float:
    """How many times the photons so far are needed in all; 1 or less is enough."""
    match tracing.until:
        case "error":
            return (error / tracing.error) ** 2
        case "landed":
            return tracing.landed / max(tally.landed, 1)
        case "time":
            return tracing.seconds / max(elapsed, 1e-9)


def _said(tally: Tally, error: float) -> str:
    counts = f"{tally.emitted / 1e6:.1f} M photons, {tally.landed / 1e6:.1f} M landed"
    return f"{counts}, error {100 * error:.0f} %" if np.isfinite(error) else counts
