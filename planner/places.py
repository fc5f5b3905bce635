"""Where an arm can stand to take its directions: full turns apart, and at the pole anyhow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.rig import Axis

_AZIMUTHS = 72
"""How many azimuths the pole is tried at: more would save little and take long."""


@dataclass(frozen=True)
class Places:
    """The places of one arm, those of a direction one after the other, the plain one first.

    Attributes
    ----------
    theta_deg, phi_deg, turn
        Angles, phi in [0, 360), and the full turns beyond it; shape (p,) each.
    first
        The first place of each direction, shape (d,).
    direction
        Which direction each shot has, shape (n,).
    """

    theta_deg: NDArray[np.float64]
    phi_deg: NDArray[np.float64]
    turn: NDArray[np.int64]
    first: NDArray[np.int64]
    direction: NDArray[np.int64]

    @classmethod
    def of(cls, angles_deg: NDArray[np.float64], phi_axis: Axis) -> Places:
        """Find the places of shots whose theta and phi are `angles_deg`, shape (n, 2).

        A direction that is out of the axis' travel has its plain place alone.
        """
        directions, direction = np.unique(angles_deg, axis=0, return_inverse=True)
        azimuths = _thinned(np.unique(directions[:, 1]))
        rows: list[tuple[float, float, int]] = []
        first = []
        for theta, phi in directions.tolist():
            first.append(len(rows))
            others = azimuths if theta == 0.0 else ()
            rows += [(theta, each, turn) for each, turn in _stands(phi, others, phi_axis)]
        theta_deg, phi_deg, turns = zip(*rows, strict=True)
        return cls(
            np.array(theta_deg),
            np.array(phi_deg),
            np.array(turns),
            np.array(first),
            direction.reshape(-1),
        )

    def __len__(self) -> int:
        return len(self.turn)

    @property
    def angles_deg(self) -> NDArray[np.float64]:
        """The angles of both axes at each place, shape (p, 2)."""
        return np.stack([self.theta_deg, self.phi_deg + 360.0 * self.turn], axis=1)

    @property
    def plain(self) -> NDArray[np.int64]:
        """The plain place of each shot, shape (n,)."""
        return self.first[self.direction]

    @property
    def choices(self) -> list[NDArray[np.int64]]:
        """All places of each direction."""
        return np.split(np.arange(len(self)), self.first[1:])


def turns_within(phi_deg: float, phi_axis: Axis) -> list[int]:
    """Return the full turns that may be added to phi within an axis' travel, the smallest first."""
    lowest = math.floor((phi_axis.min_deg - phi_deg) / 360.0)
    highest = math.ceil((phi_axis.max_deg - phi_deg) / 360.0)
    turns = [
        turn
        for turn in range(lowest, highest + 1)
        if phi_axis.min_deg <= phi_deg + 360.0 * turn <= phi_axis.max_deg
    ]
    return sorted(turns, key=abs)


def _stands(phi_deg: float, others: tuple[float, ...], axis: Axis) -> list[tuple[float, int]]:
    own = [(phi_deg, turn) for turn in turns_within(phi_deg, axis)] or [(phi_deg, 0)]
    return own + [
        (other, turn) for other in others if other != phi_deg for turn in turns_within(other, axis)
    ]


def _thinned(azimuths: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(azimuths[:: math.ceil(len(azimuths) / _AZIMUTHS)].tolist())
