"""What a chart's patches are under a lamp whose spectrum is known."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.chart import PATCHES
from gonio.color import D65, adaptation
from gonio.errors import BadFileError, MissingExtraError
from gonio.validation import plain_float, read_text

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

_NM: Final = np.arange(380.0, 731.0, 5.0)
_REMEDY = "compare it with docs/topics/color.md"
_MEASURED_CHARTS = "BabelColor Average"


def colour_science() -> Any:
    """Return the package colour.

    Raises
    ------
    gonio.errors.MissingExtraError
        Without the extra `color`.
    """
    try:
        import colour
    except ModuleNotFoundError:
        raise MissingExtraError("colour-science", "color") from None
    return colour


def read_lamp(path: Path) -> NDArray[np.float64]:
    """Read a lamp's relative power from a CSV table with the columns wavelength_nm and power.

    Returns
    -------
    ndarray
        Every 5 nm from 380 to 730 nm, shape (71,).

    Raises
    ------
    gonio.errors.BadFileError
        When it is no such table, or does not reach from 400 to 700 nm.
    """
    return _read(path, 1)[:, 0]


def read_chart_spectra(path: Path) -> NDArray[np.float64]:
    """Read the reflectance of all patches: wavelength_nm, then 24 columns, dark skin to black.

    Returns
    -------
    ndarray
        Shape (71, 24), wavelengths as `read_lamp`'s.

    Raises
    ------
    gonio.errors.BadFileError
        As `read_lamp`.
    """
    return _read(path, PATCHES)


def _read(path: Path, columns: int) -> NDArray[np.float64]:
    rows = [row for row in csv.reader(read_text(path, _REMEDY).splitlines()) if row]
    header = [cell.strip() for cell in rows[0]] if rows else []
    if header[:1] != ["wavelength_nm"] or len(header) != columns + 1:
        problem = f"has no columns wavelength_nm and {columns} more"
        raise BadFileError(path, problem, _REMEDY)
    numbers = [_numbers(path, line, row, columns + 1) for line, row in enumerate(rows[1:], 2)]
    table = np.array(numbers).reshape(-1, columns + 1)
    table = table[np.argsort(table[:, 0])]
    if not len(table) or table[0, 0] > 400.0 or table[-1, 0] < 700.0:
        raise BadFileError(path, "does not reach from 400 to 700 nm", _REMEDY)
    if not np.diff(table[:, 0]).all():
        twice = table[:-1][np.diff(table[:, 0]) == 0][0, 0]
        raise BadFileError(path, f"has a wavelength of {twice:g} nm twice", _REMEDY)
    values = np.stack([np.interp(_NM, table[:, 0], each) for each in table[:, 1:].T], axis=-1)
    if not values.max() > 0:
        raise BadFileError(path, "is zero throughout", _REMEDY)
    return values


def _numbers(path: Path, line: int, row: list[str], columns: int) -> list[float]:
    try:
        numbers = [plain_float(cell) for cell in row]
    except ValueError:
        raise BadFileError(path, f"line {line}: holds what is no number", _REMEDY) from None
    if len(numbers) != columns or not np.isfinite(numbers).all() or min(numbers) < 0:
        problem = f"line {line}: {columns} numbers of at least zero are needed"
        raise BadFileError(path, problem, _REMEDY)
    return numbers


def lit_xyz(
    lamp: NDArray[np.float64], chart: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return XYZ of the patches under a lamp, adapted from its white to D65, shape (24, 3).

    The CIE 1931 observer every 5 nm (ISO/CIE 11664-3), then Bradford's adaptation; a perfect
    diffuser's Y is 1.

    Parameters
    ----------
    lamp
        As from `read_lamp`.
    chart
        As from `read_chart_spectra`; by default the mean of thirty charts that BabelColor measured.

    Raises
    ------
    gonio.errors.MissingExtraError
        Without the extra `color`.
    """
    colour = colour_science()
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    weights = lamp[:, None] * np.asarray(observer[_NM])
    weights /= weights[:, 1].sum()
    reflectance = measured_charts(colour) if chart is None else chart
    return np.asarray(reflectance.T @ weights @ adaptation(weights.sum(axis=0), D65).T)


def wavelengths_nm() -> NDArray[np.float64]:
    """Return those that all spectra here are of, every 5 nm from 380 to 730, shape (71,)."""
    return _NM.copy()


def measured_charts(colour: Any) -> NDArray[np.float64]:
    """Return the mean reflectance of thirty charts that BabelColor measured, shape (71, 24)."""
    spectra = colour.SDS_COLOURCHECKERS[_MEASURED_CHARTS].values()
    return np.stack([np.interp(_NM, each.wavelengths, each.values) for each in spectra], axis=-1)
