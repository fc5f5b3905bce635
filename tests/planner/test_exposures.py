"""Predicted exposures: each shot's interval of brightness is seen, with the fewest."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gonio.errors import BadInputError
from gonio.rig import default_rig
from gonio.timing import default_timing
from planner.exposures import BRIGHTEST, FAINTEST, Exposer
from planner.make import make_plan

RIG = default_rig()
Z95 = 1.6448536269514722
EXPOSURES = st.lists(
    st.sampled_from([1e-5, 1e-4, 0.002, 0.02, 0.2, 2.0, 20.0, 300.0]), min_size=1, unique=True
).map(lambda exposures: tuple(sorted(exposures)))


class Belief:
    """A prior that expects the same everywhere."""

    def __init__(self, mean, sd):
        self.mean, self.sd = mean, sd

    def expected(self, light, view):
        return np.full(len(light), self.mean), np.full(len(light), self.sd)


def bracket(exposures_s, mean, sd, cosine=1.0):
    exposer = Exposer(exposures_s, full_s=0.1, white_s=1e9)
    (chosen,) = exposer.choose(np.array([mean]), np.array([sd]), np.array([cosine]))
    return chosen


def is_seen(exposures_s, fill_s):
    """Whether one of the exposures neither fills the range nor leaves the shot faint."""
    return any(FAINTEST * fill_s <= e <= BRIGHTEST * fill_s * (1 + 1e-9) for e in exposures_s)


@given(EXPOSURES, st.floats(-15, 8), st.floats(0, 3), st.floats(0.05, 1))
def test_whatever_can_be_seen_is_seen(exposures_s, mean, sd, cosine):
    chosen = bracket(exposures_s, mean, sd, cosine)
    assert set(chosen) <= set(exposures_s)
    assert list(chosen) == sorted(set(chosen))
    for log in np.linspace(mean - Z95 * sd, mean + Z95 * sd, 41):
        fill_s = 0.1 / cosine / np.exp(log)
        if is_seen(exposures_s, fill_s):
            assert is_seen(chosen, fill_s)


@given(EXPOSURES, st.floats(-15, 8), st.floats(0, 3))
def test_fewer_would_not_see_it(exposures_s, mean, sd):
    chosen = bracket(exposures_s, mean, sd)
    logs = np.linspace(mean - Z95 * sd, mean + Z95 * sd, 41)
    fills = [0.1 / np.exp(log) for log in logs]
    assume(all(is_seen(exposures_s, fill) for fill in fills))
    for fewer in combinations(exposures_s, len(chosen) - 1):
        assert not all(is_seen(fewer, fill) for fill in fills) or not fewer or len(chosen) == 1


def test_too_bright_for_all_takes_the_shortest_and_too_dark_the_longest():
    assert bracket((0.002, 0.02, 0.2), 20.0, 0.1) == (0.002,)
    assert bracket((0.002, 0.02, 0.2), -20.0, 0.1) == (0.2,)


def test_the_surer_the_fewer():
    exposures = (0.002, 0.02, 0.2, 2.0)
    counts = [len(bracket(exposures, -2.0, sd)) for sd in (3.0, 1.5, 0.1)]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 1


def test_grazing_light_and_beyond_all_bounds():
    assert bracket((0.002, 0.2), 0.0, 1.0, cosine=0.0) == (0.2,)
    assert bracket((0.002, 0.2), 1e6, 1e6) == (0.002, 0.2)


def test_one_shot_suits_the_white_reference():
    exposer = Exposer((0.002, 0.02, 0.2, 2.0), full_s=0.1, white_s=0.4)
    dark = exposer.choose(np.full(3, -9.0), np.zeros(3), np.ones(3))
    assert dark == [(0.2, 2.0), (2.0,), (2.0,)]
    suits = exposer.choose(np.array([-9.0, -1.2]), np.zeros(2), np.ones(2))
    assert suits == [(2.0,), (0.2,)]


def test_a_plan_takes_what_is_predicted_and_counts_it():
    plans = [
        make_plan(RIG, views=3, lights=3, bracket=name, prior=lambda: Belief(-2.0, 0.2))
        for name in ("all", "predicted")
    ]
    taken = {shot.exposures_s for shot in plans[1].shots}
    assert taken <= {(0.02,), (0.2,)}
    assert plans[1].estimates.exposing_s < 0.2 * plans[0].estimates.exposing_s
    assert plans[1].estimates.frames == 9 + 8 * len(taken)


def test_a_sensitive_camera_exposes_shorter():
    timing = default_timing(RIG).model_copy(update={"white_level_s": 0.004, "measured": True})
    plan = make_plan(
        RIG, views=3, lights=3, bracket="predicted", timing=timing, prior=lambda: Belief(-2.0, 0.2)
    )
    assert {shot.exposures_s for shot in plan.shots} == {(0.002,)}


def test_without_a_prior_nothing_is_predicted():
    with pytest.raises(BadInputError, match="need a prior"):
        make_plan(RIG, bracket="predicted")
