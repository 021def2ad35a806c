"""Study files: what they say is what is run; what they say wrong is named."""

import json

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, HeliformError
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
    plane_receiver,
)
from heliform.engines.core.study import load_study, save_study
from heliform.engines.light import TRACE_PHOTONS, IrradianceMap, PhotonTracing
from heliform.engines.light.luminaires import source
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
    result = IrradianceMap.load(out / "all")
    result.save(tmp_path)
    again = IrradianceMap.load(tmp_path)
    np.testing.assert_array_equal(again.illuminance, result.illuminance)
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
