"""Photon tracing as an analysis: its parameters, when it stops, and what it hands back."""

import time
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import VERSION
from ..core import runtime, solid
from ..core.errors import SceneError
from ..core.parameters import param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Body, Receiver, Scene
from . import interval, kernel
from .irradiance import IrradianceMap
from .luminaires import source
from .tally import Tally

BATCH = 1 << 20
SMALLEST = 1 << 16
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
        "(about 6 % slower)",
    )
    direct: Literal["computed", "traced"] = param(
        "computed", help="Light that meets no body: closed form with shadow rays, or by photons too"
    )
    kernel: Literal["adaptive", "none"] = param(
        "adaptive", help="Smooth map beside the texel means: gathered photons, or no smoothing"
    )
    repair: bool = param(False, help="Mend open or inside-out glass before tracing")


def trace(
    scene: Scene, tracing: PhotonTracing, *, seed: int = 0, progress: Progress = SILENT
) -> IrradianceMap:
    """Illuminance on the scene's receiver by photon tracing.

    Photons leave the luminaires toward the bodies, refract and reflect until they land on the
    receiver, escape or are absorbed. Texel means are unfiltered and unbiased [Jensen, Realistic
    Image Synthesis Using Photon Mapping, 2001, ch. 2]; the interval is `interval.interval`.

    The receiver is opaque and black: light that lands does not go on.

    Raises SceneError when a lamp or a receiver is missing or a glass is open, FileError for a
    photometric file that cannot be read, RuntimeMissing where Mitsuba cannot run, Cancelled when
    ``progress`` is asked to stop.
    """
    started = time.perf_counter()
    receiver = _receiver(scene)
    if not scene.luminaires:
        raise SceneError("There is no lamp to trace from; add one in Heliform › Light.")
    notes: list[str] = []
    progress(0.0, "Reading lamps")
    sources = [source(luminaire) for luminaire in scene.luminaires]
    if tracing.repair:
        scene = _repaired(scene, notes)
    progress(0.02, "Starting Mitsuba")
    runtime.mitsuba()
    from . import direct, emission, photons, stage

    progress(0.05, "Building the scene")
    staged = stage.build(scene)
    everything = tracing.direct == "traced"
    light = np.zeros((2, receiver.rows, receiver.columns))
    if not everything:
        for index, lamp in enumerate(sources):
            progress(0.1, f"Direct light of “{lamp.name}”")
            value, spread = direct.direct_light(staged, receiver, lamp, (seed, index))
            light = light[0] + value, np.hypot(light[1], spread)
    progress(0.2, "Aiming at the glass")
    emissions = [emission.emission(s, staged, everywhere=everything) for s in sources]
    emitters = [emission.Emitter(e, staged) for e in emissions if e.aimed > 0]
    tally = Tally(receiver.rows, receiver.columns, everything)
    error = 0.0
    if emitters:
        tracer = staged, photons.Plane(receiver, staged)
        share = part(progress, 0.2, 1.0)
        error = _batches(tally, tracer, emitters, tracing, seed, share, notes)
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
        "seconds": time.perf_counter() - started,
        "notes": notes,
    }
    return _result(tally, (light[0], light[1]), receiver, meta, sum(s.flux for s in sources))


def _receiver(scene: Scene) -> Receiver:
    match scene.receivers:
        case ():
            raise SceneError("There is no receiver to trace onto; add one in Heliform › Light.")
        case (receiver,):
            return receiver
    names = ", ".join(f"“{r.name}”" for r in scene.receivers)
    raise SceneError(f"There is more than one receiver ({names}); switch off all but one.")


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
    scene: Any,
    emitters: list[Any],
    tracing: PhotonTracing,
    seed: int,
    progress: Progress,
    notes: list[str],
) -> float | None:
    """Trace batch after batch until there is enough; the error reached, None without a landing."""
    from . import photons

    staged, plane = scene
    share = np.array([e.emission.aimed for e in emitters])
    share /= share.sum()
    polarised = tracing.fresnel == "polarised"
    began = time.perf_counter()
    count, batch = PILOT, 0
    progress(0.0, "Compiling")
    while True:
        sent = np.random.default_rng((0, seed, batch)).multinomial(count, share)
        for index in np.flatnonzero(sent):
            key = (seed, batch, int(index))
            landing = photons.trace_batch(
                staged, plane, emitters[index], int(sent[index]), polarised, key
            )
            tally.add(landing, share[index])
        batch += 1
        error = interval.error(tally.total, tally.square)
        elapsed = time.perf_counter() - began
        more = _times_more(tally, tracing, error, elapsed)
        if more <= 1.0 or (tally.landed == 0 and batch >= HOPELESS):
            break
        if elapsed > tracing.at_most:
            notes.append(f"Stopped after {elapsed:.0f} s, before what was asked was reached.")
            break
        progress(1.0 / more, _said(tally, error))
        count = int(np.clip(1.02 * tally.emitted * (more - 1.0), SMALLEST, BATCH))
    if tally.landed == 0:
        notes.append(
            f"None of {tally.emitted:,} photons landed on the receiver: no caustic light is known, "
            "only its upper bound."
        )
        return None
    return error


def _times_more(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> float:
    """How many times the photons so far are needed in all; 1 or less is enough."""
    match tracing.until:
        case "error":
            return (error / tracing.error) ** 2
        case "landed":
            return tracing.landed / max(tally.landed, 1)
        case "time":
            return tracing.seconds / elapsed


def _said(tally: Tally, error: float) -> str:
    counts = f"{tally.emitted / 1e6:.1f} M photons, {tally.landed / 1e6:.1f} M landed"
    return f"{counts}, error {100 * error:.0f} %" if np.isfinite(error) else counts


def _result(
    tally: Tally,
    light: tuple[NDArray[np.float64], NDArray[np.float64]],
    receiver: Receiver,
    meta: dict[str, Any],
    emitted: float,
) -> IrradianceMap:
    """Sums to illuminance, the interval, and the account of the flux."""
    computed, spread = light
    area = receiver.texel_area
    lux = tally.per_photon(1.0) / area
    direct, caustic, indirect = (r.reshape(computed.shape) * lux for r in tally.routes)
    direct = direct + computed
    illuminance = direct + caustic + indirect
    total = tally.total.reshape(computed.shape) * lux
    low, high = (
        b.reshape(computed.shape) * lux
        for b in interval.interval(tally.total, tally.square, tally.typical)
    )
    lower = illuminance - np.hypot(total - low, spread)
    upper = illuminance + np.hypot(high - total, spread)
    traced_spread = interval.Z * np.sqrt(tally.square.sum()) * lux / illuminance.size
    shadow_spread = np.sqrt(np.square(spread).sum()) / illuminance.size
    half_width = (upper - lower) / 2
    smooth = illuminance, half_width, np.zeros_like(total)
    if meta["parameters"]["kernel"] == "adaptive":
        found = kernel.smoothed(*(s.reshape(computed.shape) for s in (tally.total, tally.square)))
        noise = np.hypot(found.half_width * lux, spread)
        smooth = illuminance - total + found.value * lux, noise, found.bias * lux
        meta["gathered"] = found.gathered
    maps = (illuminance, direct, caustic, indirect, half_width, lower, upper, *smooth)
    return IrradianceMap(
        *(m.astype(np.float32) for m in maps),
        meta={
            "quantity": "Illuminance",
            "unit": "lx",
            "receiver": receiver.name,
            "size": [float(np.linalg.norm(receiver.u)), float(np.linalg.norm(receiver.v))],
            "mean_half_width": float(np.hypot(traced_spread, shadow_spread)),
            "traced_half_width": float(traced_spread),
            "photons": {"emitted": tally.emitted, "landed": tally.landed},
            "flux": tally.account(emitted, float(computed.sum()) * area),
            **meta,
        },
    )
