"""Photon tracing as an analysis: its parameters, when it stops, and what it hands back."""

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import VERSION
from ..core import runtime, solid
from ..core.errors import SceneError
from ..core.parameters import param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Body, Receiver, Scene
from . import interval
from .irradiance import IrradianceMap
from .luminaires import Source, source

if TYPE_CHECKING:
    from .photons import Landing

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
        0.25, "", 0.005, 1.0, "95 % half-width ÷ mean of the traced light, over texels above 5 %"
    )
    landed: int = param(1_000_000, "", 1000, 200_000_000, "Photons to land on the receiver")
    seconds: float = param(30.0, "s", 0.1, 86400.0, "Time to trace for")
    fresnel: Literal["averaged", "polarised"] = param(
        "averaged",
        help="Reflectance averaged over polarisations at each surface as Radiance does, or exact "
        "(about 5 % slower)",
    )
    direct: Literal["computed", "traced"] = param(
        "computed", help="Light that meets no body: closed form with shadow rays, or by photons too"
    )
    repair: bool = param(False, help="Mend open or inside-out glass before tracing")


@dataclass(slots=True)
class Tally:
    """What has landed where, in float64; its memory does not grow with the photons.

    Every photon is counted with the whole flux it stands for: divide by ``emitted`` for lm.
    """

    texels: int
    routes: NDArray[np.float64] = field(init=False)
    square: NDArray[np.float64] = field(init=False)
    flux: dict[str, float] = field(init=False)
    direct_by_photons: float = 0.0
    traced: float = 0.0
    emitted: int = 0
    landed: int = 0

    def __post_init__(self) -> None:
        self.routes = np.zeros((3, self.texels))
        self.square = np.zeros(self.texels)
        self.flux = dict.fromkeys(("landed", "absorbed", "escaped", "cut_off"), 0.0)

    def total(self, count_direct: bool) -> NDArray[np.float64]:
        """Sum over photons, a texel (T,) in lm, not yet divided by their number."""
        return self.routes.sum(axis=0) if count_direct else self.routes[1:].sum(axis=0)


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
    shape = (receiver.rows, receiver.columns)
    everything = tracing.direct == "traced"
    light = np.zeros(shape), np.zeros(shape)
    if not everything:
        for index, lamp in enumerate(sources):
            progress(0.1, f"Direct light of “{lamp.name}”")
            value, spread = direct.direct_light(staged, receiver, lamp, (seed, index))
            light = light[0] + value, np.hypot(light[1], spread)
    progress(0.2, "Aiming at the glass")
    emissions = [emission.emission(s, staged, everywhere=everything) for s in sources]
    emissions = [e for e in emissions if e.flux.sum() > 0]
    tally = Tally(receiver.rows * receiver.columns)
    error = 0.0
    if emissions and (scene.bodies or everything):
        plane = photons.Plane(receiver, staged)
        emitters = [emission.Emitter(e, staged) for e in emissions]
        error = _batches(
            tally, staged, plane, emitters, tracing, shape, seed, part(progress, 0.2, 1.0), notes
        )
    elif not scene.bodies:
        notes.append("There is no glass or other body in the scene: direct light only.")
    else:
        notes.append("No light of the lamps can meet a body: direct light only.")
    return _result(
        tally, light, receiver, sources, tracing, error, seed, notes, time.perf_counter() - started
    )


def _receiver(scene: Scene) -> Receiver:
    if not scene.receivers:
        raise SceneError("There is no receiver to trace onto; add one in Heliform › Light.")
    if len(scene.receivers) > 1:
        names = ", ".join(f"“{r.name}”" for r in scene.receivers)
        raise SceneError(f"There is more than one receiver ({names}); switch off all but one.")
    return scene.receivers[0]


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
    staged: Any,
    plane: Any,
    emitters: list[Any],
    tracing: PhotonTracing,
    shape: tuple[int, int],
    seed: int,
    progress: Progress,
    notes: list[str],
) -> float:
    """Trace batch after batch until there is enough; returns the error reached."""
    from . import photons

    share = np.array([e.emission.flux.sum() for e in emitters])
    share /= share.sum()
    polarised = tracing.fresnel == "polarised"
    everything = tracing.direct == "traced"
    began = time.perf_counter()
    count, batch, error, said = PILOT, 0, float("inf"), "Compiling"
    while True:
        progress(_fraction(tally, tracing, error, time.perf_counter() - began), said)
        sent = np.random.default_rng((seed, batch)).multinomial(count, share)
        for index, emitter in enumerate(emitters):
            if sent[index]:
                key = (seed, batch, index)
                landing = photons.trace_batch(
                    staged, plane, emitter, int(sent[index]), polarised, key
                )
                _add(tally, landing, share[index], shape, everything)
        batch += 1
        elapsed = time.perf_counter() - began
        error = interval.error(tally.total(everything), tally.square)
        said = f"{tally.emitted / 1e6:.1f} M photons, {tally.landed / 1e6:.1f} M landed"
        said += f", error {100 * error:.0f} %" if np.isfinite(error) else ""
        if tally.landed == 0 and batch >= HOPELESS:
            notes.append("None of the photons landed on the receiver: no caustic light.")
            return 0.0
        if _enough(tally, tracing, error, elapsed):
            return error
        count = _next(tally, tracing, error, elapsed)


def _enough(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> bool:
    match tracing.until:
        case "error":
            return error <= tracing.error
        case "landed":
            return tally.landed >= tracing.landed
        case "time":
            return elapsed >= tracing.seconds


def _ratio(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> float:
    """How many times the photons so far are needed in all."""
    match tracing.until:
        case "error":
            return (error / tracing.error) ** 2
        case "landed":
            return tracing.landed / max(tally.landed, 1)
        case "time":
            return tracing.seconds / elapsed


def _fraction(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> float:
    if tally.emitted == 0:
        return 0.0
    ratio = _ratio(tally, tracing, error, elapsed)
    return 1.0 / ratio if ratio > 1.0 else 1.0


def _next(tally: Tally, tracing: PhotonTracing, error: float, elapsed: float) -> int:
    """The next batch: what is still missing, between SMALLEST and BATCH."""
    missing = tally.emitted * (_ratio(tally, tracing, error, elapsed) - 1.0)
    return int(np.clip(1.02 * missing, SMALLEST, BATCH))


def _add(
    tally: Tally, landing: "Landing", share: float, shape: tuple[int, int], everything: bool
) -> None:
    """Sum a batch of the luminaire that sends this ``share`` of all photons into the tally."""
    from . import photons

    weight = landing.weight.astype(np.float64) / share
    gained = float(landing.gained.sum(dtype=np.float64)) / share
    for name in tally.flux:
        tally.flux[name] += float(weight[landing.fate == photons.FATES[name]].sum())
    tally.flux["cut_off"] -= gained
    tally.traced += float(weight.sum()) - gained
    tally.emitted += len(weight)
    on = landing.fate == photons.FATES["landed"]
    route = landing.route[on]
    if not everything:
        straight = route == photons.DIRECT
        tally.direct_by_photons += float(weight[on][straight].sum())
        on[on] = ~straight
        route = route[~straight]
    rows, columns = shape
    column = np.minimum((landing.u[on] * columns).astype(np.int64), columns - 1)
    row = np.minimum((landing.v[on] * rows).astype(np.int64), rows - 1)
    texel, weight = row * columns + column, weight[on]
    for index, total in enumerate(tally.routes):
        chosen = route == index
        if chosen.any():
            total += np.bincount(texel[chosen], weight[chosen], tally.texels)
    tally.square += np.bincount(texel, weight * weight, tally.texels)
    tally.landed += len(texel)


def _result(
    tally: Tally,
    light: tuple[NDArray[np.float64], NDArray[np.float64]],
    receiver: Receiver,
    sources: list[Source],
    tracing: PhotonTracing,
    error: float,
    seed: int,
    notes: list[str],
    seconds: float,
) -> IrradianceMap:
    """Sums to illuminance, the interval, and the account of the flux."""
    shape, area = light[0].shape, receiver.texel_area
    everything = tracing.direct == "traced"
    lux = 1.0 / (area * max(tally.emitted, 1))
    direct, caustic, indirect = (r.reshape(shape) * lux for r in tally.routes)
    direct = direct + light[0]
    total = tally.total(everything)
    low, high = (b.reshape(shape) * lux for b in interval.interval(total, tally.square))
    traced = total.reshape(shape) * lux
    illuminance = direct + caustic + indirect
    lower = illuminance - np.hypot(traced - low, light[1])
    upper = illuminance + np.hypot(high - traced, light[1])
    flux = _account(tally, float(light[0].sum()) * area, sum(s.flux for s in sources), everything)
    mean_spread = interval.Z * np.sqrt(tally.square.sum()) * lux / illuminance.size
    maps = (illuminance, direct, caustic, indirect, (upper - lower) / 2, lower, upper)
    return IrradianceMap(
        *(m.astype(np.float32) for m in maps),
        meta={
            "quantity": "Illuminance",
            "unit": "lx",
            "receiver": receiver.name,
            "size": [float(np.linalg.norm(receiver.u)), float(np.linalg.norm(receiver.v))],
            "parameters": to_table(tracing),
            "seed": seed,
            "version": VERSION,
            "backend": runtime.choose().backend,
            "error": error,
            "mean_half_width": float(np.hypot(mean_spread, light[1].mean())),
            "photons": {"emitted": tally.emitted, "landed": tally.landed},
            "flux": flux,
            "seconds": seconds,
            "notes": notes,
        },
    )


def _account(tally: Tally, computed: float, emitted: float, everything: bool) -> dict[str, float]:
    """Where the luminaires' flux in lm went.

    With direct light traced every photon is followed and the parts are counted one by one. With it
    computed, light that was not aimed lands as the direct map says, and the rest of it escapes.
    """
    flux = {name: value / max(tally.emitted, 1) for name, value in tally.flux.items()}
    if not everything:
        traced = tally.traced / max(tally.emitted, 1)
        seen = computed - tally.direct_by_photons / max(tally.emitted, 1)
        flux["landed"] += seen
        flux["escaped"] += emitted - traced - seen
    return {"emitted": emitted, **flux}
