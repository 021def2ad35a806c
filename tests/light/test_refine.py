"""Going on from kept sums: what adds up, what repeats, and what is refused."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import Cancelled, FileError, SceneError
from heliform.engines.core.scene import Body, Material, Scene
from heliform.engines.light import Irradiance, PhotonTracing, trace
from light import scenes

BALL = scenes.glass(scenes.sphere(0.02, 4))
LAMP = scenes.lambertian_point(1000.0, 0.15)
FLOOR = scenes.floor(0.08, 24, scenes.at(z=-0.03))
SCENE = Scene((BALL,), (LAMP,), (FLOOR,))
FIRST = PhotonTracing(until="landed", landed=60_000, keep_sums=True)
TWICE = replace(FIRST, landed=120_000)


@pytest.fixture
def kept(tmp_path):
    """A first run's result and the file of its sums."""
    result = trace(SCENE, FIRST, seed=5)
    result.save(tmp_path)
    return result, tmp_path / "sums.npz"


def maps_equal(one, other):
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for a, b in zip(one.maps, other.maps, strict=True)
        for name in ("illuminance", "caustic", "half_width", "lower", "upper", "smooth")
    )


def test_the_sums_go_with_the_result(kept, tmp_path):
    result, sums = kept
    assert sums.exists()
    assert Irradiance.load(tmp_path).sums == sums
    assert not result.sums.exists()  # moved, not copied
    plain = trace(SCENE, replace(FIRST, keep_sums=False), seed=5)
    assert plain.sums is None
    np.testing.assert_array_equal(plain.maps[0].illuminance, result.maps[0].illuminance)


def test_going_on_adds_to_what_was_there(kept):
    first, sums = kept
    before = sums.read_bytes()
    more = trace(SCENE, TWICE, seed=5, sums=sums)
    assert sums.read_bytes() == before
    counts = [r.meta["photons"] for r in (first, more)]
    assert counts[1]["landed"] >= 120_000
    assert counts[1]["emitted"] > counts[0]["emitted"]
    assert counts[1]["landed"] / counts[1]["emitted"] == pytest.approx(
        counts[0]["landed"] / counts[0]["emitted"], rel=0.02
    )
    # Photons of the first run are among those of the second: what it saw stays.
    share = counts[0]["emitted"] / counts[1]["emitted"]
    assert (more.maps[0].caustic >= first.maps[0].caustic * share * (1 - 1e-5)).all()
    flux = more.meta["flux"]
    parts = sum(flux[k] for k in ("landed", "absorbed", "escaped", "cut_off"))
    assert parts == pytest.approx(flux["emitted"], rel=1e-4)


def test_going_on_twice_from_the_same_file_is_the_same(kept):
    _, sums = kept
    one, other = (trace(SCENE, TWICE, seed=5, sums=sums) for _ in range(2))
    assert one.meta["photons"] == other.meta["photons"]
    assert maps_equal(one, other)


def test_in_two_steps_or_in_one(kept, tmp_path):
    """Step by step each batch is what it would have been: the same photons, other sizes."""
    _, sums = kept
    halfway = trace(SCENE, TWICE, seed=5, sums=sums)
    (tmp_path / "halfway").mkdir()
    halfway.save(tmp_path / "halfway")
    whole = trace(SCENE, replace(TWICE, landed=240_000), seed=5)
    stepwise = trace(
        SCENE, replace(TWICE, landed=240_000), seed=5, sums=tmp_path / "halfway" / "sums.npz"
    )
    found = [m.maps[0] for m in (whole, stepwise)]
    spread = np.hypot(found[0].half_width, found[1].half_width)
    apart = np.abs(found[0].illuminance - found[1].illuminance)
    assert (apart <= spread).mean() > 0.95
    both = np.hypot(*(m.meta["traced_half_width"] for m in found))
    assert found[0].mean == pytest.approx(found[1].mean, abs=1.5 * both)


def test_enough_is_enough(kept):
    """Sums that already hold what is asked come back as they are."""
    first, sums = kept
    again = trace(SCENE, FIRST, seed=5, sums=sums)
    assert again.meta["photons"] == first.meta["photons"]
    assert maps_equal(again, first)
    assert again.meta["error"] == pytest.approx(first.meta["error"])


def test_the_error_falls_with_the_root_of_the_photons(kept):
    first, sums = kept
    truth = trace(SCENE, replace(FIRST, landed=3_000_000, keep_sums=False), seed=99).maps[0]
    errors, counts = [first.meta["error"]], [first.meta["photons"]["landed"]]
    for factor in (4, 16):
        more = trace(SCENE, replace(FIRST, landed=60_000 * factor), seed=5, sums=sums)
        errors.append(more.meta["error"])
        counts.append(more.meta["photons"]["landed"])
        found = more.maps[0]
        slack = truth.half_width
        held = (found.lower - slack <= truth.illuminance) & (
            truth.illuminance <= found.upper + slack
        )
        assert held.mean() > 0.94
    for error, count in zip(errors[1:], counts[1:], strict=True):
        assert error / errors[0] == pytest.approx(np.sqrt(counts[0] / count), rel=0.12)


def test_going_on_to_an_error(kept):
    first, sums = kept
    asked = replace(FIRST, until="error", error=first.meta["error"] / 2)
    more = trace(SCENE, asked, seed=5, sums=sums)
    assert more.meta["error"] <= asked.error
    assert more.meta["photons"]["emitted"] < 8 * first.meta["photons"]["emitted"]


@pytest.mark.parametrize("colour", ["none", "daylight"])
@pytest.mark.parametrize("direct", ["computed", "traced"])
def test_all_that_is_summed_is_kept(colour, direct, tmp_path):
    """Colours, routes and the account of a scene with matte and reflecting things."""
    wall = replace(scenes.floor(0.1, 8, scenes.at(-0.05, 0, 0, (-1, 0, 0))), reflectance=0.5)
    matte = Body("Matte", scenes.box(0.01, 0.01, 0.01, (0.03, 0, 0)), Material(kind="diffuse"))
    scene = Scene((BALL, matte), (LAMP,), (FLOOR, wall))
    tracing = replace(FIRST, colour=colour, direct=direct)
    first = trace(scene, tracing, seed=1)
    first.save(tmp_path)
    again = trace(scene, tracing, seed=1, sums=tmp_path / "sums.npz")
    for a, b in zip(first.maps, again.maps, strict=True):
        for name in ("direct", "caustic", "indirect", "red", "green", "blue", "half_width"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    assert again.meta["flux"] == pytest.approx(first.meta["flux"])


def changed():
    moved = replace(LAMP, pose=scenes.at(z=0.151))
    denser = replace(BALL, material=replace(BALL.material, ior=1.51))
    finer = replace(FLOOR, columns=25, rows=25)
    grey = replace(FLOOR, reflectance=0.1)
    larger = replace(BALL, mesh=replace(BALL.mesh, vertices=BALL.mesh.vertices * 1.0001))
    return {
        "lamp moved": (Scene((BALL,), (moved,), (FLOOR,)), TWICE, 5),
        "other index": (Scene((denser,), (LAMP,), (FLOOR,)), TWICE, 5),
        "other mesh": (Scene((larger,), (LAMP,), (FLOOR,)), TWICE, 5),
        "other texels": (Scene((BALL,), (LAMP,), (finer,)), TWICE, 5),
        "grey receiver": (Scene((BALL,), (LAMP,), (grey,)), TWICE, 5),
        "second lamp": (Scene((BALL,), (LAMP, moved), (FLOOR,)), TWICE, 5),
        "no glass": (Scene((), (LAMP,), (FLOOR,)), TWICE, 5),
        "other seed": (SCENE, TWICE, 6),
        "polarised": (SCENE, replace(TWICE, fresnel="polarised"), 5),
        "in colours": (SCENE, replace(TWICE, colour="led"), 5),
        "all traced": (SCENE, replace(TWICE, direct="traced"), 5),
    }


@pytest.mark.parametrize("what", changed())
def test_a_changed_scene_is_refused(kept, what):
    _, sums = kept
    scene, tracing, seed = changed()[what]
    with pytest.raises(SceneError, match="has changed since it was traced"):
        trace(scene, tracing, seed=seed, sums=sums)


def test_sums_that_are_no_sums_are_named(kept, tmp_path):
    _, sums = kept
    whole = sums.read_bytes()
    broken = tmp_path / "söms ä.npz"
    random = np.random.default_rng(1)
    cases = [b"", b"PK", whole[: len(whole) // 2], whole[:-40], b"\0" * 500, b"no sums at all"]
    for _ in range(200):
        bent = bytearray(whole)
        place = random.integers(len(bent))
        bent[place : place + 8] = random.bytes(8)
        cases.append(bytes(bent))
    said = []
    for case in cases:
        broken.write_bytes(case)
        try:
            trace(SCENE, FIRST, seed=5, sums=broken, progress=stop_after(0.02))
        except FileError as error:
            said.append(str(error))
        except Cancelled:
            pass  # the damage lay where nothing is read
    assert len(said) > 0.9 * len(cases)
    assert all("söms ä.npz" in sentence for sentence in said)
    with pytest.raises(FileError, match="nowhere"):
        trace(SCENE, FIRST, seed=5, sums=tmp_path / "nowhere.npz")


def test_sums_of_another_kind_of_archive_are_named(tmp_path):
    other = tmp_path / "other.npz"
    np.savez(other, light=np.zeros(3))
    with pytest.raises(FileError, match=r"other\.npz"):
        trace(SCENE, FIRST, seed=5, sums=other)
    np.savez(other, about=np.array("{}"), routes=np.zeros(1), square=0, colour=0)
    with pytest.raises(FileError, match=r"other\.npz"):
        trace(SCENE, FIRST, seed=5, sums=other)
    np.save(tmp_path / "other.npy", np.zeros(3))
    with pytest.raises(FileError, match=r"other\.npy"):
        trace(SCENE, FIRST, seed=5, sums=tmp_path / "other.npy")


def stop_after(moment):
    def progress(fraction, text):
        if fraction >= moment:
            raise Cancelled

    return progress


@pytest.mark.parametrize("moment", [0.1, 0.3, 0.6])
def test_a_cancelled_run_leaves_the_sums_as_they_were(kept, tmp_path, moment):
    _, sums = kept
    copy = tmp_path / "copy.npz"
    shutil.copy(sums, copy)
    with pytest.raises(Cancelled):
        trace(
            SCENE,
            replace(FIRST, landed=5_000_000),
            seed=5,
            sums=sums,
            progress=stop_after(moment),
        )
    assert sums.read_bytes() == copy.read_bytes()
    more = trace(SCENE, TWICE, seed=5, sums=sums)
    assert more.meta["photons"]["landed"] >= 120_000
