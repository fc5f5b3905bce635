"""Less than ideal twins, each measured by its own calibration: what is left is as sigma says."""

import numpy as np
import pytest

from sim.materials import load_material
from tests.calibrated_draws import calibrated_samples, imperfect_rig
from tests.draws import covered


@pytest.mark.parametrize(
    ("imperfections", "material"),
    [("mild", "woven-cloth"), ("all", "wood-veneer"), ("all", "velvet")],
)
def test_what_is_left_of_imperfections_is_as_sigma_says(imperfections, material):
    random = np.random.default_rng(12)
    samples, truth, correction = calibrated_samples(
        imperfections, load_material(material), random, shots=12
    )
    found = correction.document.stray_light
    assert found.share == pytest.approx({"mild": 0.005, "all": 0.03}[imperfections], abs=0.001)
    z = (samples.value - truth) / samples.sigma
    # samples share many of their errors, so that one session may be off as a whole
    assert np.sqrt(np.mean(z**2)) < 1.7
    assert 0.75 < covered(samples.value, samples.sigma, truth) <= 1.0
    assert (samples.components["color"] > 0).all()


def test_a_flat_field_lets_more_of_the_white_reference_count(monkeypatch):
    noise = []
    for side_mm in (1.0, 40.0):
        monkeypatch.setattr("gonio.reduce.calibrate.WHITE_MM", side_mm)
        samples, truth, _ = calibrated_samples(
            "mild", load_material("woven-cloth"), np.random.default_rng(12), shots=4
        )
        assert (np.abs(samples.value - truth) < 4 * samples.sigma).all()
        noise.append(np.median(samples.components["white"] / samples.value))
    # the flux of its frames does not become surer
    assert noise[1] < 0.65 * noise[0]


@pytest.mark.parametrize(("stated", "is_told"), [(0.3, True), (0.028, False)])
def test_stray_light_that_the_calibration_contradicts_is_told(caplog, stated, is_told):
    rig = imperfect_rig("all")
    camera = rig.camera.model_copy(update={"stray_light": stated})
    rig = rig.model_copy(update={"camera": camera})
    material = load_material("matte-paint")
    calibrated_samples("all", material, np.random.default_rng(1), shots=1, rig=rig)
    assert ("goes before the 0.0" in caplog.text) == is_told
