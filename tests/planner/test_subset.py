import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees, paper_angles_deg, paper_directions
from planner.subset import angles_between, farthest_from, farthest_points

DIRECTIONS = paper_directions()

# the 14 lights of density sixth, as (theta, phi) in degrees
SIXTH = [
    (0, 0), (30, 90), (45, 40), (45, 140), (45, 220), (45, 320), (75, 0), (75, 45), (75, 90),
    (75, 135), (75, 180), (75, 225), (75, 270), (75, 315),
]  # fmt: skip


def test_the_sixth_from_the_pole():
    theta, phi = paper_angles_deg()
    chosen = farthest_points(DIRECTIONS, 14, start=0)
    assert list(zip(theta[chosen], phi[chosen], strict=True)) == SIXTH


@given(count=st.integers(1, 81), start=st.integers(0, 80))
def test_chosen_are_distinct_and_hold_the_start(count, start):
    chosen = farthest_points(DIRECTIONS, count, start)
    assert len(set(chosen.tolist())) == count
    assert start in chosen
    assert (np.diff(chosen) > 0).all()


@given(count=st.integers(2, 40))
def test_the_chosen_cover_at_least_as_well_as_half_the_gap_between_them(count):
    """Greedy guarantee: no direction is farther from the chosen than they are from each other."""
    chosen = DIRECTIONS[farthest_points(DIRECTIONS, count, start=0)]
    apart = angles_between(chosen, chosen)[~np.eye(count, dtype=bool)].min()
    assert angles_between(DIRECTIONS, chosen).min(axis=1).max() <= apart + 1e-9


def test_ties_go_to_the_lowest_index():
    ring = from_degrees(75.0, np.arange(4) * 90.0)
    pole = from_degrees([0.0], [0.0])
    assert farthest_from(ring, pole) == 0
    assert farthest_points(np.concatenate([pole, ring]), 3, start=0).tolist() == [0, 1, 2]


def test_round_off_does_not_break_ties():
    theta = 75.0 + 1e-12 * np.arange(4)
    ring = from_degrees(theta, np.arange(4) * 90.0)
    assert farthest_from(ring, from_degrees([0.0], [0.0])) == 0


@pytest.mark.parametrize("degrees", [0.0, 1e-7, 1.0, 90.0, 150.0, 180.0])
def test_angles_keep_their_precision(degrees):
    pole = np.array([[0.0, 0.0, 1.0]])
    angle = np.radians(degrees)
    other = np.array([[np.sin(angle), 0.0, np.cos(angle)]])
    assert angles_between(pole, other)[0, 0] == pytest.approx(angle, rel=1e-12, abs=1e-15)
