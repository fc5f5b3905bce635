"""Does the expected error rank designs as the true one does? On measured materials.

    python tests/benchmarks/study_expected.py TABLE.npz... [-o picture.png]

For products of 4 x 4 to 20 x 20 and 16 to 400 free pairs by every criterion: the expected error of
`gonio plan --pareto`, and the error of estimator `prior` at the same pairs: root mean square of
ln((estimate + 0.01 white) / (true + 0.01 white)) over pairs, channels and materials.
Then Kendall's tau between the two, over all designs and among those of as many shots.
Noise-free values, sigma 0.3 %.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np
from scipy.stats import kendalltau
from study_few_shots import samples_at

from gonio.files import write_with
from gonio.materials import MeasuredTable
from gonio.rig import default_rig
from nnbrdf.posterior_model import PriorEstimator
from nnbrdf.prior import MaterialPrior
from planner.beliefs import RememberedPrior
from planner.candidates import paper_candidates
from planner.criteria import CRITERIA
from planner.expected import RANK, ExpectedError
from planner.field import Field
from planner.locate import rows_of
from planner.make import make_plan
from planner.sweep import PAIRS, SIDES, Design

if TYPE_CHECKING:
    from collections.abc import Sequence

MOST = 400
ROW = "| {:9s} | {:9s} | {:>5s} | {:>8s} | {:>6s} | {:s} |"


class Judged(NamedTuple):
    design: Design
    shots: int
    expected: float
    true: np.ndarray

    @property
    def error(self) -> float:
        return float(np.sqrt(np.mean(self.true**2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", type=Path, nargs="+")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    tables = [MeasuredTable.load(path) for path in options.tables]
    click.echo(f"true: {', '.join(path.stem for path in options.tables)}")
    click.echo(ROW.format("design", "criterion", "shots", "expected", "true", "by material"))
    judged = judge_all(tables)
    for name, group in groups(judged).items():
        tau = kendalltau([j.expected for j in group], [j.error for j in group]).statistic
        ratio = np.median([j.error / j.expected for j in group])
        click.echo(f"{name}: {len(group)} designs, tau {tau:.2f}, true / expected {ratio:.2f}")
    if options.output:
        draw(options.output, judged)


def judge_all(tables: Sequence[MeasuredTable]) -> list[Judged]:
    candidates = paper_candidates()
    field = Field(candidates, candidates, np.ones((81, 81), bool))
    prior = MaterialPrior.generate()
    known = RememberedPrior(lambda: prior, RANK)
    expected = ExpectedError(field, known)
    plan_of = partial(make_plan, default_rig(), prior=lambda: known)
    estimator = PriorEstimator(prior=prior)
    judged = []
    for design in designs():
        plan = plan_of(**design.settings)
        measured = np.zeros((81, 81), bool)
        measured[rows_of(plan, "light", candidates), rows_of(plan, "view", candidates)] = True
        true = [true_error(estimator, table, measured) for table in tables]
        told = expected.after(np.flatnonzero(measured))
        judged.append(Judged(design, len(plan.shots), told, np.array(true)))
        echo(judged[-1])
    return judged


def designs() -> list[Design]:
    return [
        *(Design(name, side=side) for side in SIDES if side**2 <= MOST for name in CRITERIA),
        *(Design(name, pairs=pairs) for pairs in PAIRS if pairs <= MOST for name in CRITERIA),
    ]


def true_error(estimator: PriorEstimator, table: MeasuredTable, measured: np.ndarray) -> float:
    told = estimator.fit(samples_at(table, measured)).grid()["values"].clip(0.0)
    floor = 0.01 * table.white
    return float(np.sqrt(np.mean(np.log((told + floor) / (table.values + floor)) ** 2)))


def groups(judged: Sequence[Judged]) -> dict[str, list[Judged]]:
    found = {"all": list(judged)}
    for shots in sorted({j.shots for j in judged}):
        found[f"{shots} shots"] = [j for j in judged if j.shots == shots]
    return found


def echo(judged: Judged) -> None:
    design = judged.design
    label = design.label if design.side else f"{design.label} free"
    by_material = ", ".join(f"{error:.3f}" for error in judged.true)
    numbers = (str(judged.shots), f"{judged.expected:.3f}", f"{judged.error:.3f}")
    click.echo(ROW.format(label, design.criterion, *numbers, by_material))


def draw(path: Path, judged: Sequence[Judged]) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 5.6), layout="constrained")
    axes = figure.subplots()
    for name, mark in zip(CRITERIA, "osD^v", strict=True):
        group = [j for j in judged if j.design.criterion == name]
        axes.loglog([j.expected for j in group], [j.error for j in group], mark, label=name)
    ends = [min(j.expected for j in judged), max(j.expected for j in judged)]
    axes.loglog(ends, ends, color="0.6", linewidth=0.8)
    axes.set_xlabel("expected error")
    axes.set_ylabel("true error, root mean square over the materials")
    axes.legend()
    write_with(path, lambda aside: figure.savefig(aside, format="png", dpi=120))


if __name__ == "__main__":
    main()
