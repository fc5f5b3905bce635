"""Comma-separated values: a line a pair of directions, with sigma."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_angles_deg, paper_directions
from gonio.errors import BadFileError
from gonio.exchange.format import Format, Source, WithoutSigma
from gonio.exchange.limits import head_of
from gonio.files import write_bytes
from gonio.materials import MeasuredTable
from gonio.samples import RGB
from gonio.tables import read_table
from gonio.words import size as size_in_words

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.samples import Samples

_ANGLES = ("light_theta_deg", "light_phi_deg", "view_theta_deg", "view_phi_deg")
_REMEDY = "make a material of it with: gonio reconstruct"
# in bytes: of 6561 lines, a dozen times what gonio export writes
_LONGEST = 1 << 22
# as near as angles of three decimals are
_NEAR = 2e-5


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write the 6561 pairs of the grid, light by light, with sigma where it is known."""
    header = [*_ANGLES, *RGB]
    columns = [*_angles(), *source.values.reshape(-1, 3).T]
    if source.uncertain is not None:
        header += [f"sigma_{name}" for name in RGB]
        directions = paper_directions()
        columns += [*source.uncertain.sigma(directions[:, None], directions).reshape(-1, 3).T]
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(header)
    rows.writerows([f"{value:.9g}" for value in row] for row in zip(*columns, strict=True))
    write_bytes(path, text.getvalue().encode())


def read(path: Path) -> MeasuredTable:
    """Read a table that holds each of the 81 x 81 pairs once.

    Raises
    ------
    gonio.errors.BadFileError
        When it cannot be read, or its pairs are others: that is a measurement to be completed.
    """
    _, size = head_of(path)
    if size > _LONGEST:
        raise BadFileError(path, f"is longer than {size_in_words(_LONGEST)}", _REMEDY)
    samples = read_table(path)
    light, view = _node(samples.light), _node(samples.view)
    if (light < 0).any() or (view < 0).any() or not _is_each_once(light, view):
        problem = f"holds {len(samples)} pairs, not each of the 81 x 81 once"
        raise BadFileError(path, problem, _REMEDY)
    values = np.empty((81, 81, 3))
    values[light, view] = _rgb(samples)
    kind = WithoutSigma if np.isfinite(samples.sigma).any() else MeasuredTable
    return kind.of(values.clip(0.0))


def _angles() -> list[NDArray[np.float64]]:
    theta_deg, phi_deg = paper_angles_deg()
    count = len(theta_deg)
    return [
        np.repeat(theta_deg, count),
        np.repeat(phi_deg, count),
        np.tile(theta_deg, count),
        np.tile(phi_deg, count),
    ]


def _node(direction: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which of the 81 directions each is, -1 for none."""
    nodes = paper_directions()
    near = np.argmax(direction @ nodes.T, axis=1)
    is_there = np.linalg.norm(direction - nodes[near], axis=1) < _NEAR
    return np.where(is_there, near, -1)


def _is_each_once(light: NDArray[np.int64], view: NDArray[np.int64]) -> bool:
    return len(light) == 81**2 and len(np.unique(light * 81 + view)) == 81**2


def _rgb(samples: Samples) -> NDArray[np.float64]:
    return np.broadcast_to(samples.value, (len(samples), 3))


FORMAT = Format(
    name="csv",
    suffix=".csv",
    title="a line a pair of directions, as spreadsheets and gonio reconstruct read it",
    keeps="every pair of the grid to nine digits, anisotropy, linear RGB, sigma where it is known",
    loses="what lies between the nodes and beyond 75 deg",
    write=write,
    read=read,
    sigma=True,
)
