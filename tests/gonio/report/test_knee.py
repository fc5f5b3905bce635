import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.report.knee import best_within, knee
from gonio.report.pareto import Point


def points(seconds, errors):
    return [Point(f"{i}", s, e) for i, (s, e) in enumerate(zip(seconds, errors, strict=True))]


CURVES = {
    # seconds, errors, which is the knee
    "corner": ([1, 2, 10], [1.0, 0.1, 0.09], "1"),
    "corner late": ([1, 2, 3, 4, 40], [1.0, 0.8, 0.5, 0.1, 0.09], "3"),
    "beaten points do not count": ([1, 2, 2.5, 10], [1.0, 0.1, 0.5, 0.09], "1"),
    "unsorted": ([10, 1, 2], [0.09, 1.0, 0.1], "2"),
    "one point": ([5], [1.0], None),
    "two points": ([1, 5], [1.0, 0.5], None),
    "three of one": ([5, 5, 5], [1.0, 1.0, 1.0], None),
    "even rate": ([0, 1, 2, 3], [1.0, 0.5, 0.25, 0.125], None),
    "ever better": ([1, 2, 3], [1.0, 0.9, 0.1], None),
}


@pytest.mark.parametrize("name", CURVES)
def test_knees_of_known_curves(name):
    seconds, errors, expected = CURVES[name]
    found = knee(points(seconds, errors))
    assert (found and found.name) == expected


def test_of_an_exponential_that_levels_off():
    # least distance of exp(-t) + c below the chord, in ln error, by hand: where its slope is theirs
    times = np.linspace(0.0, 10.0, 1001)
    log = np.log(np.exp(-times) + 0.01)
    slope = (log[-1] - log[0]) / 10.0
    expected = times[np.argmin(np.abs(np.gradient(log, times) - slope))]
    found = knee(points(times, np.exp(log)))
    assert found.seconds == pytest.approx(expected, abs=0.03)


@given(
    st.lists(st.tuples(st.floats(1, 1e4), st.floats(1e-3, 10)), min_size=1, max_size=10),
    st.floats(0.1, 10), st.floats(0.1, 10),
)  # fmt: skip
def test_units_change_nothing(pairs, minute, scale):
    plain = knee(points(*zip(*pairs, strict=True)))
    scaled = knee(points([s * minute for s, _ in pairs], [e * scale for _, e in pairs]))
    if plain is not None and scaled is not None:
        depths = {p.name for p in (plain, scaled)}
        assert len(depths) == 1 or pairs[int(plain.name)] == pairs[int(scaled.name)]


def test_the_best_within_a_time():
    front = points([1, 2, 3], [0.3, 0.2, 0.25])
    assert best_within(front, 0.5) is None
    assert best_within(front, 1.0).name == "0"
    assert best_within(front, 9.0).name == "1"
