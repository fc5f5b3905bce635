"""Ways of the arms: what is swept on the way, and the way round what is in the way."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from gonio.clearance import limits_of, not_free
from gonio.detours import with_approach
from gonio.errors import BadInputError
from gonio.paths import blocked, free_way
from gonio.rig import AXES, Rig, default_rig
from gonio.swept import SPARE, START_SKEW_S, leg_blocked
from gonio.timemodel import move_time, route_times

RIG = default_rig()
BOX = {"min_mm": (500, 500, 200), "max_mm": (700, 800, 900)}


def rig_with(axes=None, **arm):
    """Return the built-in rig with keys of the arm, and of axes: {"view_phi": {...}}."""
    data = RIG.model_dump()
    data["arm"].update(arm)
    for name, keys in (axes or {}).items():
        data["axis"][name].update(keys)
    return Rig.model_validate(data)


QUICK_LIGHT = {"light_phi": {"max_velocity_deg_s": 90.0, "max_acceleration_deg_s2": 200.0}}
LAZY_VIEW = {"view_theta": {"max_velocity_deg_s": 0.5, "max_acceleration_deg_s2": 0.1}}
APPROACHED = {name: {"approach_deg": 3.0} for name in AXES}
RIGS = {
    "separation": rig_with(min_separation_deg=12.0),
    "box": rig_with(keep_out=[BOX]),
    "both": rig_with(min_separation_deg=30.0, keep_out=[BOX]),
    "uneven": rig_with(QUICK_LIGHT | LAZY_VIEW, min_separation_deg=20.0, keep_out=[BOX]),
    "approached": rig_with(APPROACHED, min_separation_deg=12.0, keep_out=[BOX]),
}
few = settings(max_examples=25)
rigs = pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)

theta = st.one_of(st.floats(-1, 91), st.sampled_from([0.0, 15.0, 75.0, 90.0]))
phi = st.one_of(st.floats(-5, 365), st.sampled_from([0.0, 45.0, 180.0, 360.0]))
pose = st.tuples(theta, phi, theta, phi).map(np.array)


def free(poses, rig):
    """Return whether poses are free, and so are those at which axes may start their approach."""
    run_up = [(0.0, rig.axis[name].approach_deg) for name in AXES]
    low, high = zip(
        *[(rig.axis[name].min_deg, rig.axis[name].max_deg) for name in AXES], strict=True
    )
    starts = [np.clip(poses - np.array(back), low, high) for back in product(*run_up)]
    return not np.any(list(not_free(np.concatenate(starts), rig).values()))


def positions(start, goal, times_s, rig, late_s=(0.0,) * 4):
    """Return where the axes are, shape (n, 4), by adding up their accelerations in closed form."""
    ways = []
    for i, name in enumerate(AXES):
        axis, way = rig.axis[name], goal[i] - start[i]
        end = float(move_time(way, axis))
        ramp = min(axis.max_velocity_deg_s / axis.max_acceleration_deg_s2, end / 2)
        peak = axis.max_acceleration_deg_s2 * ramp
        knots = np.array([0.0, ramp, end - ramp, end])
        fine = np.union1d(knots, np.linspace(0.0, end, 4001))
        speed = np.interp(fine, knots, [0.0, peak, peak, 0.0])
        gone = np.concatenate([[0.0], np.cumsum(np.diff(fine) * (speed[1:] + speed[:-1]) / 2)])
        ways.append(start[i] + np.sign(way) * np.interp(times_s - late_s[i], fine, gone))
    return np.stack(ways, axis=1)


def margins(poses, rig):
    return np.array([limit.margin(poses[:, limit.columns]) for limit in limits_of(rig)])


@rigs
@few
@given(pose, pose, st.tuples(*[st.floats(0, START_SKEW_S)] * 4))
def test_what_is_not_blocked_keeps_clear_however_the_axes_start(rig, start, goal, late_s):
    ends = np.array([start, goal])
    assume(free(ends, rig))
    if leg_blocked(start[None], goal[None], rig)[0]:
        return
    times_s = np.linspace(0, route_times(ends, rig)[0] + START_SKEW_S, 3000)
    least = margins(positions(start, goal, times_s, rig, late_s), rig).min(axis=1)
    assert (least >= np.minimum(margins(ends, rig).min(axis=1), 0.0) - 1e-6).all()


@rigs
@few
@given(pose, pose)
def test_what_is_blocked_comes_near(rig, start, goal):
    ends = np.array([start, goal])
    assume(free(ends, rig))
    if not leg_blocked(start[None], goal[None], rig)[0]:
        return
    times_s = np.linspace(0, route_times(ends, rig)[0], 3000)
    swept = positions(start, goal, times_s, rig)
    # what the arms turn while others may not have started yet
    speed = np.abs(np.gradient(swept, times_s, axis=0)).sum(axis=1).max()
    assert margins(swept, rig).min() <= SPARE + 2 * np.radians(speed * START_SKEW_S) + 0.01


@rigs
@few
@given(pose, st.integers(0, 3), st.floats(0, 1))
def test_an_axis_that_moves_alone_sweeps_the_same_there_and_back(rig, start, axis, part):
    goal = start.copy()
    travel = rig.axis[AXES[axis]]
    goal[axis] = travel.min_deg + part * (travel.max_deg - travel.min_deg)
    assume(free(np.array([start, goal]), rig))
    there, back = leg_blocked(np.array([start, goal]), np.array([goal, start]), rig)
    assert there == back


@given(pose, pose)
def test_without_separation_and_boxes_every_way_is_straight(start, goal):
    assert not blocked(start[None], goal[None], RIG)[0]
    way = free_way(start, goal, RIG)
    assert way.poses_deg.tolist() == [goal.tolist()]
    assert way.seconds == route_times(np.array([start, goal]), RIG)[0]


@rigs
@given(pose, pose)
@settings(max_examples=10, derandomize=True)
def test_a_way_is_free_and_takes_no_less_than_straight_on_and_so_does_the_way_back(
    rig, start, goal
):
    assume(free(np.array([start, goal]), rig))
    for begin, end in ((start, goal), (goal, start)):
        way = free_way(begin, end, rig)
        passed = np.array([begin, *way.poses_deg])
        assert ((way.poses_deg[-1] - end) % [1000, 360, 1000, 360] == 0).all()
        assert not np.any(list(not_free(passed, rig).values()))
        assert not leg_blocked(passed[:-2], passed[1:-1], rig).any()
        assert not blocked(passed[-2:-1], passed[-1:], rig)[0]
        assert way.seconds >= route_times(passed[[0, -1]], rig)[0] - 1e-9
        if not blocked(begin[None], end[None], rig)[0]:
            assert len(way.poses_deg) == 1


@few
@given(st.lists(st.tuples(pose, pose), max_size=8))
def test_many_moves_at_once_are_as_one_by_one(moves):
    rig = RIGS["both"]
    starts, goals = np.array(moves, float).reshape(-1, 2, 4).transpose(1, 0, 2)
    together = blocked(starts, goals, rig).tolist()
    alone = [bool(blocked(a[None], b[None], rig)[0]) for a, b in zip(starts, goals, strict=True)]
    assert together == alone


MOVES = [
    # rig, start, goal, whether straight on is blocked
    ("separation", (60, 40, 60, 60), (60, 60, 60, 40), True),
    ("separation", (60, 40, 60, 60), (60, 140, 60, 160), False),
    ("separation", (60, 0, 60, 20), (60, 0, 60, 340), False),
    ("separation", (60, 20, 60, 0), (60, 20, 60, 350), True),
    # over the pole: the azimuth turns the other arm about itself
    ("separation", (0, 0, 30, 0), (0, 300, 30, 0), False),
    ("separation", (20, 0, 0, 0), (20, 180, 0, 0), False),
    ("separation", (20, 0, 0, 0), (0, 0, 20, 0), True),
    # at the limit, going away from it and on along it
    ("separation", (12, 0, 0, 0), (40, 0, 0, 0), False),
    ("separation", (12, 0, 0, 0), (12, 300, 0, 0), False),
    # side by side: either may start 30 ms before the other, and turns 0.9 deg in that
    ("separation", (90, 0, 90, 12.5), (90, 200, 90, 212.5), True),
    ("separation", (90, 0, 90, 13.5), (90, 200, 90, 213.5), False),
    ("box", (55, 0, 0, 0), (55, 90, 0, 0), True),
    ("box", (0, 0, 55, 90), (0, 0, 55, 0), True),
    ("box", (10, 0, 0, 0), (10, 90, 0, 0), False),
    # before the goal the arm goes on by three degrees, into the other
    ("separation", (60, 300, 60, 244), (60, 260, 60, 244), False),
    ("approached", (60, 300, 60, 244), (60, 260, 60, 244), True),
    ("approached", (60, 0, 60, 344), (60, 0, 60, 320), False),
]


@pytest.mark.parametrize(("name", "start", "goal", "hit"), MOVES)
def test_moves(name, start, goal, hit):
    rig = RIGS[name]
    assert blocked([start], [goal], rig)[0] == hit
    way = free_way(start, goal, rig)
    assert (len(way.poses_deg) > 1) == hit
    assert way.poses_deg[-1].tolist() == list(goal)


@given(pose, pose)
@settings(max_examples=20)
# round about: an azimuth is where it should be, from the wrong side, two legs before the end
@example(np.array([72.0, 74.0, 0.0, 181.0]), np.array([27.0, 0.0, 78.0, 0.0]))
def test_every_axis_comes_to_its_goal_from_the_one_side_whatever_the_way(start, goal):
    rig = RIGS["approached"]
    goal = np.maximum(goal, [2.0, -2.0, 2.0, -2.0])
    assume(free(np.array([start, goal]), rig))
    way = free_way(start, goal, rig)
    steps = np.diff(with_approach(np.array([start, *way.poses_deg]), rig), axis=0)
    for step in steps.T[np.abs(way.poses_deg[-1] - start) > 0.03]:
        assert step[np.flatnonzero(np.abs(step) > 1e-9)[-1]] >= 3.0 - 1e-9


@pytest.mark.parametrize("home", [(-3, -10, -3, -10), (0, 0, 0, 0), (30, 50, 31, 50)])
def test_arms_that_stand_too_close_part(home):
    rig = RIGS["separation"]
    way = free_way(home, (45, 0, 0, 0), rig)
    passed = np.array([home, *way.poses_deg])
    apart = []
    for start, goal in pairwise(passed):
        times_s = np.linspace(0, route_times(np.array([start, goal]), rig)[0], 500)
        apart.extend(margins(positions(start, goal, times_s, rig), rig)[0])
    assert (np.diff(np.minimum(apart, 0.0)) >= -1e-6).all()
    assert apart[-1] > 0


def test_encoders_may_be_off_by_as_much_as_is_in_position():
    rig = RIGS["separation"]
    assert not blocked([(11.97, 0, 0, 0)], [(40, 0, 0, 0)], rig)[0]
    with pytest.raises(BadInputError, match="closer than 12 deg"):
        free_way((40, 0, 0, 0), (11.97, 0, 0, 0), rig)


def test_no_pose_on_the_way_is_nearer_than_allowed_by_a_hair():
    """Between a box and a light at the pole, past stops at 22 deg that are just too near to it."""
    wall = {"min_mm": (-300, 500, 200), "max_mm": (300, 1500, 1000)}
    rig = rig_with(min_separation_deg=22.1, keep_out=[wall])
    start, goal = np.array([50.0, 0, 0, 0]), np.array([50.0, 180, 0, 0])
    assert blocked(start[None], goal[None], rig)[0]
    assert not np.any([*not_free(free_way(start, goal, rig).poses_deg, rig).values()])


RING = {
    "view_theta": {"min_deg": 60.0, "max_deg": 80.0},
    "view_phi": {"min_deg": 175.0, "max_deg": 185.0},
    "light_theta": {"min_deg": 60.0, "max_deg": 80.0},
}


def test_what_no_way_leads_to_is_named():
    rig = rig_with(RING, min_separation_deg=30.0)
    says = r"no free way from view 70/180, light 70/90 deg .* to view 70/180, light 70/270 deg"
    with pytest.raises(BadInputError, match=says):
        free_way((70, 180, 70, 90), (70, 180, 70, 270), rig)


def test_the_other_way_round_where_the_travel_allows():
    rig = rig_with(RING | {"light_phi": {"min_deg": -360.0}}, min_separation_deg=30.0)
    way = free_way((70, 180, 70, 90), (70, 180, 70, 270), rig)
    assert way.poses_deg[-1].tolist() == [70, 180, 70, -90]


def test_a_way_of_many_legs():
    """Between two walls, arms that have to keep far apart take many steps to change places."""
    walls = [{"min_mm": (x, -900, 100), "max_mm": (x + 100, 900, 1200)} for x in (-400, 300)]
    rig = rig_with(keep_out=walls, min_separation_deg=40.0)
    start, goal = np.array([60.0, 270, 15, 240]), np.array([15.0, 300, 75, 255])
    passed = np.array([start, *free_way(start, goal, rig).poses_deg])
    assert len(passed) > 4
    assert not leg_blocked(passed[:-1], passed[1:], rig).any()
