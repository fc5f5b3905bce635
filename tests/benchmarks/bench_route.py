"""How much quicker the planned route is than raster order and nearest neighbour, and how near the
bound that no route can beat: each shot is entered and left by no less than its two nearest moves.
"""

import time

import numpy as np
import pytest

from gonio.rig import default_rig
from gonio.timemodel import pose_angles_deg
from planner.make import make_plan
from planner.metric import TimeMetric
from planner.route import nearest_neighbour

CASES = [("vs-is", "sixth", "sixth"), ("va-is", "all", "sixth"), ("va-ia", "all", "all")]


def bound_s(metric):
    """Return a lower bound of any route's moving time in seconds."""
    nearest = np.empty((len(metric), 2))
    everything = np.arange(len(metric))
    for shot in everything:
        away = np.delete(metric.between(np.int64(shot), everything), shot)
        nearest[shot] = np.partition(away, 1)[:2]
    # a route has two ends, which lack one of the two moves
    return nearest.sum() / 2 - nearest.max()


@pytest.mark.parametrize(("name", "views", "lights"), CASES, ids=[c[0] for c in CASES])
def test_route(name, views, lights):
    rig = default_rig()
    start = time.perf_counter()
    plan = make_plan(rig, views=views, lights=lights)
    planning_s = time.perf_counter() - start
    angles_deg = pose_angles_deg(plan.shots)
    # lights outside, views inside, ring by ring
    raster = angles_deg[np.lexsort(angles_deg[:, [1, 0, 3, 2]].T)]
    metric = TimeMetric.of(raster, rig)
    moving_s = plan.estimates.moving_s
    raster_s = metric.total(np.arange(len(raster)))
    neighbor_s = metric.total(nearest_neighbour(metric))
    print(  # noqa: T201
        f"\n{name}: {len(raster)} shots, moving {moving_s:.0f} s = {moving_s / raster_s:.2f} x "
        f"raster order, {moving_s / neighbor_s:.3f} x nearest neighbour, "
        f"{moving_s / bound_s(metric):.3f} x lower bound; planned in {planning_s:.1f} s"
    )
    assert moving_s < 0.75 * raster_s
    assert moving_s <= neighbor_s
    assert planning_s < 10
