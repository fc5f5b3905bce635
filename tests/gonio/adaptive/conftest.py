import pytest

from nnbrdf.prior import MaterialPrior


@pytest.fixture(scope="session")
def prior(tmp_path_factory):
    """A prior of few examples, quick to work with."""
    path = tmp_path_factory.mktemp("prior") / "few.npz"
    MaterialPrior.generate(examples=40).save(path)
    return path
