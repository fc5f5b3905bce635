"""A material as an RGL tensor: half vectors where their density is, values at their nodes.

Any positive density makes a tensor that gives back the same values at its nodes. This one follows
what the material sends back to where it came from, as Dupuy and Jakob (2018) do, without their
iteration for shadowing: it places nodes and importance samples, and nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.color import XYZ_FROM_SRGB
from gonio.directions import TWO_PI, from_spherical
from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.horizon import above_horizon
from gonio.exchange.isotropy import ISOTROPIC_BELOW
from gonio.exchange.rgl import RglTensor
from gonio.exchange.tensor_file import pack
from gonio.exchange.warp import Warp, alone
from gonio.files import write_bytes
from gonio.words import utf8

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.exchange.format import Source
    from gonio.protocols import Material, Progress

_THETA_DEG: Final = (0, 7.5, 15, 22.5, 30, 37.5, 45, 52.5, 60, 67.5, 75, 82, 89)
_FINE_THETA_DEG: Final = (*range(0, 90, 5), 89)
_PHI_STEP_DEG: Final = 10.0
_DENSITY_SIZE: Final = 64
_NODES: Final = 48
_FINE_NODES: Final = 64
# of the mean: so much density everywhere, or what is not bright is left with too few nodes
_FLOOR: Final = 0.5


def write_tensor(source: Source, path: Path, progress: Progress | None) -> None:
    """Write a tensor of RGB values, isotropic where the material is."""
    empty = _densities(source.material, isotropic=source.anisotropy <= ISOTROPIC_BELOW)
    rgb, luminance = _values(source.material, empty, progress)
    fields: dict[str, NDArray[Any]] = {
        "version": np.array([1, 0], np.uint8),
        "description": np.frombuffer(utf8(f"{source.name} (gonio)"), np.uint8),
        "phi_i": empty.phi,
        "theta_i": empty.theta,
        "sigma": empty.sigma,
        "ndf": empty.ndf,
        "vndf": empty.vndf,
        "luminance": luminance,
        "rgb": rgb,
    }
    singles = {
        name: array if array.dtype == np.uint8 else array.astype("<f4")
        for name, array in fields.items()
    }
    write_bytes(path, pack(singles | {"jacobian": np.array([1], np.uint8)}))


def _densities(material: Material, *, isotropic: bool) -> RglTensor:
    """Return a tensor without values: directions of the light, ndf, sigma and vndf."""
    theta = np.radians(_FINE_THETA_DEG if isotropic else _THETA_DEG)
    steps = round(360.0 / _PHI_STEP_DEG)
    phi = np.zeros(1) if isotropic else np.linspace(-np.pi, np.pi, steps + 1)
    half, area = _half_vectors()
    ndf = _sent_back(material, half)
    if isotropic:
        ndf = np.broadcast_to(ndf.mean(axis=0), ndf.shape)
    ndf = ndf / (ndf * half[..., 2] * area).sum()
    flux = ndf * area
    sigma = np.maximum(_facing(half, half.reshape(-1, 3), flux), 1e-3).reshape(ndf.shape)
    light = from_spherical(theta, phi[:, None])
    seen = np.maximum(np.einsum("ptc,hwc->pthw", light, half), 0.0)
    vndf = ndf * seen * area
    vndf += _FLOOR * vndf.mean(axis=(2, 3), keepdims=True)
    none = np.zeros((len(phi), len(theta), 3, 2, 2))
    return RglTensor(phi, theta, _single(ndf), _single(sigma), _single(vndf), none)


def _half_vectors() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the half vectors of the square's nodes, shape (h, w, 3), and their solid angles."""
    edge = np.linspace(0.0, 1.0, _DENSITY_SIZE)
    theta, phi = edge**2 * np.pi / 2, (2 * edge - 1) * np.pi
    # trapezoids: half a step at the ends
    step = np.full(_DENSITY_SIZE, edge[1])
    step[[0, -1]] /= 2
    area = (np.sin(theta) * np.pi * edge * step) * (TWO_PI * step)[:, None]
    return from_spherical(theta, phi[:, None]), area


def _sent_back(material: Material, half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the luminance that comes back along each half vector, with a floor, shape (h, w)."""
    flat = above_horizon(half.reshape(-1, 3))
    back = (evaluate_in_blocks(material, flat, flat) @ XYZ_FROM_SRGB[1]).reshape(half.shape[:2])
    told: NDArray[np.float64] = back.clip(0.0) * half[..., 2]
    # black has no density of its own
    return told + (_FLOOR * float(told.mean()) + 1e-12)


def _facing(
    half: NDArray[np.float64], direction: NDArray[np.float64], flux: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the area that normals show to each direction, shape (n,)."""
    normals, amount = half.reshape(-1, 3), flux.ravel()
    return np.concatenate(
        [np.maximum(part @ normals.T, 0.0) @ amount for part in np.array_split(direction, 16)]
    )


def _values(
    material: Material, empty: RglTensor, progress: Progress | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return values and luminance at the nodes, shapes (p, t, 3, n, n) and (p, t, n, n)."""
    size = _FINE_NODES if empty.is_isotropic else _NODES
    views = len(empty.phi) * len(empty.theta)
    warp = Warp(empty.vndf.reshape(views, _DENSITY_SIZE, _DENSITY_SIZE))
    square = np.stack([warp.nodes(index, size) for index in range(views)]).reshape(-1, 2)
    phi_i = np.repeat(empty.phi, len(empty.theta) * size**2)
    theta_i = np.tile(np.repeat(empty.theta, size**2), len(empty.phi))
    light = from_spherical(theta_i, phi_i)
    theta, phi = square[:, 0] ** 2 * np.pi / 2, (2 * square[:, 1] - 1) * np.pi
    half = from_spherical(theta, phi + phi_i if empty.is_isotropic else phi)
    facing = (light * half).sum(axis=1)
    view = 2 * facing[:, None] * half - light
    seen = evaluate_in_blocks(material, light, above_horizon(view), progress)
    # zero beyond the horizon: what is negative there is so above it, too, between the nodes
    seen *= view[:, 2:].clip(0.0)
    value = seen / empty.density(square, theta_i, phi_i)[:, None]
    stretch = np.maximum(2 * np.pi**2 * square[:, 0] * np.sin(theta), 1e-6) * 4 * facing.clip(0.0)
    _, density = warp.invert(square, alone(np.repeat(np.arange(views), size**2)))
    bright = (seen @ XYZ_FROM_SRGB[1]).clip(0.0) * stretch / density
    shape = (len(empty.phi), len(empty.theta), size, size)
    luminance = bright.reshape(shape)
    luminance = luminance + 1e-2 * luminance.mean(axis=(2, 3), keepdims=True) + 1e-12
    return np.moveaxis(value.reshape(*shape, 3), -1, 2), luminance


def _single(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to single precision, in which the file keeps it: nodes are to lie where it says."""
    return values.astype(np.float32).astype(np.float64)
