"""Tables of a study, ready for a page or a terminal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gonio.report.drawings import Drawing

NAMES = {
    "eps8": "eps8 (8-bit steps)",
    "male": "male",
    "cube_root_rmse": "cube-root RMSE",
    "sphere_psnr_db": "sphere PSNR (dB)",
    "seconds": "learning time (s, one core)",
}
DIGITS = {"eps8": 2, "male": 3, "cube_root_rmse": 4, "sphere_psnr_db": 1, "seconds": 3}


@dataclass(frozen=True)
class Line:
    """One row of a grid: its name first."""

    cells: tuple[str, ...]
    best: bool


@dataclass(frozen=True)
class Grid:
    """A table, ready for a page or a terminal; of words, not numbers, where it says so."""

    title: str
    head: tuple[str, ...]
    lines: tuple[Line, ...]
    words: bool = False


@dataclass(frozen=True)
class Section:
    """One material; its drawings one below the other where they are broad."""

    title: str
    drawings: tuple[Drawing, ...]
    grids: tuple[Grid, ...]
    broad: bool = False


def number(value: float | None, digits: int) -> str:
    """Return a number in words; what has none diverged."""
    return "diverged" if value is None else f"{value:.{digits}f}"


def identifier(name: str) -> str:
    """Return what a name may be called in HTML."""
    return "".join(letter if letter.isalnum() else "-" for letter in name)
