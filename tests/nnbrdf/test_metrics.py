import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.errors import BadInputError
from nnbrdf.metrics import eps8, eps8_per_channel, male, male_per_channel

positive = st.floats(0, 1e3)


def grid(value):
    return np.full((81, 81, 3), float(value))


def test_known_errors():
    assert eps8(grid(0.3), grid(0.2), white=1.0) == pytest.approx(25.5)
    assert male(grid(0.3), grid(0.2), white=1.0) == pytest.approx(np.log(0.31 / 0.21))


def test_eps8_ends_at_white_and_male_does_not():
    assert eps8(grid(7), grid(2), white=2.0) == 0
    assert male(grid(7), grid(2), white=2.0) == pytest.approx(np.log(7.02 / 2.02))


def test_an_estimate_below_zero_counts_as_zero():
    assert eps8(grid(-1), grid(0), white=1.0) == 0
    assert male(grid(-1), grid(0), white=1.0) == 0


def test_channels_apart_and_together():
    estimate = grid(0.2) + np.array([0.0, 0.1, 0.2])
    assert eps8_per_channel(estimate, grid(0.2), 1.0) == pytest.approx([0, 25.5, 51])
    assert eps8(estimate, grid(0.2), 1.0) == pytest.approx(25.5)
    per_channel = np.log(np.array([0.21, 0.31, 0.41]) / 0.21)
    assert male_per_channel(estimate, grid(0.2), 1.0) == pytest.approx(per_channel)
    assert male(estimate, grid(0.2), 1.0) == pytest.approx(per_channel.mean())


@given(positive, positive, st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_unit_does_not_matter(estimate, true, white, factor):
    a, b = np.array([[estimate]]), np.array([[true]])
    for metric in (eps8, male):
        assert metric(factor * a, factor * b, factor * white) == pytest.approx(
            metric(a, b, white), rel=1e-9, abs=1e-9
        )


BAD = {
    "shapes": ((grid(1), np.ones((81, 81, 1)), 1.0), "compare them on one grid"),
    "NaN in the estimate": ((grid(np.nan), grid(1), 1.0), "the estimate holds values"),
    "infinity in the truth": ((grid(1), grid(np.inf), 1.0), "the truth holds values"),
    "white": ((grid(1), grid(1), 0.0), "white is 0, not positive"),
}


@pytest.mark.parametrize(("arguments", "problem"), BAD.values(), ids=BAD)
def test_refuses_what_has_no_error(arguments, problem):
    for metric in (eps8, male):
        with pytest.raises(BadInputError, match=problem):
            metric(*arguments)


@pytest.mark.measured
def test_agrees_with_the_scoring_script(measured, tmp_path):
    true = np.load(measured / "rgl_satin_rosaline.npz", allow_pickle=False)
    values = true["values"] * np.random.default_rng(0).normal(1, 0.3, (81, 81, 3))
    np.savez(tmp_path / "estimate.npz", values=values)
    script = measured.parent / "score.py"
    files = [measured / "rgl_satin_rosaline.npz", tmp_path / "estimate.npz"]
    scored = subprocess.run(
        [sys.executable, script, *files], capture_output=True, text=True, check=True
    )
    arguments = values, true["values"], float(true["white"])
    expected = f"eps8 {eps8(*arguments):.3f}  male {male(*arguments):.4f}\n"
    assert scored.stdout == expected
