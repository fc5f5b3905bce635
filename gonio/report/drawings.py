"""All drawings of the page, with their captions, by section."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.color import InSpace
from gonio.materials import MeasuredTable
from gonio.report import chosen, errors, maps, slices
from gonio.report.figures import inline_svg, page_style
from gonio.report.screen import Screen
from gonio.report.spheres import sphere_uri

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from markupsafe import Markup
    from matplotlib.figure import Figure

    from gonio.plan import Plan
    from gonio.protocols import Material
    from gonio.samples import Samples
    from nnbrdf.load import Model

_ENDS_AT_WHITE = {"paper": " Beyond it, the network was told no more than white."}
_PLANES = ((0.0, "Along the marked edge"), (90.0, "Across the marked edge"))


class Drawing(NamedTuple):
    """A figure with its title and its caption."""

    title: str
    svg: Markup
    caption: str


class Drawings(NamedTuple):
    """What the page shows, by section; spheres are data URIs by their caption."""

    spheres: dict[str, str]
    measured: list[Drawing]
    material: list[Drawing]
    planes: list[Drawing]
    errors: list[Drawing]


def draw_all(
    model: Path, samples: Samples, chain: Sequence[Plan], truth: MeasuredTable | None
) -> Drawings:
    """Draw everything that is known of a model; without the truth, what needs none."""
    from nnbrdf.load import load_model

    estimate, screen = load_model(model), Screen.of(samples.color_space)
    with page_style():
        return Drawings(
            spheres=_spheres(estimate, truth, screen),
            measured=list(_measured(samples, chain, screen)),
            material=list(_material(estimate, truth, screen)),
            planes=list(_planes(estimate, truth, samples)),
            errors=list(_errors(model, estimate, truth, samples)),
        )


def _drawing(title: str, figure: Figure, caption: str) -> Drawing:
    name = "-".join(title.lower().split())
    return Drawing(title, inline_svg(figure, name, f"{title}: {caption}"), caption)


def _spheres(estimate: Model, truth: MeasuredTable | None, screen: Screen) -> dict[str, str]:
    white = estimate.card.white if truth is None else truth.white
    known = {"reconstruction": quick_to_evaluate(estimate), "truth": truth}
    return {
        name: sphere_uri(InSpace(each, screen.matrix), white)
        for name, each in known.items()
        if each is not None
    }


def quick_to_evaluate(material: Material) -> Material:
    """Return what a picture of half a million pairs may be made of in a second or two."""
    from nnbrdf.posterior_model import PosteriorBRDF

    if isinstance(material, PosteriorBRDF):
        # minutes otherwise, and the picture is no larger than its grid is fine
        return MeasuredTable(material.grid()["values"].astype(np.float64), material.card.white)
    return material


def _measured(samples: Samples, chain: Sequence[Plan], screen: Screen) -> Iterator[Drawing]:
    candidates = chosen.candidates_of(chain)
    for side in ("view", "light"):
        directions = chosen.planned(chain, side) if chain else chosen.measured(samples, side)
        yield _drawing(
            f"{side} directions".capitalize(),
            chosen.draw_chosen(directions, candidates),
            f"{_of(len(directions), len(candidates))}, seen against the sample's normal, "
            "the marked edge to the right.",
        )
    yield _drawing(
        "Measured pairs",
        maps.draw_map(screen.shown(maps.measured_map(samples)), samples.white),
        "Each sample in its color, at the nearest pair of the 81 x 81 grid; white is "
        f"{samples.white:.3g} 1/sr.",
    )


def _of(count: int, candidates: int) -> str:
    if not candidates:
        return f"{count} directions"
    return f"{count} chosen of {candidates} (filled), {candidates - count} skipped (open)"


def _material(estimate: Model, truth: MeasuredTable | None, screen: Screen) -> Iterator[Drawing]:
    grid = {name: array.astype(np.float64) for name, array in estimate.grid().items()}
    white = estimate.card.white if truth is None else truth.white
    exposed = f"White is {white:.3g} 1/sr, then {screen.words}."
    yield _drawing("Reconstruction", maps.draw_map(screen.shown(grid["values"]), white), exposed)
    if truth is not None:
        yield _drawing("Truth", maps.draw_map(screen.shown(truth.values), white), exposed)
        difference = np.abs(grid["values"].clip(max=white) - truth.values.clip(max=white))
        factor = maps.enlargement(difference, white)
        yield _drawing(
            f"Difference × {factor}",
            maps.draw_map(factor * difference, white),
            f"Absolute, channel by channel, both clipped at white as eps8 does, enlarged {factor} "
            "times.",
        )
    yield _drawing(
        "Uncertainty",
        maps.draw_sigma(grid["sigma"]),
        "One standard uncertainty; the brightest per cent is cut.",
    )


def _planes(estimate: Model, truth: MeasuredTable | None, samples: Samples) -> Iterator[Drawing]:
    known = "" if truth is None else ", dashed: truth"
    for azimuth_deg, title in _PLANES:
        dots = (
            ", dots: samples within 3°"
            if slices.has_samples(azimuth_deg, samples)
            else "; no sample is within 3° of it"
        )
        yield _drawing(
            title,
            slices.draw_slice(azimuth_deg, estimate, truth, samples),
            f"Plane of incidence at φ = {azimuth_deg:g}°. Line: model with its 5 to 95 % band"
            f"{known}{dots}.",
        )


def _errors(
    model: Path, estimate: Model, truth: MeasuredTable | None, samples: Samples
) -> Iterator[Drawing]:
    from nnbrdf.history import FILE_NAME, History

    yield _drawing(
        "Model against samples",
        errors.draw_scatter(estimate, samples),
        f"A dot a value; upright line: white.{_ENDS_AT_WHITE.get(estimate.card.estimator, '')}",
    )
    if (model / FILE_NAME).is_file():
        what = "Loss" if truth is None else "Error"
        yield _drawing(
            f"{what} against training time",
            errors.draw_training(History.load(model), truth),
            "Thin: each network; thick: their median.",
        )
