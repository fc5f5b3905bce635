"""The angles that a pair of directions makes, as the generated materials and kernels use them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_HORIZON = 1e-3


@dataclass(frozen=True)
class Pairs:
    """Pairs of directions, light and view interchangeable in all but the names.

    Attributes
    ----------
    light, view
        Unit vectors, shape (n, 3).
    half
        Unit half vectors, shape (n, 3); of opposite directions at the horizon, the normal.
    """

    light: NDArray[np.float64]
    view: NDArray[np.float64]
    half: NDArray[np.float64]

    @classmethod
    def of(cls, light: NDArray[np.float64], view: NDArray[np.float64]) -> Pairs:
        """Make the pairs of unit vectors of shape (n, 3)."""
        light, view = np.asarray(light, np.float64), np.asarray(view, np.float64)
        half = light + view
        length = np.linalg.norm(half, axis=1, keepdims=True)
        half = np.where(length > _HORIZON, half / np.maximum(length, _HORIZON), (0.0, 0.0, 1.0))
        return cls(light, view, half)

    def __len__(self) -> int:
        return len(self.light)

    def part(self, rows: slice | NDArray[np.int64]) -> Pairs:
        """Return some of the pairs."""
        return Pairs(self.light[rows], self.view[rows], self.half[rows])

    @property
    def cos_light(self) -> NDArray[np.float64]:
        """Cosine of incidence, kept a thousandth above the horizon, shape (n,)."""
        return self.light[:, 2].clip(_HORIZON, 1.0)

    @property
    def cos_view(self) -> NDArray[np.float64]:
        """Cosine of the view's polar angle, kept as `cos_light`."""
        return self.view[:, 2].clip(_HORIZON, 1.0)

    @property
    def cos_difference(self) -> NDArray[np.float64]:
        """Cosine between either direction and the half vector, shape (n,)."""
        return np.asarray(np.einsum("ij,ij->i", self.light, self.half).clip(0.0, 1.0))

    @property
    def cos_between(self) -> NDArray[np.float64]:
        """Cosine between light and view, shape (n,)."""
        return np.asarray(np.einsum("ij,ij->i", self.light, self.view))

    def reciprocal(self) -> tuple[Pairs, NDArray[np.int64]]:
        """Return the pairs that differ under exchange of light and view, and which each one is."""
        swap = _comes_later(self.light, self.view)[:, None]
        return self._distinct(
            np.where(swap, self.view, self.light), np.where(swap, self.light, self.view)
        )

    def rotated(self) -> tuple[Pairs, NDArray[np.int64]]:
        """Return the pairs that differ under exchange, rotation and mirroring too, and which."""
        low, high = np.sort(np.stack([self.light[:, 2], self.view[:, 2]]), axis=0)
        sin_low, sin_high = np.sqrt(1 - low.clip(-1, 1) ** 2), np.sqrt(1 - high.clip(-1, 1) ** 2)
        across = np.maximum(sin_low * sin_high, 1e-12)
        cos_phi = ((self.cos_between - low * high) / across).clip(-1.0, 1.0)
        cos_phi = np.where(sin_low * sin_high < 1e-9, 1.0, cos_phi)
        light = np.stack([sin_low, np.zeros_like(low), low], axis=1)
        sin_phi = np.sqrt(1 - cos_phi**2)
        view = np.stack([sin_high * cos_phi, sin_high * sin_phi, high], axis=1)
        return self._distinct(light, view)

    @staticmethod
    def _distinct(
        light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> tuple[Pairs, NDArray[np.int64]]:
        key = np.concatenate([light, view], axis=1).round(7) + 0.0
        _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
        return Pairs.of(light[first], view[first]), inverse.reshape(-1)


def _comes_later(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether direction `a` comes after `b` in the order of z, then y, then x."""
    difference = (a - b)[:, ::-1].round(7)
    first = np.argmax(difference != 0, axis=1)
    return np.asarray(difference[np.arange(len(a)), first] > 0)
