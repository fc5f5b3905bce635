"""`gonio color` as a user runs it: the twin's chart to the twin's own matrix, and samples by it."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.camera import Camera
from gonio.chart import CORNERS
from gonio.cli._main import cli
from gonio.color import XYZ_FROM_SRGB
from gonio.colorimetry.color_file import ColorFile, lit_lamps
from gonio.errors import BadFileError, BadInputError, GonioError
from gonio.geometry import ArmPose
from gonio.plan import Plan
from gonio.reduce.color import Wanted
from gonio.reduce.raw import Sensor
from gonio.rig import default_rig, default_rig_text, load_rig
from gonio.samples import Samples
from gonio.tables import read_table
from sim.chart import centres_mm, patches_srgb
from sim.sensor import CAMERA_FROM_SRGB, CAMERA_NEUTRAL

TRUE = XYZ_FROM_SRGB @ np.linalg.inv(CAMERA_FROM_SRGB / CAMERA_NEUTRAL[:, None])
ONE_EXPOSURE = default_rig_text().replace("[0.002, 0.02, 0.2, 2.0]", "[0.2]")


def run(*arguments):
    """Run the command line in process; raise what it refuses with."""
    done = CliRunner().invoke(cli, [str(each) for each in arguments])
    if done.exception is not None:
        raise done.exception
    return done.output


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """A folder with the chart's session, and that of a sample."""
    root = tmp_path_factory.mktemp("lab")
    (root / "rig.toml").write_text(ONE_EXPOSURE)
    for name, material, lights in (
        ("chart", "colorchecker", "rings:45x1"),
        ("session", "satin", "rings:30x2"),
    ):
        which = ("--view-candidates", "rings:0x1", "--light-candidates", lights)
        plan = root / f"{name}.json"
        run("plan", "--rig", root / "rig.toml", *which, "--density", "all", "--no-page", "-o", plan)
        run(
            "capture", "--sim", "--rig", root / "rig.toml", "--material", material,
            "--plan", plan, "-o", root / name,
        )  # fmt: skip
    run("color", root / "chart", "-o", root / "color.json")
    return root


@pytest.fixture
def session(lab, tmp_path):
    """A copy of the sample's session, to be reduced."""
    return shutil.copytree(lab / "session", tmp_path / "session")


def matrix_in(path):
    (chart,) = json.loads(path.read_text())["charts"]
    return np.array(chart["xyz_from_camera"]), [patch["delta_e"] for patch in chart["patches"]]


def test_the_twins_own_matrix_is_recovered(lab):
    found, delta_e = matrix_in(lab / "color.json")
    # noise of 0.2 %, which undoing the crosstalk triples
    np.testing.assert_allclose(found, TRUE, atol=0.02)
    assert np.mean(delta_e) < 0.4
    # one exposure leaves black to the read noise
    assert max(delta_e[:-1]) < 1.2
    assert delta_e[-1] < 2.5
    assert (lab / "color.png").read_bytes().startswith(b"\x89PNG")


def test_patches_are_read_as_they_reflect(lab):
    (chart,) = json.loads((lab / "color.json").read_text())["charts"]
    factor, sigma = (np.array([p[name] for p in chart["patches"]]) for name in ("camera", "sigma"))
    true = patches_srgb() @ (CAMERA_FROM_SRGB / CAMERA_NEUTRAL[:, None]).T
    # one white frame's noise is in all of them
    off = (factor - true) / np.hypot(sigma, 0.002 * true)
    assert np.abs(off).max() < 5.0
    assert 0.5 < np.sqrt(np.mean(off**2)) < 1.5


def corners_text(rig, pose_deg, order=CORNERS):
    pixels = Camera(rig.camera).project(centres_mm()[list(order)], ArmPose.from_degrees(*pose_deg))
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in pixels)


def test_stated_corners_give_the_same_matrix(lab, tmp_path):
    corners = corners_text(default_rig(), (0.0, 0.0))
    run("color", lab / "chart", "--corners", corners, "-o", tmp_path / "color.json")
    stated, _ = matrix_in(tmp_path / "color.json")
    np.testing.assert_allclose(stated, matrix_in(lab / "color.json")[0], atol=0.01)


@pytest.mark.parametrize(
    ("corners", "problem"),
    [
        (corners_text(default_rig(), (0.0, 0.0), [18, 23, 5, 0]), "are no such chart"),
        ("10,10 50,10 90,10 130,10", "are not the corners of a chart"),
        ("10,10 50,10", "four pairs of column and row are needed"),
        ("nan,10 50,10 50,50 10,50", "four pairs of column and row are needed"),
        ("10,10 20,10 20,16 10,16", "has fewer than 8 pixels of a color"),
    ],
)
def test_wrong_corners_are_refused(lab, tmp_path, corners, problem):
    with pytest.raises(BadInputError, match=problem):
        run("color", lab / "chart", "--corners", corners, "-o", tmp_path / "color.json")
    assert not (tmp_path / "color.json").exists()


def test_where_there_is_no_chart_it_says_so_and_what_to_do(gonio, lab):
    ran = gonio("color", lab / "session")
    assert ran.returncode == 2
    assert "no chart of 24 patches is found" in ran.stderr
    assert "--corners" in ran.stderr
    assert ran.stderr.count("\n") == 1


def test_every_space_holds_the_same_light_and_is_stated(lab, session):
    samples = {}
    run("reduce", session, "--color", lab / "color.json")
    for space in ("linear-srgb", "xyz", "acescg", "camera"):
        run("reduce", session, "--space", space)
        samples[space] = Samples.load(session / "samples.nc")
    srgb, xyz = samples["linear-srgb"], samples["xyz"]
    names = [(each.color_space, each.color_made_by) for each in samples.values()]
    assert names == [
        ("linear sRGB", "chart"), ("XYZ D65", "chart"), ("ACEScg", "chart"), ("camera RGB", "none"),
    ]  # fmt: skip
    assert xyz.channels == ("X", "Y", "Z")
    stated = json.loads((lab / "color.json").read_text())["sha256"]
    assert xyz.provenance["color"] == stated
    np.testing.assert_allclose(xyz.value, srgb.value @ XYZ_FROM_SRGB.T, rtol=1e-9)
    camera = samples["camera"]
    np.testing.assert_allclose(camera.value @ matrix_in(lab / "color.json")[0].T, xyz.value)
    # photons err in each camera channel by itself
    noise = camera.components["photon"] ** 2 @ (matrix_in(lab / "color.json")[0] ** 2).T
    np.testing.assert_allclose(xyz.components["photon"], np.sqrt(noise), rtol=1e-6)
    # a session stays in the space that it was reduced to
    run("reduce", session)
    assert Samples.load(session / "samples.nc").color_space == "camera RGB"


def test_without_a_chart_the_frames_matrix_is_named(session):
    run("reduce", session, "--space", "xyz")
    samples = Samples.load(session / "samples.nc")
    assert (samples.color_space, samples.color_made_by) == ("XYZ D65", "ColorMatrix1")
    assert "color" not in samples.provenance


def test_a_table_states_its_space_and_is_read_back(lab, session, tmp_path):
    run("reduce", session, "--space", "xyz", "--csv", tmp_path / "xyz.csv")
    read = read_table(tmp_path / "xyz.csv")
    assert (read.color_space, read.channels) == ("XYZ D65", ("X", "Y", "Z"))
    np.testing.assert_array_equal(read.value, Samples.load(session / "samples.nc").value)
    text = (tmp_path / "xyz.csv").read_text().replace("XYZ D65", "Adobe RGB", 1)
    (tmp_path / "xyz.csv").write_text(text)
    with pytest.raises(BadFileError, match="line 2, column color_space: 'Adobe RGB' is none of"):
        read_table(tmp_path / "xyz.csv")


def test_sessions_of_several_sets_of_lamps_make_one_file(lab, session, tmp_path):
    plan = Plan.load(lab / "chart.json")
    (shot,) = plan.shots
    few = shot.model_copy(update={"lamps": shot.lamps[:3]})
    plan.model_copy(update={"shots": (few,)}).save(tmp_path / "few.json")
    run(
        "capture", "--sim", "--rig", lab / "rig.toml", "--material", "colorchecker",
        "--plan", tmp_path / "few.json", "-o", tmp_path / "few",
    )  # fmt: skip
    both = tmp_path / "both.json"
    told = run("color", lab / "chart", tmp_path / "few", "-o", both)
    assert "11 lamps, published values" in told
    assert "3 lamps, published values" in told
    run("reduce", session, "--color", both)
    by_both = Samples.load(session / "samples.nc").value
    run("reduce", session, "--color", lab / "color.json")
    # of the two, the matrix of the lamps that the session lit
    np.testing.assert_array_equal(by_both, Samples.load(session / "samples.nc").value)
    with pytest.raises(BadInputError, match="two of the same lamps"):
        run("color", lab / "chart", lab / "chart", "-o", both)


def test_a_camera_without_a_matrix_needs_a_chart_or_keeps_its_own_channels(lab):
    color = ColorFile.load(lab / "color.json", load_rig(lab / "rig.toml"))
    sensor = Sensor(**color.camera.model_dump(), color_matrix=())
    with pytest.raises(BadInputError, match="state no color matrix, so nothing tells their colors"):
        Wanted("xyz").coloring(sensor)
    own = Wanted("camera").coloring(sensor)
    np.testing.assert_allclose(own.white, 1.0, rtol=1e-6)
    np.testing.assert_array_equal(own.camera_from_space, np.eye(3))
    by_chart = Wanted("xyz", color).coloring(sensor)
    assert by_chart.made_by == "chart"
    np.testing.assert_allclose(np.linalg.inv(by_chart.camera_from_space), color.charts[0].matrix)
    with pytest.raises(BadInputError, match="was shot with camera gonio simulated camera RGGB"):
        Wanted("xyz", color).coloring(replace(sensor, model="another"))


def edited(path, change):
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))
    return path


def test_a_changed_file_is_refused(lab, session, tmp_path):
    copy = shutil.copy(lab / "color.json", tmp_path / "color.json")
    edited(copy, lambda content: content["charts"][0].update(lamps=[1]))
    with pytest.raises(BadFileError, match="has changed since it was written"):
        run("reduce", session, "--color", copy)


def test_the_matrix_of_another_rig_is_refused(lab, tmp_path):
    with pytest.raises(BadFileError, match="is of rig"):
        ColorFile.load(lab / "color.json", default_rig())


def test_lamps_that_differ_have_a_matrix_each(lab):
    color = ColorFile.load(lab / "color.json", load_rig(lab / "rig.toml"))
    only = color.charts[0]
    # one alone serves whatever is lit
    assert color.under([1]) is only
    warm = only.model_copy(update={"lamps": (1, 2)})
    both = color.model_copy(update={"charts": (only, warm)})
    assert both.under([2, 1]) is warm
    with pytest.raises(BadInputError, match="and none for 1, which this session lit"):
        both.under([1])
    assert lit_lamps([[2, 1], [1, 2]]) == (1, 2)
    with pytest.raises(BadInputError, match="were lit by 2 sets of lamps"):
        lit_lamps([[1], [1, 2]])


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--chart", "mine.csv"), "need a lamp's; name it with --lamp"),
        (("--lamp", "a.csv", "--lamp", "b.csv"), "is there 2 times for 1 session;"),
        (("--lamp", "nowhere.csv"), "nowhere.csv: no such file"),
    ],
)
def test_options_that_do_not_go_together_are_refused(lab, tmp_path, options, problem):
    with pytest.raises(GonioError, match=problem):
        run("color", lab / "chart", *options, "-o", tmp_path / "color.json")
