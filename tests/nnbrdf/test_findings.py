import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.samples import Samples
from nnbrdf.findings import Findings
from nnbrdf.posterior_model import PriorEstimator
from nnbrdf.prior import MaterialPrior

FOUND = {
    "isotropic": True, "isotropic_log_odds": 9.0, "reciprocal": True, "reciprocal_log_odds": 9.0,
    "single_spectrum": None, "smooth": 0.1, "stretch": 1.0, "exchange": 0.0, "noise": 0.1,
    "inflation": 1.0, "outliers": (), "lower_bounds": (), "condition": 1.0, "jitter": 0.0,
}  # fmt: skip
AZIMUTHS = [
    # isotropic, log odds for it, says
    (True, 12.3, "isotropic: only the difference of the azimuths counts (log odds 12)"),
    (False, -12.3, "anisotropic (log odds 12 against isotropic)"),
    (True, 0.0, "the samples do not tell whether only the difference of the azimuths counts "
     "(log odds 0.0); assumed: isotropic, by the likeliest setting"),
    (False, 2.6, "the samples do not tell whether only the difference of the azimuths counts "
     "(log odds 2.6); assumed: anisotropic, by the likeliest setting"),
    (True, -5.0, "isotropic by the likeliest setting, though all settings together speak against "
     "it (log odds 5)"),
    (False, 5.0, "anisotropic by the likeliest setting, though all settings together speak "
     "against it (log odds 5)"),
    (False, None, "isotropy was not examined"),
]  # fmt: skip


@pytest.mark.parametrize(("isotropic", "odds", "says"), AZIMUTHS)
def test_what_is_said_of_azimuths_is_what_the_odds_say(isotropic, odds, says):
    found = FOUND | {"isotropic": isotropic, "isotropic_log_odds": odds}
    assert Findings(**found).sentences()[0] == says


def test_samples_that_tell_nothing_decide_nothing():
    rng = np.random.default_rng(0)
    light, view = (from_degrees(rng.uniform(0, 75, 64), rng.uniform(0, 360, 64)) for _ in range(2))
    value = np.full((64, 3), 0.15)
    samples = Samples.from_values(light, view, value, sigma=np.full((64, 3), 1e11))
    model = PriorEstimator(prior=MaterialPrior.generate(examples=60)).fit(samples)
    assert any("do not tell" in each for each in model.card.sentences())
