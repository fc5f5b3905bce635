"""Decides which faults strike, in the order in which things come by, and counts them."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from sim.faults.kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gonio.clock import Clock
    from sim.faults.document import Fault
    from sim.faults.kinds import Place


class Injector:
    """Draws faults; the same seed and the same run give the same ones.

    Parameters
    ----------
    faults
        What may strike.
    clock
        For faults at given times.
    seed
        Of what is left to chance.

    Attributes
    ----------
    random
        For whatever else a fault leaves to chance.
    struck
        How often each kind has struck.
    """

    def __init__(self, faults: Iterable[Fault], clock: Clock, seed: int) -> None:
        self.random = np.random.default_rng([seed, 0xFA017])
        self.struck: Counter[str] = Counter()
        self._clock = clock
        self._faults = tuple(faults)
        self._seen: Counter[int] = Counter()
        # what was due before this run began has struck in the one before
        self._due_s = [sorted(t for t in fault.at_s if t >= clock.now()) for fault in self._faults]

    def strike(self, place: Place, per: str, axis: str | None = None) -> Fault | None:
        """Return the fault that strikes something that comes by now, or None; the first wins.

        Parameters
        ----------
        place, per
            What comes by, as kinds name it.
        axis
            Of which axis, where it is one's.
        """
        hit = None
        for number, fault in enumerate(self._faults):
            kind = KINDS[fault.kind]
            if (kind.place, kind.per) != (place, per) or fault.axis not in (None, axis):
                continue
            if self._is_due(number, fault) and hit is None:
                hit = fault
        if hit is not None:
            self.struck[hit.kind] += 1
        return hit

    def lamp(self, fault: Fault, lit: Iterable[int]) -> int | None:
        """Return which lamp a fault strikes, of those that are lit; None where none is."""
        lamps = [n for n in lit if fault.lamp in (None, n)]
        return int(self.random.choice(lamps)) if lamps else None

    def _is_due(self, number: int, fault: Fault) -> bool:
        index = self._seen[number]
        self._seen[number] += 1
        times = self._due_s[number]
        if times and times[0] <= self._clock.now():
            times.pop(0)
            return True
        return index in fault.at or bool(fault.rate and self.random.random() < fault.rate)
