"""Samples from a CSV table, as any other rig writes one (see docs/topics/samples-table.md)."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.color import CAMERA, LUMINANCE, SPACES, SRGB
from gonio.directions import from_degrees
from gonio.errors import BadFileError
from gonio.files import sha256_file
from gonio.samples import LARGEST, RGB, Flag, Samples
from gonio.validation import plain_float, read_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

_ANGLES = ("light_theta_deg", "light_phi_deg", "view_theta_deg", "view_phi_deg")
_CHANNELS = {space.name: space.channels for space in SPACES.values()}
_CHANNELS |= {CAMERA: RGB, LUMINANCE: ("y",)}
_SPACE = "color_space"
_REMEDY = "compare it with docs/topics/samples-table.md"
_TURN_DEG = 360.0
# in bytes: 150 000 lines; in memory it takes eighty times as much
_LONGEST = 1 << 24
_COMMAS = "separate them by commas and write decimals with a point, as in 0.5"
_DECIMAL_COMMA = " (decimal commas? write 0.5, not 0,5)"
# one value of noise in 3.5 million is lower
_NOISE = 5.0


def read_table(path: Path | str) -> Samples:
    """Read samples from a CSV table.

    Columns, in any order: `light_theta_deg`, `light_phi_deg`, `view_theta_deg`, `view_phi_deg`,
    then `r`, `g`, `b` or one `y` in 1/sr, and where known `sigma_r`, `sigma_g`, `sigma_b` or
    `sigma_y`, where an empty cell is an unknown sigma. A column `color_space` says what they are:
    linear sRGB, as without it, ACEScg, camera RGB, luminance of `y`, or XYZ D65, whose channels are
    `X`, `Y` and `Z`. Other columns are ignored. A value may be below zero as far as noise can be:
    by 5 sigma, where that is unknown by the median value.

    Raises
    ------
    gonio.errors.BadFileError
        Naming the line and the column that cannot be used.
    """
    path = Path(path)
    rows = _rows(path)
    header = next(rows, None)
    if header is None:
        raise BadFileError(path, "is empty", _REMEDY)
    table = _Table.of(header, list(rows))
    color_space = table.color_space()
    channels = _CHANNELS[color_space]
    angle = [table.column(name, _theta if "theta" in name else _phi) for name in _ANGLES]
    value = np.stack([table.column(name, _value) for name in channels], axis=1)
    sigma = table.sigma(channels)
    table.refuse_below_noise(channels, value, sigma)
    samples = Samples.from_values(
        light=from_degrees(*angle[:2]),
        view=from_degrees(*angle[2:]),
        value=value,
        sigma=sigma,
        channels=channels,
        color_space=color_space,
    )
    unknown = np.where(np.isnan(samples.sigma), np.uint32(Flag.NO_SIGMA), np.uint32(0))
    return replace(samples, flag=unknown, provenance={"table": sha256_file(path)})


@dataclass(frozen=True)
class _Row:
    """The cells of one line, and where it stands."""

    path: Path
    line: int
    cells: list[str]

    def error(self, problem: str) -> BadFileError:
        return BadFileError(self.path, f"line {self.line}{problem}", _REMEDY)

    def hint(self, cells: int) -> str:
        """Return what explains more cells than there should be, where they are all whole."""
        whole = all(cell.lstrip("+-").isdigit() for cell in self.cells)
        return _DECIMAL_COMMA if whole and len(self.cells) > cells else ""


@dataclass(frozen=True)
class _Table:
    header: _Row
    rows: list[_Row]

    @classmethod
    def of(cls, header: _Row, rows: list[_Row]) -> _Table:
        """Check that the lines fit the header."""
        for separator, called in {";": "semicolons", "\t": "tabs"}.items():
            if any(separator in name for name in header.cells):
                raise header.error(f": the cells seem to be separated by {called}; {_COMMAS}")
        for name in header.cells:
            if name and header.cells.count(name) > 1:
                raise header.error(f": column {name} is there twice")
        for row in rows:
            if len(row.cells) != len(header.cells):
                count = f"has {len(row.cells)} cells where the header has {len(header.cells)}"
                raise row.error(f": {count}{row.hint(len(header.cells))}")
        if not rows:
            raise header.error(": no samples follow the header")
        return cls(header, rows)

    def color_space(self) -> str:
        """Return what the values are: as stated, or told from whether there is r, g, b or y."""
        cells = self.header.cells
        if "y" in cells and set(RGB) & set(cells):
            raise self.header.error(": has both y and r, g, b; keep one of the two")
        if _SPACE not in cells:
            return LUMINANCE if "y" in cells else SRGB
        stated = self.rows[0].cells[cells.index(_SPACE)]
        for row in self.rows:
            if (name := row.cells[cells.index(_SPACE)]) != stated or name not in _CHANNELS:
                known = ", ".join(_CHANNELS)
                raise row.error(f", column {_SPACE}: {name!r} is none of {known}, one for all")
        return stated

    def sigma(self, channels: tuple[str, ...]) -> NDArray[np.float64] | None:
        """Return the sigmas, NaN where a cell is empty; None where no column states them."""
        names = [f"sigma_{channel}" for channel in channels]
        for name in self.header.cells:
            if name.startswith("sigma_") and name not in names:
                raise self.header.error(f": column {name} fits no value; use {', '.join(names)}")
        if not set(names) & set(self.header.cells):
            return None
        return np.stack([self.column(name, _sigma) for name in names], axis=1)

    def refuse_below_noise(
        self,
        channels: tuple[str, ...],
        value: NDArray[np.float64],
        sigma: NDArray[np.float64] | None,
    ) -> None:
        """Refuse a value further below zero than noise can be that a dark frame leaves behind."""
        noise = np.full(value.shape, np.nan) if sigma is None else _NOISE * sigma
        unknown = np.isnan(noise)
        noise[unknown] = np.median(np.abs(value))
        for row, channel in np.argwhere(value < -noise)[:1].tolist():
            least = (
                "the table's median, which is no noise; state its sigma if it is"
                if unknown[row, channel]
                else f"{_NOISE:g} sigma, which is no noise; correct or remove it"
            )
            raise self.rows[row].error(
                f", column {channels[channel]}: {value[row, channel]:g} is below zero by more "
                f"than {least}"
            )

    def column(self, name: str, parse: Callable[[str], float]) -> NDArray[np.float64]:
        """Parse a column, shape (rows,)."""
        if name not in self.header.cells:
            raise self.header.error(f": column {name} is missing")
        index = self.header.cells.index(name)
        values = np.empty(len(self.rows))
        for number, row in enumerate(self.rows):
            try:
                values[number] = parse(row.cells[index])
            except ValueError as error:
                raise row.error(f", column {name}: {error}") from None
        return values


def _rows(path: Path) -> Iterator[_Row]:
    """Yield the lines that are neither empty nor a comment, split at commas."""
    # a byte order mark, as spreadsheets write it, is no part of the first name
    text = read_text(path, _REMEDY, _LONGEST).removeprefix("\ufeff")
    for line, content in enumerate(text.split("\n"), start=1):
        if not content.strip() or content.lstrip().startswith("#"):
            continue
        try:
            cells = next(csv.reader([content], strict=True, skipinitialspace=True))
        except csv.Error as error:
            raise BadFileError(path, f"line {line}: is not CSV ({error})", _REMEDY) from None
        yield _Row(path, line, [cell.strip() for cell in cells])


def _is_decimal_comma(text: str) -> bool:
    """Tell whether a cell, in quotes or it would be two, is a number as in 0,112."""
    try:
        return text.count(",") == 1 and math.isfinite(float(text.replace(",", ".")))
    except ValueError:
        return False


def _number(text: str) -> float:
    try:
        value = plain_float(text)
    except ValueError:
        hint = _DECIMAL_COMMA if _is_decimal_comma(text) else ""
        raise ValueError(f"{text!r} is not a number{hint}" if text else "is empty") from None
    if not math.isfinite(value):
        raise ValueError(f"{text} is not a finite number")
    return value


def _theta(text: str) -> float:
    value = _number(text)
    if value > 90:
        raise ValueError(
            f"{text} deg is beyond 90 deg: that would be transmission, which gonio does not measure"
        )
    if value < 0:
        raise ValueError(f"{text} deg is negative; turn phi by 180 deg instead")
    return value


def _phi(text: str) -> float:
    value = _number(text)
    if abs(value) > _TURN_DEG:
        raise ValueError(f"{text} deg is more than a turn; give -360 to 360 deg")
    return value


def _value(text: str) -> float:
    value = _number(text)
    if abs(value) > LARGEST:
        raise ValueError(f"{text} is beyond {LARGEST:g} 1/sr, which nothing reflects")
    return value


def _sigma(text: str) -> float:
    if not text:
        return math.nan
    value = _number(text)
    if value <= 0:
        raise ValueError(f"{text} is not positive; leave the cell empty where it is unknown")
    if value > LARGEST:
        raise ValueError(f"{text} is beyond {LARGEST:g} 1/sr; leave the cell empty for unknown")
    return value
