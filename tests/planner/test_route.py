import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees
from planner import local_search
from planner.construct import nearest_neighbour
from planner.few import FEW
from planner.metric import TimeMetric
from planner.route import plan_route

from .rigs import RIG, WIDE, between_s, least_s, move_s, rig_of, route_s, stands_deg

RIGS = {
    "without a direction": rig_of(),
    "one-sided approach": rig_of(approach_deg=5.0),
    "from above": rig_of(approach_deg=-20.0),
    "crawling": rig_of(max_velocity_deg_s=1e-3, max_acceleration_deg_s2=1e-3),
    "darting": rig_of(max_velocity_deg_s=1e4, max_acceleration_deg_s2=1e5),
    "many turns": rig_of(WIDE),
    "many turns, one-sided": rig_of(WIDE, approach_deg=5.0),
}
rigs = st.sampled_from(list(RIGS.values()))


def angles(thetas, most):
    theta, phi = st.sampled_from(thetas), st.sampled_from([0.0, 18.0, 90.0, 200.0, 345.0])
    return st.lists(st.tuples(theta, phi, theta, phi), min_size=1, max_size=most).map(np.array)


shots = angles([0.0, 15.0, 30.0, 75.0], most=10)
few_shots = angles([15.0, 30.0, 75.0], most=6)
"""None at a pole: a rig that reaches each phi once has one pose for each."""


@given(shots, rigs)
def test_a_route_takes_each_shot_once_in_the_time_that_it_states(angles_deg, rig):
    route = plan_route(angles_deg, rig)
    assert sorted(route.order.tolist()) == list(range(len(angles_deg)))
    stands = stands_deg(angles_deg, route)
    assert route.moving_s == pytest.approx(route_s(stands, rig))
    assert 0.0 <= route.bound_s <= route.moving_s
    for column, name in ((1, "view_phi"), (3, "light_phi")):
        for phi in stands[:, column]:
            rig.check_reach(name, phi)


@given(shots, rigs)
def test_turns_keep_the_direction(angles_deg, rig):
    route = plan_route(angles_deg, rig)
    assert ((route.phi_deg >= 0) & (route.phi_deg < 360)).all()
    wanted, stands = angles_deg[route.order], stands_deg(angles_deg, route)
    for side in (slice(0, 2), slice(2, 4)):
        told, taken = (from_degrees(*each[:, side].T) for each in (wanted, stands))
        assert told == pytest.approx(taken, abs=1e-12)
    off_the_pole = wanted[:, [0, 2]] > 0
    assert (route.phi_deg == wanted[:, [1, 3]])[off_the_pole].all()


@given(shots, rigs)
def test_it_is_never_slower_than_the_nearest_neighbour(angles_deg, rig):
    metric = TimeMetric.of(angles_deg, rig)
    neighbour_s = metric.total(nearest_neighbour(metric))
    assert plan_route(angles_deg, rig).moving_s <= neighbour_s * (1 + 1e-9)


@given(few_shots, st.sampled_from(list(RIGS.values())[:5]))
def test_few_shots_get_the_best_route_of_all(angles_deg, rig):
    best_s = least_s(between_s(angles_deg, rig))
    assert plan_route(angles_deg, rig).moving_s == pytest.approx(best_s, abs=1e-6)


@given(angles([0.0, 15.0, 30.0, 75.0], most=FEW))
def test_turns_do_not_lengthen_a_route(angles_deg):
    turning, fixed = (plan_route(angles_deg, rig_of(travel)) for travel in (WIDE, (0.0, 359.0)))
    assert turning.moving_s <= fixed.moving_s * (1 + 1e-9)


def test_an_axis_goes_on_to_360_rather_than_back_to_0():
    angles_deg = np.array([[75.0, phi, 15.0, 90.0] for phi in (300.0, 330.0, 0.0)])
    route = plan_route(angles_deg, RIG)
    assert sorted(stands_deg(angles_deg, route)[:, 1]) == [300.0, 330.0, 360.0]
    assert plan_route(angles_deg, rig_of()).moving_s > 2 * route.moving_s


def test_at_the_pole_the_azimuth_stays_where_it_is():
    angles_deg = np.array([[15.0, 200.0, 15.0, 90.0], [0.0, 0.0, 15.0, 90.0]])
    route = plan_route(angles_deg, RIG)
    assert route.phi_deg[:, 0].tolist() == [200.0, 200.0]


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_shots_that_coincide_cost_no_time(rig, count):
    route = plan_route(np.tile([15.0, 90.0, 0.0, 0.0], (count, 1)), rig)
    assert sorted(route.order.tolist()) == list(range(count))
    assert (route.moving_s, route.bound_s) == (0.0, 0.0)


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_route_repeats_to_the_bit(rig):
    angles_deg = np.random.default_rng(2).uniform(1, 75, (60, 4)).round()
    one, other = (plan_route(angles_deg, rig) for _ in range(2))
    assert (one.order == other.order).all()
    assert (one.phi_deg == other.phi_deg).all()
    assert (one.turns == other.turns).all()
    assert (one.moving_s, one.bound_s) == (other.moving_s, other.bound_s)


class Blocked:
    """Moves between some poses take longer; counts what it is asked."""

    def __init__(self, rig, slow):
        self.rig, self.slow, self.asked = rig, slow, 0

    def __call__(self, starts_deg, goals_deg):
        self.asked += len(starts_deg)
        assert starts_deg.shape == goals_deg.shape == (len(starts_deg), 4)
        return np.array([self.one(a, b) for a, b in zip(starts_deg, goals_deg, strict=True)])

    def one(self, start, goal):
        extra = self.slow.get((tuple(start), tuple(goal)), 0.0)
        return move_s(start, goal, self.rig) + extra


@given(few_shots.map(lambda each: np.unique(each, axis=0)), st.data())
def test_a_route_goes_round_what_is_blocked(angles_deg, data):
    rig = data.draw(st.sampled_from([RIGS["without a direction"], RIGS["one-sided approach"]]))
    poses = [tuple(each) for each in angles_deg.tolist()]
    pairs = st.tuples(st.sampled_from(poses), st.sampled_from(poses))
    slow = data.draw(st.dictionaries(pairs, st.sampled_from([0.5, 30.0, 1e4]), max_size=6))
    way_s = Blocked(rig, slow)
    route = plan_route(angles_deg, rig, way_s=way_s)
    stands = stands_deg(angles_deg, route)
    true_s = sum(way_s.one(a, b) for a, b in itertools.pairwise(stands))
    assert route.moving_s == pytest.approx(true_s)
    all_s = np.array([[way_s.one(a, b) for b in angles_deg] for a in angles_deg])
    assert route.moving_s == pytest.approx(least_s(all_s), abs=1e-6)


def test_only_moves_of_good_routes_are_asked_for():
    angles_deg = np.random.default_rng(5).uniform(1, 75, (80, 4)).round()
    way_s = Blocked(RIG, {})
    free, asked = plan_route(angles_deg, RIG), plan_route(angles_deg, RIG, way_s=way_s)
    assert asked.moving_s <= free.moving_s
    assert way_s.asked < 2 * len(angles_deg)


def test_a_way_that_there_is_not_is_not_taken():
    angles_deg = np.array([[15.0, 10.0 * i, 15.0, 90.0] for i in range(6)])

    def way_s(starts_deg, goals_deg):
        steps = np.abs(goals_deg[:, 1] - starts_deg[:, 1])
        return np.where((steps > 0) & (steps < 15), np.inf, 1.0)

    route = plan_route(angles_deg, RIG, way_s=way_s)
    assert np.isfinite(route.moving_s)


def test_without_a_compiler_routes_are_longer_but_routes(monkeypatch):
    angles_deg = np.random.default_rng(6).uniform(1, 75, (40, 4)).round()
    for rig in (RIG, RIGS["one-sided approach"]):
        compiled = plan_route(angles_deg, rig)
        with monkeypatch.context() as patch:
            patch.setattr(local_search, "_route", None)
            route = plan_route(angles_deg, rig)
        assert "NumPy" in route.method
        assert "NumPy" not in compiled.method
        assert sorted(route.order.tolist()) == list(range(40))
        assert 0 < route.bound_s <= compiled.moving_s <= route.moving_s < 1.3 * compiled.moving_s


def test_rings_are_followed_step_by_step():
    """A lone arm on a ring goes round it, never across."""
    phi = np.arange(24) * 15.0
    angles_deg = np.stack([np.full(24, 75.0), phi, np.full(24, 15.0), np.zeros(24)], axis=1)
    shuffled = angles_deg[np.random.default_rng(3).permutation(24)]
    stands = stands_deg(shuffled, plan_route(shuffled, RIG))
    assert (np.abs(np.diff(stands[:, 1])) == 15.0).all()
