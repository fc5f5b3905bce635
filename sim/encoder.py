"""An encoder on the arm: steps, and noise that hangs on nothing but the time of a reading."""

from __future__ import annotations

import struct

import numpy as np


class Encoder:
    """Turns positions in counts into what a drive reads.

    Parameters
    ----------
    step_counts
        What it can tell apart; 0: a count.
    noise_counts
        Standard deviation of a reading.
    seed
        Of the noise; two readings at one time are one.
    """

    def __init__(
        self, step_counts: float = 0.0, noise_counts: float = 0.0, seed: tuple[int, ...] = (0,)
    ) -> None:
        self._step = step_counts
        self._noise = noise_counts
        self._seed = seed

    def count(self, position: float, now: float) -> int:
        """Return what it says of a position at a time."""
        if self._noise:
            # all digits of the time: readings a microsecond apart have nothing in common
            moment = int.from_bytes(struct.pack("d", now), "little")
            random = np.random.default_rng([*self._seed, moment])
            position += self._noise * random.standard_normal()
        if self._step:
            position = self._step * round(position / self._step)
        return round(position)
