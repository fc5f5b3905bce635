"""The color matrix of a DNG: of those that a file may hold, the one that serves under D65."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from gonio.color import D65, adaptation
from gonio.errors import BadFileError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray


class Illuminant(NamedTuple):
    """A light: its name, its white as CIE x and y, and its correlated color temperature."""

    name: str
    x: float
    y: float
    kelvin: float

    @property
    def white(self) -> NDArray[np.float64]:
        """XYZ, Y being 1; of D65 as sRGB has it."""
        if self.name == "D65":
            return D65
        return np.array([self.x / self.y, 1.0, (1.0 - self.x - self.y) / self.y])


_ILLUMINANTS: Final = {
    17: Illuminant("A", 0.44757, 0.40745, 2856.0),
    18: Illuminant("B", 0.34842, 0.35161, 4874.0),
    19: Illuminant("C", 0.31006, 0.31616, 6774.0),
    20: Illuminant("D55", 0.33242, 0.34743, 5503.0),
    21: Illuminant("D65", 0.31271, 0.32902, 6504.0),
    22: Illuminant("D75", 0.29902, 0.31485, 7504.0),
    23: Illuminant("D50", 0.34567, 0.35850, 5003.0),
    24: Illuminant("ISO studio tungsten", 0.42340, 0.39900, 3200.0),
}
"""By Exif's LightSource (CIE 15, 2 deg observer; the last is a black body)."""

_TAKEN_AS: Final = {1: 20, 4: 20, 9: 20, 10: 21, 11: 22, 3: 17}
"""Daylight, flash and fine weather as D55, clouds as D65, shade as D75, tungsten as A."""

_MATRICES: Final = (
    ("ColorMatrix1", 50721, 50778),
    ("ColorMatrix2", 50722, 50779),
    ("ColorMatrix3", 52531, 52529),
)
"""Name, tag, and tag of the light that it was made for (DNG 1.7, chapter 6)."""

_NOT_OURS: Final = "a DNG as docs/topics/reduction.md describes it is needed"


class FileMatrix(NamedTuple):
    """XYZ under D65 to camera RGB, nine numbers row by row, and which of the file's it is."""

    values: tuple[float, ...]
    name: str


def file_matrix(tags: Mapping[int, Any], path: Path) -> FileMatrix | None:
    """Return the matrix that was made for D65, or for the light nearest to it, adapted.

    A matrix is of XYZ in the light that it was made for, so colors under D65 are first adapted to
    that one's white (Bradford). Of a light that is not told, or no standard one, D65 is believed.

    Parameters
    ----------
    tags
        Of the first directory.
    path
        Where from, for messages.

    Raises
    ------
    gonio.errors.BadFileError
        When a matrix is not 3 x 3.
    """
    found = [
        (_illuminant(tags.get(light)), name, tag) for name, tag, light in _MATRICES if tag in tags
    ]
    if not found:
        return None
    light, name, tag = min(found, key=lambda each: _distance(each[0]))
    matrix = _matrix(tags[tag], name, path)
    if light is None or light.name == "D65":
        return FileMatrix(tuple(matrix.ravel().tolist()), name)
    adapted = matrix @ adaptation(D65, light.white)
    return FileMatrix(tuple(adapted.ravel().tolist()), f"{name} of illuminant {light.name}")


def _illuminant(code: object) -> Illuminant | None:
    if not isinstance(code, int):
        return None
    return _ILLUMINANTS.get(_TAKEN_AS.get(code, code))


def _distance(light: Illuminant | None) -> float:
    """Return how far a light is from D65 in reciprocal degrees; what is not told comes last."""
    d65 = _ILLUMINANTS[21]
    return abs(1e6 / light.kelvin - 1e6 / d65.kelvin) if light else np.inf


def _matrix(parts: object, name: str, path: Path) -> NDArray[np.float64]:
    if not (isinstance(parts, tuple) and len(parts) == 18 and all(parts[1::2])):
        raise BadFileError(path, f"has a {name} that is not 3 x 3", _NOT_OURS)
    return np.divide(parts[::2], parts[1::2]).reshape(3, 3)
