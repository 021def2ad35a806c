"""Study files: what they say is what is run; what they say wrong is named."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core import atlas
from heliform.engines.core.errors import FileError, HeliformError
from heliform.engines.core.export import save_study
from heliform.engines.core.meshes import load_mesh
from heliform.engines.core.run import run_study
from heliform.engines.core.scene import (
    Body,
    Lamp,
    Luminaire,
    Material,
    Mesh,
    Plane,
    Scene,
    Surface,
    plane_receiver,
)
from heliform.engines.core.study import load_study
from heliform.engines.core.unwrap import unwrap
from heliform.engines.light import TRACE_PHOTONS, Irradiance, PhotonTracing
from heliform.engines.light.luminaires import source
from heliform.engines.scan import READ_SCAN, ScanReading
from light import scenes

SMALL = """
heliform = 1
title = "Small"
analysis = "light.trace"
seed = 3

[parameters]
until = "landed"
landed = 20000

[bodies."Vase ä/1"]
form = "glass.object"
at = [0.0, 0.0, 0.001]
[bodies."Vase ä/1".shape]
width = 0.1
depth = 0.1
height = 0.05
faces = 6000

[lamps.Spot]
at = [0.0, 0.0, 0.12]

[receivers."Table 1/ä"]
width = 0.4
length = 0.2
resolution = 32

[quick.parameters]
landed = 1000

[cases.all]
[cases.dark.bodies."Vase ä/1"]
on = false
"""


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "Stüdy one.toml"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_a_study_becomes_the_scene_it_describes(small):
    study = load_study(small)
    full, dark = study.cases
    assert (full.name, dark.name, study.seed) == ("all", "dark", 3)
    assert [b.name for b in full.scene.bodies] == ["Vase ä/1"]
    assert dark.scene.bodies == ()
    low = full.scene.bodies[0].mesh.vertices.min(axis=0)
    assert low[2] == pytest.approx(0.001)
    receiver = full.scene.receivers[0]
    assert (receiver.columns, receiver.rows) == (32, 16)
    assert receiver.normal == pytest.approx([0, 0, 1])
    assert full.parameters == PhotonTracing(until="landed", landed=20000)


def test_quick_and_settings_override_in_this_order(small):
    assert load_study(small, quick=True).cases[0].parameters.landed == 1000
    study = load_study(
        small,
        quick=True,
        seed=9,
        settings=[
            "parameters.landed=5000",
            "parameters.fresnel=polarised",
            'bodies."Vase ä/1".shape.bead.sag = 0.001',
        ],
    )
    assert study.seed == 9
    assert study.cases[0].parameters == PhotonTracing(
        until="landed", landed=5000, fresnel="polarised"
    )


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("parameters.eror=0.1", "did you mean “error”"),
        ("parameters.error=7", "allowed is 0.005 to 1"),
        ("parameters.landed=1.5", "a whole number"),
        ("parameters.until=never", "error, landed, time"),
        ("parameters.repair=1", "true or false"),
        ("bodis.x=1", "did you mean “bodies”"),
        ("lamps.Spot.at=[1, 2]", "3 numbers"),
        ("lamps.Spot.source=torch", "ies, disk, point, beam"),
        ('bodies."Vase ä/1".form=glass.vase', "glass.object"),
        ('bodies."Vase ä/1".preset=mug', "tube"),
        ("analysis=light.tracing", "light.trace"),
        ("seed=-1", "0 to 2147483647"),
        ("nonsense", "section.key=value"),
        ("heliform=2", "update Heliform"),
        ("quick=true", "should be a table"),
        ("bodies=5", "should be a table"),
        ("title=5", "should be text"),
        ("parameters=1", "should be a table"),
        ("cases=[1]", "should be a table"),
        ("cases.all=1", "should be a table"),
        ("lamps.Spot.file=5", "should be text"),
        ("lamps.Spot.scale=[2, 2, 2]", "which a lamp cannot"),
        ('bodies."Vase ä/1".scale=[0, 1, 1]', "scale of 0"),
        ('bodies."Vase ä/1".on="no"', "true or false"),
        ('bodies."Vase ä/1".material=1', "should be a table"),
        ("display={automatic=false, low=10.0, high=5.0}", "10"),
    ],
)
def test_what_is_wrong_is_named_with_its_remedy(small, setting, said):
    with pytest.raises(HeliformError) as error:
        load_study(small, settings=[setting])
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_or_damaged_study_is_named(tmp_path):
    with pytest.raises(FileError, match="There is no study"):
        load_study(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("a = ", encoding="utf-8")
    with pytest.raises(FileError, match=r"bad\.toml” is not valid TOML"):
        load_study(tmp_path / "bad.toml")
    (tmp_path / "mesh.toml").write_text(
        'analysis="light.trace"\n[bodies.A]\nmesh="a.ply"', encoding="utf-8"
    )
    with pytest.raises(FileError, match="There is no mesh"):
        load_study(tmp_path / "mesh.toml")


def test_a_saved_scene_reads_back_as_it_was(tmp_path):
    smooth = scenes.sphere(0.03, 2)
    scene = Scene(
        (
            Body("Kugel ä/1", smooth, Material(ior=1.52)),
            Body("Kugel ä.1", scenes.box(0.1, 0.1, 0.1), Material(kind="mirror", reflectance=0.9)),
        ),
        (Luminaire("L/1", Lamp(source="disk", flux=100.0), scenes.at(0.1, 0.2, 0.3, (1, 1, -1))),),
        (plane_receiver("Plane", Plane(width=0.4, length=0.3), scenes.at(z=-1, axis=(1, 0, -3))),),
    )
    tracing = PhotonTracing(error=0.2, fresnel="polarised")
    path = save_study(tmp_path / "ä study", "T", scene, TRACE_PHOTONS, tracing, 5)
    case = load_study(path).cases[0]
    assert case.parameters == tracing
    for saved, read in zip(scene.bodies, case.scene.bodies, strict=True):
        assert (saved.name, saved.material) == (read.name, read.material)
        np.testing.assert_array_equal(saved.mesh.vertices, read.mesh.vertices)
        np.testing.assert_array_equal(saved.mesh.faces, read.mesh.faces)
    np.testing.assert_array_equal(smooth.normals, case.scene.bodies[0].mesh.normals)
    np.testing.assert_allclose(case.scene.luminaires[0].pose, scene.luminaires[0].pose)
    one, other = scene.receivers[0], case.scene.receivers[0]
    for name in ("origin", "u", "v"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), atol=1e-12)
    assert (one.columns, one.rows) == (other.columns, other.rows)


def vessel(columns=32, rows=32):
    """An unwrapped sphere that gathers and reflects on both sides."""
    mesh = Mesh(scenes.sphere(0.1, 2).vertices, scenes.sphere(0.1, 2).faces)
    return Surface("Vase ä/1", mesh, unwrap(mesh, columns), columns, rows, "both", 0.4)


def test_receivers_of_any_mesh_read_back_identical(tmp_path):
    plane = Plane(width=0.4, length=0.3, sides="both", reflectance=0.25)
    receivers = vessel(), plane_receiver("Plane", plane, scenes.at(z=-1)), vessel(32, 16)
    receivers = (*receivers[:2], replace(receivers[2], name="Vase ä.1"))
    path = save_study(
        tmp_path / "s", "T", Scene((), (), receivers), TRACE_PHOTONS, PhotonTracing(), 0
    )
    for saved, read in zip(receivers, load_study(path).cases[0].scene.receivers, strict=True):
        for name in ("name", "columns", "rows", "sides", "reflectance"):
            assert getattr(read, name) == getattr(saved, name)
        if isinstance(saved, Surface):
            np.testing.assert_array_equal(read.mesh.vertices, saved.mesh.vertices)
            np.testing.assert_array_equal(read.mesh.faces, saved.mesh.faces)
            np.testing.assert_array_equal(read.texture, saved.texture)


WALL = """
analysis = "light.trace"
[receivers.Wall]
mesh = "wall.obj"
unit = "cm"
resolution = 32
sides = "both"
at = [0.0, 0.0, 1.0]
"""
SQUARES = "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nv 0 0 100\nv 0 100 100\n"


def wall(folder, faces, texture="", toml=WALL):
    (folder / "wall.obj").write_text(SQUARES + texture + faces)
    (folder / "wall.toml").write_text(toml)
    return folder / "wall.toml"


def test_a_receivers_mesh_is_unwrapped_where_its_file_has_no_map(tmp_path):
    (found,) = load_study(wall(tmp_path, "f 1 2 3 4\nf 5 1 4 6\n")).cases[0].scene.receivers
    assert (found.columns, found.rows, found.sides) == (32, 32, "both")
    assert found.mesh.vertices.min(axis=0) == pytest.approx([0, 0, 1])
    assert found.mesh.vertices.max(axis=0) == pytest.approx([1, 1, 2])
    atlas.require_chart(found)


def test_a_receivers_mesh_keeps_the_map_of_its_file(tmp_path):
    texture = "vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\nvt 1 0\nvt 1 1\n"
    study = wall(tmp_path, "f 1/1 2/2 3/3 4/4\nf 5/2 1/5 4/6 6/3\n", texture)
    (found,) = load_study(study).cases[0].scene.receivers
    u, v = found.texture.reshape(-1, 2).T
    x, y, z = found.mesh.vertices[found.mesh.faces].reshape(-1, 3).T
    assert v == pytest.approx(y)
    flat = np.repeat((found.mesh.vertices[found.mesh.faces][..., 2] == 1).all(axis=1), 3)
    assert u[flat] == pytest.approx(x[flat] / 2)
    assert u[~flat] == pytest.approx(1 - (z[~flat] - 1) / 2)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("width = 2.0", "the size of its mesh; set scale, not width"),
        ("reflectance = 2.0", "allowed is 0 to 1"),
        ('sides = "all"', "front, both"),
        ("texels = [4]", "should be 2 numbers"),
        ("texels = [0, 4]", "at least 1"),
        ('color = "red"', "has no key “color”"),
    ],
)
def test_what_is_wrong_with_a_mesh_receiver_is_named(tmp_path, key, said):
    toml = WALL.replace('sides = "both"', key)
    with pytest.raises(HeliformError) as error:
        load_study(wall(tmp_path, "f 1 2 3 4\n", toml=toml))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_receiver_without_faces_or_area_is_named(tmp_path):
    study = wall(tmp_path, "", toml=WALL.replace("wall.obj", "wall.npz"))
    np.savez(tmp_path / "wall.npz", vertices=np.zeros((3, 3)), faces=np.zeros((0, 3), int))
    with pytest.raises(HeliformError, match="Receiver “Wall” has no faces"):
        load_study(study)
    np.savez(tmp_path / "wall.npz", vertices=np.zeros((3, 3)), faces=np.array([[0, 1, 2]]))
    with pytest.raises(HeliformError, match=r"Receiver “Wall”: .* without area"):
        load_study(study)
    np.savez(
        tmp_path / "wall.npz",
        vertices=np.eye(3),
        faces=np.array([[0, 1, 2]]),
        texture=np.zeros((3, 2)),
    )
    with pytest.raises(HeliformError, match="two coordinates for each corner"):
        load_study(study)


TILTED = "IESNA:LM-63-2002\nTILT={}\n1 -1 1 2 1 1 2 0 0 0\n1 1 10\n0 90\n0\n100 100\n"


def test_a_lamps_tilt_file_goes_with_it(tmp_path):
    lamps = []
    for name, factor in (("a", 0.5), ("b", 0.25)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "lamp.ies").write_text(TILTED.format(r"C:\lamps\TILT.tlt"))
        (tmp_path / name / "tilt.tlt").write_text(f"1\n2\n0 180\n{factor} {factor}\n")
        lamps.append(Luminaire(name, Lamp(file=str(tmp_path / name / "lamp.ies")), scenes.at(z=1)))
    scene = Scene((), tuple(lamps), (scenes.floor(1.0, 8),))
    path = save_study(tmp_path / "out", "T", scene, TRACE_PHOTONS, PhotonTracing(), 0)
    before = [source(lamp).flux for lamp in lamps]
    for name in ("a", "b"):
        shutil.rmtree(tmp_path / name)
    shutil.move(path.parent, tmp_path / "elsewhere")
    read = load_study(tmp_path / "elsewhere" / "study.toml").cases[0].scene.luminaires
    assert [source(lamp).flux for lamp in read] == pytest.approx(before)
    assert before[0] == pytest.approx(2 * before[1])


def test_a_lamp_whose_tilt_file_is_missing_is_named(tmp_path):
    (tmp_path / "lamp.ies").write_text(TILTED.format("tilt.tlt"))
    lamp = Luminaire("L", Lamp(file=str(tmp_path / "lamp.ies")), scenes.at(z=1))
    with pytest.raises(FileError, match="which is not beside it"):
        save_study(tmp_path / "out", "T", Scene((), (lamp,)), TRACE_PHOTONS, PhotonTracing(), 0)


def emitted(out):
    figures = json.loads((out / "result.json").read_text(encoding="utf-8"))["figures"]
    return figures["all.photons_emitted"]["value"]


def test_a_study_goes_on_from_an_earlier_result(small, tmp_path):
    kept = ["parameters.keep_sums=true"]
    run_study(small, tmp_path / "first", settings=kept)
    more = ["refine=first", "parameters.landed=60000"]
    run_study(small, tmp_path / "second", settings=more)
    assert emitted(tmp_path / "second") > 2 * emitted(tmp_path / "first")
    assert (tmp_path / "second" / "all" / "sums.npz").is_file()
    run_study(small, tmp_path / "second", settings=["refine=second", "parameters.landed=120000"])
    assert emitted(tmp_path / "second") > 4 * emitted(tmp_path / "first")


def test_what_cannot_be_gone_on_from_is_named_and_stays(small, tmp_path):
    with pytest.raises(FileError, match="There is no result"):
        load_study(small, settings=["refine=nowhere"])
    run_study(small, tmp_path / "bare", quick=True)
    with pytest.raises(FileError, match=r"no sums\.npz to go on from; trace anew with"):
        load_study(small, settings=["refine=bare"])
    run_study(small, tmp_path / "kept", quick=True, settings=["parameters.keep_sums=true"])
    before = {p: p.read_bytes() for p in (tmp_path / "kept").rglob("*") if p.is_file()}
    with pytest.raises(HeliformError, match="has changed since it was traced"):
        run_study(small, tmp_path / "kept", seed=9, settings=["refine=kept"])

    def stop(fraction, text):
        if "landed" in text:
            raise KeyboardInterrupt

    endless = ["refine=kept", "parameters.landed=100000000"]
    with pytest.raises(KeyboardInterrupt):
        run_study(small, tmp_path / "kept", settings=endless, progress=stop)
    assert {p: p.read_bytes() for p in (tmp_path / "kept").rglob("*") if p.is_file()} == before


def test_lamps_with_files_of_the_same_name_keep_their_own(tmp_path):
    lamps = []
    for name, candela in (("a", 100), ("b", 200)):
        (tmp_path / name).mkdir()
        file = tmp_path / name / "lamp.ies"
        head = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 10\n0 90\n0\n"
        file.write_text(f"{head}{candela} {candela}\n")
        lamps.append(Luminaire(name, Lamp(file=str(file)), scenes.at(z=1)))
    scene = Scene((), tuple(lamps), (scenes.floor(1.0, 8),))
    path = save_study(tmp_path / "out", "T", scene, TRACE_PHOTONS, PhotonTracing(), 0)
    read = load_study(path).cases[0].scene.luminaires
    assert source(read[1]).flux == pytest.approx(2 * source(read[0]).flux)


def test_a_damaged_copy_of_a_mesh_is_named(tmp_path):
    np.savez(tmp_path / "a.npz", vertices=np.zeros((3, 3)), faces=np.array([[0, 1, 7]]))
    with pytest.raises(FileError, match=r"a\.npz"):
        load_mesh(tmp_path / "a.npz")


def test_running_a_study_writes_its_results_and_they_load_back_equal(small, tmp_path):
    out = tmp_path / "out ä"
    files = run_study(small, out)
    assert all((out / name).is_file() for name in files)
    assert not list(tmp_path.glob(".*"))
    summary = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert summary["files"] == files
    assert {"study", "heliform", "seed", "quick", "seconds", "figures", "notes"} <= set(summary)
    assert summary["figures"]["all.photons_landed"]["value"] >= 20000
    assert "uncertainty" in summary["figures"]["all.mean_illuminance"]
    assert any("direct light only" in note for note in summary["notes"])
    result = Irradiance.load(out / "all")
    result.save(tmp_path)
    again = Irradiance.load(tmp_path)
    np.testing.assert_array_equal(again.maps[0].illuminance, result.maps[0].illuminance)
    assert again.meta == result.meta
    assert again.meta["seed"] == 3
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "http://" not in page.split("</script>")[-1]
    assert "data:image/png;base64" in page


def test_a_failing_run_leaves_an_earlier_result_alone(small, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "result.json").write_text("{}")

    def stop(fraction, text):
        if fraction > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(small, out, progress=stop)
    assert (out / "result.json").read_text() == "{}"
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith("out")] == ["out"]


def test_a_folder_that_cannot_be_written_is_said_before_anything_runs(small, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(FileError, match="choose another"):
        run_study(small, tmp_path / "file" / "out")


def test_a_mirroring_matrix_keeps_a_solid_outward():
    mesh = scenes.sphere(0.03, 3)
    flipped = mesh.moved(np.diag([-1.0, 2.0, 0.5, 1.0]))
    corners = flipped.vertices[flipped.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()
    assert volume > 0
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((flipped.normals.mean(axis=1) * faces).sum(axis=1) > 0).all()


def test_a_quadrilateral_mesh_splits_into_the_same_surface():
    quad = Mesh(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]]), np.array([[0, 1, 2, 3]]))
    assert quad.triangles().faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_files_of_parameters_go_with_the_study_and_are_found_beside_it(tmp_path):
    scan = tmp_path / "Probe: ä.ply"
    scan.write_text("ply", encoding="utf-8")
    reading = ScanReading(file=str(scan))
    path = save_study(tmp_path / "out", "T", Scene(), READ_SCAN, reading, 0)
    scan.unlink()
    moved = path.parent.rename(tmp_path / "elsewhere")
    (case,) = load_study(moved / "study.toml").cases
    found = Path(case.parameters.file)
    assert found.parent.parent == moved
    assert found.read_text(encoding="utf-8") == "ply"
    assert found.suffix == ".ply"


def test_a_file_of_parameters_that_cannot_be_copied_is_said(tmp_path):
    reading = ScanReading(file=str(tmp_path / "fehlt.ply"))
    with pytest.raises(FileError, match=r"File needs “.*fehlt.ply”, which cannot be copied"):
        save_study(tmp_path / "out", "T", Scene(), READ_SCAN, reading, 0)
