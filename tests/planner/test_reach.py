"""Which pairs a rig can take, and why not the others, in the plan and by the command line."""

import numpy as np
import pytest

from gonio.clearance import not_free
from gonio.errors import BadInputError
from gonio.plan import Plan
from gonio.rig import Rig, default_rig, default_rig_text
from planner.candidates import candidates_named, paper_candidates
from planner.make import make_plan
from planner.reach import reach_of

PAPER = paper_candidates()
RINGS = candidates_named("rings:0x1,30x8,60x16,80x20")
BOX = {"min_mm": (500, 500, 200), "max_mm": (700, 800, 900)}
TRAVEL = "beyond the travel of an axis"
BOXED = "inside a keep-out box (arm.keep_out)"
APPROACH = ", on the approach from one side (approach_deg)"


def rig_with(axes=None, **arm):
    data = default_rig().model_dump()
    data["arm"].update(arm)
    for name, keys in (axes or {}).items():
        data["axis"][name].update(keys)
    return Rig.model_validate(data)


def poses_of(lights, views):
    """Return the poses of all pairs, shape (L V, 4), light by light."""
    light, view = (
        np.stack([each.theta_deg, each.phi_deg], axis=1) for each in (lights, views)
    )  # fmt: skip
    return np.concatenate([np.tile(view, (len(light), 1)), np.repeat(light, len(view), axis=0)], 1)


SHORT = {"view_theta": {"max_deg": 62.0}, "light_phi": {"max_deg": 300.0}}
RIGS = [
    rig_with(),
    rig_with(SHORT),
    rig_with(min_separation_deg=20.0),
    rig_with(keep_out=[BOX]),
    rig_with(SHORT, min_separation_deg=25.0, keep_out=[BOX]),
    rig_with({"view_phi": {"min_deg": 290.0, "max_deg": 301.0}}, min_separation_deg=3.0),
]


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize(("lights", "views"), [(PAPER, PAPER), (RINGS, PAPER), (PAPER, RINGS)])
def test_the_pairs_are_the_free_poses(rig, lights, views):
    reach = reach_of(lights, views, rig)
    expected = not_free(poses_of(lights, views), rig)
    shape = len(lights), len(views)
    assert (reach.allowed.ravel() == ~np.any([*expected.values()], axis=0)).all()
    assert reach.allowed.shape == shape
    # each pair that is not allowed is under one reason
    counted = np.sum([*reach.reasons.values()], axis=0)
    assert (counted == ~reach.allowed).all()
    for reason in (TRAVEL, BOXED):
        mask = reach.reasons.get(reason, np.zeros(shape, bool))
        assert (mask.ravel() == alone(expected, reason, shape, rig, lights, views)).all()


def alone(expected, reason, shape, rig, lights, views):
    """Return which poses have a reason, the angle between the arms not asked for."""
    data = rig.model_dump()
    data["arm"]["min_separation_deg"] = 0.0
    return not_free(poses_of(lights, views), Rig.model_validate(data)).get(
        reason, np.zeros(shape, bool).ravel()
    )


def test_a_grazing_limit():
    reach = reach_of(PAPER, RINGS, rig_with(), max_theta_deg=60.0)
    (reason,) = [name for name, mask in reach.reasons.items() if mask.any()]
    assert reason == "beyond the grazing limit of 60 deg"
    expected = np.outer(PAPER.theta_deg <= 60.0, RINGS.theta_deg <= 60.0)
    assert (reach.allowed == expected).all()


@pytest.mark.parametrize("degrees", [-1.0, 90.5, float("nan")])
def test_a_grazing_limit_that_is_none(degrees):
    with pytest.raises(BadInputError, match=r"max theta is .* deg; give 0 to 90"):
        reach_of(PAPER, PAPER, rig_with(), max_theta_deg=degrees)


def test_an_approach_counts():
    """A run-up of 3 deg in azimuth or theta, of either arm or both, at 15 deg from each other."""
    rig = rig_with({"view_phi": {"approach_deg": 3.0}}, min_separation_deg=12.0)
    reach = reach_of(PAPER, PAPER, rig)
    reason = f"closer than 12 deg (arm.min_separation_deg){APPROACH}"
    light, view = np.nonzero(reach.together[reason])
    # the view comes from below, so from a light that stands there
    assert len(light)
    assert ((PAPER.phi_deg[view] - PAPER.phi_deg[light]) % 360 < 30).all()
    still = reach_of(PAPER, PAPER, rig_with(min_separation_deg=12.0))
    assert (still.allowed == reach.allowed | reach.together[reason]).all()


NONE = [
    ({"min_separation_deg": 179.0}, "all pairs are closer than 179 deg .arm.min_separation_deg.;"),
    (
        {"keep_out": [{"min_mm": (-3000, -3000, 100), "max_mm": (3000, 3000, 3000)}]},
        "none of the 81 directions can be taken by light_theta and light_phi: 81 inside a keep-out",
    ),
    (
        {"keep_out": [{"min_mm": (-3000, -3000, 100), "max_mm": (3000, 3000, 3000)}],
         "min_separation_deg": 12.0},
        "81 inside a keep-out box",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("arm", "says"), NONE, ids=["apart", "swallowed", "both"])
def test_a_rig_that_can_take_none(arm, says):
    with pytest.raises(BadInputError, match=says):
        reach_of(PAPER, PAPER, rig_with(**arm))


def test_wide_arms_say_what_keeps_them_apart():
    reach = reach_of(PAPER, PAPER, rig_with(arm_width_mm=10000.0, min_separation_deg=1.0))
    assert next(iter(reach.together)) == "closer than 68.32 deg (arm_width_mm, lamp_width_mm)"


@pytest.mark.parametrize("degrees", [12.0, pytest.param(30.0, marks=pytest.mark.slow), 45.0])
def test_what_a_plan_leaves_out_adds_up(degrees):
    rig = rig_with(SHORT, min_separation_deg=degrees, keep_out=[BOX])
    plan = make_plan(rig, max_theta_deg=70.0)
    left = {each.reason: each.shots for each in plan.left_out}
    assert sum(left.values()) + len(plan.shots) == 6561
    closer = f"closer than {degrees:g} deg (arm.min_separation_deg)"
    assert left.get(closer, 0) == 196 - len(plan.shots)
    assert {TRAVEL, BOXED, "beyond the grazing limit of 70 deg"} <= set(left)
    freely = make_plan(rig, max_theta_deg=70.0, shots=20, criterion="random")
    left = {each.reason: each.shots for each in freely.left_out}
    assert left[closer] == reach_of(PAPER, PAPER, rig, 70.0).together[closer].sum() > 0
    assert sum(left.values()) + 20 == 6561


def test_the_command_line_takes_boxes_and_a_grazing_limit(gonio, tmp_path):
    text = default_rig_text().replace(
        "keep_out = []",
        "keep_out = [{ min_mm = [500.0, 500.0, 200.0], max_mm = [700.0, 800.0, 900.0] }]",
    )
    (tmp_path / "rig.toml").write_text(text)
    result = gonio(
        "plan", "--criterion", "farthest", "--rig", "rig.toml", "--max-theta", "62",
        "--density", 3, "--no-page",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert BOXED in " ".join(result.stdout.split())
    assert "beyond the grazing limit of 62 deg" in " ".join(result.stdout.split())
    shots = Plan.load(tmp_path / "plan.json").shots
    assert max(max(shot.light_theta_deg, shot.view_theta_deg) for shot in shots) == 60.0
    assert gonio("capture", "--sim", "--rig", "rig.toml").returncode == 0
