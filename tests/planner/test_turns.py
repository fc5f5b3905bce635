from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees
from planner.metric import TimeMetric
from planner.places import Places, turns_within
from planner.turns import with_best_places

from .rigs import RIG, WIDE, rig_of

TURNS = [
    # phi, travel, turns
    (0.0, (-5.0, 365.0), [0, 1]),
    (5.0, (-5.0, 365.0), [0, 1]),
    (5.1, (-5.0, 365.0), [0]),
    (355.0, (-5.0, 365.0), [0, -1]),
    (354.9, (-5.0, 365.0), [0]),
    (0.0, (0.0, 359.0), [0]),
    (270.0, (-180.0, 180.0), [-1]),
    (10.0, (-730.0, 730.0), [0, -1, 1, -2, 2]),
    (100.0, (200.0, 300.0), []),
]


@pytest.mark.parametrize(("phi", "travel", "turns"), TURNS)
def test_turns_that_the_travel_allows(phi, travel, turns):
    assert turns_within(phi, rig_of(travel).axis.view_phi) == turns


angles = st.lists(
    st.tuples(st.sampled_from([0.0, 15.0, 75.0]), st.sampled_from([0.0, 2.0, 180.0, 355.0])),
    min_size=1,
    max_size=8,
).map(np.array)


@given(angles)
def test_every_place_is_its_direction_and_within_travel(angles_deg):
    places = Places.of(angles_deg, RIG.axis.view_phi)
    wanted = from_degrees(*angles_deg.T)
    for shot, direction in enumerate(places.direction):
        for theta, phi in places.angles_deg[places.choices[direction]]:
            RIG.check_reach("view_phi", phi)
            assert from_degrees(theta, phi) == pytest.approx(wanted[shot], abs=1e-12)
    assert (places.angles_deg[places.plain] == angles_deg).all()


def test_the_pole_is_tried_at_a_bounded_number_of_azimuths():
    phi = np.linspace(0, 359, 1000)
    angles_deg = np.stack([np.append(0.0, np.full(999, 40.0)), phi], axis=1)
    assert len(Places.of(angles_deg, rig_of().axis.view_phi)) <= 1000 + 72


@given(angles.filter(lambda each: len(each) < 5), st.sampled_from([0.0, 5.0]))
def test_no_places_of_one_arm_make_the_route_shorter(angles_deg, approach_deg):
    rig = rig_of(WIDE, approach_deg=approach_deg)
    view = Places.of(angles_deg, rig.axis.view_phi)
    light = Places.of(np.tile([30.0, 100.0], (len(angles_deg), 1)), rig_of().axis.light_phi)
    metric = TimeMetric.between_places(view, light, rig)
    order = np.arange(len(angles_deg))
    best = with_best_places(metric, order, (view, light))
    ways = np.array(list(product(*(view.choices[direction] for direction in view.direction))))
    stands = np.stack([ways, np.broadcast_to(light.plain, ways.shape)], axis=-1)
    times = metric.times(stands[:, :-1], stands[:, 1:]).sum(axis=1)
    assert best.total(order) == pytest.approx(times.min())


@given(angles, angles)
def test_places_of_both_arms_never_lengthen_a_route(views_deg, lights_deg):
    count = min(len(views_deg), len(lights_deg))
    rig = rig_of(WIDE)
    view = Places.of(views_deg[:count], rig.axis.view_phi)
    light = Places.of(lights_deg[:count], rig.axis.light_phi)
    metric = TimeMetric.between_places(view, light, rig)
    order = np.arange(count)
    best = with_best_places(metric, order, (view, light))
    assert best.total(order) <= metric.total(order)
    for arm, places in enumerate((view, light)):
        owner = np.searchsorted(places.first, best.poses[:, arm], side="right") - 1
        assert (owner == places.direction).all()
