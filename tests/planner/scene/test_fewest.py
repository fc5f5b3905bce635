from hypothesis import given
from hypothesis import strategies as st

from planner.scene.fewest import fewest


@given(st.integers(1, 7000), st.floats(0.05, 3), st.floats(1e-4, 3))
def test_it_is_the_least_that_reaches_the_target(most, power, target):
    asked = []

    def error(count):
        asked.append(count)
        return count**-power

    found = fewest(error, target, most)
    assert 1 <= found <= most
    if error(most) > target:
        assert found == most
    else:
        assert error(found) <= target
        lower = found - max(1, int(0.02 * found))
        assert lower < 1 or error(lower) > target
    assert len(asked) < 40


@given(st.integers(1, 500), st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=500, max_size=500))
def test_errors_that_do_not_fall_end_it_as_well(most, errors):
    found = fewest(lambda count: errors[count - 1], 0.7, most)
    assert found == most or errors[found - 1] <= 0.7
