"""Sun and sky in Blender: studied, shown, followed live, picked, drawn, saved and refused."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import bpy
import gpu
import numpy as np
import pytest
from heliform.addon import live_sun, sun_overlay, sun_place
from heliform.addon.bridge import layers, results, sun, sun_said, sun_sensor
from heliform.addon.properties import write
from heliform.engines.core.scene import Body, Material, Mesh, Receiver, Scene
from heliform.engines.sun import QUANTITIES, SUN_RADIATION, Radiation, study_radiation
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.maps import SunMaps
from heliform.engines.sun.periods import Period
from heliform.engines.sun.position import sun_position
from heliform.engines.sun.site import Site
from heliform.engines.sun.times import moment
from heliform.engines.sun.words import figure_text, matters
from heliform.operators.sun import receiver_along
from mathutils import Matrix, Vector

NOON = Period(span="summer solstice", first_hour=9.0, last_hour=15.0)
CHEAP = Radiation(period=NOON, subdivision=1, accuracy=5.0)
MAPS = ("sun_hours", "direct", "diffuse", "total", "open", "shading")


@pytest.fixture
def ground(scene):
    """A receiver of 4 m × 2 m, 8 × 4 texels, over which a canopy covers the half of negative x."""
    write(scene.heliform.radiation, CHEAP)
    bpy.ops.heliform.add_receiver()
    obj = bpy.context.object
    obj.location = (0, 0, 0)
    obj.heliform.plane.width, obj.heliform.plane.length = 4.0, 2.0
    obj.heliform.plane.resolution = 8
    bpy.ops.mesh.primitive_plane_add(size=1, location=(-4.5, 0, 1.0))
    bpy.context.object.scale = (9, 9, 1)
    bpy.context.object.name = "Canopy"
    bpy.context.object.heliform.role = "BODY"
    bpy.context.object.heliform.material.kind = "diffuse"
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.fixture
def study(ground):
    """The same, studied."""
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    return ground


def asked_directly(canopy: float = -4.5) -> SunMaps:
    """The same scene as the engine is given it without Blender."""
    corners = np.array([[-4.5, -4.5, 0], [4.5, -4.5, 0], [4.5, 4.5, 0], [-4.5, 4.5, 0]])
    mesh = Mesh(corners + np.array([canopy, 0, 1.0]), np.array([[0, 1, 2, 3]], np.int32))
    floor = Receiver(
        "Receiver", np.array([-2.0, -1, 0]), np.array([4.0, 0, 0]), np.array([0, 2.0, 0]), 8, 4
    )
    scene = Scene((Body("Canopy", mesh, Material(kind="diffuse")),), (), (floor,))
    return study_radiation(scene, CHEAP)


@pytest.mark.parametrize("name", MAPS)
def test_every_map_is_an_image_of_what_the_engine_says(study, name):
    bpy.context.scene.heliform.sun_map = name
    kept = sun.map_on(study).maps[name]
    np.testing.assert_allclose(kept, asked_directly().maps[0].maps[name], rtol=1e-4, atol=1e-4)
    layer = layers.layer_of(study)
    assert layer.quantity == QUANTITIES[name][0]
    picture = results.pixels_of(results.find(study, results.PICTURE, ""))
    np.testing.assert_allclose(picture, layer.scale.colours(kept) / 255, atol=0.01)


def test_the_canopy_shades_its_half(study):
    sunny = sun.map_on(study).maps["sun_hours"].mean(axis=0)
    assert sunny[-1] == 6
    assert sunny[0] == 0
    assert sun.mean_on(study, "sun_hours") == pytest.approx(sunny.mean())


def test_all_receivers_share_a_scale(ground):
    other = ground.copy()
    other.data = ground.data.copy()
    other.name = "Below"
    other.location = (-4, 0, 0)
    bpy.context.collection.objects.link(other)
    bpy.ops.heliform.study_sun()
    assert [obj.name for obj in sun.staged_on(bpy.context.scene)] == ["Below", "Receiver"]
    assert layers.layer_of(other).scale == layers.layer_of(ground).scale
    assert sun.mean_on(other, "direct") < sun.mean_on(ground, "direct")


def test_both_sides_have_their_own_pictures(ground):
    ground.heliform.plane.sides = "both"
    bpy.ops.heliform.study_sun()
    front, back = (
        results.pixels_of(results.find(ground, results.PICTURE, side)) for side in ("front", "back")
    )
    assert np.abs(front - back).max() > 0.3
    assert sun.map_on(ground).maps["direct"][1].max() == 0


def test_a_mesh_without_a_map_is_unwrapped_and_measured(scene):
    write(scene.heliform.radiation, CHEAP)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1, location=(0, 0, 3))
    obj = bpy.context.object
    for layer in list(obj.data.uv_layers):
        obj.data.uv_layers.remove(layer)
    obj.heliform.role = "RECEIVER"
    obj.heliform.plane.resolution = 64
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    facts = sun.facts_of(scene)
    assert any("was unwrapped" in note for note in facts["notes"])
    direct = sun.map_on(obj).maps["direct"]
    assert np.nanmax(direct) > 1
    assert np.nanmin(direct) == 0


def test_live_sun_follows_a_canopy_that_moves(ground):
    scene = bpy.context.scene
    scene.heliform.live_texels = 8
    scene.heliform.live_sun = True
    assert not live_sun.state.problem
    np.testing.assert_allclose(
        sun.map_on(ground).maps["total"], asked_directly().maps[0].maps["total"], rtol=1e-4
    )
    bpy.data.objects["Canopy"].location.x = -3.5
    live_sun.changed(scene)
    np.testing.assert_allclose(
        sun.map_on(ground).maps["total"], asked_directly(-3.5).maps[0].maps["total"], rtol=1e-4
    )
    scene.heliform.live_texels = 4
    assert sun.map_on(ground).area.shape == (2, 4)
    assert layers.layer_of(ground).footing[-1].startswith("live")


def test_live_sun_asks_once_about_what_stays_the_same(ground, monkeypatch):
    scene = bpy.context.scene
    scene.heliform.live_sun = True
    asked = []
    true = live_sun.jobs.ask
    monkeypatch.setattr(live_sun.jobs, "ask", lambda *a: asked.append(a) or true(*a))
    live_sun.changed(scene)
    assert not asked
    scene.heliform.radiation.ground_reflectance = 0.9
    assert len(asked) == 1
    scene.heliform.live_sun = False
    ground.location.x += 1
    live_sun.changed(scene)
    assert len(asked) == 1


def test_live_sun_says_what_is_wrong_and_goes_on(ground):
    scene = bpy.context.scene
    scene.heliform.live_sun = True
    ground.heliform.on = False
    live_sun.changed(scene)
    assert "no receiver" in live_sun.state.problem
    ground.heliform.on = True
    scene.heliform.radiation.weather_file = "/nowhere/Ürümqi.epw"
    assert "Ürümqi" in live_sun.state.problem
    scene.heliform.radiation.weather_file = ""
    assert not live_sun.state.problem


def test_live_sun_says_what_is_hidden(ground):
    bpy.data.objects["Canopy"].hide_set(True)
    scene = bpy.context.scene
    scene.heliform.live_sun = True
    assert "“Canopy” is hidden and left out." in sun.facts_of(scene)["notes"]


def test_live_sun_leaves_no_files(ground):
    bpy.context.scene.heliform.live_sun = True
    assert not list(Path(bpy.app.tempdir).glob("live-*"))
    with pytest.raises(RuntimeError, match="writes no files"):
        bpy.ops.heliform.open_sun_report()


def test_one_sensor_has_its_hours_as_a_picture(study):
    bpy.context.view_layer.objects.active = study
    assert bpy.ops.heliform.sun_sensor() == {"FINISHED"}
    image = sun_sensor.picture_of(bpy.context.scene)
    assert image.name == "Receiver sensor"
    assert len(np.unique(results.pixels_of(image).reshape(-1, 3), axis=0)) > 10
    (mark,) = layers.layer_of(study).marks
    assert "kWh/m²" in mark.label
    found = float(mark.label.split()[1])
    there = sun.map_on(study).maps["total"]
    assert there.min() - 1e-3 <= found <= there.max() * 1.001


def test_a_click_passes_bodies_to_the_receiver(ground):
    down = Vector((0, 0, -1))
    bpy.context.view_layer.update()
    obj, where, normal = receiver_along(bpy.context, Vector((-1.0, 0.2, 30)), down)  # the canopy
    assert obj == ground
    assert tuple(where) == pytest.approx((-1.0, 0.2, 0.0), abs=1e-4)
    assert normal.z == pytest.approx(1)
    assert receiver_along(bpy.context, Vector((-5.0, 0.2, 30)), down) is None
    ground.heliform.on = False
    assert receiver_along(bpy.context, Vector((-1.0, 0.2, 30)), down) is None


def test_a_new_study_drops_the_sensors_mark_and_the_maps_of_others(study):
    scene = bpy.context.scene
    bpy.ops.heliform.sun_sensor()
    bpy.ops.heliform.add_receiver()
    bpy.context.object.location = (3, 3, 0)
    bpy.context.object.heliform.plane.resolution = 4
    study.heliform.role = "NONE"
    study.hide_set(True)
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    (other,) = sun.staged_on(scene)
    assert other != study
    assert layers.layer_of(study) is None
    study.heliform.role = "RECEIVER"
    study.hide_set(False)
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    assert layers.layer_of(study).marks == []


def test_a_night_has_no_number_for_what_is_not_known(ground):
    scene = bpy.context.scene
    period = scene.heliform.radiation.period
    period.first_hour, period.last_hour = 22.0, 4.0
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    assert np.isnan(sun.mean_on(ground, "shading"))
    assert figure_text("shading", {"value": sun.mean_on(ground, "shading"), "unit": "%"}) == "–"
    for name in sun.offered_maps(scene):
        scene.heliform.sun_map = name
        assert not any("nan" in line for line in layers.layer_of(ground).footing)
    report = Path(sun.facts_of(scene)["folder"], "report.html").read_text(encoding="utf-8")
    assert ">nan" not in report.partition("<h2>Figures")[2]


def test_hidden_bodies_are_said(ground):
    bpy.data.objects["Canopy"].hide_set(True)
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    notes = sun.facts_of(bpy.context.scene)["notes"]
    assert "“Canopy” is hidden and left out." in notes
    assert matters("“Canopy” is hidden and left out.")
    assert not matters("4,428 suns are merged into 620 directions.")


def test_other_settings_make_a_study_one_of_earlier_ones(study):
    scene = bpy.context.scene

    def said():
        return "of earlier settings" in layers.layer_of(study).footing

    assert not said()
    scene.heliform.radiation.site.latitude = np.radians(10.0)
    assert said()
    scene.heliform.radiation.site.latitude = np.radians(Site().latitude)
    assert not said()
    scene.heliform.radiation.period.first_month = 5  # does not count for a solstice
    scene.heliform.daylight.target = 500.0  # nor is it of this study
    assert not said()
    scene.heliform.radiation.period.first_hour = 8.0
    assert said()
    assert sun.facts_of(scene)["stale"]


def test_a_live_map_says_so_and_the_last_study_keeps_its_files(study, tmp_path):
    scene = bpy.context.scene
    folder = sun.facts_of(scene)["folder"]
    scene.heliform.live_sun = True
    facts = sun.facts_of(scene)
    assert facts["live"]
    assert facts["folder"] == folder
    scene.heliform.live_sun = False
    assert "live, coarse: press Study Sun" in layers.layer_of(study).footing
    assert not sun.facts_of(scene)["stale"]
    path = tmp_path / "hours.csv"
    assert bpy.ops.heliform.export_sun_hours(filepath=str(path)) == {"FINISHED"}
    assert path.is_file()


def test_bodies_are_edges_while_one_sees_inside(study):
    canopy, own = bpy.data.objects["Canopy"], bpy.context.scene.heliform
    canopy.display_type = "BOUNDS"
    own.see_inside = True
    assert (canopy.display_type, study.display_type) == ("WIRE", "TEXTURED")
    own.see_inside = False
    assert canopy.display_type == "BOUNDS"
    own.see_inside = True
    bpy.ops.heliform.clear_sun()
    assert canopy.display_type == "BOUNDS"


def test_hours_are_exported_as_a_table(study, tmp_path):
    path = tmp_path / "Stunden ä"
    assert bpy.ops.heliform.export_sun_hours(filepath=str(path)) == {"FINISHED"}
    lines = path.with_suffix(".csv").read_text(encoding="utf-8").splitlines()
    assert sum(line.startswith("2019-06-21 ") for line in lines) == 6


def test_a_map_goes_on_the_vertices_of_a_mesh(ground):
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.heliform.sun_to_vertices()
    bpy.data.objects.remove(bpy.data.objects["Canopy"])
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, location=(0, 0, 5))
    ball = bpy.context.object
    ball.heliform.role = "RECEIVER"
    ball.heliform.plane.resolution = 64
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    assert bpy.ops.heliform.sun_to_vertices() == {"FINISHED"}
    assert "total" not in ground.data.attributes
    values = np.array([item.value for item in ball.data.attributes["total"].data])
    height = np.array([vertex.co.z for vertex in ball.data.vertices])
    assert values[height > 0.8].min() > 2 * values[height < -0.8].max()
    assert values.max() < sun.map_on(ground).maps["total"].max()


def test_a_range_set_by_hand_is_taken_and_an_empty_one_said(study):
    display = bpy.context.scene.heliform.sun_display
    display.automatic = False
    display.high = 5.0
    assert layers.layer_of(study).scale.high == 5
    display.low = 7.0
    assert sun.facts_of(bpy.context.scene)["problem"]
    display.low = 0.0
    assert not sun.facts_of(bpy.context.scene)["problem"]


def test_a_result_of_light_takes_the_place_of_a_study_and_back(study):
    bpy.ops.heliform.add_lamp()
    bpy.context.object.location = (1.5, 0, 1.5)
    tracing = bpy.context.scene.heliform.photon_tracing
    tracing.until, tracing.landed = "landed", 1000
    assert bpy.ops.heliform.trace_photons() == {"FINISHED"}
    assert layers.layer_of(study) is None
    assert sun.facts_of(bpy.context.scene) is None
    assert len(results.results_of(bpy.context.scene)) == 1
    assert bpy.ops.heliform.study_sun() == {"FINISHED"}
    assert not results.results_of(bpy.context.scene)
    assert layers.layer_of(study) is not None


def test_a_saved_study_opens_with_all_its_maps(study, tmp_path):
    known = sun.facts_of(bpy.context.scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "Sonne ä.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "Sonne ä.blend"))
    scene = bpy.context.scene
    assert sun.facts_of(scene) == known
    scene.heliform.sun_map = "shading"
    assert layers.layer_of(bpy.data.objects["Receiver"]).quantity == "Shading"


def test_a_study_can_be_taken_off(study):
    assert bpy.ops.heliform.clear_sun() == {"FINISHED"}
    assert sun.facts_of(bpy.context.scene) is None
    assert layers.layer_of(study) is None
    assert not [image for image in bpy.data.images if results.is_ours(image)]
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.heliform.clear_sun()


def test_without_a_receiver_or_a_file_the_reason_is_said(scene):
    with pytest.raises(RuntimeError, match="no receiver"):
        bpy.ops.heliform.study_sun()
    bpy.ops.heliform.add_receiver()
    scene.heliform.radiation.weather_file = "/nowhere/Ürümqi.epw"
    assert "Ürümqi" in sun_place.weather_problem(scene)
    with pytest.raises(RuntimeError, match="Ürümqi"):
        bpy.ops.heliform.study_sun()


@pytest.mark.parametrize("hour", [9.0, 16.5])
@pytest.mark.parametrize("north", [0.0, 30.0])
def test_the_lamp_shines_from_where_the_sun_stands(scene, hour, north):
    own = scene.heliform
    own.sun_month, own.sun_day = 6, 21
    bpy.ops.heliform.add_sun_lamp()
    own.sun_hour = hour
    own.radiation.site.north = np.radians(north)
    bpy.context.view_layer.update()
    site = Site()
    sun_there = sun_position(moment(2019, 6, 21, hour, site), site)
    towards = np.array(own.sun_lamp.matrix_world)[:3, 2]
    turned = np.degrees(np.arctan2(towards[0], towards[1])) % 360
    assert (turned + north) % 360 == pytest.approx(sun_there.azimuth[0], abs=1e-3)
    altitude = np.degrees(np.arcsin(towards[2]))
    assert altitude == pytest.approx(sun_there.apparent_altitude[0], abs=1e-3)
    assert 500 < own.sun_lamp.data.energy < 1000
    own.sun_hour = 2.0
    assert own.sun_lamp.data.energy == 0


def test_a_weather_file_brings_its_place(scene, tmp_path, monkeypatch):
    there = Site(latitude=-33.9, longitude=151.2, utc_offset=10.0)
    weather = clear_weather(there)
    monkeypatch.setattr(sun_place, "read_weather", lambda path: weather)
    scene.heliform.radiation.site.north = np.radians(20.0)
    scene.heliform.radiation.site.turbidity = 3.5
    scene.heliform.radiation.weather_file = "//Sydney.epw"
    site = sun_place.site_of(scene)
    assert site == replace(there, north=20.0, turbidity=3.5)
    assert sun_said.asked(scene, Radiation).site == site
    scene.heliform.radiation.weather_file = ""
    assert sun_place.site_of(scene) == Site(north=20.0, turbidity=3.5)


def test_the_path_is_drawn_where_the_sun_goes(scene):
    site = Site(latitude=70.0, longitude=20.0, utc_offset=1.0)
    strokes = {look[0]: ends for *look, ends in sun_overlay._strokes(site)}
    arcs = strokes[sun_overlay._DAY]
    np.testing.assert_allclose(np.linalg.norm(arcs, axis=1), 1, atol=1e-6)
    assert arcs[:, 2].max() == pytest.approx(np.sin(np.radians(20 + 23.44)), abs=2e-3)
    texts = [text for text, _ in sun_overlay._labels(site)]
    assert {"N", "E", "S", "W", "12 h", "0 h"} <= set(texts)  # the sun is up at midnight in June
    assert not any("December" in text for text in texts)  # and not at noon at Christmas


def test_units_do_not_change_what_is_measured(ground):
    bpy.context.scene.unit_settings.scale_length = 0.01
    write(bpy.context.scene.heliform.radiation, CHEAP, 0.01)
    for obj in bpy.context.scene.objects:
        obj.location *= 100
        obj.scale *= 100
    ground.scale /= 100
    ground.heliform.plane.width, ground.heliform.plane.length = 400.0, 200.0
    bpy.ops.heliform.study_sun()
    np.testing.assert_allclose(
        sun.map_on(ground).maps["total"], asked_directly().maps[0].maps["total"], rtol=1e-3
    )


def test_daylight_has_its_maps_and_figures(ground):
    scene = bpy.context.scene
    daylight = scene.heliform.daylight
    daylight.subdivision, daylight.accuracy, daylight.paths = 1, np.radians(10.0), 2048
    scene.heliform.radiation.site.latitude = np.radians(50.0)
    assert bpy.ops.heliform.study_daylight() == {"FINISHED"}
    facts = sun.facts_of(scene)
    assert scene.heliform.sun_map == "daylight_autonomy"
    assert facts["period"] == "year, 8 to 18 h"
    factor = sun.map_on(ground).maps["daylight_factor"].mean(axis=0)
    assert factor[-1] > 2 * factor[0]
    assert any(name.startswith("sda_") for name in facts["figures"])
    folder = Path(facts["folder"])
    said = SunMaps.load(folder).meta["parameters"]
    assert said["site"]["latitude"] == 50  # place and weather are those of the scene
    bpy.context.view_layer.objects.active = ground
    assert bpy.ops.heliform.sun_sensor() == {"FINISHED"}
    (mark,) = layers.layer_of(ground).marks
    value, unit = mark.label.removeprefix("Sensor: ").partition(",")[0].rsplit(" ", 1)
    assert unit == "lx"
    there = sun.map_on(ground).maps["illuminance"]
    assert 0.9 * there.min() <= float(value.replace("\u2009", "")) <= 1.1 * there.max()


def test_a_receiver_shows_its_own_figures():
    from heliform.panels.sun import own_figures

    one = {"sda_300_50": 1, "sda_62.5_50": 2}
    assert own_figures(one, "Desk", ["Desk"]) == one
    several = {"Desk.ase": 1, "Desk.001.ase": 2, "Roof.ase": 3, "Desk.sda_62.5_50": 4}
    names = ["Desk", "Desk.001", "Roof"]
    assert own_figures(several, "Desk", names) == {"ase": 1, "sda_62.5_50": 4}
    assert own_figures(several, "Desk.001", names) == {"ase": 2}
    assert own_figures(several, "Renamed", names) == {}
    assert own_figures(several, "Desk.001", ["Desk.001"]) == {"ase": 2}


def test_a_receiver_that_is_renamed_keeps_its_name_in_the_study(study):
    study.name = "Another"
    assert sun.name_in_study(study) == "Receiver"


def test_what_is_asked_names_the_weather_by_its_whole_path(ground, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.context.scene.heliform.radiation.weather_file = "//here.epw"
    asked = sun_said.asked(bpy.context.scene, SUN_RADIATION.record)
    assert asked.weather_file == str(tmp_path / "here.epw")


class Region:
    width, height = 800, 800


class View:
    """A view from above, 80 m wide."""

    area = object = None
    region = Region
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    perspective_matrix = Matrix.Diagonal((1 / 40, 1 / 40, -1 / 100, 1))

    def __init__(self, scene):
        self.scene = scene
        self.view_layer = bpy.context.view_layer
        self.space_data = SimpleNamespace(
            overlay=SimpleNamespace(show_overlays=True), region_3d=self
        )


def drawn(scene):
    """The overlay on black, (800, 800, 3) from the bottom up."""
    gpu.init()
    screen = gpu.types.GPUOffScreen(Region.width, Region.height, format="RGBA16F")
    pixels = Matrix.Translation((-1, -1, 0)) @ Matrix.Diagonal((2 / 800, 2 / 800, 1, 1))
    try:
        with screen.bind(), gpu.matrix.push_pop():
            gpu.matrix.load_matrix(Matrix.Identity(4))
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=(0.0, 0.0, 0.0, 1.0), depth=1.0)
            gpu.matrix.load_projection_matrix(View.perspective_matrix)
            sun_overlay.draw_lines(View(scene))
            gpu.matrix.load_projection_matrix(pixels)
            sun_overlay.draw_labels(View(scene))
            read = framebuffer.read_color(0, 0, Region.width, Region.height, 4, 0, "FLOAT")
    finally:
        screen.free()
    return np.array(read.to_list())[..., :3]


def test_the_sun_is_drawn_where_it_stands(scene):
    own = scene.heliform
    assert not drawn(scene).any()
    own.sun_path = True
    own.sun_month, own.sun_day, own.sun_hour = 3, 20, 9.0
    view = drawn(scene)
    now = sun_place.sun_now(scene)
    radius = 1.25 * sun_place.middle_and_radius(bpy.context.view_layer)[1]
    column, row = (round(400 + 10 * radius * axis) for axis in now.direction[:2])
    np.testing.assert_allclose(view[row, column], sun_overlay._SUN[:3], atol=0.01)
    ring = np.hypot(*(np.indices((800, 800)) - 400)) - 10 * radius
    assert (view[np.abs(ring) < 1].max(axis=-1) > 0.1).mean() > 0.5  # the horizon
    own.sun_hour = 0.0
    night = drawn(scene)
    assert np.abs(night - sun_overlay._SUN[:3]).max(axis=-1).min() > 0.01
