"""How quick planned routes are, against raster order, nearest neighbour and OR-Tools' guided local
search at equal time, and how near what no route can beat.

OR-Tools comes with `pip install -e '.[bench]'`; without it the rest is compared. All get the same
shots at the same angles of the axes; `ours, turning` may choose turns, and azimuths at the pole.
"""

import time
from importlib.util import find_spec

import numpy as np
import pytest

from gonio.rig import Rig, default_rig
from planner.candidates import paper_candidates
from planner.construct import nearest_neighbour
from planner.criteria import criterion_named
from planner.density import count_of, split_density
from planner.field import Field
from planner.metric import TimeMetric
from planner.route import plan_route

CASES = ["vs-is", "va-is", "va-ia"]
NS = 1e9


def shots_of(density):
    """Return the angles of a product subset in raster order, shape (n, 4): view inside light."""
    directions = paper_candidates()
    field = Field(directions, directions, np.ones((81, 81), dtype=bool))
    views, lights = (count_of(each, 81, 81, "view", "density") for each in split_density(density))
    light, view = np.nonzero(criterion_named("farthest").product(field, lights, views).measured)
    theta, phi = directions.theta_deg, directions.phi_deg
    return np.stack([theta[view], phi[view], theta[light], phi[light]], axis=1)


def fixed(angles_deg):
    """Return shots and a rig with one pose for each: next to the pole, less than a turn."""
    data = default_rig().model_dump()
    for name in ("view_phi", "light_phi"):
        data["axis"][name] |= {"min_deg": 0.0, "max_deg": 359.0}
    return np.maximum(angles_deg, [1e-9, 0.0, 1e-9, 0.0]), Rig.model_validate(data)


def guided_local_search(metric, seconds):
    """Return OR-Tools' route in about so many seconds; None when it finds none."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    count = len(metric)
    everything = np.arange(count)
    # a last shot, nowhere, makes the route open; equal numbers are one object, or it would not fit
    numbers, rows = {}, []
    for shot in everything:
        times = np.append(metric.between(shot, everything), 0.0) * NS
        rows.append([numbers.setdefault(int(t), int(t)) for t in times.tolist()])
    rows.append([0] * (count + 1))
    manager = pywrapcp.RoutingIndexManager(count + 1, 1, count)
    routing = pywrapcp.RoutingModel(manager)
    routing.SetArcCostEvaluatorOfAllVehicles(routing.RegisterTransitMatrix(rows))
    settings = pywrapcp.DefaultRoutingSearchParameters()
    settings.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    settings.local_search_metaheuristic = (
        routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    )
    settings.time_limit.FromMilliseconds(round(1000 * seconds))
    solution = routing.SolveWithParameters(settings)
    if solution is None:
        return None
    order, index = [], solution.Value(routing.NextVar(routing.Start(0)))
    while not routing.IsEnd(index):
        order.append(manager.IndexToNode(index))
        index = solution.Value(routing.NextVar(index))
    return np.array(order)


def timed(call, *arguments):
    """Return what a call returns, and the processor's seconds that it took."""
    start = time.process_time()
    return call(*arguments), time.process_time() - start


@pytest.mark.parametrize("density", CASES)
def test_route(density):
    angles_deg = shots_of(density)
    metric = TimeMetric.of(angles_deg, default_rig())
    start = time.perf_counter()
    ours, ours_s = timed(plan_route, *fixed(angles_deg))
    waited_s = time.perf_counter() - start
    turning, turning_s = timed(plan_route, angles_deg, default_rig())
    others = {
        "raster order": (np.arange(len(metric)), 0.0),
        "nearest neighbour": timed(nearest_neighbour, metric),
    }
    if find_spec("ortools"):
        others["OR-Tools"] = timed(guided_local_search, metric, waited_s)
    moving = {
        name: (np.inf if order is None else metric.total(order), ours.bound_s, took_s)
        for name, (order, took_s) in others.items()
    }
    found = moving | {
        "ours": (ours.moving_s, ours.bound_s, ours_s),
        "ours, turning": (turning.moving_s, turning.bound_s, turning_s),
    }
    print(f"\n{density}, {len(metric)} shots: moving, gap to the bound, found in")  # noqa: T201
    for name, (moving_s, bound_s, took_s) in found.items():
        gap = 1 - bound_s / moving_s
        print(f"  {name:20} {moving_s:8.1f} s {gap:8.2%} {took_s:8.1f} s")  # noqa: T201
    assert all(ours.moving_s < moving_s for moving_s, *_ in moving.values())
    assert turning.moving_s < ours.moving_s * 1.001
    assert turning_s < 20
