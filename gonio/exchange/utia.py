"""UTIA's anisotropic binary tables (Filip and Vavra 2014)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import TWO_PI, from_degrees, to_spherical
from gonio.errors import BadFileError
from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.format import Format, Source
from gonio.exchange.grids import Place, check_finite, clamped, multilinear, periodic
from gonio.exchange.limits import read_whole
from gonio.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress

_RINGS: Final = 6
_STEP_DEG: Final = 15.0
_AZIMUTHS: Final = 48
_SIZE: Final = 3 * (_RINGS * _AZIMUTHS) ** 2 * 8
_REMEDY = f"expected: 3 x 6 x 48 x 6 x 48 doubles, {_SIZE} bytes"


@dataclass(frozen=True)
class UtiaTable:
    """A material at each 15 deg of theta, up to 75 deg, and each 7.5 deg of phi.

    Attributes
    ----------
    values
        Shape (6, 48, 6, 48, 3): theta and phi of the light, those of the view, linear RGB in 1/sr.
    """

    values: NDArray[np.float64]

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, shape (..., 3), linear in the four angles up to 75 deg."""
        light, view = np.broadcast_arrays(light, view)
        places = (*_places(light.reshape(-1, 3)), *_places(view.reshape(-1, 3)))
        return multilinear(self.values, places).reshape(light.shape)


def read(path: Path) -> UtiaTable:
    """Read a table; what is negative in it, of noise, counts as 0.

    Raises
    ------
    gonio.errors.BadFileError
        When its length is another, or a value is not finite.
    """
    content = read_whole(path)
    if len(content) != _SIZE:
        raise BadFileError(path, f"is {len(content)} bytes long", _REMEDY)
    planes = np.frombuffer(content, "<f8").reshape(3, _RINGS, _AZIMUTHS, _RINGS, _AZIMUTHS)
    check_finite(planes, path, "a plane", _REMEDY)
    return UtiaTable(np.moveaxis(planes, 0, -1).clip(0.0))


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write the values at 288 x 288 pairs, a plane a channel, light first."""
    theta_deg = np.repeat(np.arange(_RINGS) * _STEP_DEG, _AZIMUTHS)
    phi_deg = np.tile(np.arange(_AZIMUTHS) * 360.0 / _AZIMUTHS, _RINGS)
    nodes = from_degrees(theta_deg, phi_deg)
    light, view = np.repeat(nodes, len(nodes), axis=0), np.tile(nodes, (len(nodes), 1))
    values = evaluate_in_blocks(source.material, light, view, progress)
    write_bytes(path, values.T.astype("<f8").tobytes())


def _places(direction: NDArray[np.float64]) -> tuple[Place, Place]:
    theta, phi = to_spherical(direction)
    return (
        clamped(np.degrees(theta) / _STEP_DEG, _RINGS),
        periodic(phi / TWO_PI * _AZIMUTHS, _AZIMUTHS),
    )


FORMAT = Format(
    name="utia",
    suffix=".bin",
    title="UTIA's table of 6 x 48 x 6 x 48 directions, as its readers and ALTA take it",
    keeps="anisotropy, both ways of light, linear RGB",
    loses="what is finer than 15 deg of theta and 7.5 deg of phi, what is beyond 75 deg, sigma",
    write=write,
    read=read,
    claims=lambda head, size: size == _SIZE and not head.startswith((b"PK", b"<", b"tensor_file")),
)
