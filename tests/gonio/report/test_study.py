"""Parts of a study's page."""

import math

from gonio.report.study import analytic_section
from nnbrdf.metrics import Scores
from nnbrdf.studies.analytic import Result


def test_a_network_that_diverged_is_in_the_table_and_in_no_picture():
    model = Result("ggx", "vs-is", 10, Scores(1.0, 0.1, 0.01, 40.0), 0.5, 0.1)
    worst = Scores(math.inf, math.inf, math.inf, -math.inf)
    lost = Result("network 30-30", "vs-is", 900, worst, math.inf, 0.2)
    section = analytic_section("felt", [lost, model])
    (grid,) = section.grids
    assert [line.cells[0] for line in grid.lines] == ["ggx", "network 30-30"]
    assert all("network 30-30" not in drawing.svg for drawing in section.drawings)
