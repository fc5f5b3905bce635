"""Parts of a study's page."""

import math
import shutil
import subprocess

import numpy as np
import pytest
from matplotlib.image import imread

from gonio.report.grids import Grid, Line, Section
from gonio.report.study import analytic_section, write_study
from nnbrdf.metrics import Scores
from nnbrdf.studies.analytic import Result
from nnbrdf.studies.export import write_results


def test_a_perfect_picture_has_not_diverged():
    perfect = Result("lambert", "vs-is", 3, Scores(0.0, 0.0, 0.0, math.inf), 0.5, 0.1)
    section = analytic_section("felt", [perfect])
    (line,) = section.grids[0].lines
    assert line.cells[2:6] == ("0.00", "0.000", "0.0000", "inf")
    assert all("lambert" in drawing.svg for drawing in section.drawings)


def test_a_table_has_nothing_where_nothing_is(tmp_path):
    worst = Scores(math.inf, math.inf, math.inf, -math.inf)
    results = [
        Result("lambert", "vs-is", 3, Scores(0.0, 0.0, 0.0, math.inf), 0.5, 0.25),
        Result("network 30-30", "vs-is", 900, worst, math.inf, 0.25),
    ]
    write_results(tmp_path / "analytic.csv", {"felt": results})
    head, *rows = (tmp_path / "analytic.csv").read_text().splitlines()
    assert head == (
        "material,name,subset,parameters,eps8,male,cube_root_rmse,sphere_psnr_db,fit_seconds,"
        "million_seconds"
    )
    assert rows == [
        "felt,lambert,vs-is,3,0.0,0.0,0.0,inf,0.5,0.25",
        "felt,network 30-30,vs-is,900,,,,,,0.25",
    ]


def test_a_network_that_diverged_is_in_the_table_and_in_no_picture():
    model = Result("ggx", "vs-is", 10, Scores(1.0, 0.1, 0.01, 40.0), 0.5, 0.1)
    worst = Scores(math.inf, math.inf, math.inf, -math.inf)
    lost = Result("network 30-30", "vs-is", 900, worst, math.inf, 0.2)
    section = analytic_section("felt", [lost, model])
    (grid,) = section.grids
    assert [line.cells for line in grid.lines] == [
        ("ggx", "10", "1.00", "0.100", "0.0100", "40.0", "0.500", "0.100"),
        ("network 30-30", "900", *["diverged"] * 5, "0.200"),
    ]
    assert [line.best for line in grid.lines] == [True, False]
    assert all("network 30-30" not in drawing.svg for drawing in section.drawings)


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")
@pytest.mark.parametrize("width", [1300, 500])
def test_the_lines_of_a_table_are_straight(tmp_path, width):
    names = ("softsign", "tanh", "gelu")
    head = ("", *(f"a column {index}" for index in range(9)))
    grid = Grid("grid", head, tuple(Line((name, *"123456789"), best=False) for name in names))
    write_study(tmp_path / "page.html", "title", "about", [Section("felt", (), (grid,))], [])
    subprocess.run(
        ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
         f"--user-data-dir={tmp_path / 'profile'}", f"--window-size={width},900",
         f"--screenshot={tmp_path / 'page.png'}", f"file://{tmp_path / 'page.html'}"],
        check=True, capture_output=True, timeout=120,
    )  # fmt: skip
    pixels = np.rint(255 * imread(tmp_path / "page.png")[..., :3])
    is_line = (pixels == (0xD5, 0xDA, 0xE0)).all(axis=-1)
    rows = np.flatnonzero(is_line.any(axis=1))
    assert len(rows) == 1 + len(names)
    left = is_line[rows].argmax(axis=1)
    right = width - is_line[rows, ::-1].argmax(axis=1)
    assert np.array_equal(is_line[rows].sum(axis=1), right - left)
    assert (right - left > 0.8 * width).all()
