"""Materials drawn from a seed: what a BRDF may look like before anything is measured."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.prior.geometry import Pairs

    Array = NDArray[np.float64]

LOBES = 3
_CHUNK = 1 << 19


@dataclass(frozen=True)
class GeneratedMaterials:
    """Parameters of n reciprocal one-channel materials; their scale does not matter.

    A diffuse body (Oren and Nayar 1994, qualitative model, times a power of the cosines for bodies
    that darken or brighten to the horizon), under a clear coat or none (Schlick 1994, twice);
    up to three microfacet lobes (Walter et al. 2007 with height-correlated masking, Beckmann, or
    Burley's generalised Trowbridge-Reitz); sheen at the rim (Charlie-like, a power of the half
    vector's sine); retro-reflection (a power of the cosine between light and view); and
    cloth-like fibres (a Gaussian about the plane normal to the thread).

    Attributes
    ----------
    body, roughness, limb
        Diffuse albedo, Oren and Nayar's sigma in radians, the cosines' power; shape (n,).
    coat
        Whether there is a clear coat, as 0 or 1, shape (n,).
    lobe
        Weight of each lobe, 0 where there is none, shape (n, 3); likewise
    alpha_x, alpha_y, rotation, f0
        roughness along and across, azimuth of the grain in radians, reflectance at normal incidence
    tail
        Power of the Trowbridge-Reitz denominator, 2 for GGX; 0 for Beckmann.
    sheen, sheen_power, retro, retro_power
        Weights, 0 where absent, and powers; shape (n,).
    fiber, fiber_width, fiber_rotation
        Weight, width as a cosine, azimuth of the thread in radians; shape (n,).
    """

    body: Array
    roughness: Array
    limb: Array
    coat: Array
    lobe: Array
    alpha_x: Array
    alpha_y: Array
    rotation: Array
    f0: Array
    tail: Array
    sheen: Array
    sheen_power: Array
    retro: Array
    retro_power: Array
    fiber: Array
    fiber_width: Array
    fiber_rotation: Array

    @classmethod
    def draw(cls, count: int, seed: int, *, isotropic: bool) -> GeneratedMaterials:
        """Draw `count` materials; anisotropic ones are isotropic in part, as materials are."""
        rng = np.random.default_rng(seed)
        one, lobes = (count,), (count, LOBES)
        body = _log_uniform(rng, 1e-3, 0.9, one)
        least = np.where(body > 0.05, 0, 1)
        number = (least + rng.random(one) * (LOBES + 1 - least)).astype(int)
        alpha = _log_uniform(rng, 0.04, 0.9, lobes)
        grained = (rng.random(one) < 0.45) & (not isotropic)
        ratio = np.where(grained[:, None], _log_uniform(rng, 1.0, 6.0, lobes), 1.0)
        kind = rng.random(lobes) * 3
        tail = np.select([kind < 1, kind < 2], [2.0, 0.0], rng.uniform(1.2, 3.0, lobes))
        weight = _log_uniform(rng, 0.05, 1.0, lobes)
        fiber = _some(rng, 0.25, _log_uniform(rng, 0.01, 1.0, one))
        return cls(
            body=body,
            roughness=_some(rng, 0.6, rng.random(one)),
            limb=rng.uniform(-0.3, 0.3, one),
            coat=(rng.random(one) < 0.5).astype(float),
            lobe=np.where(np.arange(LOBES) < number[:, None], weight, 0.0),
            alpha_x=(alpha * np.sqrt(ratio)).clip(max=1.2),
            alpha_y=(alpha / np.sqrt(ratio)).clip(min=0.02),
            rotation=rng.uniform(0, np.pi, lobes),
            f0=_log_uniform(rng, 0.01, 1.0, lobes),
            tail=tail,
            sheen=_some(rng, 0.35, _log_uniform(rng, 0.005, 0.5, one)),
            sheen_power=_log_uniform(rng, 1.0, 8.0, one),
            retro=_some(rng, 0.25, _log_uniform(rng, 0.003, 0.5, one)),
            retro_power=_log_uniform(rng, 1.0, 40.0, one),
            fiber=fiber * (not isotropic),
            fiber_width=rng.uniform(0.05, 0.6, one),
            fiber_rotation=rng.uniform(0, np.pi, one),
        )

    def __len__(self) -> int:
        return len(self.body)

    def select(self, rows: slice | NDArray[np.int64]) -> GeneratedMaterials:
        """Return some of the materials."""
        return GeneratedMaterials(*(getattr(self, field.name)[rows] for field in fields(self)))

    def evaluate(self, pairs: Pairs) -> Array:
        """Return their BRDF, positive, up to each one's scale, shape (pairs, n)."""
        result = np.empty((len(pairs), len(self)))
        step = max(1, _CHUNK // max(len(self), 1) // 8)
        for start in range(0, len(pairs), step):
            rows = slice(start, start + step)
            result[rows] = self._evaluate(pairs.part(rows))
        return result

    def _evaluate(self, pairs: Pairs) -> Array:
        total = self._body(pairs)
        for index in range(LOBES):
            here = np.flatnonzero(self.lobe[:, index])
            total[:, here] += self._lobe(pairs, here, index)
        for weight, term in (
            (self.sheen, self._sheen), (self.retro, self._retro), (self.fiber, self._fiber),
        ):  # fmt: skip
            here = np.flatnonzero(weight)
            total[:, here] += weight[here] * term(pairs, here)
        return total

    def _body(self, pairs: Pairs) -> Array:
        cos_l, cos_v = pairs.cos_light[:, None], pairs.cos_view[:, None]
        variance = self.roughness**2
        a = 1 - 0.5 * variance / (variance + 0.33)
        b = 0.45 * variance / (variance + 0.09)
        lit = a + b * _oren_nayar(pairs)[:, None]
        lit *= (cos_l * cos_v) ** self.limb * (self.body / np.pi)
        through = (1 - _schlick(cos_l, 0.04)) * (1 - _schlick(cos_v, 0.04))
        return np.asarray(lit * np.where(self.coat > 0, through, 1.0))

    def _lobe(self, pairs: Pairs, here: NDArray[np.int64], index: int) -> Array:
        cos, sin = np.cos(self.rotation[here, index]), np.sin(self.rotation[here, index])
        ax, ay = self.alpha_x[here, index], self.alpha_y[here, index]

        def along_across(w: Array) -> tuple[Array, Array]:
            x, y = w[:, :1], w[:, 1:2]
            return x * cos + y * sin, y * cos - x * sin

        def masking(w: Array, cos_w: Array) -> Array:
            x, y = along_across(w)
            return np.asarray(np.sqrt(1 + ((x * ax) ** 2 + (y * ay) ** 2) / cos_w[:, None] ** 2))

        x, y = along_across(pairs.half)
        cos_h = pairs.half[:, 2:].clip(1e-3)
        density = _density((x / ax) ** 2 + (y / ay) ** 2, cos_h, self.tail[here, index])
        seen = 0.5 * (masking(pairs.light, pairs.cos_light) + masking(pairs.view, pairs.cos_view))
        cosines = 4 * np.pi * (pairs.cos_light * pairs.cos_view)[:, None]
        fresnel = _schlick(pairs.cos_difference[:, None], self.f0[here, index])
        return np.asarray(density * fresnel * self.lobe[here, index] / (seen * cosines * ax * ay))

    def _sheen(self, pairs: Pairs, here: NDArray[np.int64]) -> Array:
        sine = np.sqrt(1 - pairs.half[:, 2:].clip(0.0, 1.0) ** 2)
        light, view = pairs.cos_light, pairs.cos_view
        spread = 2 * (light + view - light * view)
        return np.asarray(sine ** self.sheen_power[here] / spread[:, None])

    def _retro(self, pairs: Pairs, here: NDArray[np.int64]) -> Array:
        return np.asarray(pairs.cos_between[:, None].clip(0.0, 1.0) ** self.retro_power[here])

    def _fiber(self, pairs: Pairs, here: NDArray[np.int64]) -> Array:
        azimuth = self.fiber_rotation[here]
        thread = np.stack([np.cos(azimuth), np.sin(azimuth)])
        along = (pairs.light + pairs.view)[:, :2] @ thread / self.fiber_width[here]
        return np.asarray(np.exp(-(along**2)) / (pairs.cos_light + pairs.cos_view)[:, None])


def _density(slope: Array, cos_h: Array, tail: Array) -> Array:
    """Return the microfacet density times pi, alpha_x and alpha_y; `slope` is (h_xy / alpha)^2."""
    result = np.empty_like(slope)
    beckmann = tail == 0
    squared = cos_h**2
    result[:, beckmann] = np.exp(-slope[:, beckmann] / squared) / squared**2
    power = tail[~beckmann]
    result[:, ~beckmann] = (power - 1) * (slope[:, ~beckmann] + squared) ** -power
    return result


def _oren_nayar(pairs: Pairs) -> Array:
    sin_l, sin_v = np.sqrt(1 - pairs.cos_light**2), np.sqrt(1 - pairs.cos_view**2)
    across = sin_l * sin_v
    cos_phi = (pairs.cos_between - pairs.cos_light * pairs.cos_view) / np.maximum(across, 1e-6)
    # sin(larger angle) tan(smaller angle) is the product of the sines over the larger cosine
    larger = np.maximum(pairs.cos_light, pairs.cos_view)
    return np.asarray(np.where(across > 1e-6, cos_phi.clip(0.0, 1.0), 0.0) * across / larger)


def _schlick(cosine: Array, f0: Array | float) -> Array:
    return np.asarray(f0 + (1 - f0) * (1 - cosine) ** 5)


def _log_uniform(
    rng: np.random.Generator, low: float, high: float, shape: tuple[int, ...]
) -> Array:
    return np.exp(rng.uniform(np.log(low), np.log(high), shape))


def _some(rng: np.random.Generator, chance: float, value: Array) -> Array:
    return np.where(rng.random(value.shape) < chance, value, 0.0)
