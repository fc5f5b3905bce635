"""RGL's adaptive tensors (Dupuy and Jakob 2018), as Mitsuba 3's `measured` plugin reads them.

What the files call incident is the light. Mitsuba hands the direction towards the camera as
incident: it renders a material whose two ways of light differ with them exchanged.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.directions import TWO_PI, half_vector, to_spherical
from gonio.errors import BadFileError
from gonio.exchange.format import Format, Source
from gonio.exchange.grids import between, check_finite, clamped, multilinear
from gonio.exchange.horizon import LOWEST
from gonio.exchange.limits import read_whole
from gonio.exchange.spectra import with_rgb
from gonio.exchange.tensor_file import MAGIC, unpack
from gonio.exchange.warp import Slices, Warp

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress

_QUARTER: Final = np.pi / 2.0
_REMEDY: Final = "expected: an RGL tensor file, whose name ends in _rgb.bsdf or _spec.bsdf"
_DIMENSIONS: Final = {
    "phi_i": 1, "theta_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "luminance": 4, "rgb": 5,
    "jacobian": 1,
}  # fmt: skip
_MOST_VALUES: Final = 1 << 24
"""Of vndf and of rgb; the largest files of the database have a quarter of it."""


@dataclass(frozen=True)
class RglTensor:
    """A material at half vectors, where their density puts them, for each direction of the light.

    Attributes
    ----------
    phi, theta
        Of the light in radians, shapes (p,) and (t,); with p at most 2 the material is isotropic.
    ndf, sigma
        Density of normals and projected area, over (phi, theta), shape (h, w) each.
    vndf
        Density that places the half vectors, shape (p, t, h, w).
    rgb
        f cos(theta of the view), divided by ndf / (4 sigma), shape (p, t, 3, h, w).
    times_density
        Whether values are to be multiplied by ndf / (4 sigma).
    """

    phi: NDArray[np.float64]
    theta: NDArray[np.float64]
    ndf: NDArray[np.float64]
    sigma: NDArray[np.float64]
    vndf: NDArray[np.float64]
    rgb: NDArray[np.float64]
    times_density: bool = True

    @property
    def is_isotropic(self) -> bool:
        """Whether azimuth counts from that of the light."""
        return len(self.phi) <= 2

    @property
    def symmetry(self) -> int:
        """Of how many lights one stands for all: 1, 2 (half a turn) or 4 (both mirrors)."""
        if self.is_isotropic:
            return 1
        return int(np.rint(TWO_PI / (self.phi[-1] - self.phi[0])))

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, shape (..., 3), never below zero; views end at 89 deg."""
        light, view = np.broadcast_arrays(light, view)
        flat_light, flat_view = light.reshape(-1, 3), view.reshape(-1, 3)
        cosine = np.maximum(flat_view[:, 2:], LOWEST)
        value: NDArray[np.float64] = self._seen(*self._reduced(flat_light, flat_view)) / cosine
        return value.clip(0.0).reshape(light.shape)

    def _reduced(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mirror both into the part of azimuths that is there, which ends at phi = 0."""
        if self.symmetry < 2:
            return light, view
        y = np.where(light[:, 1] < 0, 1.0, -1.0)
        x = np.where(light[:, 0] < 0, 1.0, -1.0) if self.symmetry == 4 else y
        mirror = np.stack([x, y, np.ones(len(light))], axis=1)
        return light * mirror, view * mirror

    def _seen(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return f cos(theta of the view), shape (n, 3)."""
        theta_i, phi_i = _angles(light)
        square = self.square_of(half_vector(light, view), phi_i)
        azimuth, polar = between(phi_i, self.phi), between(theta_i, self.theta)
        corners = [
            (i * len(self.theta) + j, wi * wj)
            for i, wi in ((azimuth.low, 1 - azimuth.weight), (azimuth.high, azimuth.weight))
            for j, wj in ((polar.low, 1 - polar.weight), (polar.high, polar.weight))
        ]
        slices = Slices(*(np.stack(each, axis=1) for each in zip(*corners, strict=True)))
        place, _ = self._warp.invert(square, slices)
        height, width = self.rgb.shape[3:]
        spots = (
            clamped(place[:, 1] * (height - 1), height),
            clamped(place[:, 0] * (width - 1), width),
        )
        values = multilinear(self._values, (azimuth, polar, *spots))
        return values * self.density(square, theta_i, phi_i)[:, None]

    def square_of(
        self, half: NDArray[np.float64], phi_i: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return where half vectors lie on the square of the tables, shape (n, 2)."""
        theta, phi = _angles(half)
        turned = phi - phi_i if self.is_isotropic else phi
        return np.stack([np.sqrt(theta / _QUARTER), ((turned + np.pi) / TWO_PI) % 1.0], axis=1)

    def density(
        self, square: NDArray[np.float64], theta_i: NDArray[np.float64], phi_i: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return ndf / (4 sigma), shape (n,), or 1 where values are without."""
        if not self.times_density:
            return np.ones(len(square))
        of_light = np.stack([np.sqrt(theta_i / _QUARTER), (phi_i + np.pi) / TWO_PI], axis=1)
        return _bilinear(self.ndf, square) / (
            4.0 * np.maximum(_bilinear(self.sigma, of_light), 1e-9)
        )

    @cached_property
    def _warp(self) -> Warp:
        return Warp(self.vndf.reshape(-1, *self.vndf.shape[2:]))

    @cached_property
    def _values(self) -> NDArray[np.float64]:
        return np.ascontiguousarray(np.moveaxis(self.rgb, 2, -1))


def read(path: Path) -> RglTensor:
    """Read a tensor of RGB values, or of spectra, which become RGB under D65.

    Raises
    ------
    gonio.errors.BadFileError
        When fields are missing, do not fit each other, or hold what no reflectance is.
    gonio.errors.MissingExtraError
        For spectra, without the extra `color`.
    """
    fields = with_rgb(unpack(read_whole(path), path), path, _MOST_VALUES)
    _check_shapes(fields, path)
    # signalling NaNs warn when they are cast; all are refused below
    with np.errstate(invalid="ignore"):
        numbers = {name: np.asarray(fields[name], np.float64) for name in _DIMENSIONS}
    for name, array in numbers.items():
        check_finite(array, path, name, _REMEDY)
    for name in ("ndf", "sigma", "vndf"):
        if (numbers[name] < 0).any():
            raise BadFileError(path, f"{name} is negative somewhere", _REMEDY)
    for name in ("phi_i", "theta_i"):
        if (np.diff(numbers[name]) <= 0).any():
            raise BadFileError(path, f"{name} does not grow", _REMEDY)
    _check_azimuths(numbers["phi_i"], path)
    return RglTensor(
        phi=numbers["phi_i"],
        theta=numbers["theta_i"],
        ndf=numbers["ndf"],
        sigma=numbers["sigma"],
        vndf=numbers["vndf"],
        rgb=numbers["rgb"],
        times_density=bool(numbers["jacobian"][0]),
    )


def write(source: Source, path: Path, progress: Progress | None) -> None:
    """Write a tensor of RGB values, isotropic where the material is."""
    from gonio.exchange.rgl_writing import write_tensor

    write_tensor(source, path, progress)


def _check_shapes(fields: Mapping[str, NDArray[Any]], path: Path) -> None:
    for name, dimensions in _DIMENSIONS.items():
        if name not in fields:
            raise BadFileError(path, f"has no field {name}", _REMEDY)
        if fields[name].ndim != dimensions or fields[name].size == 0:
            raise BadFileError(path, f"{name} is of shape {fields[name].shape}", _REMEDY)
        if fields[name].size > _MOST_VALUES:
            raise BadFileError(path, f"{name} holds more than {_MOST_VALUES} values", _REMEDY)
    views = fields["phi_i"].shape + fields["theta_i"].shape
    fit = all(fields[name].shape[:2] == views for name in ("vndf", "luminance", "rgb"))
    fit = fit and fields["rgb"].shape[2] == 3
    wide = (fields[name].shape[-2:] for name in ("ndf", "sigma", "vndf", "rgb"))
    if not fit or min(min(shape) for shape in wide) < 2:
        raise BadFileError(path, "has fields that do not fit each other", _REMEDY)


def _check_azimuths(phi: NDArray[np.float64], path: Path) -> None:
    first, last = float(phi[0]), float(phi[-1])
    # less than a radian would be a fifth of a turn or less, which no mirrors stand for
    if len(phi) > 2 and not (last - first > 1.0 and round(TWO_PI / (last - first)) in (1, 2, 4)):
        raise BadFileError(path, "phi_i is over no whole, half or quarter turn", _REMEDY)


def _angles(direction: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return theta, and phi from -pi to pi."""
    theta, _ = to_spherical(direction)
    return np.minimum(theta, _QUARTER), np.arctan2(direction[:, 1], direction[:, 0])


def _bilinear(values: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    height, width = values.shape
    spots = clamped(place[:, 1] * (height - 1), height), clamped(place[:, 0] * (width - 1), width)
    return multilinear(values[..., None], spots)[:, 0]


FORMAT = Format(
    name="rgl",
    suffix=".bsdf",
    title="RGL's adaptive tensor, as Mitsuba 3's measured plugin and the RGL loader read it",
    keeps="anisotropy, narrow highlights, theta to 89 deg, linear RGB, importance sampling",
    loses="spectra (RGB is written), sigma; Mitsuba takes the two ways of light for one another",
    write=write,
    read=read,
    claims=lambda head, size: head.startswith(MAGIC),
)
