"""Spectra of reflectance as linear sRGB, such as those of RGL tensors that end in _spec.bsdf."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.color import D65, XYZ_FROM_SRGB, adaptation
from gonio.colorimetry.spectra import colour_science
from gonio.errors import BadFileError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

_NM: Final = np.arange(360.0, 831.0)
_MOST_WAVELENGTHS: Final = 2048
_AT_ONCE: Final = 1 << 22
_REMEDY: Final = "expected: spectra over (phi_i, theta_i, wavelengths, y, x), wavelengths in nm"


def with_rgb(
    fields: Mapping[str, NDArray[Any]], path: Path, most_values: int
) -> Mapping[str, NDArray[Any]]:
    """Return the fields with `rgb` made of `spectra`, where there is none.

    What each node reflects of D65 as the CIE 1931 observer sees it, in linear sRGB; between their
    wavelengths spectra are linear, beyond the last ones constant.

    Parameters
    ----------
    fields
        Of a tensor file.
    path
        For messages.
    most_values
        Of rgb.

    Raises
    ------
    gonio.errors.BadFileError
        When spectra and wavelengths do not fit each other, are too many, or leave light unseen.
    gonio.errors.MissingExtraError
        Without the extra `color`.
    """
    if "rgb" in fields or "spectra" not in fields:
        return fields
    wavelengths = _wavelengths(fields, path)
    spectra, count = fields["spectra"], len(wavelengths)
    if spectra.ndim != 5 or spectra.shape[2] != count or spectra.size == 0:
        problem = f"spectra is of shape {spectra.shape} for {count} wavelengths"
        raise BadFileError(path, problem, _REMEDY)
    if spectra.size // count * 3 > most_values:
        raise BadFileError(path, f"rgb would hold more than {most_values} values", _REMEDY)
    return {**fields, "rgb": _seen(spectra, wavelengths)}


def _wavelengths(fields: Mapping[str, NDArray[Any]], path: Path) -> NDArray[np.float64]:
    if "wavelengths" not in fields:
        raise BadFileError(path, "has spectra, but no field wavelengths", _REMEDY)
    told = fields["wavelengths"]
    if told.ndim != 1 or not 2 <= told.size <= _MOST_WAVELENGTHS:
        problem = f"wavelengths is of shape {told.shape}, not 2 to {_MOST_WAVELENGTHS} numbers"
        raise BadFileError(path, problem, _REMEDY)
    with np.errstate(invalid="ignore"):
        wavelengths: NDArray[np.float64] = told.astype(np.float64)
    if not np.isfinite(wavelengths).all() or (np.diff(wavelengths) <= 0).any():
        raise BadFileError(path, "wavelengths does not grow", _REMEDY)
    if not (wavelengths[0] <= 400.0 and wavelengths[-1] >= 700.0):
        raise BadFileError(path, "has spectra that do not reach from 400 to 700 nm", _REMEDY)
    return wavelengths


def _seen(spectra: NDArray[Any], wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    weights = srgb_weights(wavelengths).T
    flat = spectra.reshape(-1, len(wavelengths), spectra.shape[3] * spectra.shape[4])
    rgb = np.empty((len(flat), 3, flat.shape[2]))
    step = max(1, _AT_ONCE // flat[0].size)
    # what is not finite stays so, and is told of by whoever looks at rgb
    with np.errstate(all="ignore"):
        for start in range(0, len(flat), step):
            part = slice(start, start + step)
            rgb[part] = weights @ flat[part].astype(np.float64)
    return rgb.reshape(*spectra.shape[:2], 3, *spectra.shape[3:])


def srgb_weights(wavelengths_nm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what each value of a spectrum adds to linear sRGB under D65, shape (wavelengths, 3).

    The spectrum is linear between its wavelengths and even beyond them; the CIE 1931 observer every
    nm (ISO/CIE 11664-3). A perfect diffuser comes out as 1, 1, 1.

    Raises
    ------
    gonio.errors.MissingExtraError
        Without the extra `color`.
    """
    colour = colour_science()
    observer = np.asarray(colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"][_NM])
    lamp = np.asarray(colour.SDS_ILLUMINANTS["D65"][_NM])
    within = np.stack(
        [np.interp(_NM, wavelengths_nm, one) for one in np.eye(len(wavelengths_nm))], axis=1
    )
    xyz = within.T @ (lamp[:, None] * observer) / (lamp @ observer[:, 1])
    weights: NDArray[np.float64] = (
        xyz @ adaptation(xyz.sum(axis=0), D65).T @ np.linalg.inv(XYZ_FROM_SRGB).T
    )
    return weights
