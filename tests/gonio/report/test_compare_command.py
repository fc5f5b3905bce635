import json

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.compare import command
from gonio.errors import BadInputError
from gonio.materials import MeasuredTable
from nnbrdf.metrics import eps8, male


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr("gonio.cli.compare._SIZE_PX", 24)
    monkeypatch.setattr("gonio.cli.compare._LIGHTS", 16)


def compare(*arguments):
    result = CliRunner().invoke(command, [*map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """A table, and the same but for one pair that is far off, brighter by a tenth elsewhere."""
    folder = tmp_path_factory.mktemp("tables")
    values = np.random.default_rng(0).lognormal(-2.0, 0.3, (81, 81, 3))
    MeasuredTable.of(values).save(folder / "one.npz")
    other = 1.1 * values
    other[80, 40] = 0.0
    MeasuredTable.of(other).save(folder / "other.npz")
    return folder / "one.npz", folder / "other.npz"


def test_the_table_as_json_and_the_page(tables, tmp_path, standalone):
    page = tmp_path / "page.html"
    told = json.loads(compare(*tables, "--json", "-o", page))
    one, other = map(MeasuredTable.load, tables)
    assert (told["reference"], told["white_per_sr"]) == ("one", one.white)
    (row,) = told["compared"]
    assert row["eps8"] == eps8(other.values, one.values, one.white)
    assert row["male"] == male(other.values, one.values, one.white)
    worst = row["worst"][0]
    assert worst["light_theta_deg"] == 75.0
    assert worst["light_phi_deg"] == 345.0
    assert worst["view_theta_deg"] == 60.0
    assert worst["value"] == 0.0
    assert row["largest_steps"] == worst["steps"] > 5 * row["median_steps"]
    read = standalone(page.read_text())
    for words in ("one, other", "Lobes along the marked edge", "Renders", "75, 345"):
        assert words in read.text
    assert page.stat().st_size < 3e6


def test_a_session_and_its_model_against_its_truth(measure, tmp_path):
    session = measure().session
    said = compare(session.root, session.model, "--truth", session.root, "-o", tmp_path / "p.html")
    assert "against truth" in said
    assert "session: furthest off by" in said
    assert "model: furthest off by" in said


def test_one_alone_is_refused(tables):
    with pytest.raises(BadInputError, match="one material alone is not compared"):
        compare(tables[0])


def test_through_the_real_command_line(gonio, tmp_path):
    result = gonio("compare", "velvet", "velvt")
    assert result.returncode == 2
    assert result.stderr.startswith("gonio: velvt: no such file, folder or material; give")
    assert result.stderr.count("\n") == 1
