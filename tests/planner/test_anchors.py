"""Anchors: one pair through the whole scan."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from gonio.cli.plan import command
from gonio.plan import Plan
from gonio.rig import default_rig
from planner.anchors import with_anchors
from planner.make import make_plan

RIG = default_rig()


@pytest.fixture(scope="module")
def plan():
    return make_plan(RIG, views=3, lights=3)


@pytest.mark.parametrize(("every", "places"), [(4, (0, 5, 10, 12)), (9, (0, 10)), (50, (0, 10))])
def test_one_pair_comes_before_each_few_shots_and_at_the_end(plan, every, places):
    anchored = with_anchors(plan, every, RIG)
    anchors = [shot for shot in anchored.shots if shot.anchor]
    assert tuple(shot.index for shot in anchors) == places
    assert len({(shot.direction_deg("light"), shot.direction_deg("view")) for shot in anchors}) == 1
    others = [shot.model_copy(update={"index": 0}) for shot in anchored.shots if not shot.anchor]
    assert others == [shot.model_copy(update={"index": 0}) for shot in plan.shots]
    assert [shot.index for shot in anchored.shots] == list(range(len(anchored.shots)))


def test_anchors_are_in_the_estimates(plan):
    anchored = with_anchors(plan, 3, RIG)
    added = len(anchored.shots) - len(plan.shots)
    assert anchored.estimates.frames == plan.estimates.frames + 4 * added
    assert anchored.estimates.total_s > plan.estimates.total_s
    assert anchored.route.moving_s > plan.route.moving_s >= anchored.route.bound_s


def test_the_anchor_is_neither_grazing_nor_a_highlight(plan):
    angles_deg = [(75, 0), (40, 50), (10, 40), (0, 75), (60, 60)]
    shots = tuple(
        shot.model_copy(update={"light_theta_deg": light, "view_theta_deg": view})
        for shot, (light, view) in zip(plan.shots, angles_deg, strict=False)
    )
    anchor = with_anchors(plan.model_copy(update={"shots": shots}), 9, RIG).shots[0]
    assert (anchor.light_theta_deg, anchor.view_theta_deg) == (10, 40)


def test_a_plan_without_anchors_says_nothing_of_them(plan, tmp_path):
    plan.save(tmp_path / "plan.json")
    assert "anchor" not in (tmp_path / "plan.json").read_text()
    with_anchors(plan, 4, RIG).save(tmp_path / "anchored.json")
    text = (tmp_path / "anchored.json").read_text()
    assert text.count('"anchor":true') + text.count('"anchor": true') == 4
    assert Plan.load(tmp_path / "anchored.json").shots[0].anchor


def test_the_command(tmp_path):
    runner = CliRunner()
    path = tmp_path / "plan.json"
    options = ["--density", "3", "--criterion", "farthest", "--no-page", "-o", str(path)]
    done = runner.invoke(command, [*options, "--anchors", "4"])
    assert done.exit_code == 0, done.output
    assert "4 of these shots repeat one pair" in done.output
    assert sum(shot.anchor for shot in Plan.load(Path(path)).shots) == 4
