"""Stiff and extreme trainings: everything trains or says why not, and limits are where they are."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadInputError
from gonio.samples import Samples
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.network import glorot_uniform
from nnbrdf.paper import PaperEstimator
from nnbrdf.stability import limits
from nnbrdf.stability.cases import CASES, outcome
from nnbrdf.stability.floor import loss_floor
from nnbrdf.stability.precision import drift
from nnbrdf.stability.starts import dead_share, look_at_start

REFUSED = {"all zero": "median is 0", "one sample": "takes at least 8"}


def some_data(count=100):
    rng = np.random.default_rng(0)
    inputs = rng.normal(size=(count, 6))
    inputs /= np.linalg.norm(inputs, axis=1, keepdims=True)
    return inputs, 0.4 + 0.3 * np.sin(3 * inputs[:, :3])


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("activation", ACTIVATIONS)
def test_everything_trains_or_says_why_not(activation, case):
    said = outcome(activation, case, steps=60)
    if case in REFUSED:
        assert said.startswith("refused: ")
        assert REFUSED[case] in said
    else:
        assert said.startswith("trained")


sizes = st.floats(-9, 9).map(lambda power: 10.0**power)
directions = st.builds(from_degrees, st.floats(0, 90), st.floats(0, 360))


@settings(max_examples=40)
@given(
    pairs=st.lists(st.tuples(directions, directions, sizes, sizes), min_size=8, max_size=20),
    activation=st.sampled_from(list(ACTIVATIONS)),
)
def test_no_positive_samples_make_a_number_that_is_none(pairs, activation):
    light, view = (np.stack([pair[index] for pair in pairs]) for index in range(2))
    values = np.array([[pair[2], pair[3], pair[2]] for pair in pairs])
    try:
        samples = Samples.from_values(light, view, values)
        model = PaperEstimator(steps=20, members=2, activation=activation).fit(samples)
    except BadInputError:
        return
    grid = paper_directions()[::9]
    for array in (
        model.evaluate(grid[:, None], grid[None]),
        model.sigma(grid[:, None], grid[None]),
        *model.quantiles(grid[:, None], grid[None]),
    ):
        assert np.isfinite(array).all()


def quadratic(curvatures):
    matrix = torch.diag(torch.tensor(curvatures, dtype=torch.float64))
    return lambda value: 0.5 * value @ matrix @ value


def test_power_iteration_finds_the_largest_curvature():
    loss = quadratic([0.5, 4.0, 1.0])
    value, vector = limits.largest_curvature(loss, torch.ones(3, dtype=torch.float64))
    assert value == pytest.approx(4.0)
    assert abs(vector).tolist() == pytest.approx([0, 1, 0], abs=1e-9)
    scale = torch.tensor([0.01, 4.0, 1.0], dtype=torch.float64)
    value, _ = limits.largest_curvature(loss, torch.ones(3, dtype=torch.float64), scale)
    assert value == pytest.approx(50.0)


def test_gradient_descent_is_stable_below_two_over_the_curvature():
    loss, start = quadratic([0.5, 4.0]), torch.ones(2, dtype=torch.float64)
    below, past = (limits.descend(loss, start, share * 2 / 4.0, 300) for share in (0.98, 1.02))
    assert float(loss(below)) < 1e-4
    assert float(loss(past)) > 1e4


def test_adamax_with_its_norm_held_is_stable_below_38_over_the_curvature():
    assert pytest.approx(38) == limits.ADAMAX_LIMIT
    loss, start = quadratic([0.5, 4.0]), torch.ones(2, dtype=torch.float64)
    scale = torch.tensor([2.0, 0.1], dtype=torch.float64)
    rate = limits.ADAMAX_LIMIT / 40.0
    assert limits.momentum_growth(loss, start, scale, 0.98 * rate) < 1e-3
    assert limits.momentum_growth(loss, start, scale, 1.02 * rate) > 1e3


@pytest.mark.slow
def test_the_limits_hold_on_a_network():
    loss, start = limits.squared_loss(*some_data(), (3, 3))
    settled = limits.descend(loss, start, 0.3, 200)
    curvature, _ = limits.largest_curvature(loss, settled)
    assert limits.descent_growth(loss, settled, 0.97 * 2 / curvature) < 0.1
    assert limits.descent_growth(loss, settled, 1.03 * 2 / curvature) > 10


def test_a_larger_step_rests_higher_on_absolute_loss_and_never_explodes():
    small, large, huge = (loss_floor(*some_data(), rate, 6000) for rate in (4e-3, 6e-2, 10.0))
    assert small < large < huge < np.inf


def test_precisions_part_and_end_alike():
    found = drift("softsign", *some_data(), 1000)
    assert found.apart[0] < 1e-6
    assert found.apart[-1] > 3 * found.apart[0]
    means, error = found.losses.mean(axis=1), found.losses.std(axis=1, ddof=1) / np.sqrt(20)
    assert abs(means[0] - means[1]) < 2 * np.hypot(*error)


def test_exponentials_of_exponentials_begin_with_huge_gradients():
    exponential, softsign = (
        look_at_start(name, *some_data(), (15, 30, 20), 50) for name in ("exponential", "softsign")
    )
    assert softsign.largest_gradient < 1
    assert exponential.gradient > 30 * softsign.gradient


def test_those_that_learn_nothing_are_counted():
    rng = np.random.default_rng(0)
    inputs = rng.normal(size=(64, 6))
    data = inputs / 20, inputs[:, :3] / 4 + 0.5  # too small to pass the threshold
    assert look_at_start("softshrink", *data, (3, 4), 200).idle == 20
    assert look_at_start("softsign", *data, (3, 4), 2000).idle == 0


def test_dead_units_are_counted():
    inputs, _ = some_data()
    networks = glorot_uniform((6, 4, 3), [np.random.default_rng(0)], activation="relu")
    assert dead_share(networks, inputs) == 0
    networks.layers[0][0, :2, -1] = -100.0
    assert dead_share(networks, inputs) == 0.5
