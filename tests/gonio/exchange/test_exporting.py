"""`gonio export`: which file it writes, and what it says of it."""

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.api.material import Material
from gonio.cli._main import cli
from gonio.errors import BadInputError
from gonio.exchange import Source, export, format_named, tensor_tree
from gonio.exchange.plain_csv import write as write_csv
from gonio.materials import MeasuredTable
from nnbrdf.metrics import eps8
from nnbrdf.posterior_model import PriorEstimator
from nnbrdf.prior import MaterialPrior
from sim.materials import load_material
from tests.gonio.exchange.networks import taught
from tests.gonio.report.conftest import make_measured


def run(*arguments):
    return CliRunner().invoke(cli, list(map(str, arguments)))


def refusal(*arguments):
    ran = run(*arguments)
    assert isinstance(ran.exception, BadInputError)
    return str(ran.exception)


class Known:
    """What knows its sigma."""

    def sigma(self, light, view):
        return np.full(np.broadcast_shapes(light.shape, view.shape), 0.01)


@pytest.fixture(scope="module")
def table():
    light = load_material("satin")
    return MeasuredTable.of(Source(light, "satin").values)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def with_sigma(here, table):
    path = here / "my.csv"
    write_csv(Source(table, "my", uncertain=Known()), path, None)
    return path


@pytest.mark.parametrize("name", ["my.npz", "linked.npz", "hard.npz", "sub/../my.npz"])
def test_the_source_is_never_written(name, table, here):
    table.save(here / "my.npz")
    (here / "sub").mkdir()
    (here / "linked.npz").symlink_to(here / "my.npz")
    (here / "hard.npz").hardlink_to(here / "my.npz")
    says = f"{name}: is the file that is read; name another with -o"
    assert refusal("export", "my.npz", "--to", "table", "-o", name) == says
    with pytest.raises(BadInputError, match="is the file that is read"):
        Material.load("my.npz").export("table")
    assert (here / "my.npz").samefile(here / "hard.npz")


def test_what_is_there_is_replaced_only_by_name(table, here):
    table.save(here / "satin.npz")
    (here / "satin.csv").write_text("mine")
    says = "satin.csv: is there already; name it with -o to replace it"
    assert refusal("export", "satin.npz", "--to", "csv") == says
    with pytest.raises(BadInputError, match="is there already"):
        Material.load("satin.npz").export("csv")
    assert (here / "satin.csv").read_text() == "mine"
    assert run("export", "satin.npz", "--to", "csv", "-o", "satin.csv").exit_code == 0
    assert "light_theta_deg" in (here / "satin.csv").read_text()
    assert "satin.csv (csv): eps8 " in repr(Material.load("satin.npz").export("csv", "satin.csv"))


def test_sigma_is_in_the_file_or_the_line_says_that_it_is_not(with_sigma, table):
    told = run("export", "my.csv", "--to", "csv", "-o", "other.csv").output
    assert "its sigma is not in the file: tables keep values alone" in told
    told = run("export", "other.csv", "--to", "csv", "-o", "third.csv").output
    assert "no sigma is in the file" in told
    kept = export(Source(table, "new", uncertain=Known()), format_named("csv"), None)
    assert not kept.notes


def test_a_file_that_cannot_be_read_back_is_not_left(table, here, monkeypatch):
    monkeypatch.setattr(tensor_tree, "_ANISOTROPIC", 4)
    MeasuredTable(table.values * 1e300, 1.0).save(here / "huge.npz")
    (here / "z.xml").write_text("good")
    says = refusal("export", "huge.npz", "--to", "tensortree", "-o", "z.xml")
    assert says.startswith("huge: its values, up to ")
    assert "1/sr, are too large for tensortree" in says
    assert sorted(each.name for each in here.iterdir()) == ["huge.npz", "z.xml"]
    assert (here / "z.xml").read_text() == "good"


def test_a_file_that_cannot_be_written_is_called_by_its_name(table, here):
    table.save(here / "satin.npz")
    (here / "file").write_text("")
    # the second is too long only with what the file aside adds
    for name in ("file/z.csv", 250 * "z"):
        ran = run("export", "satin.npz", "--to", "csv", "-o", name)
        assert str(ran.exception).startswith(f"{name}: cannot be written")


def test_the_error_of_a_mean_is_told_against_the_material_itself(table, here):
    source = Source(table, "my", uncertain=Known())
    exported = export(source.averaged(), format_named("table"), None)
    written = MeasuredTable.load("my.npz").values
    true = eps8(written, table.values, table.white)
    assert exported.eps8 == pytest.approx(true)
    assert true > 1
    assert exported.of_mean.eps8 < 1e-9
    assert exported.notes == ("its sigma is not in the file: of a mean over turns it is not known",)


def test_what_is_not_read_back_says_so(here):
    taught().save(here / "leather")
    ran = run("export", "leather", "--to", "glsl")
    assert "not read back: gonio does not read glsl" in ran.output
    assert "c, mitsuba) are not read back" in " ".join(run("export", "--help").output.split())


def test_of_a_posterior_it_is_told_that_it_takes_long(here):
    session, samples = make_measured(here / "session", truth=False)
    PriorEstimator(prior=MaterialPrior.generate(examples=60)).fit(samples).save(session.model)
    told = "session is a posterior, exact and slow to evaluate"
    assert told in " ".join(run("export", "session", "--to", "csv").output.split())
    taught().save(here / "network")
    assert "posterior" not in run("export", "network", "--to", "csv").output
