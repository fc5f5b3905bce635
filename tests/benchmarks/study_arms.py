"""What arms that bend behind their encoders do to samples, and which `angle_deg` holds it.

    python -m tests.benchmarks.study_arms

No frames and no noise: what a material sends between directions that are off as the twin's arms
bend (sag and warmth, 200, 1500 and 4000 s after power-up), over what it sends as told, less what
the white frames share. Told of the relative errors are their root mean square and 95 % quantile,
and how many lie within 1.645 sigma of the component `angle`, by stated angle; slopes are fitted to
64 of the pairs, as a session's are.
"""

from __future__ import annotations

import click
import numpy as np

from gonio.directions import from_degrees, paper_directions, to_degrees
from gonio.reduce.slope import misfit, smooth_fit
from gonio.reduce.tolerance import axis_effects, missed_effects
from gonio.samples import Samples
from sim.bending import bent_deg
from sim.imperfections import load_imperfections
from sim.materials import load_material
from tests.draws import Z90

MATERIALS = ("matte-paint", "woven-cloth", "velvet", "wood-veneer", "satin", "gold-leaf")
ANGLES_DEG = {"mild": (0.003, 0.005, 0.01), "all": (0.01, 0.02, 0.03, 0.04)}
TIMES_S = (200.0, 1500.0, 4000.0)
PAIRS, FITTED = 600, 64


def main() -> None:
    """Print a row for each set and material."""
    for name, angles_deg in ANGLES_DEG.items():
        heads = " | ".join(f"{angle:g} deg" for angle in angles_deg)
        click.echo(f"| `{name}` | rms | 95 % | {heads} |")
        for material in MATERIALS:
            echo(material, name, angles_deg)


def echo(material: str, name: str, angles_deg: tuple[float, ...]) -> None:
    sent, directions = load_material(material), paper_directions()
    light, view = directions[np.random.default_rng(0).integers(81, size=(2, PAIRS))]
    value = sent.evaluate(light, view)
    told = np.transpose([*to_degrees(light), *to_degrees(view)])
    errors = np.abs([off(sent, told, value * light[:, 2:], name, at) for at in TIMES_S])
    few = slice(FITTED)
    samples = Samples.from_values(light[few], view[few], value[few], sigma=0.01 * value[few])
    fit = smooth_fit(samples)
    held = []
    for angle in np.radians(angles_deg):
        effects = axis_effects(fit, np.radians(told), angle)
        missed = missed_effects(misfit(samples, fit), np.radians(told), angle)
        sigma = np.sqrt((np.concatenate([effects, missed]) ** 2).sum(axis=0))
        held.append(f"{100 * np.mean(errors <= Z90 * sigma):.0f} %")
    sizes = np.sqrt(np.mean(errors**2)), np.quantile(errors, 0.95)
    shown = " | ".join([*(f"{100 * size:.2f} %" for size in sizes), *held])
    click.echo(f"| {material} | {shown} |")


def off(sent, told, radiance, name: str, at: float):
    """Return the relative errors at a time after power-up, shape (n, 3)."""
    by = load_imperfections(name)
    true = np.array([[*bent_deg(*row[:2], at, by), *bent_deg(*row[2:], at, by)] for row in told])
    light, view = from_degrees(*true.T[:2]), from_degrees(*true.T[2:])
    white = np.cos(np.radians(bent_deg(0.0, 0.0, at, by)[0]))
    return sent.evaluate(light, view) * light[:, 2:] / radiance - white


if __name__ == "__main__":
    main()
