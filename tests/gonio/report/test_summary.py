import io
from dataclasses import fields, replace

import numpy as np
import pytest
from rich.console import Console

from gonio.directions import normalize
from gonio.materials import MeasuredTable
from gonio.report import summarize
from gonio.report.summary import NOT_KNOWN
from nnbrdf.ensemble import grid_pairs
from nnbrdf.model import NNBRDF


def eps8(estimate, true, white):
    b8 = [255 * np.minimum(np.maximum(f / white, 0), 1) for f in (estimate, true)]
    return np.mean(np.abs(b8[0] - b8[1]))


def male(estimate, true, white):
    ratio = (np.maximum(estimate, 0) + 0.01 * white) / (true + 0.01 * white)
    return np.mean(np.abs(np.log(ratio)))


def truth_of(session):
    return MeasuredTable.load(session.truth_path)


def test_errors_are_those_of_the_definitions(measure):
    session, samples = measure()
    summary = summarize(session.model, samples, truth_of(session))
    with np.load(session.truth_path) as truth, np.load(session.model / "grid.npz") as grid:
        true, white = truth["values"], float(truth["white"])
        values, lo, hi = (grid[name].astype(float) for name in ("values", "lo", "hi"))
    delivered = summary.against_truth.delivered
    assert delivered.eps8 == pytest.approx(eps8(values, true, white), rel=1e-6)
    assert delivered.male == pytest.approx(male(values, true, white), rel=1e-6)
    for index, (name, channel) in enumerate(summary.against_truth.channels.items()):
        pair = values[..., index], true[..., index], white
        assert name == "rgb"[index]
        assert channel.eps8 == pytest.approx(eps8(*pair), rel=1e-6)
        assert channel.male == pytest.approx(male(*pair), rel=1e-6)
    assert summary.coverage == pytest.approx(np.mean((true >= lo) & (true <= hi)), abs=1e-4)


def test_the_quoted_error_is_the_median_of_the_networks(measure):
    session, samples = measure()
    model = NNBRDF.load(session.model)
    with np.load(session.truth_path) as truth:
        true, white = truth["values"], float(truth["white"])
    members = [
        replace(model, card=model.card.model_copy(update={"delivered": k})).evaluate(*grid_pairs())
        for k in range(5)
    ]
    error = summarize(session.model, samples, truth_of(session)).error
    assert error.eps8 == pytest.approx(np.median([eps8(m, true, white) for m in members]))
    assert error.male == pytest.approx(np.median([male(m, true, white) for m in members]))


CHANNELS = [("r", "g", "b"), ("y",)]


@pytest.mark.parametrize("channels", CHANNELS)
def test_the_residual_needs_no_truth(measure, channels):
    session, samples = measure(channels=channels, truth=False)
    summary = summarize(session.model, samples, None)
    model = NNBRDF.load(session.model)
    told = model.evaluate(samples.light, samples.view)[:, : len(channels)]
    pair = told, np.maximum(samples.value, 0), 4 * np.median(samples.value)
    assert summary.residual.eps8 == pytest.approx(eps8(*pair))
    assert summary.residual.male == pytest.approx(male(*pair))
    assert summary.against_truth is None
    assert (summary.error, summary.coverage) == (None, None)
    assert (summary.shots, summary.share) == (16, 16 / 6561)
    assert summary.weights == 6 * 4 + 4 + 4 * len(channels) + len(channels)


def again(samples, light, view):
    """Return samples with some more: the first two once again, from these directions."""
    rows = {f.name: getattr(samples, f.name) for f in fields(samples)}
    more = {
        name: np.concatenate([rows[name], rows[name][:2]])
        for name in rows
        if isinstance(rows[name], np.ndarray)
    }
    more["light"][-2:], more["view"][-2:] = light, view
    return replace(samples, **more)


@pytest.mark.parametrize(("exchanged", "pairs"), [(False, 16), (True, 18)])
def test_the_share_counts_different_pairs(measure, exchanged, pairs):
    session, samples = measure(truth=False)
    # a pair whose reverse is measured, too, would be no different one
    reverse = samples.light @ samples.view.T
    twice = np.flatnonzero(~((reverse > 0.999) & (reverse.T > 0.999)).any(axis=1))[:2]
    # an encoder never comes to stand on the same count
    light = normalize(samples.light[twice] + 1e-4)
    view = samples.view[twice]
    more = again(samples, view, light) if exchanged else again(samples, light, view)
    summary = summarize(session.model, more, None)
    assert (summary.shots, summary.share) == (18, pairs / 6561)


def test_a_rig_without_truth_says_so_in_the_table(measure):
    session, samples = measure(truth=False)
    assert printed(summarize(session.model, samples, None)).count(NOT_KNOWN) == 2
    assert ("error", NOT_KNOWN, "") in summarize(session.model, samples, None).rows()


def test_the_table_says_what_the_summary_says(measure):
    session, samples = measure()
    summary = summarize(session.model, samples, truth_of(session))
    text = printed(summary)
    for name, errors in (*summary.against_truth.rows(), ("residual at", summary.residual)):
        assert name.strip() in text
        assert f"{errors.eps8:.2f}" in text
        assert f"{errors.male:.3f}" in text
    assert "0.244 % of 6561 pairs" in text


def printed(summary):
    console = Console(file=io.StringIO(), width=100)
    console.print(summary.table())
    return console.file.getvalue()
