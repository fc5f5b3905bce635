"""The directions that a plan chooses from: the paper's, rings, Fibonacci, Klems, or a file's."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_degrees, paper_angles_deg, ring_angles_deg
from gonio.errors import BadFileError, BadInputError
from gonio.validation import plain_float, read_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

PAPER = "paper-81"
KNOWN = f"{PAPER}, klems, rings:THETAxCOUNT,..., fibonacci:N, or a file FILE.csv"
MOST = 4000
"""Directions of a set: the pairs of two such sets are 16 million."""

_KLEMS = ((0, 1), (10, 8), (20, 16), (30, 20), (40, 24), (50, 24), (60, 24), (70, 16), (82.5, 12))
_GOLDEN_DEG = 180 * (3 - np.sqrt(5))
_LARGEST = 2_000_000
_SAME_DEG = 1e-6
_REMEDY = "give a line theta_deg,phi_deg and then a direction a line, in degrees"


@dataclass(frozen=True)
class Candidates:
    """A set of directions of one arm.

    Attributes
    ----------
    name
        As the plan records it.
    theta_deg, phi_deg
        Angles in degrees, shape (n,) each, phi in [0, 360).
    """

    name: str
    theta_deg: Array
    phi_deg: Array

    def __len__(self) -> int:
        return len(self.theta_deg)

    @property
    def directions(self) -> Array:
        """Unit vectors, shape (n, 3)."""
        return from_degrees(self.theta_deg, self.phi_deg)

    def part(self, rows: NDArray[np.bool_]) -> Candidates:
        """Return those where `rows`, shape (n,), is true."""
        return Candidates(self.name, self.theta_deg[rows], self.phi_deg[rows])


def paper_candidates() -> Candidates:
    """Return the paper's 81 directions, the pole first (see `gonio.directions.RINGS_81`)."""
    return Candidates(PAPER, *paper_angles_deg())


def candidates_named(name: str) -> Candidates:
    """Return a set of directions by name.

    Parameters
    ----------
    name
        `paper-81`; `klems`, the 145 centres of the full Klems basis (Klems 1994), the outermost
        ring at 82.5 deg; `rings:0x1,30x8,60x16`, rings of theta in degrees and number of azimuths,
        each from phi 0; `fibonacci:300`, a spiral of equal solid angles from the pole to the
        horizon (Gonzalez 2010); or the path of a CSV file with the columns theta_deg and phi_deg.

    Raises
    ------
    BadInputError
        For a name that is none, listing the known; a set of more than 4000, or one that holds a
        direction twice.
    """
    kind, _, rest = name.partition(":")
    if kind.lower() == PAPER:
        return paper_candidates()
    if kind.lower() == "klems":
        return _rings("klems", _KLEMS)
    if kind.lower() == "rings":
        return _checked(_rings(name.lower(), _parsed_rings(name, rest)))
    if kind.lower() == "fibonacci":
        return _fibonacci(name, rest)
    if name.lower().endswith(".csv"):
        return _checked(_read(Path(name)))
    raise BadInputError(f"candidates {name!r} are not known; use {KNOWN}")


def _rings(name: str, rings: Sequence[tuple[float, int]]) -> Candidates:
    return Candidates(name, *ring_angles_deg(rings))


def _parsed_rings(name: str, text: str) -> list[tuple[float, int]]:
    rings = []
    for part in text.lower().split(","):
        match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)x(\d{1,4})\s*", part)
        if not match:
            raise BadInputError(
                f"candidates {name!r}: {part!r} is no ring; write rings:0x1,30x8,60x16, each "
                "theta in degrees x number of azimuths"
            )
        theta, count = float(match[1]), int(match[2])
        if theta > 90 or not 1 <= count <= MOST:
            raise BadInputError(
                f"candidates {name!r}: ring {part!r} is beyond 90 deg, or not of 1 to {MOST}"
            )
        rings.append((theta, count))
    return rings


def _fibonacci(name: str, text: str) -> Candidates:
    count = int(text) if re.fullmatch(r"\d{1,6}", text) else 0
    if not 1 <= count <= MOST:
        raise BadInputError(f"candidates {name!r}: write fibonacci:N with N from 1 to {MOST}")
    place = np.arange(count)
    theta_deg = np.degrees(np.arccos(1 - (place + 0.5) / count))
    return Candidates(name.lower(), theta_deg, (place * _GOLDEN_DEG) % 360)


def _read(path: Path) -> Candidates:
    if path.exists() and not path.is_dir():
        # a device, or a pipe that nobody writes to, would never end
        if not path.is_file():
            raise BadFileError(path, "is no regular file", _REMEDY)
        if path.stat().st_size > _LARGEST:
            raise BadFileError(path, f"is larger than {MOST} directions ever are", _REMEDY)
    rows = [row for row in csv.reader(read_text(path, _REMEDY).splitlines()) if row]
    head = [name.strip().lower() for name in rows[0]] if rows else []
    if not {"theta_deg", "phi_deg"} <= set(head):
        raise BadFileError(path, "has no columns theta_deg and phi_deg", _REMEDY)
    if len(rows) < 2:
        raise BadFileError(path, "holds no direction", _REMEDY)
    columns = [head.index("theta_deg"), head.index("phi_deg")]
    angles = np.array([_angles(path, line, row, columns) for line, row in enumerate(rows[1:], 2)])
    return Candidates(path.name, angles[:, 0], angles[:, 1])


def _angles(path: Path, line: int, row: list[str], columns: list[int]) -> tuple[float, float]:
    try:
        theta, phi = (plain_float(row[column]) for column in columns)
    except (ValueError, IndexError):
        raise BadFileError(
            path, f"line {line}: {','.join(row)!r} are no two angles", _REMEDY
        ) from None
    if not (0 <= theta <= 90 and abs(phi) <= 720):
        raise BadFileError(path, f"line {line}: theta is 0 to 90 deg, phi within 720", _REMEDY)
    turned = phi % 360
    # a tiny negative angle modulo 360 rounds up to 360 itself
    return theta, turned if turned < 360 else 0.0


def _checked(candidates: Candidates) -> Candidates:
    if len(candidates) > MOST:
        raise BadInputError(
            f"candidates {candidates.name}: {len(candidates)} directions are too many; {MOST} "
            "at most"
        )
    near = np.round(candidates.directions / np.radians(_SAME_DEG))
    _, first, inverse = np.unique(near, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[inverse.reshape(-1)] != np.arange(len(candidates)))
    if len(again):
        theta, phi = candidates.theta_deg[again[0]], candidates.phi_deg[again[0]]
        raise BadInputError(
            f"candidates {candidates.name}: theta {theta:g}, phi {phi:g} deg stands there twice; "
            "list each direction once (at theta 0 all azimuths are one)"
        )
    return candidates
