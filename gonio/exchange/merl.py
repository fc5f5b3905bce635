"""MERL's isotropic binary tables (Matusik, Pfister, Brand and McMillan 2003)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import from_half_difference, to_half_difference
from gonio.errors import BadFileError
from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.format import Format, Source
from gonio.exchange.grids import check_finite, clamped, multilinear, periodic
from gonio.exchange.horizon import above_horizon
from gonio.exchange.limits import read_whole
from gonio.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress

_SHAPE: Final = (90, 90, 180)
_HEADER: Final = struct.Struct("<3i")
_SCALE: Final = np.array([1.0, 1.15, 1.66]) / 1500.0
_QUARTER = np.pi / 2.0
_REMEDY = "expected: MERL's 3 counts of theta_h, theta_d and phi_d, then 3 planes of doubles"


@dataclass(frozen=True)
class MerlTable:
    """An isotropic, reciprocal material at half and difference angles.

    Attributes
    ----------
    values
        Shape (theta_h, theta_d, phi_d, 4): linear RGB in 1/sr and 1, or 0 throughout where the file
        holds nothing. Theta_h grows with the square of its index, phi_d goes over half a turn.
    """

    values: NDArray[np.float64]

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, shape (..., 3), linear between the middles of the cells."""
        light, view = np.broadcast_arrays(light, view)
        angles = to_half_difference(light.reshape(-1, 3), view.reshape(-1, 3))
        theta_h, _, theta_d, phi_d = angles
        half, difference, turn, _ = self.values.shape
        places = (
            clamped(np.sqrt(theta_h / _QUARTER) * half - 0.5, half),
            clamped(theta_d / _QUARTER * difference - 0.5, difference),
            periodic(phi_d % np.pi / np.pi * turn - 0.5, turn),
        )
        told = multilinear(self.values, places)
        return (told[:, :3] / np.maximum(told[:, 3:], 1e-9)).reshape(light.shape)


def read(path: Path) -> MerlTable:
    """Read a table of any number of cells.

    Raises
    ------
    gonio.errors.BadFileError
        When its length is not that of its cells, or a value is not finite.
    """
    content = read_whole(path)
    shape = _shape_of(content[: _HEADER.size], len(content))
    if shape is None:
        raise BadFileError(path, "has not the length that its header tells", _REMEDY)
    planes = np.frombuffer(content, "<f8", offset=_HEADER.size).reshape(3, *shape)
    check_finite(planes, path, "a plane", _REMEDY)
    values = np.empty((*shape, 4))
    # below the horizon the files of the database hold negative numbers
    values[..., 3] = (planes >= 0).all(axis=0)
    values[..., :3] = np.moveaxis(planes, 0, -1) * _SCALE * values[..., 3:]
    return MerlTable(values)


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write the values at the middles of 90 x 90 x 180 cells, as the mean of both ways of light.

    Behind the horizon, where there are none, are those at 89 deg: readers that interpolate need
    some.
    """
    half, difference, turn = (np.arange(count) + 0.5 for count in _SHAPE)
    theta_h, theta_d, phi_d = np.meshgrid(
        (half / _SHAPE[0]) ** 2 * _QUARTER,
        difference / _SHAPE[1] * _QUARTER,
        turn / _SHAPE[2] * np.pi,
        indexing="ij",
    )
    pairs = from_half_difference(theta_h.ravel(), 0.0, theta_d.ravel(), phi_d.ravel())
    light, view = map(above_horizon, pairs)
    both = np.concatenate([light, view]), np.concatenate([view, light])
    there, back = np.split(evaluate_in_blocks(source.material, *both, progress), 2)
    planes = np.moveaxis((there + back) / 2.0 / _SCALE, -1, 0)
    write_bytes(path, _HEADER.pack(*_SHAPE) + planes.astype("<f8").tobytes())


def _shape_of(header: bytes, size: int) -> tuple[int, int, int] | None:
    """Return the numbers of cells, where the file's size fits them."""
    if len(header) < _HEADER.size:
        return None
    half, difference, turn = _HEADER.unpack(header)
    fits = min(half, difference, turn) > 0
    fits = fits and size == _HEADER.size + 24 * half * difference * turn
    return (half, difference, turn) if fits else None


FORMAT = Format(
    name="merl",
    suffix=".binary",
    title="MERL's table of half and difference angles, as most renderers and BRDF viewers read it",
    keeps="narrow highlights (theta_h to 0.03 deg), theta to 90 deg, linear RGB",
    loses="anisotropy (it is refused), differences between the two ways of light, sigma",
    write=write,
    read=read,
    claims=lambda head, size: _shape_of(head[: _HEADER.size], size) is not None,
    anisotropic=False,
)
