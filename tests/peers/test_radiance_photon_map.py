"""The tube of Table 1 in Radiance and here: obj2mesh, oconv, mkpmap -apc, pmapdump, rtrace -I.

Radiance's stored photons are compared block by block, where statistics alone set the tolerance.
The map that rtrace reads from them is compared by its mean: its density estimate from the k
nearest photons blurs the rings and does not preserve flux, it reads 1 to 2 % high here.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from heliform.engines.light import PhotonTracing
from heliform.engines.light.ies import sample_path

pytest.importorskip("pyradiance")

from light.scenes import traced
from peers import radiance, tube

pytestmark = [pytest.mark.peer, pytest.mark.slow]

BLOCKS, POINTS, BANDWIDTH = 64, 256, 50
SEEDS, PHOTONS, LANDED = (1, 2, 3), 200_000, 4_000_000
ROUNDING = 0.01
"""Allowed beside chance: mkpmap stores flux in 8 bits (0.4 %) and cuts the lamp into cells."""


@dataclass
class Peer:
    """What Radiance found for each seed: photons a block, lm of one, rtrace's map in lx."""

    counts: np.ndarray
    photon: np.ndarray
    maps: np.ndarray


@pytest.fixture(scope="module")
def mesh():
    return tube.tube()


@pytest.fixture(scope="module")
def peer(mesh, tmp_path_factory):
    folder = tmp_path_factory.mktemp("radiance")
    receiver = tube.scene(mesh, POINTS).receivers[0]
    radiance.write_obj(folder / "glass.obj", mesh)
    radiance.describe(folder, sample_path(), tube.LAMP, receiver, tube.IOR)
    radiance.build(folder)
    rays = radiance.points(receiver, POINTS, POINTS)
    counts, photon, maps = [], [], []
    for seed in SEEDS:
        radiance.caustic_map(folder, PHOTONS, seed)
        count, flux = radiance.stored_photons(folder, receiver, BLOCKS)
        counts.append(count)
        photon.append(flux)
        maps.append(radiance.caustic(folder, rays, (POINTS, POINTS), (BANDWIDTH,)))
    return Peer(np.array(counts), np.array(photon), np.array(maps))


def ours(mesh, ior=tube.IOR):
    """Caustic flux a block in lm, and that of one photon."""
    scene = tube.scene(mesh, BLOCKS, ior)
    settings = PhotonTracing(until="landed", landed=LANDED, fresnel="averaged")
    result = traced(scene, settings, seed=11)
    flux = result.caustic.astype(np.float64) * scene.receivers[0].texel_area
    return flux, flux.sum() / result.meta["photons"]["landed"]


@pytest.fixture(scope="module")
def found(mesh):
    return ours(mesh)


def deviations(found, peer):
    """(mean of the seeds − ours) ÷ its standard deviation, over blocks above 5 % of the mean."""
    flux, photon = found
    theirs = (peer.counts * peer.photon[:, None, None]).mean(axis=0)
    bright = flux > 0.05 * flux.mean()
    flux, theirs = flux[bright], theirs[bright]
    variance = flux * (peer.photon.mean() / len(SEEDS) + photon) + (ROUNDING * flux) ** 2
    return (theirs - flux) / np.sqrt(variance)


def test_the_seeds_of_radiance_scatter_as_poisson_says(found, peer):
    """So that the Poisson variance below may stand for their spread, which three seeds say badly.

    The ratio of the two over 4000 blocks has a standard deviation of 2 %.
    """
    expected = found[0] / peer.photon.mean()
    bright = found[0] > 0.05 * found[0].mean()
    ratio = peer.counts.var(axis=0, ddof=1)[bright] / expected[bright]
    assert ratio.mean() == pytest.approx(1.0, abs=0.08)


def test_the_caustic_flux_is_radiances(found, peer):
    """600,000 photons leave 0.2 % to chance."""
    flux = (peer.counts.sum(axis=(1, 2)) * peer.photon).mean()
    assert flux == pytest.approx(found[0].sum(), rel=ROUNDING)


def test_the_mean_of_rtraces_map_is_ours(found, peer):
    mean = found[0].sum() / tube.PLANE**2
    assert peer.maps.mean() == pytest.approx(mean, rel=0.03)


def test_the_maps_agree_within_their_scatter(found, peer):
    """Of 4000 blocks 95 % should lie within 1.96 deviations, give or take 0.5 % by chance.

    A per cent less is allowed because the lamps differ: Radiance sends a disk's photons from the
    square of its area. An index of refraction of 1.45 gives 78 %.
    """
    z = deviations(found, peer)
    assert np.mean(np.abs(z) < 1.96) > 0.925
    assert abs(z.mean()) < 0.15


def test_a_glass_of_another_index_does_not_agree(mesh, peer):
    """The comparison can fail: ior 1.45 in place of 1.5 moves the rings."""
    z = deviations(ours(mesh, ior=1.45), peer)
    assert np.mean(np.abs(z) < 1.96) < 0.85
