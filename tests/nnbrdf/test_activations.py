"""The twenty activations: NumPy's values, torch's, and the kernel's with its slopes."""

import numpy as np
import pytest
import torch

from gonio.errors import BadInputError
from nnbrdf.activations import ACTIVATIONS, activation_named
from nnbrdf.batched import TORCH_ACTIVATIONS

_fused = pytest.importorskip("nnbrdf._fused", reason="the kernel was not compiled")
POINTS = np.array([-30.0, -5.0, -2.4, -0.7, -0.3, -1e-3, 1e-3, 0.2, 0.6, 1.0, 2.4, 7.0, 25.0])
LIMITS = {  # at minus and plus a large number
    "sigmoid": (0, 1), "tanh": (-1, 1), "softsign": (-1, 1), "hard-sigmoid": (0, 1),
    "relu": (0, None), "elu": (-1, None), "selu": (-1.7580993408473766, None),
    "softplus": (0, None), "swish": (0, None), "mish": (0, None), "gelu": (0, None),
    "exponential": (0, None),
}  # fmt: skip
each = pytest.mark.parametrize("name", ACTIVATIONS)
# softmax's slopes are a matrix, no vector; the gradient of the network tests them
each_with_slopes = pytest.mark.parametrize(
    "name", [each for each in ACTIVATIONS if each != "softmax"]
)
each_isa = pytest.mark.parametrize("isa", _fused.isas())


def numpy_value(name, rows):
    """Features on the last axis, as the kernel has them."""
    return ACTIVATIONS[name](rows.T).T


def kernel(name, rows, isa="", single=False):
    activate = _fused.activate32 if single else _fused.activate64
    return activate(list(ACTIVATIONS).index(name), rows, isa)


def test_there_are_twenty_and_both_frameworks_have_all():
    assert len(ACTIVATIONS) == 20
    assert list(TORCH_ACTIVATIONS) == list(ACTIVATIONS)


@each
@each_isa
def test_double_precision_of_the_kernel_and_of_torch_is_that_of_numpy(name, isa):
    rows = np.stack([POINTS, POINTS[::-1]])
    expected = numpy_value(name, rows)
    value, _ = kernel(name, rows, isa)
    assert np.allclose(value, expected, rtol=1e-13, atol=1e-14)
    with_torch = TORCH_ACTIVATIONS[name](torch.from_numpy(rows)).numpy()
    assert np.allclose(with_torch, expected, rtol=1e-13, atol=1e-14)


@each
@each_isa
def test_single_precision_of_the_kernel_is_near(name, isa):
    rows = np.random.default_rng(0).normal(0, 4, (50, 37)).astype(np.float32)
    value, slope = kernel(name, rows, isa, single=True)
    exact_value, exact_slope = kernel(name, rows.astype(float))
    assert np.allclose(value, exact_value, rtol=2e-6, atol=2e-6)
    assert np.allclose(slope, exact_slope, rtol=2e-6, atol=2e-6)


@each_with_slopes
def test_slopes_are_finite_differences(name):
    points, step = POINTS[None, 1:-1], 1e-5
    _, slope = kernel(name, points)
    rise = numpy_value(name, points + step) - numpy_value(name, points - step)
    assert np.allclose(slope, rise / (2 * step), rtol=1e-8, atol=1e-8)


@each_with_slopes
def test_slopes_are_those_of_autograd(name):
    points = torch.from_numpy(POINTS).requires_grad_()
    TORCH_ACTIVATIONS[name](points).sum().backward()
    _, slope = kernel(name, POINTS[None])
    assert np.allclose(slope[0], points.grad.numpy(), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("name", "limits"), LIMITS.items())
@pytest.mark.parametrize("single", [False, True])
def test_far_out_they_end_where_they_should(name, limits, single):
    rows = np.array([[-1e4, 1e4]], np.float32 if single else float)
    for values in (numpy_value(name, rows)[0], kernel(name, rows, single=single)[0][0]):
        for value, limit in zip(values, limits, strict=True):
            assert limit is None or value == pytest.approx(limit, rel=1e-6, abs=2e-4)
            assert not np.isnan(value)


@each
@pytest.mark.parametrize("single", [False, True])
def test_no_activation_or_slope_is_nan_at_large_numbers(name, single):
    sizes = np.array([0.0, 1.0, 50.0, 89.0, 1e3, 1e6, 1e8, 1e9, 3e15])
    rows = np.stack([sizes, -sizes]).astype(np.float32 if single else float)
    value, slope = kernel(name, rows, single=single)
    assert not np.isnan(value).any()
    assert not np.isnan(slope).any()
    assert not np.isnan(numpy_value(name, rows)).any()


@pytest.mark.parametrize("single", [False, True])
def test_the_sine_of_snake_is_one_however_far_out(single):
    sizes = np.array([5e6, 1e8, 1e9, 3e15, 1e30])
    rows = np.stack([sizes, -sizes]).astype(np.float32 if single else float)
    value, slope = kernel("snake", rows, single=single)
    assert np.allclose(value, rows, rtol=1e-6, atol=1)
    assert ((slope >= 0) & (slope <= 2)).all()


def test_softmax_sums_to_one_and_does_not_overflow():
    rows = np.array([[1e4, 1e4, -1e4], [0.0, 1.0, 2.0]])
    value, _ = kernel("softmax", rows)
    assert np.allclose(value.sum(axis=1), 1)
    assert np.allclose(value[0], [0.5, 0.5, 0])


def test_an_unknown_name_lists_the_known():
    with pytest.raises(BadInputError, match="'silu' is not known; use linear, sigmoid"):
        activation_named("silu")
