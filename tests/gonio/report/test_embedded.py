"""What the page's script is given, unpacked as it does, beside what the model says."""

import base64
import json
import re

import numpy as np
import pytest

from gonio.directions import from_degrees, paper_angles_deg
from gonio.materials import MeasuredTable
from gonio.report import write_report
from gonio.report.gridded import GriddedModel
from nnbrdf.load import load_model

THETA, PHI = paper_angles_deg()


@pytest.fixture
def told(measure, small_pictures):
    session, samples = measure()
    write_report(session.report_path, model=session.model, samples=samples, session=session)
    text = session.report_path.read_text()
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text)[1]
    return json.loads(data), session, samples


def unpacked(text, dtype):
    return np.frombuffer(base64.b64decode(text), dtype)


def logs(fans, name, *shape):
    most, steps = fans["log"]
    return np.exp((2.0 * unpacked(fans[name], "<u2") / steps - 1.0) * most).reshape(81, *shape)


def test_the_map_holds_grid_and_samples_to_the_bit(told):
    data, session, samples = told
    with np.load(session.model / "grid.npz") as grid:
        for name in ("values", "sigma", "lo", "hi"):
            held = unpacked(data["grid"][name], "<f4").reshape(81, 81, 3)
            np.testing.assert_array_equal(held, grid[name])
    truth = MeasuredTable.load(session.truth_path).values
    held = unpacked(data["grid"]["truth"], "<f4").reshape(81, 81, 3)
    np.testing.assert_array_equal(held, truth.astype(np.float32))
    light, view = np.divmod(unpacked(data["samples"]["pair"], "<u2"), 81)
    np.testing.assert_allclose(from_degrees(THETA[light], PHI[light]), samples.light, atol=1e-9)
    np.testing.assert_allclose(from_degrees(THETA[view], PHI[view]), samples.view, atol=1e-9)
    for name in ("value", "sigma"):
        held = unpacked(data["samples"][name], "<f4").reshape(-1, 3)
        np.testing.assert_array_equal(held, getattr(samples, name).astype(np.float32))


def test_lobes_and_slices_are_the_models(told):
    data, session, _ = told
    fans, model = data["fans"], load_model(session.model)
    (rings, ring_deg), (around, around_deg) = fans["rings"], fans["azimuths"]
    lobe = fans["white"] * logs(fans, "lobe", rings, around)
    relative = logs(fans, "relative", rings, around)
    light, ring, turn = 40, 7, 11
    at = from_degrees(THETA[light], PHI[light])
    view = from_degrees(ring * ring_deg, PHI[light] + turn * around_deg)
    value, sigma = model.evaluate(at, view), model.sigma(at, view)
    assert lobe[light, ring, turn] == pytest.approx(value.mean(), rel=1e-3)
    ratio = (sigma / (value + 0.01 * fans["white"])).mean()
    assert relative[light, ring, turn] == pytest.approx(ratio, rel=1e-3)
    steps, step_deg = fans["steps"]
    away = from_degrees(8 * step_deg, PHI[light] + 180)
    step = steps // 2 + 8
    values = fans["white"] * logs(fans, "slice", steps, 3)
    np.testing.assert_allclose(values[light, step], model.evaluate(at, away), rtol=1e-3, atol=1e-6)
    for name, bound in zip(("low", "high"), model.quantiles(at, away), strict=True):
        held = fans["white"] * logs(fans, name, steps)[light, step]
        assert held == pytest.approx(bound.mean(), rel=1e-3, abs=1e-6)
    truth = MeasuredTable.load(session.truth_path).evaluate(at, away).mean()
    held = fans["white"] * logs(fans, "truth", steps)[light, step]
    assert held == pytest.approx(truth, rel=1e-3)


def test_a_gridded_model_is_the_model_at_the_grid(measure):
    model = load_model(measure(truth=False).session.model)
    gridded, grid = GriddedModel.of_grid(model.grid(), model.card.white), model.grid()
    pair = from_degrees(THETA[30:40], PHI[30:40]), from_degrees(THETA[3:13], PHI[3:13])
    at = np.arange(30, 40), np.arange(3, 13)
    np.testing.assert_allclose(gridded.evaluate(*pair), grid["values"][at], rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(gridded.sigma(*pair), grid["sigma"][at], rtol=1e-6, atol=1e-12)
    for name, bound in zip(("lo", "hi"), gridded.quantiles(*pair), strict=True):
        np.testing.assert_allclose(bound, grid[name][at], rtol=1e-6, atol=1e-12)
