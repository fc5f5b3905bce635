"""Do 90 % intervals hold nine of ten true values, whatever errs in a session's calibration?

    python -m tests.benchmarks.study_coverage [--draws 1000]

Each draw is a session on the twin: dark and white frames, then eight shots at random pairs of the
81 x 81 grid, under errors drawn anew from what the rig file states (`tests/draws.py`): the
reference's scale, the flux monitor, the zero of each axis, tilt and height of sample and
reference, the black level, stray light; and new noise. Materials take turns. Told by material and
for all: coverage of value +- 1.645 sigma; interval score over the truth, beside that of the best
constant relative sigma; median relative error; and the share of the variance by component.
"""

from __future__ import annotations

from collections import defaultdict

import click
import numpy as np

from gonio.report.budget import parts_of
from gonio.samples import Flag
from gonio.uncertainty import COMPONENT_NAMES
from sim.materials import load_material
from tests.draws import constant_sigma, covered, drawn_samples, interval_score, small_rig

MATTE = ("matte-paint", "woven-cloth", "velvet")
OTHERS = ("wood-veneer", "satin", "gold-leaf", "glossy-plastic")
ROW = "| {:14s} | {:>6s} | {:>8s} | {:>6s} | {:>8s} | {:>12s} |"


@click.command()
@click.option("--draws", type=int, default=1000, show_default=True)
@click.option("--seed", type=int, default=0, show_default=True)
def main(draws: int, seed: int) -> None:
    """Draw sessions and tell what their intervals hold."""
    random, rig, names = np.random.default_rng(seed), small_rig(), MATTE + OTHERS
    found, shares = defaultdict(list), []
    for draw in range(draws):
        name = names[draw % len(names)]
        samples, truth = drawn_samples(rig, load_material(name), random)
        # what is flagged as a lower bound claims no interval
        whole = samples.flag & Flag.CLIPPED == 0
        found[name].append(np.stack([samples.value, samples.sigma, truth])[:, whole])
        shares.append([part.share for part in parts_of(samples)])
        if not (draw + 1) % 100:
            click.echo(f"{draw + 1} of {draws} draws", err=True)
    click.echo(ROW.format("material", "values", "coverage", "score", "constant", "median error"))
    for group in (*((name,) for name in names), MATTE, names):
        title = {MATTE: "matte", names: "all"}.get(group, group[0])
        echo(title, np.concatenate([three for name in group for three in found[name]], axis=1))
    for part, share in zip(COMPONENT_NAMES, np.mean(shares, axis=0), strict=True):
        click.echo(f"| {part:10s} | {100 * share:5.1f} % |")


def echo(name: str, three: np.ndarray) -> None:
    value, sigma, truth = three
    constant = constant_sigma(value, truth)
    scores = [f"{interval_score(value, each, truth):.4f}" for each in (sigma, constant)]
    median = f"{100 * np.median(np.abs(value / truth - 1)):.2f} %"
    cover = f"{100 * covered(value, sigma, truth):.1f} %"
    click.echo(ROW.format(name, str(len(value)), cover, *scores, median))


if __name__ == "__main__":
    main()
