import dataclasses
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.materials import MeasuredTable
from nnbrdf.analytic import AnisotropicGGX
from nnbrdf.metrics import (
    Scores,
    cube_root_rmse,
    cube_root_rmse_per_channel,
    eps8,
    eps8_per_channel,
    male,
    male_per_channel,
    score,
)

positive = st.floats(0, 1e3)


def grid(value):
    return np.full((81, 81, 3), float(value))


def test_known_errors():
    assert eps8(grid(0.3), grid(0.2), white=1.0) == pytest.approx(25.5)
    assert male(grid(0.3), grid(0.2), white=1.0) == pytest.approx(np.log(0.31 / 0.21))


def test_eps8_ends_at_white_and_male_does_not():
    assert eps8(grid(7), grid(2), white=2.0) == 0
    assert male(grid(7), grid(2), white=2.0) == pytest.approx(np.log(7.02 / 2.02))


def test_a_truth_below_zero_counts_as_zero():
    # as noise of samples that were held out may be
    assert male(grid(0.2), grid(-0.5), white=1.0) == male(grid(0.2), grid(0), white=1.0)


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


def noisy(true, size, seed=0):
    return true * np.random.default_rng(seed).lognormal(0.0, size, true.shape)


def a_material():
    """Return a body with a highlight, as a table."""
    grid = paper_directions()
    return AnisotropicGGX((1.0, 0.8, 0.6), alpha_x=0.15, alpha_y=0.5).evaluate(
        grid[:, None], grid[None]
    )


TRUE = a_material()
WHITE = MeasuredTable.of(TRUE).white


def belts():
    """Return solid angle (but for 2 pi) and cosine of each ring of the grid."""
    edges = np.cos(np.radians([0, 7.5, 22.5, 37.5, 52.5, 67.5, 82.5]))
    return -np.diff(edges), np.cos(np.radians([0, 15, 30, 45, 60, 75]))


def test_cube_roots_by_hand():
    estimate, true = grid(1), grid(1)
    estimate[0] = 8
    # the light at the pole has the solid angle of a cap of 7.5 deg, of a cap of 82.5 deg in all
    cap, whole = (1 - np.cos(np.radians(degrees)) for degrees in (7.5, 82.5))
    assert cube_root_rmse(estimate, true, white=1.0) == pytest.approx(np.sqrt(cap / whole))


def test_cube_roots_count_the_cosine_of_the_light_alone():
    light, view = grid(1), grid(1)
    light[-1], view[:, -1] = 8, 8
    # in the ring at 75 deg the cosine shrinks the light's error and leaves the view's
    belt = np.cos(np.radians(67.5)) - np.cos(np.radians(82.5))
    share = belt / 24 / (1 - np.cos(np.radians(82.5)))
    at_75 = np.cbrt(np.cos(np.radians(75)))
    assert cube_root_rmse(light, grid(1), white=1.0) == pytest.approx(at_75 * np.sqrt(share))
    solid_angle, cosine = belts()
    mean = (solid_angle * np.cbrt(cosine) ** 2).sum() / solid_angle.sum()
    assert cube_root_rmse(view, grid(1), white=1.0) == pytest.approx(np.sqrt(share * mean))


def test_cube_roots_of_channels_are_pooled_as_squares():
    estimate = grid(0.2) * np.array([1.0, 2.0, 3.0])
    each = cube_root_rmse_per_channel(estimate, grid(0.2), 1.0)
    assert each[0] == 0
    assert each[1] / each[2] == pytest.approx((np.cbrt(2) - 1) / (np.cbrt(3) - 1))
    assert cube_root_rmse(estimate, grid(0.2), 1.0) == pytest.approx(np.sqrt((each**2).mean()))
    single = cube_root_rmse(estimate[..., 1:2], grid(0.2)[..., 1:2], 1.0)
    assert single == pytest.approx(each[1])


def test_cube_roots_of_what_is_below_zero_are_zero():
    assert cube_root_rmse(grid(-1), grid(0), white=1.0) == 0


def test_cube_roots_need_the_grid():
    with pytest.raises(BadInputError, match="not \\(81, 81, channels\\)"):
        cube_root_rmse(np.ones((81, 3)), np.ones((81, 3)), 1.0)


def test_the_same_table_has_no_error():
    assert score(TRUE, TRUE, WHITE) == Scores(0.0, 0.0, 0.0, np.inf, None, None)


def test_errors_are_symmetric():
    estimate = noisy(TRUE, 0.3)
    there, back = score(estimate, TRUE, WHITE), score(TRUE, estimate, WHITE)
    assert dataclasses.astuple(there)[:4] == pytest.approx(dataclasses.astuple(back)[:4])


@settings(max_examples=10)
@given(exponent=st.integers(-20, 20), seed=st.integers(0, 9))
def test_no_score_has_the_unit_of_the_brdf(exponent, seed):
    # powers of two: rounding then moves no pixel across the edge of an 8-bit step
    factor, estimate = 2.0**exponent, noisy(TRUE, 0.2, seed)
    before = dataclasses.astuple(score(estimate, TRUE, WHITE))[:4]
    after = dataclasses.astuple(score(factor * estimate, factor * TRUE, factor * WHITE))[:4]
    assert after == pytest.approx(before, rel=1e-9)


@settings(max_examples=10)
@given(seed=st.integers(0, 99))
def test_a_growing_error_scores_worse(seed):
    scores = [score(noisy(TRUE, size, seed), TRUE, WHITE) for size in (0.05, 0.1, 0.2, 0.4)]
    for name in ("eps8", "male", "cube_root_rmse"):
        errors = [getattr(each, name) for each in scores]
        assert errors == sorted(errors)
    decibels = [each.sphere_psnr_db for each in scores]
    assert decibels == sorted(decibels, reverse=True)


def test_scores_are_those_of_the_metrics_alone():
    estimate = noisy(TRUE, 0.2)
    scores = score(estimate.astype(np.float32), TRUE, WHITE)
    assert scores.eps8 == pytest.approx(eps8(estimate, TRUE, WHITE), rel=1e-5)
    assert scores.male == pytest.approx(male(estimate, TRUE, WHITE), rel=1e-5)
    assert scores.cube_root_rmse == pytest.approx(cube_root_rmse(estimate, TRUE, WHITE), rel=1e-5)
    assert 20 < scores.sphere_psnr_db < 50


def test_color_differences_when_asked_for():
    pytest.importorskip("colour", reason="needs the extra color")
    small, large = (score(noisy(TRUE, size), TRUE, WHITE, delta_e=True) for size in (0.1, 0.4))
    assert 0 < small.delta_e_mean < small.delta_e_95
    assert small.delta_e_mean < large.delta_e_mean
    same = score(TRUE, TRUE, WHITE, delta_e=True)
    assert (same.delta_e_mean, same.delta_e_95) == (0.0, 0.0)


BAD = {
    "shapes": ((grid(1), np.ones((81, 81, 1)), 1.0), "compare them on one grid"),
    "NaN in the estimate": ((grid(np.nan), grid(1), 1.0), "the estimate holds values"),
    "infinity in the truth": ((grid(1), grid(np.inf), 1.0), "the truth holds values"),
    "white": ((grid(1), grid(1), 0.0), "white is 0, not positive"),
}


@pytest.mark.parametrize(("arguments", "problem"), BAD.values(), ids=BAD)
def test_refuses_what_has_no_error(arguments, problem):
    for metric in (eps8, male, cube_root_rmse, score):
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
