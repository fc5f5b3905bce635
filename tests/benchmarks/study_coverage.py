"""Do 90 % intervals hold nine of ten true values, whatever errs in a session's calibration?

    python -m tests.benchmarks.study_coverage [--draws 1000] [--twin calibrated]

Each draw is a session on the twin: dark and white frames, then eight shots at random pairs of the
81 x 81 grid, under errors drawn anew from what the rig file states: the reference's scale, the flux
monitor, the zero of each axis, tilt and height of sample and reference, the black level; and new
noise. With `--twin ideal` camera, lamps and arms are ideal but for stray light, and nothing is
calibrated (`tests/draws.py`). With `calibrated` the twin has the imperfections of `mild` and `all`
by turns, every draw another sensor, which `gonio calibrate`'s own steps measure first
(`tests/calibrated_draws.py`). Materials take turns. Told by material and for all: coverage of value
+- 1.645 sigma; interval score over the truth, beside that of the best constant relative sigma;
median relative error; and the share of the variance by component.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np

from gonio.reduce.patch import usual_patch_mm
from gonio.report.budget import parts_of
from gonio.samples import Flag
from gonio.uncertainty import COMPONENT_NAMES
from sim.materials import load_material
from tests.calibrated_draws import calibrated_samples, imperfect_rig
from tests.draws import constant_sigma, covered, drawn_samples, interval_score, small_rig

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

MATTE = ("matte-paint", "woven-cloth", "velvet")
OTHERS = ("wood-veneer", "satin", "gold-leaf", "glossy-plastic")
IMPERFECT = ("mild", "all")
ROW = "| {:20s} | {:>6s} | {:>8s} | {:>6s} | {:>8s} | {:>12s} |"


class Found(NamedTuple):
    """What one draw gave: values, sigmas and truths, shape (3, n), and shares by component."""

    material: str
    imperfections: str
    three: np.ndarray
    shares: list[float]


@click.command()
@click.option("--draws", type=int, default=1000, show_default=True)
@click.option("--seed", type=int, default=0, show_default=True)
@click.option("--twin", type=click.Choice(["ideal", "calibrated"]), default="ideal")
def main(draws: int, seed: int, twin: str) -> None:
    """Draw sessions and tell what their intervals hold."""
    found = []
    for each in drawn(draws, seed, twin):
        found.append(each)
        if not len(found) % 100:
            click.echo(f"{len(found)} of {draws} draws", err=True)
    tell(found)


def drawn(draws: int, seed: int, twin: str) -> Iterator[Found]:
    """Draw sessions, each from its own seed, so that any of them can be had again."""
    names = MATTE + OTHERS
    for draw in range(draws):
        random = np.random.default_rng([seed, draw])
        name, kind = names[draw % len(names)], IMPERFECT[draw // len(names) % 2]
        material = load_material(name)
        if twin == "ideal":
            kind = twin
            samples, truth = drawn_samples(small_rig(), material, random)
        else:
            rig = imperfect_rig(kind, pixels=160)
            samples, truth, _ = calibrated_samples(
                kind, material, random, rig=rig, patch_mm=usual_patch_mm(rig.camera)
            )
        # what is flagged as a lower bound claims no interval
        whole = samples.flag & Flag.CLIPPED == 0
        three = np.stack([samples.value, samples.sigma, truth])[:, whole]
        yield Found(name, kind, three, [part.share for part in parts_of(samples)])


def tell(found: Sequence[Found]) -> None:
    click.echo(ROW.format("material", "values", "coverage", "score", "constant", "median error"))
    for name in MATTE + OTHERS:
        echo(name, [each for each in found if each.material == name])
    matte = [each for each in found if each.material in MATTE]
    echo("matte", matte)
    for kind in sorted({each.imperfections for each in found}, reverse=True):
        echo(kind, [each for each in found if each.imperfections == kind])
        echo(f"{kind}, matte", [each for each in matte if each.imperfections == kind])
    echo("all together", found)
    for part, share in zip(
        COMPONENT_NAMES, np.mean([f.shares for f in found], axis=0), strict=True
    ):
        click.echo(f"| {part:11s} | {100 * share:5.1f} % |")


def echo(name: str, found: Sequence[Found]) -> None:
    value, sigma, truth = np.concatenate([each.three for each in found], axis=1)
    constant = constant_sigma(value, truth)
    scores = [f"{interval_score(value, each, truth):.4f}" for each in (sigma, constant)]
    median = f"{100 * np.median(np.abs(value / truth - 1)):.2f} %"
    cover = f"{100 * covered(value, sigma, truth):.1f} %"
    click.echo(ROW.format(name, str(len(value)), cover, *scores, median))


if __name__ == "__main__":
    main()
