"""LBNL's matrix BSDF: averages over the 145 x 145 patches of the full Klems basis, as XML.

Klems (1994), A new method for predicting the solar heat gain of complex fenestration systems;
directions and order as Radiance's `bsdf_m.c` reads them: columns are incident, and an incident
patch is named by where its light goes to, so phi is turned by 180 deg.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import TWO_PI, from_spherical, to_spherical
from gonio.errors import BadFileError
from gonio.exchange.format import Format, Source
from gonio.exchange.window_xml import (
    REMEDY,
    WindowFile,
    is_window,
    read_window,
    rgb_of,
    text_of,
)

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from gonio.protocols import Progress

    Array = NDArray[np.float64]

FULL: Final = "LBNL/Klems Full"
"""The basis that is written."""

BASES: Final = {
    FULL: ((0, 5, 15, 25, 35, 45, 55, 65, 75, 90), (1, 8, 16, 20, 24, 24, 24, 16, 12)),
    "LBNL/Klems Half": ((0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90), (1, 8, 12, 16, 20, 12, 4)),
    "LBNL/Klems Quarter": ((0, 9, 27, 46, 66, 90), (1, 8, 12, 12, 8)),
}
"""Bounds of theta in degrees, and patches of each ring, the first around phi 0, by name."""

# a node of the grid on a bound belongs to the ring outside it, whatever its last digit
_ON_BOUND_DEG = 1e-9


@dataclass(frozen=True)
class KlemsMatrix:
    """A material that is constant on pairs of patches.

    Attributes
    ----------
    values
        BRDF in 1/sr, shape (incident patches, outgoing patches, 3).
    incident, outgoing
        Names of their bases.
    mirrored
        Whether x runs the other way.
    """

    values: Array
    incident: str
    outgoing: str
    mirrored: bool = False

    def evaluate(self, light: Array, view: Array) -> Array:
        """Return the BRDF in 1/sr, shape (..., 3), without interpolation, as Radiance reads it."""
        sign = [-1.0, 1.0, 1.0] if self.mirrored else [1.0, 1.0, 1.0]
        incident = patch_of(self.incident, light * np.array(sign) * [-1.0, -1.0, 1.0])
        return self.values[incident, patch_of(self.outgoing, view * np.array(sign))]


def patch_of(basis: str, direction: Array) -> NDArray[np.int64]:
    """Return the patch in which each direction of shape (..., 3) lies, shape (...)."""
    bounds, counts = BASES[basis]
    theta, phi = to_spherical(direction)
    inner = np.asarray(bounds[1:-1])
    ring = np.searchsorted(inner, np.degrees(theta) + _ON_BOUND_DEG, side="right")
    count = np.asarray(counts)[ring]
    first = np.concatenate([[0], np.cumsum(counts)])[ring]
    turn = np.floor(phi / TWO_PI * count + 0.5).astype(np.int64) % count
    return np.asarray(first + turn)


def points_in(basis: str, patch: NDArray[np.int64], place: Array) -> Array:
    """Return directions within patches, of equal weight by the cosine, shape (patches, points, 3).

    Parameters
    ----------
    basis
        Its name.
    patch
        Numbers of patches, shape (patches,).
    place
        Where in a patch, in sin^2 theta and phi, from 0 to 1, shape (points, 2).
    """
    bounds, counts = BASES[basis]
    height, count = np.sin(np.radians(bounds)) ** 2, np.asarray(counts)
    ring = np.repeat(np.arange(len(count)), count)[patch]
    number = patch - (np.cumsum(count) - count)[ring]
    low, high = height[ring][:, None], height[ring + 1][:, None]
    theta = np.arcsin(np.sqrt(low + (high - low) * place[:, 0]))
    turn = (number[:, None] + place[:, 1] - 0.5) / count[ring][:, None]
    return from_spherical(theta, turn * TWO_PI)


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write luminance and, for Radiance, X and Z of the colours."""
    from gonio.exchange.klems_writing import write_matrix

    write_matrix(source, path, progress)


def read(path: Path) -> KlemsMatrix:
    """Read the matrices of a full, half or quarter Klems basis.

    Raises
    ------
    gonio.errors.BadFileError
        When it is none, of another basis, or its matrix does not fit.
    """
    file = read_window(path)
    if file.structure.lower() not in ("columns", "rows"):
        raise BadFileError(path, f"holds {file.structure[:20]!r}, no matrix", REMEDY)
    incident, outgoing = _bases(path, file.blocks["visible"])
    luminance = _matrix(path, file, "visible")
    x, z = (_matrix(path, file, name) for name in ("cie-x", "cie-z"))
    if luminance is None or x is None or z is None:
        values = np.repeat(np.asarray(luminance)[..., None], 3, axis=-1)
    else:
        values = rgb_of(np.stack([x, luminance, z], axis=-1))
    return KlemsMatrix(values, incident, outgoing, file.mirrored)


def _bases(path: Path, block: Element) -> tuple[str, str]:
    known = {name.lower(): name for name in BASES}
    names = [text_of(block, f"{each}AngleBasis").lower() for each in ("Column", "Row")]
    for name in names:
        if name not in known:
            problem = f"is of the basis {name[:40]!r}, not of {', '.join(BASES)}"
            raise BadFileError(path, problem, REMEDY)
    return known[names[0]], known[names[1]]


def _matrix(path: Path, file: WindowFile, name: str) -> Array | None:
    """Return a wavelength's values, not below 0, incident first; None where it is not there."""
    if name not in file.blocks:
        return None
    block = file.blocks[name]
    incident, outgoing = (sum(BASES[each][1]) for each in _bases(path, block))
    words = text_of(block, "ScatteringData").replace(",", " ").split()
    if len(words) != incident * outgoing:
        problem = f"has {len(words)} values for {name}, not {incident} x {outgoing}"
        raise BadFileError(path, problem, REMEDY)
    try:
        values = np.array(words, dtype=np.float64)
    except ValueError as error:
        raise BadFileError(path, f"holds what is no number ({error})", REMEDY) from None
    if not np.isfinite(values).all() or values.max() > np.finfo(np.float32).max:
        raise BadFileError(path, f"holds values for {name} that are not finite", REMEDY)
    values = values.clip(0.0)
    if file.structure.lower() == "rows":
        return values.reshape(incident, outgoing)
    return values.reshape(outgoing, incident).T


FORMAT = Format(
    name="klems",
    suffix=".xml",
    title="145 x 145 matrix of the full Klems basis, as WINDOW and Radiance read it",
    keeps="means over patches of 10 to 15 deg to six digits, anisotropy, up to the horizon, "
    "luminance and, for Radiance, colour",
    loses="whatever is finer than a patch, colour in WINDOW, sigma",
    write=write,
    read=read,
    claims=lambda head, size: is_window(head, tree=False),
)
