"""What a model's bands let one expect, and the numbers that come first."""

import numpy as np
import pytest

from gonio.checks import Check
from gonio.report.captured import Captured
from gonio.report.expected import expected_of, log_deviation, relative_sigma
from gonio.report.headline import headline
from gonio.report.summary import Against, Summary
from nnbrdf.metrics import Errors

WHITE = 0.8
Z95 = 1.6448536269514722


def grid_of(deviation, seed=0):
    """Make a grid whose ln(f + 0.01 white) has that standard deviation everywhere."""
    rng = np.random.default_rng(seed)
    values = rng.lognormal(-1.5, 0.7, (81, 81, 3))
    ends = {
        name: (values + 0.01 * WHITE) * np.exp(sign * Z95 * deviation) - 0.01 * WHITE
        for name, sign in (("lo", -1), ("hi", 1))
    }
    return {"values": values, "sigma": deviation * values, **ends}


@pytest.mark.parametrize("deviation", [0.02, 0.3])
def test_errors_are_those_of_draws_from_the_bands(deviation):
    grid, rng = grid_of(deviation), np.random.default_rng(1)
    drawn = (grid["values"] + 0.01 * WHITE) * np.exp(deviation * rng.normal(size=(81, 81, 3)))
    b8 = [255 * np.clip(f / WHITE, 0, 1) for f in (drawn - 0.01 * WHITE, grid["values"])]
    expected = expected_of(grid, WHITE)
    assert expected.eps8 == pytest.approx(np.abs(b8[0] - b8[1]).mean(), rel=0.03)
    off = np.log(drawn / (grid["values"] + 0.01 * WHITE))
    assert expected.male == pytest.approx(np.abs(off).mean(), rel=0.02)
    assert expected.deviation == pytest.approx(deviation)
    np.testing.assert_allclose(log_deviation(grid, WHITE), deviation)


def test_relative_sigma_counts_a_hundredth_of_white():
    grid = grid_of(0.1)
    ratio = grid["sigma"] / (grid["values"] + 0.01 * WHITE)
    np.testing.assert_allclose(relative_sigma(grid, WHITE), ratio.mean(axis=2))
    assert expected_of(grid, WHITE).sigma == pytest.approx(np.median(ratio))


OK = Check(name="drift", ok=True, found="none", limit="1 %")
BAD = Check(name="reciprocity", ok=False, found="5 %", limit="1 %")
NOTHING = Check(name="anchors", ok=True, found="none there", limit="", asked=False)
RESIDUAL = Errors(2.0, 0.03)
CAPTURED = Captured("2026-01-01", 2280.0, "", "", None, {}, None)
VERDICTS = {
    "nothing asked": ((), None),
    "all well": ((OK, NOTHING), ("all ok", "1 check", "good")),
    "a flag": ((OK, BAD), ("1 flag", "reciprocity", "bad")),
}


def shown(*, truth=False, captured=None, checks=()):
    error = Errors(5.234, 0.0741)
    against = Against(error, error, {}) if truth else None
    summary = Summary(against, RESIDUAL, 0.93 if truth else None, 1262, 196, 196)
    figures = headline(summary, expected_of(grid_of(0.1), WHITE), captured, checks)
    return {each.name: each for each in figures}


@pytest.mark.parametrize("case", VERDICTS)
def test_the_verdict_of_the_checks_comes_first(case):
    checks, told = VERDICTS[case]
    figure = shown(checks=checks).get("checks")
    assert (figure and figure[1:]) == told


def test_only_what_is_known_comes_first():
    names = ["shots", "median σ", "expected error"]
    assert list(shown()) == names
    known = shown(truth=True, captured=CAPTURED)
    assert list(known) == ["shots", "rig time", *names[1:], "true error", "coverage"]
    assert [known[name].value for name in ("rig time", "true error", "coverage")] == [
        "38 min", "5.23", "93 %",
    ]  # fmt: skip
    assert known["shots"].note == "2.99 % of the 6561 pairs"
