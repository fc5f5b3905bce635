"""`gonio plan` with a scene, as a user runs it; few candidates keep it quick."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.plan import Plan
from gonio.words import several

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
PAIRS = 19 * 19
TABLE = """
[[surface]]
shape = "flat"
tilt_deg = 0
[[light]]
kind = "direction"
elevation_deg = 60
azimuth_deg = 90
[[viewer]]
kind = "direction"
elevation_deg = 60
azimuth_deg = {azimuth}
spread_deg = 20
"""


@pytest.fixture(scope="module")
def prior(tmp_path_factory):
    """Make a prior of few materials, which is soon read."""
    from nnbrdf.prior import MaterialPrior

    path = tmp_path_factory.mktemp("prior") / "prior.npz"
    MaterialPrior.generate(100).save(path)
    return path


@pytest.fixture
def plan_few(gonio, prior):
    """Run `gonio plan` with few candidates and a small prior, and no page unless asked for."""
    few = ("--candidates", "rings:0x1,30x6,60x12", "--prior", prior, "--no-page")

    def run(*options):
        return gonio("plan", *few, *options)

    return run


@pytest.fixture
def table(tmp_path):
    (tmp_path / "table.toml").write_text(TABLE.format(azimuth=180))
    return "table.toml"


def row(plan, start):
    return next(each for each in plan.left_out if each.reason.startswith(start))


def test_a_scene_takes_fewer_shots_and_says_what_that_spares(plan_few, tmp_path, table):
    result = plan_few("--scene", table, "--page")
    assert result.returncode == 0, result.stderr
    assert plan_few("-o", "plain.json").returncode == 0
    plan, plain = (Plan.load(tmp_path / name) for name in ("plan.json", "plain.json"))
    rows = json.loads((tmp_path / "plain.json").read_text())["left_out"]
    assert all(set(each) == {"reason", "shots"} for each in rows)
    assert len(plan.shots) < len(plain.shots)
    assert sum(each.shots for each in plan.left_out) == PAIRS - len(plan.shots)
    unasked = row(plan, "the scene does not ask for")
    freely = row(plan, "by choosing pairs freely")
    spared = len(plain.shots) - len(plan.shots)
    assert freely.spared_shots + unasked.spared_shots == spared
    seconds = plain.estimates.total_s - plan.estimates.total_s
    assert freely.spared_min + unasked.spared_min == pytest.approx(seconds / 60)
    assert unasked.error_inside < 0.001
    assert unasked.error_outside > 0.01
    assert f"spares {several(freely.spared_shots, 'shot')}" in " ".join(result.stdout.split())
    assert "in what counts" in result.stdout


def away_deg(shots):
    """Return how far shots are on average from the pair that the scene looks at, either way."""
    light, view = (
        from_degrees(
            [shot.axis_deg(f"{side}_theta") for shot in shots],
            [shot.axis_deg(f"{side}_phi") for shot in shots],
        )
        for side in ("light", "view")
    )
    east, south = from_degrees([30, 30], [0, 270])
    cosines = [np.minimum(a @ east, b @ south) for a, b in ((light, view), (view, light))]
    return float(np.degrees(np.arccos(np.maximum(*cosines).clip(-1, 1))).mean())


def test_shots_are_spent_where_the_scene_looks(plan_few, tmp_path, table):
    away = []
    for name, options in (("scene", ("--scene", table)), ("plain", ())):
        assert plan_few(*options, "--shots", 12, "-o", name).returncode == 0
        shots = Plan.load(tmp_path / name).shots
        assert len(shots) == 12
        away.append(away_deg(shots))
    assert away[0] < 35
    assert away[1] > 50
    unasked = row(Plan.load(tmp_path / "scene"), "the scene does not ask for")
    assert unasked.spared_shots == 0
    assert unasked.error_inside < 0 < unasked.error_outside


def test_views_and_lights_go_with_a_scene(plan_few, tmp_path, table):
    assert plan_few("--scene", table, "--density", "3").returncode == 0
    plan = Plan.load(tmp_path / "plan.json")
    assert plan.selection.views <= 3
    assert plan.selection.lights <= 3


def test_turning_the_scene_changes_the_plan(plan_few, tmp_path, table):
    (tmp_path / "other.toml").write_text(TABLE.format(azimuth=0))
    for name in (table, "other.toml"):
        assert plan_few("--scene", name, "-o", f"{name}.json").returncode == 0
    plans = [Plan.load(tmp_path / f"{name}.json") for name in (table, "other.toml")]
    assert plans[0].shots != plans[1].shots


def test_isotropic_materials_need_one_azimuth_of_the_light(plan_few, tmp_path, table):
    result = plan_few("--isotropic", "--page")
    assert result.returncode == 0, result.stderr
    plan = Plan.load(tmp_path / "plan.json")
    assert {shot.light_phi_deg for shot in plan.shots} == {0.0}
    assert row(plan, "equal to others at another azimuth").spared_min > 0
    assert plan_few("--scene", table, "--isotropic").returncode == 0
    both = Plan.load(tmp_path / "plan.json")
    assert len(both.shots) < len(plan.shots)
    assert {shot.light_phi_deg for shot in both.shots} == {0.0}


def test_color_spares_nothing_and_the_plan_says_so(plan_few, tmp_path):
    for name, options in (("color", ()), ("mono", ("--mono",))):
        assert plan_few("--shots", 9, *options, "-o", f"{name}.json").returncode == 0
    color, mono = (Plan.load(tmp_path / f"{name}.json") for name in ("color", "mono"))
    assert mono.shots == color.shots
    assert row(mono, "shots for color").spared_shots == 0


def test_the_same_scene_gives_the_same_bytes(plan_few, tmp_path, table):
    for name in ("a", "b"):
        assert plan_few("--scene", table, "-o", name).returncode == 0
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_the_picture_shows_where_the_light_is(plan_few, tmp_path, table):
    from matplotlib.image import imread

    command = "--scene", table, "--shots", 8, "--plot-demand", "demand.png"
    assert "wrote demand.png" in plan_few(*command).stdout
    image = imread(tmp_path / "demand.png")[..., :3]
    dark = (image[..., 2] - image[..., 0] > 0.3) & (image[..., 0] < 0.4)
    third = image.shape[1] // 3
    # at the marked edge, to the right, and at the lower side, where south is
    assert np.argwhere(dark[:, :third])[:, 1].mean() > 0.5 * third
    assert np.argwhere(dark[:, third : 2 * third])[:, 0].mean() > 0.5 * image.shape[0]


DARK = TABLE.format(azimuth=0).replace("elevation_deg = 60", "elevation_deg = -60", 1)
BAD = [
    # options, what the line says
    (("--scene", "none.toml"), "none.toml: no such file"),
    (("--scene", "dark.toml"), "the scene asks for no pair of directions"),
    (("--scene", "broken.toml"), "surface: is missing"),
    (("--scene", "table.toml", "--material", "paint"), "give --scene FILE.xml"),
    (("--material", "paint"), "give --scene FILE.xml"),
    (("--scene", "scene.xml"), "name its id with --material"),
    (("--plot-demand", "d.png"), "give --scene"),
    (("--scene", "table.toml", "--plot-demand", "plan.json"), "give the picture another name"),
    (("--scene", "table.toml", "--criterion", "energy"), "does not ask what counts"),
    (("--isotropic", "--criterion", "random"), "does not ask what counts"),
    (("--scene", "table.toml", "--weight", "cosine"), "leave out --weight"),
    (("--scene", "table.toml", "--shots", "5000"), "shots is 5000; give 1 to"),
]


@pytest.mark.parametrize(("options", "says"), BAD, ids=[" ".join(b[0]) for b in BAD])
def test_what_does_not_go_together_is_one_line(gonio, tmp_path, table, options, says):
    (tmp_path / "dark.toml").write_text(DARK)
    (tmp_path / "broken.toml").write_text("light = 3")
    result = gonio("plan", *options)
    assert result.returncode == 2
    assert says in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "plan.json").exists()


def test_a_single_pair_gives_a_small_plan(plan_few, tmp_path, table):
    (tmp_path / "one.toml").write_text(TABLE.format(azimuth=180).replace("spread_deg = 20", ""))
    result = plan_few("--scene", "one.toml")
    assert result.returncode == 0, result.stderr
    plan = Plan.load(tmp_path / "plan.json")
    assert len(plan.shots) <= 9


def test_a_rig_that_cannot_look_where_the_scene_does(plan_few, tmp_path, table):
    from gonio.rig import default_rig_text

    text = default_rig_text().replace("max_deg = 91.0", "max_deg = 10.0")
    (tmp_path / "rig.toml").write_text(text)
    low = TABLE.format(azimuth=180).replace("elevation_deg = 60", "elevation_deg = 10")
    (tmp_path / "low.toml").write_text(low)
    result = plan_few("--scene", "low.toml", "--rig", "rig.toml", "--shots", 1)
    assert result.returncode == 2
    assert "no pair is left" in result.stderr


@pytest.mark.parametrize("name", ["wall", "car", "garment"])
def test_the_examples_are_scenes(name):
    from planner.scene.scene import load_scene

    assert load_scene(EXAMPLES / f"{name}.toml").surface


def test_a_traced_scene_is_planned_for(plan_few, tmp_path):
    pytest.importorskip("mitsuba")
    scene = EXAMPLES / "shop.xml"
    result = plan_few("--scene", scene, "--material", "shirt", "--shots", 9)
    assert result.returncode == 0, result.stderr
    assert "the scene does not ask for" in result.stdout


def test_without_the_renderer_a_traced_scene_says_what_to_install(
    gonio_from_nothing, tmp_path, monkeypatch
):
    (tmp_path / "mitsuba.py").write_text("raise ImportError('none')")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}")
    result = gonio_from_nothing("plan", "--scene", EXAMPLES / "shop.xml", "--material", "shirt")
    assert result.returncode == 2
    assert "pip install 'gonio[mitsuba]'" in result.stderr


def test_hours_and_a_scene_go_together(plan_few, tmp_path, table):
    result = plan_few("--scene", table, "--hours", "0.08", "--page")
    assert result.returncode == 0, result.stderr
    plan = Plan.load(tmp_path / "plan.json")
    assert 3600 * 0.07 < plan.estimates.total_s <= 3600 * 0.08
    assert row(plan, "the scene does not ask for").error_inside < 0
    asked = f"what {table} asks for"
    assert (plan.selection.demand, len(plan.selection.demand_sha256)) == (asked, 64)
    assert f"weighted by {asked}" in " ".join(result.stdout.split())
    assert "What the scene asks for" in (tmp_path / "plan.html").read_text()
