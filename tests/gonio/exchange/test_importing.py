"""`gonio import`: which file it writes, what it reads, and what it says of both."""

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli._main import cli
from gonio.errors import BadInputError
from gonio.exchange import Source
from gonio.exchange.plain_csv import write as write_csv
from gonio.materials import Lambertian, MeasuredTable


def run(*arguments):
    return CliRunner().invoke(cli, ["import", *map(str, arguments)])


def refusal(*arguments):
    ran = run(*arguments)
    assert isinstance(ran.exception, BadInputError)
    return str(ran.exception)


class Known:
    """What knows its sigma."""

    def sigma(self, light, view):
        return np.full(np.broadcast_shapes(light.shape, view.shape), 0.01)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_csv(Source(Lambertian(0.5), "white", uncertain=Known()), tmp_path / "white.csv", None)
    return tmp_path


def test_what_is_there_is_replaced_only_by_name(here):
    (here / "white.npz").write_text("mine")
    says = "white.npz: is there already; name it with -o to replace it"
    assert refusal("white.csv") == says
    assert (here / "white.npz").read_text() == "mine"
    ran = run("white.csv", "-o", "white.npz")
    assert "note: its sigma is not in the table: tables keep values alone" in ran.output
    assert "keeps every pair of the grid" in ran.output
    assert "loses what lies between the nodes" in ran.output
    assert (MeasuredTable.load("white.npz").values > 0.1).all()


def test_the_source_is_never_written(here):
    (here / "white.npz").hardlink_to(here / "white.csv")
    before = (here / "white.csv").read_bytes()
    for arguments in ((), ("-o", "white.npz")):
        assert "is the file that is read" in refusal("white.csv", *arguments)
    assert (here / "white.csv").read_bytes() == before


def test_a_table_is_called_so(here):
    says = "white.xml: a table's name ends in .npz; name it so with -o"
    assert refusal("white.csv", "-o", "white.xml") == says


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (np.ones((81, 81, 3)), "is a table already"),
        (np.full((81, 81, 3), np.nan), "not finite"),
        (np.full((81, 81, 3), None), "is not a table"),
        (np.ones(3), "values has shape"),
        (None, "is not a table"),
    ],
    ids=["whole", "nan", "objects", "shape", "truncated"],
)
def test_a_table_is_looked_into(here, values, says):
    path = here / "other.npz"
    np.savez(path, values=np.ones((81, 81, 3)) if values is None else values)
    if values is None:
        path.write_bytes(path.read_bytes()[:1000])
    assert says in refusal("other.npz")


@pytest.mark.parametrize("name", ["onnx", "table", "obj"])
def test_only_what_is_imported_is_offered(here, name):
    says = f"--from {name}: no format that is imported; use csv, rgl, merl, utia, klems, tensortree"
    assert refusal("white.csv", "--from", name) == says


def test_help_lists_what_is_imported():
    listed = run("--help").output.partition("Formats:")[2]
    assert "csv" in listed
    assert "  table " not in listed
    assert "onnx" not in listed
