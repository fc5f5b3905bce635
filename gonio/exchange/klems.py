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
from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.format import Format, Source
from gonio.exchange.window_xml import (
    REMEDY,
    WindowFile,
    is_window,
    read_window,
    rgb_of,
    text_of,
    write_window,
    xyz_of,
)

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress

    Array = NDArray[np.float64]

_FULL = "LBNL/Klems Full"
BASES: Final = {
    _FULL: ((0, 5, 15, 25, 35, 45, 55, 65, 75, 90), (1, 8, 16, 20, 24, 24, 24, 16, 12)),
    "LBNL/Klems Half": ((0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90), (1, 8, 12, 16, 20, 12, 4)),
    "LBNL/Klems Quarter": ((0, 9, 27, 46, 66, 90), (1, 8, 12, 12, 8)),
}
"""Bounds of theta in degrees, and patches of each ring, the first around phi 0, by name."""

_ACROSS, _ALONG = 2, 3
_WAVELENGTHS = ("CIE-X", "Visible", "CIE-Z")
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


def quadrature(basis: str) -> Array:
    """Return directions within each patch, of equal weight by the cosine, shape (patches, 6, 3).

    Midpoints in sin^2 theta and phi, which halve and third each patch's projected solid angle.
    """
    bounds, counts = BASES[basis]
    height = np.sin(np.radians(bounds)) ** 2
    across = (np.arange(_ACROSS) + 0.5) / _ACROSS
    along = (np.arange(_ALONG) + 0.5) / _ALONG - 0.5
    patches = []
    for low, high, count in zip(height, height[1:], counts, strict=False):
        theta = np.arcsin(np.sqrt(low + (high - low) * across))
        phi = (np.arange(count)[:, None] + along) * TWO_PI / count
        points = from_spherical(theta[:, None], phi[:, None])
        patches.append(points.reshape(count, -1, 3))
    return np.concatenate(patches)


def averages(material: Material, progress: Progress | None = None) -> Array:
    """Return the mean BRDF of each pair of patches in 1/sr, shape (145, 145, 3), incident first.

    The mean is by projected solid angle, of both patches.
    """
    outgoing = quadrature(_FULL)
    incident = outgoing * [-1.0, -1.0, 1.0]
    patches, points = outgoing.shape[:2]
    shape = (patches, patches, points, points, 3)
    light = np.broadcast_to(incident[:, None, :, None], shape).reshape(-1, 3)
    view = np.broadcast_to(outgoing[None, :, None, :], shape).reshape(-1, 3)
    values = evaluate_in_blocks(material, light, view, progress)
    return np.asarray(values.reshape(shape).mean(axis=(2, 3)))


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write luminance and, for Radiance, X and Z of the colours."""
    xyz = xyz_of(averages(source.material, progress).clip(0.0))
    data = {_WAVELENGTHS[i]: _rows(xyz[..., i].T) for i in (1, 0, 2)}
    bases = f"<ColumnAngleBasis>{_FULL}</ColumnAngleBasis><RowAngleBasis>{_FULL}</RowAngleBasis>\n"
    write_window(path, source.name, "Columns", _definition(), bases, data)


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


def _rows(matrix: Array) -> str:
    return "\n".join(", ".join(f"{value:.6g}" for value in row) for row in matrix)


def _definition() -> str:
    bounds, counts = BASES[_FULL]
    rings = [
        f"<AngleBasisBlock><Theta>{0 if low == 0 else (low + high) / 2:g}</Theta>"
        f"<nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{low:g}</LowerTheta>"
        f"<UpperTheta>{high:g}</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        for low, high, count in zip(bounds, bounds[1:], counts, strict=False)
    ]
    return (
        f"<AngleBasis>\n<AngleBasisName>{_FULL}</AngleBasisName>\n{''.join(rings)}</AngleBasis>\n"
    )


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
