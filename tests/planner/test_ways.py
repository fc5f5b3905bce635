import numpy as np
import pytest

from gonio.errors import BadInputError
from gonio.paths import blocked, free_way
from gonio.rig import Rig
from gonio.timemodel import pose_angles_deg, route_times
from gonio.timing import default_timing
from planner.make import make_plan
from planner.ways import seconds_of_ways

from .rigs import RIG


def rig_apart(degrees, approach_deg=0.0):
    data = RIG.model_dump()
    data["arm"]["min_separation_deg"] = degrees
    for axis in data["axis"].values():
        axis["approach_deg"] = approach_deg
    return Rig.model_validate(data)


# the light passes over the view, or past it
STARTS = np.array([[30.0, 90.0, 60.0, 90.0], [30.0, 90.0, 60.0, 180.0]])
GOALS = np.array([[30.0, 90.0, 10.0, 90.0], [30.0, 90.0, 60.0, 210.0]])


@pytest.mark.parametrize("approach_deg", [0.0, 3.0])
def test_a_blocked_move_takes_what_its_way_round_takes(approach_deg):
    rig = rig_apart(12.0, approach_deg)
    timing = default_timing(rig)
    assert blocked(STARTS, GOALS, rig).tolist() == [True, False]
    over, past = seconds_of_ways(rig, timing)(STARTS, GOALS)
    straight = [
        route_times(np.stack(move), rig, timing)[0] for move in zip(STARTS, GOALS, strict=True)
    ]
    assert past == straight[1]
    way = free_way(STARTS[0], GOALS[0], rig)
    # the built-in timing is that of the rig file and a little latency at each stop
    assert way.seconds < over < way.seconds + 1.0
    assert over > straight[0]


def test_a_rig_without_limits_has_no_ways_to_look_for():
    assert seconds_of_ways(RIG, default_timing(RIG)) is None


def test_no_way_takes_for_ever():
    rig = rig_apart(170.0)
    timing = default_timing(rig)
    assert np.isinf(seconds_of_ways(rig, timing)(STARTS, GOALS)).all()


def test_a_plan_pays_for_ways_round():
    rig = rig_apart(25.0)
    plan = make_plan(rig, views=6, lights=6)
    angles_deg, timing = pose_angles_deg(plan.shots), default_timing(rig)
    moves = angles_deg[:-1], angles_deg[1:]
    assert plan.route.moving_s == pytest.approx(seconds_of_ways(rig, timing)(*moves).sum())
    straight_s = route_times(angles_deg, rig, timing).sum()
    assert plan.route.bound_s <= straight_s
    detours_s = plan.route.moving_s - straight_s
    free = make_plan(RIG, views=6, lights=6)
    assert plan.estimates.moving_s > plan.route.moving_s
    assert detours_s >= 0.0
    assert free.route.moving_s < free.estimates.moving_s


def test_shots_between_which_there_is_no_way_are_refused(monkeypatch):
    monkeypatch.setattr(
        "planner.shots.seconds_of_ways",
        lambda rig, timing: lambda starts, goals: np.full(len(starts), np.inf),
    )
    with pytest.raises(BadInputError, match="no order of the 4 shots"):
        make_plan(RIG, views=2, lights=2)
