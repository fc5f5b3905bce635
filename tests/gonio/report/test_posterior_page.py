import numpy as np
import pytest

from gonio.report import write_report
from nnbrdf.posterior_model import PosteriorBRDF, PriorEstimator
from nnbrdf.prior import MaterialPrior
from tests.gonio.report.conftest import REPORT_SCRIPTS


@pytest.mark.usefixtures("small_pictures")
def test_the_page_of_a_posterior_asks_it_of_few_pairs(measure, standalone, monkeypatch):
    """Half a million pairs of its sphere would take minutes."""
    session, samples = measure(truth=False)
    PriorEstimator(prior=MaterialPrior.generate(examples=60)).fit(samples).save(session.model)
    asked, told = [], PosteriorBRDF._told

    def counting(model, light, view):
        asked.append(np.broadcast(light, view).size // 3)
        return told(model, light, view)

    monkeypatch.setattr(PosteriorBRDF, "_told", counting)
    write_report(session.report_path, model=session.model, samples=samples, session=session)
    assert sum(asked) < 10 * 6561
    page = standalone(session.report_path.read_text(), REPORT_SCRIPTS)
    assert "sphere of the material: reconstruction" in page.values("alt")
