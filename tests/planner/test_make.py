import numpy as np
import pytest

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadInputError
from gonio.rig import Rig, default_rig
from gonio.timemodel import pose_angles_deg, route_times
from planner.candidates import paper_candidates
from planner.density import PAPER_SUBSETS, split_density
from planner.field import Field
from planner.make import make_plan
from planner.subset import angles_between, farthest_points

RIG = default_rig()


def rig_with(**changes) -> Rig:
    """Return the built-in rig with fields replaced, by dotted names with __ for the dot."""
    data = RIG.model_dump()
    for name, value in changes.items():
        *path, last = name.split("__")
        table = data
        for key in path:
            table = table[key]
        table[last] = value
    return Rig.model_validate(data)


def pairs(plan):
    return {(*shot.direction_deg("view"), *shot.direction_deg("light")) for shot in plan.shots}


DENSITIES = [
    # density, views, lights
    pytest.param("va-ia", 81, 81, marks=pytest.mark.slow),
    ("vs-ia", 14, 81),
    ("va-is", 81, 14),
    ("vs-is", 14, 14),
    ("sixth", 14, 14),
    (1, 1, 1),
    ("7", 7, 7),
]
assert set(PAPER_SUBSETS) < {"va-ia"} | {each[0] for each in DENSITIES[1:]}


@pytest.mark.parametrize(
    ("density", "views", "lights"), DENSITIES, ids=["va-ia", *(d[0] for d in DENSITIES[1:])]
)
def test_densities(density, views, lights):
    view_density, light_density = split_density(density)
    plan = make_plan(RIG, views=view_density, lights=light_density)
    assert (plan.selection.views, plan.selection.lights) == (views, lights)
    assert len(plan.shots) == len(pairs(plan)) == views * lights
    assert [shot.index for shot in plan.shots] == list(range(views * lights))
    assert sum(left.shots for left in plan.left_out) == 6561 - views * lights


BAD = [
    # views, lights, what the line says
    ("82", "sixth", "--views '82' is no"),
    ("sixth", 0, "--lights 0 is no"),
    (-1, "sixth", "--views -1 is no"),
    ("", "sixth", "--views '' is no"),
    ("half", "sixth", "all, sixth, a number from 1 to 81"),
    ("1.5", "sixth", "--views '1.5' is no"),
    ("9" * 5000, "sixth", "views"),
    ("82", "82", "--density '82' is no"),
]


@pytest.mark.parametrize(("views", "lights", "says"), BAD, ids=range(len(BAD)))
def test_densities_that_are_none(views, lights, says):
    with pytest.raises(BadInputError, match=says):
        make_plan(RIG, views=views, lights=lights)


def test_an_unknown_criterion_lists_the_known():
    with pytest.raises(
        BadInputError,
        match="'best' is not known; use i-optimal, d-optimal, energy, farthest, random",
    ):
        make_plan(RIG, criterion="best")


def test_shots_are_in_route_order():
    plan = make_plan(RIG)
    angles_deg = pose_angles_deg(plan.shots)
    ring_by_ring = angles_deg[np.lexsort(angles_deg[:, [1, 0, 3, 2]].T)]
    assert route_times(angles_deg, RIG).sum() < 0.6 * route_times(ring_by_ring, RIG).sum()


def test_a_shot_takes_every_exposure_with_every_lamp_on():
    shot = make_plan(RIG, views=1, lights=1).shots[0]
    assert shot.exposures_s == RIG.camera.exposures_s
    assert [(lamp.n, lamp.mA) for lamp in shot.lamps] == [(n, 700.0) for n in range(1, 12)]


def test_lights_start_at_the_pole_and_views_far_from_them():
    plan = make_plan(RIG, views=1, lights=14)
    lights = from_degrees(*np.transpose([(s.light_theta_deg, s.light_phi_deg) for s in plan.shots]))
    assert (lights[:, 2] == 1.0).any()
    view = from_degrees([plan.shots[0].view_theta_deg], [plan.shots[0].view_phi_deg])
    assert angles_between(view, lights).min() > np.radians(25)


def test_few_pairs_are_measured_both_ways():
    plan = make_plan(RIG)
    both = {p for p in pairs(plan) if (*p[2:], *p[:2]) in pairs(plan) and p[:2] < p[2:]}
    assert plan.selection.reciprocal_pairs == len(both) == 21
    assert make_plan(RIG, views=5, lights=5).selection.reciprocal_pairs == 0


def test_equal_sets_would_measure_far_more():
    lights = farthest_points(paper_directions(), 14, start=0)
    measured = np.zeros((81, 81), dtype=bool)
    measured[np.ix_(lights, lights)] = True
    field = Field(paper_candidates(), paper_candidates(), measured)
    assert field.reciprocal(measured) == 14 * 13 // 2


def test_the_same_input_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        make_plan(RIG, views=20, lights=10).save(tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_another_rig_gives_another_hash():
    slower = rig_with(axis__view_phi__max_velocity_deg_s=3.0)
    plans = [make_plan(rig, views=4, lights=4) for rig in (RIG, slower)]
    assert plans[0].rig_sha256 != plans[1].rig_sha256
    assert plans[0].sha256 != plans[1].sha256
    assert plans[0].estimates.moving_s < plans[1].estimates.moving_s


def test_short_travel_leaves_directions_out():
    rig = rig_with(axis__view_theta__max_deg=62.0)
    plan = make_plan(rig, views="all", lights=1)
    assert len(plan.shots) == 57
    assert max(shot.view_theta_deg for shot in plan.shots) == 60.0
    beyond, density = plan.left_out
    assert (beyond.reason, beyond.shots) == ("beyond the travel of an axis", 24 * 81)
    assert density.shots == 57 * 80


TRAVEL = [
    # changes to the rig, views, what the line says
    (
        {"axis__view_theta__max_deg": 62.0},
        58,
        "the limits of the plan and clear of everything are 57 of 81",
    ),
    (
        {"axis__view_theta__max_deg": 1.0},
        1,
        "white reference: view_theta 45 deg is beyond the axis' travel of -1 to 1 deg",
    ),
    ({"axis__light_theta__min_deg": 80.0}, 1, "none of the 81 .* light_theta and light_phi"),
    ({"axis__light_phi__min_deg": 359.0}, 1, "none of the 81 .* light_theta and light_phi"),
    ({"arm__min_separation_deg": 179.0}, 14, "all pairs are closer than"),
    (
        {"arm__keep_out": [{"min_mm": (-3e3, -3e3, 100), "max_mm": (3e3, 3e3, 3e3)}]},
        14,
        "none of the 81 .* 81 inside a keep-out box",
    ),
]


@pytest.mark.parametrize(("changes", "views", "says"), TRAVEL, ids=[t[2] for t in TRAVEL])
def test_a_rig_that_cannot(changes, views, says):
    with pytest.raises(BadInputError, match=says):
        make_plan(rig_with(**changes), views=views)


def test_pairs_too_close_are_left_out():
    plan = make_plan(rig_with(arm__min_separation_deg=15.0), views="all", lights=6)
    light = from_degrees(*np.transpose([(s.light_theta_deg, s.light_phi_deg) for s in plan.shots]))
    view = from_degrees(*np.transpose([(s.view_theta_deg, s.view_phi_deg) for s in plan.shots]))
    angle = np.degrees(np.arccos(np.clip(np.sum(light * view, axis=1), -1, 1)))
    # the pole and its ring of six are 15 deg apart, which is enough
    assert angle.min() == pytest.approx(15.0, abs=1e-6)
    _, left_out = plan.left_out
    assert left_out.reason == "closer than 15 deg (arm.min_separation_deg)"
    assert left_out.shots == 81 * 6 - len(plan.shots)
