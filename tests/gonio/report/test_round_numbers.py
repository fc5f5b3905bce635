"""Ticks of logarithmic axes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.report.figures import round_numbers


@given(st.floats(1e-6, 1e6), st.floats(1.05, 1e8))
def test_there_are_three_or_more_within_the_axis(low, ratio):
    ticks = round_numbers(low, low * ratio)
    assert 3 <= len(ticks) <= 20
    assert low <= min(ticks)
    assert max(ticks) <= low * ratio
    assert ticks == sorted(set(ticks))


ROUND = {
    "many decades": ((0.5, 2000.0), [1, 10, 100, 1000]),
    "one decade": ((0.9, 11.0), [1, 2, 5, 10]),
    "half a decade": ((4.6, 29.0), [5, 10, 20]),
    "less": ((0.11, 0.34), [0.15, 0.2, 0.3]),
    "a factor of two": ((0.00072, 0.00129), [0.0008, 0.0009, 0.001, 0.0011, 0.0012]),
    "hardly any": ((9.5, 11.0), [9.5, 9.75, 10, 10.25, 10.5, 10.75, 11]),
}


@pytest.mark.parametrize(("limits", "ticks"), ROUND.values(), ids=ROUND)
def test_they_are_as_round_as_can_be(limits, ticks):
    assert round_numbers(*limits) == pytest.approx(ticks)
