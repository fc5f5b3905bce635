"""Error against shots: pairs chosen before anything is known, and chosen by what was measured.

    python tests/benchmarks/study_adaptive.py FOLDER [NAME ...] [--plot FILE.png]

For each table in FOLDER (npz, 81 x 81; by default one matte, one glossy, one grained, one felt):
eps8 / male of estimator `prior` and the mean posterior standard deviation that it states, at fixed
i-optimal plans of so many free pairs, and at rounds of 16 that go on from the plan of 32; then how
many shots the rounds need for the male of each fixed plan. Noise-free values, sigma 0.3 %.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np

from gonio.materials import MeasuredTable
from gonio.samples import Samples
from nnbrdf.metrics import eps8, male
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.conditioned import ConditionedPrior
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.ground import Grounds
from nnbrdf.prior.infer import infer
from planner.field import paper_field
from planner.optimal import IOptimal

if TYPE_CHECKING:
    from collections.abc import Sequence

FOUR = ("rgl_paper_white", "rgl_satin_rosaline", "flow_aniso_green_pvc", "ubo2014_felt05")
FIRST, BATCH, MOST = 32, 16, 192
COUNTS = (32, 48, 64, 96, 128, 160, 192)
SIGMA = 0.003
GRID, FIELD, GROUNDS = grid_pairs(), paper_field(), Grounds()
Rows = np.ndarray


class Point(NamedTuple):
    shots: int
    eps8: float
    male: float
    deviation: float

    def __str__(self) -> str:
        return f"{self.eps8:.2f} / {self.male:.3f} ({self.deviation:.3f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=FOUR)
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    prior = MaterialPrior.generate()
    plans = {count: chosen(prior, count) for count in COUNTS}
    curves = {}
    for name in options.names:
        table = MeasuredTable.load(options.folder / f"{name}.npz")
        fixed = [take_stock(prior, table, rows)[0] for rows in plans.values()]
        rounds = in_rounds(prior, table, plans[FIRST])
        curves[name] = fixed, rounds
        echo(name, fixed, rounds)
    if options.plot:
        draw(curves, options.plot)


def chosen(prior: MaterialPrior | ConditionedPrior, count: int, before: Sequence[int] = ()) -> Rows:
    allowed = np.ones((81, 81), bool)
    allowed.flat[list(before)] = False
    field = replace(FIELD, allowed=allowed & allowed.T)
    return np.flatnonzero(IOptimal(lambda: prior).pairs(field, count).measured)


def take_stock(
    prior: MaterialPrior, table: MeasuredTable, rows: Rows
) -> tuple[Point, ConditionedPrior]:
    value = table.values.reshape(-1, 3)[rows].astype(float)
    samples = Samples.from_values(GRID.light[rows], GRID.view[rows], value, sigma=SIGMA * value)
    inference = infer(prior.families, samples)
    sites = Pairs.of(samples.light, samples.view)
    belief = ConditionedPrior.of(prior.families, inference, sites, GROUNDS)
    told = belief.now.median.reshape(81, 81, 3)
    pair = (table.values, table.white)
    point = Point(len(rows), eps8(told, *pair), male(told, *pair), belief.deviation)
    return point, belief


def in_rounds(prior: MaterialPrior, table: MeasuredTable, rows: Rows) -> list[Point]:
    points = []
    while True:
        point, belief = take_stock(prior, table, rows)
        points.append(point)
        if len(rows) >= MOST:
            return points
        rows = np.concatenate([rows, chosen(belief, BATCH, rows)])


def echo(name: str, fixed: list[Point], rounds: list[Point]) -> None:
    click.echo(f"\n{name}: eps8 / male (stated sd); shots that the rounds need for a plan's male")
    by_shots = {point.shots: point for point in rounds}
    for point in fixed:
        enough = [each.shots for each in rounds if each.male <= point.male]
        needs = str(min(enough)) if enough else f"> {MOST}"
        beside = by_shots.get(point.shots)
        click.echo(f"| {point.shots:3d} | {point!s:24s} | {beside!s:24s} | {needs:>5s} |")


def draw(curves: dict[str, tuple[list[Point], list[Point]]], path: Path) -> None:
    from gonio.report.figures import ACCENT, MUTED, new_figure, page_style

    with page_style():
        figure = new_figure(7.2, 5.6)
        panels = figure.subplots(2, 2, sharex=True).flat
        for axes, (name, (fixed, rounds)) in zip(panels, curves.items(), strict=False):
            for points, color, label in (
                (fixed, MUTED, "plan fixed beforehand"), (rounds, ACCENT, "in rounds of 16"),
            ):  # fmt: skip
                shots = [point.shots for point in points]
                axes.plot(shots, [p.male for p in points], "o-", color=color, ms=4, label=label)
            stated = [point.deviation for point in rounds]
            axes.plot(shots, stated, ":", color=ACCENT, label="sd that the rounds state")
            axes.set_title(name, fontsize=9)
            axes.set_xscale("log")
            axes.set_xticks(COUNTS, [str(count) for count in COUNTS], fontsize=7)
            axes.minorticks_off()
            axes.set_ylim(bottom=0)
            axes.set_xlabel("shots")
            axes.set_ylabel("male")
        panels = figure.axes
        panels[0].legend(fontsize=7)
        figure.savefig(path, dpi=120, facecolor="white")


if __name__ == "__main__":
    main()
