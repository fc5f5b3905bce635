"""`gonio plan --pareto`, on few candidates and a small prior."""

import csv
import re

import pytest
from click.testing import CliRunner

from gonio.cli.plan import command
from nnbrdf.prior import MaterialPrior

SMALL = ("--pareto", "--candidates", "rings:0x1,40x3,70x4")


def rows_of(path):
    return list(csv.DictReader(path.read_text().splitlines()))


@pytest.fixture
def run(tmp_path):
    MaterialPrior.generate(examples=40).save(tmp_path / "prior.npz")

    def invoke(*options):
        arguments = [*SMALL, "--prior", tmp_path / "prior.npz", "-o", tmp_path / "o/plan.json"]
        return CliRunner().invoke(command, [str(each) for each in (*arguments, *options)])

    return invoke


def test_table_page_and_line_agree(run, tmp_path):
    result = run("--seed", "3")
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in (tmp_path / "o").iterdir()) == [
        "pareto.csv", "pareto.html",
    ]  # fmt: skip
    rows = rows_of(tmp_path / "o/pareto.csv")
    assert {row["criterion"] for row in rows} == {
        "i-optimal", "d-optimal", "energy", "farthest", "random",
    }  # fmt: skip
    front = [row for row in rows if row["on_front"] == "1"]
    for row in rows:
        beaten = any(
            float(f["acquisition_s"]) <= float(row["acquisition_s"])
            and float(f["expected_error"]) <= float(row["expected_error"])
            for f in front
        )
        assert beaten or row in front
    page = (tmp_path / "o/pareto.html").read_text()
    assert "gonio plan --pareto" in page
    told = [float(cell) for cell in re.findall(r">(\d\.\d{4})<", page)]
    for row in rows:
        assert min(abs(float(row["expected_error"]) - each) for each in told) < 1e-4
    (knee,) = [row for row in rows if row["knee"] == "1"]
    assert knee in front
    (line,) = [line for line in result.output.splitlines() if line.startswith("the knee: ")]
    assert f"by {knee['criterion']}, {knee['shots']} shots in " in line
    assert f"expected error {float(knee['expected_error']):.3f}" in line
    assert line[0].upper() + line[1:] in page


def test_one_criterion_alone(run, tmp_path):
    assert run("--criterion", "energy").exit_code == 0
    rows = rows_of(tmp_path / "o/pareto.csv")
    assert {row["criterion"] for row in rows} == {"energy"}


BAD = {
    "a density": (("--density", "4"), "--pareto tries densities of its own"),
    "views": (("--views", "4"), "--pareto tries densities of its own"),
    "shots": (("--shots", "4"), "--pareto tries densities of its own"),
    "a plot": (("--plot", "x.png"), "--pareto tries densities of its own"),
    "no criterion": (("--criterion", "best"), "criterion 'best' is not known"),
    "a seed for nothing": (("--criterion", "energy", "--seed", "1"), "draws nothing"),
    "too few": (("--candidates", "rings:0x1,40x2"), "9 pairs of candidates are too few"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(run, tmp_path, name):
    options, says = BAD[name]
    result = run(*options)
    assert says in str(result.exception)
    assert not (tmp_path / "o").exists()
