"""One material against another, in numbers and where they differ most."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gonio.directions import paper_directions, to_spherical
from gonio.errors import MissingExtraError
from gonio.report.grids import Grid, Line
from nnbrdf.metrics import score

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gonio.materials import MeasuredTable

_WORST = 5
_HEAD = (
    "", "eps8", "male", "median (steps)", "largest (steps)", "sphere PSNR (dB)", "delta E 2000",
    "its 95 %",
)  # fmt: skip
_NO_COLOR = "-"


class Pair(NamedTuple):
    """A pair of directions in degrees, what both say in 1/sr, and their difference in steps."""

    light_theta_deg: float
    light_phi_deg: float
    view_theta_deg: float
    view_phi_deg: float
    value: float
    reference: float
    steps: float


@dataclass(frozen=True)
class Versus:
    """How far a table is from the reference.

    Attributes
    ----------
    name
        Of the material.
    eps8, male, sphere_psnr_db, delta_e_mean, delta_e_95
        See `nnbrdf.metrics.Scores`.
    median_steps, largest_steps
        Of the mean over channels of the absolute 8-bit difference (as in eps8), over the pairs.
    worst
        The pairs that differ most, mean of the channels, the worst first.
    """

    name: str
    eps8: float
    male: float
    median_steps: float
    largest_steps: float
    sphere_psnr_db: float | None
    delta_e_mean: float | None
    delta_e_95: float | None
    worst: tuple[Pair, ...]

    @classmethod
    def of(cls, name: str, table: MeasuredTable, reference: MeasuredTable) -> Versus:
        """Hold a table against the reference, with the reference's white."""
        white = reference.white
        values = table.values.clip(0.0)
        try:
            scores = score(values, reference.values, white, delta_e=True)
        except MissingExtraError:
            scores = score(values, reference.values, white)
        ends = (np.clip(each / white, 0.0, 1.0) for each in (values, reference.values))
        steps = 255.0 * np.abs(np.subtract(*ends)).mean(axis=-1)
        # JSON has no infinity, which is the PSNR of what is the same
        psnr = scores.sphere_psnr_db if np.isfinite(scores.sphere_psnr_db) else None
        return cls(
            name, scores.eps8, scores.male, float(np.median(steps)), float(steps.max()), psnr,
            scores.delta_e_mean, scores.delta_e_95, _worst(steps, values, reference.values),
        )  # fmt: skip

    def document(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return asdict(self) | {"worst": [pair._asdict() for pair in self.worst]}


def versus_grid(reference: str, rows: Sequence[Versus]) -> Grid:
    """Return the table of errors, the least eps8 marked."""
    best = min(rows, key=lambda row: row.eps8)
    lines = tuple(Line(_cells(row), best=row is best and len(rows) > 1) for row in rows)
    return Grid(f"against {reference}, over the 81 x 81 pairs", _HEAD, lines)


def worst_grid(row: Versus) -> Grid:
    """Return where a material is furthest from the reference."""
    head = ("light θ, φ (deg)", "view θ, φ (deg)", "value (1/sr)", "reference (1/sr)", "steps")
    lines = tuple(
        Line(
            (
                f"{pair.light_theta_deg:.0f}, {pair.light_phi_deg:.0f}",
                f"{pair.view_theta_deg:.0f}, {pair.view_phi_deg:.0f}",
                f"{pair.value:.4g}", f"{pair.reference:.4g}", f"{pair.steps:.1f}",
            ),
            best=False,
        )
        for pair in row.worst
    )  # fmt: skip
    return Grid(f"{row.name}: where it is furthest off", head, lines)


def documents(reference: str, white: float, rows: Sequence[Versus]) -> Mapping[str, Any]:
    """Return the whole comparison as JSON has it."""
    compared = [row.document() for row in rows]
    return {"reference": reference, "white_per_sr": white, "compared": compared}


def _cells(row: Versus) -> tuple[str, ...]:
    delta = (row.delta_e_mean, row.delta_e_95)
    return (
        row.name,
        f"{row.eps8:.2f}",
        f"{row.male:.3f}",
        f"{row.median_steps:.2f}",
        f"{row.largest_steps:.1f}",
        "identical" if row.sphere_psnr_db is None else f"{row.sphere_psnr_db:.1f}",
        *(_NO_COLOR if each is None else f"{each:.2f}" for each in delta),
    )


def _worst(steps: Any, values: Any, reference: Any) -> tuple[Pair, ...]:
    angles = np.degrees(to_spherical(paper_directions())).round(6).T.tolist()
    order = np.argsort(-steps, axis=None, kind="stable")[:_WORST].tolist()
    pairs = (divmod(index, len(angles)) for index in order)
    return tuple(
        Pair._make(
            [
                *angles[light],
                *angles[view],
                float(values[light, view].mean()),
                float(reference[light, view].mean()),
                float(steps[light, view]),
            ]
        )
        for light, view in pairs
    )
