"""Views drawn for a direction of light, and their density."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import TWO_PI, from_spherical, half_vector, to_spherical
from nnbrdf.sampling.cells import AREA, EDGES, RINGS, SECTORS, Cells, half_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.protocols import Material

    Array = NDArray[np.float64]

COSINE_SHARE = 0.05
"""Of the samples that are drawn by the cosine alone: it bounds the weights where the table errs."""

_ELEVATIONS, _AZIMUTHS = 24, 16
_STEEPEST = np.radians(89.5)
_PROBES, _SAME = 256, 1e-3


@dataclass(frozen=True)
class Sampler:
    """Draws views about in proportion to BRDF times cosine; exact in what it says of its density.

    For each of a net of light directions, BRDF x cos(theta_v) is tabulated over the half vector,
    where highlights stay in place when the light moves. Between the net's directions the
    densities of the nearest ones are mixed, and a share of `COSINE_SHARE` is drawn by the cosine.

    Attributes
    ----------
    cells
        One density for each light direction of the net, azimuths of one elevation together.
    azimuths
        How many each elevation has; 1 for a material that looks the same from all round.
    """

    cells: Cells
    azimuths: int

    @classmethod
    def of(cls, material: Material) -> Sampler:
        """Tabulate a material: some hundred thousand evaluations, or millions where it has a grain.

        A pair at which the material is not finite, or below zero, counts as black.
        """
        azimuths = 1 if _is_isotropic(material) else _AZIMUTHS
        phi = TWO_PI * np.arange(azimuths) / azimuths
        theta = np.linspace(0.0, _STEEPEST, _ELEVATIONS)
        lights = from_spherical(theta[:, None], phi).reshape(-1, 3)
        return cls(Cells(np.stack([_mass(material, light) for light in lights])), azimuths)

    def sample(self, light: Array, u: Array) -> tuple[Array, Array]:
        """Draw one view for each direction of light.

        Parameters
        ----------
        light
            Unit vectors away from the sample, shape (..., 3).
        u
            Uniform numbers in [0, 1), shape (..., 2), broadcast against the lights.

        Returns
        -------
        view, pdf
            Unit vectors, shape (..., 3), and their density in 1/sr, shape (...). A view below the
            horizon has density 0: light that the draw lost, to be counted as black.
        """
        shape = np.broadcast_shapes(np.shape(light)[:-1], np.shape(u)[:-1])
        light = np.broadcast_to(light, (*shape, 3)).reshape(-1, 3)
        u = np.broadcast_to(u, (*shape, 2)).reshape(-1, 2)
        by_cosine = u[:, 0] < COSINE_SHARE
        first = np.where(
            by_cosine, u[:, 0] / COSINE_SHARE, (u[:, 0] - COSINE_SHARE) / (1 - COSINE_SHARE)
        )
        rest = np.stack([first, u[:, 1]], axis=-1)
        view = np.where(by_cosine[:, None], _by_cosine(rest), self._by_table(light, rest))
        return view.reshape(*shape, 3), self.pdf(light, view).reshape(shape)

    def pdf(self, light: Array, view: Array) -> Array:
        """Return the density with which `sample` draws views, in 1/sr, shape (...).

        Light and view are unit vectors, shapes (..., 3), broadcast against each other. It is 0
        for directions below the horizon; over the hemisphere it adds up to what is not lost.
        """
        light, view = np.broadcast_arrays(np.asarray(light, float), np.asarray(view, float))
        flat_light, flat_view = light.reshape(-1, 3), view.reshape(-1, 3)
        half = half_vector(flat_light, flat_view)
        cosine = np.einsum("ni,ni->n", flat_light, half)
        turned = self._turned(half, flat_light, -1.0)
        table = sum(
            share * self.cells.density(which, turned) for which, share in self._nearest(flat_light)
        )
        density = (1 - COSINE_SHARE) * table / (4.0 * np.maximum(cosine, 1e-12))
        density = density + COSINE_SHARE * flat_view[:, 2] / np.pi
        above = (flat_light[:, 2] > 0) & (flat_view[:, 2] > 0)
        return np.where(above, density, 0.0).reshape(light.shape[:-1])

    def _by_table(self, light: Array, u: Array) -> Array:
        chosen, first = _choose(self._nearest(light), u[:, 0])
        half = self.cells.draw(chosen, np.stack([first, u[:, 1]], axis=-1))
        return mirrored(light, self._turned(half, light, 1.0))

    def _turned(self, half: Array, light: Array, sign: float) -> Array:
        """Return half vectors in the table's frame (sign -1), or back (sign 1).

        The table of a material without a grain has its light at azimuth 0.
        """
        if self.azimuths > 1:
            return half
        _, phi = to_spherical(light)
        cos, sin = np.cos(phi), sign * np.sin(phi)
        x, y = half[:, 0], half[:, 1]
        return np.stack([cos * x - sin * y, sin * x + cos * y, half[:, 2]], axis=-1)

    def _nearest(self, light: Array) -> list[tuple[NDArray[np.int64], Array]]:
        """Return which densities to mix, and the share of each, shapes (n,)."""
        theta, phi = to_spherical(light)
        along = (theta / _STEEPEST).clip(0.0, 1.0) * (_ELEVATIONS - 1)
        row = along.astype(int).clip(0, _ELEVATIONS - 2)
        up = along - row
        around = phi / TWO_PI * self.azimuths
        column = around.astype(int) % self.azimuths
        on = around - around.astype(int)
        corners = []
        for step, share in ((0, 1 - up), (1, up)):
            start = (row + step) * self.azimuths
            if self.azimuths == 1:
                corners.append((start, share))
                continue
            corners.append((start + column, share * (1 - on)))
            corners.append((start + (column + 1) % self.azimuths, share * on))
        return corners


def mirrored(light: Array, half: Array) -> Array:
    """Return the light's directions mirrored at half vectors, shape (n, 3)."""
    return np.asarray(2.0 * np.einsum("ni,ni->n", light, half)[:, None] * half - light)


def _choose(
    corners: list[tuple[NDArray[np.int64], Array]], u: Array
) -> tuple[NDArray[np.int64], Array]:
    """Return one of the densities for each number by their shares, and a fresh number from it."""
    chosen, rest = corners[-1][0], u
    start = np.zeros_like(u)
    for which, share in corners:
        inside = (u >= start) & (u < start + share)
        chosen = np.where(inside, which, chosen)
        rest = np.where(inside, (u - start) / np.maximum(share, 1e-300), rest)
        start = start + share
    return chosen, rest.clip(0.0, np.nextafter(1.0, 0.0))


def _by_cosine(u: Array) -> Array:
    """Return directions of density cos(theta) / pi (Malley's method), shape (n, 3)."""
    radius, phi = np.sqrt(u[:, 0]), TWO_PI * u[:, 1]
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1)


def _mass(material: Material, light: Array) -> Array:
    """Return the share of each cell of the BRDF times cosine under a light, (RINGS, SECTORS)."""
    corners = _corners()
    # solid angle of views is 4 l.h times that of half vectors
    spread = 4.0 * (corners @ light)
    view = mirrored(np.broadcast_to(light, corners.shape), corners)
    lit = (view[:, 2] > 0) & (spread > 0)
    values = np.zeros(len(corners))
    values[lit] = material.evaluate(light, view[lit]).mean(axis=-1) * view[lit, 2] * spread[lit]
    values = np.where(np.isfinite(values), values.clip(0.0), 0.0)
    # a mean of corners, not a centre: a cell that reaches above the horizon is never empty
    net = values.reshape(RINGS + 1, SECTORS)
    across = net + np.roll(net, -1, axis=1)
    mass = (across[1:] + across[:-1]) * AREA[:, None]
    total = mass.sum()
    return np.asarray(mass / total if total > 0 else np.broadcast_to(AREA[:, None], mass.shape))


def _corners() -> Array:
    """Return the corners of all cells as half vectors, ring by ring, those of the normal alike."""
    phi = TWO_PI * np.arange(SECTORS) / SECTORS
    return half_at(np.repeat(EDGES, SECTORS), np.tile(phi, RINGS + 1))


def _is_isotropic(material: Material) -> bool:
    """Tell whether turning the sample under a fixed light and view changes next to nothing."""
    rng = np.random.default_rng(0)
    theta = np.arccos(rng.uniform(0.05, 1.0, (2, _PROBES)))
    phi, turn = rng.uniform(0.0, TWO_PI, (2, _PROBES)), rng.uniform(0.0, TWO_PI, _PROBES)
    still = material.evaluate(*from_spherical(theta, phi))
    turned = material.evaluate(*from_spherical(theta, phi + turn))
    return bool(np.abs(still - turned).mean() <= _SAME * np.abs(still).mean())
