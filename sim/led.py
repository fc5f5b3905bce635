"""One lamp: its junction warms up in closed form, and its light droops with that.

The light follows a new setting within microseconds, where the electronics are not ideal, and the
junction within seconds; products of both are exponentials again, so that no step is ever taken.
"""

from __future__ import annotations

import math

FULL_CURRENT_MA = 700.0
TOO_HOT_C = 85.0
COOL_AGAIN_C = 70.0

_AMBIENT_C = 23.0
_RISE_C = 42.0
_REFERENCE_C = 25.0
_WARM_UP_S = 20.0
_DROOP_PER_C = 0.0025
# efficacy falls with current: half the current gives a little more than half the light
_CURRENT_DROOP = 0.12


class Led:
    """A lamp under constant current, whose state is a function of time.

    Attributes
    ----------
    current_mA, on
        As set; change them with `set`.
    overheats_at_s
        When the junction will pass 85 deg C; infinite if it will not.
    tripped
        Whether it switched itself off and has not cooled down and been switched on since.
    is_open
        Whether its circuit is open; change it with `break_circuit`.
    electronics_s
        Time constant of its current after a change; 0: it changes at once.
    """

    def __init__(self, now: float) -> None:
        self.current_mA = 0.0
        self.on = False
        self.tripped = False
        self.is_open = False
        self.overheats_at_s = math.inf
        self.electronics_s = 0.0
        self._rise_c = _RISE_C
        self._since_s = now
        self._start_c = _AMBIENT_C
        self._dose_s = 0.0
        self._efficacy = 1.0
        # by how much the light is still above the strength that was set, at the piece's start
        self._excess = 0.0

    def set(self, now: float, *, current_mA: float | None = None, on: bool | None = None) -> None:
        """Change current or state at once."""
        before = self._strength
        self._keep(now)
        self.current_mA = self.current_mA if current_mA is None else current_mA
        self.on = self.on if on is None else on
        if self.electronics_s:
            self._excess += before - self._strength
        self.overheats_at_s = self._when_too_hot()

    def trip(self, now: float) -> None:
        """Switch off for heat."""
        self.set(now, on=False)
        self.tripped = True

    def break_circuit(self, now: float) -> None:
        """Open the circuit."""
        self.set(now, on=False)
        self.is_open = True

    def lose_cooling(self, now: float) -> None:
        """Let the heat sink fall off: at full current the junction gets too hot."""
        self._keep(now)
        self._rise_c = 2.0 * _RISE_C
        self.overheats_at_s = self._when_too_hot()

    def heat_up(self, now: float) -> None:
        """Be too hot at once, as in a draft of hot air, and switch off for it."""
        self.trip(now)
        self._start_c = TOO_HOT_C + 1.0

    def fade(self, now: float, share: float) -> None:
        """Give only that share of the light from now on."""
        self._keep(now)
        self._efficacy *= share

    def temperature_c(self, now: float) -> float:
        """Return the junction's temperature in deg C."""
        final = self._final_c
        return final + (self._start_c - final) * math.exp((self._since_s - now) / _WARM_UP_S)

    def flux(self, now: float) -> float:
        """Return the light, 1 at 700 mA and 25 deg C."""
        droop = _DROOP_PER_C * (self.temperature_c(now) - _REFERENCE_C)
        return (self._strength + self._excess_at(now)) * (1.0 - droop)

    def dose_s(self, now: float) -> float:
        """Return the light so far, the integral of `flux` over time, from power-up to `now`."""
        past = now - self._since_s
        excess = (self._start_c - self._final_c) * _WARM_UP_S * -math.expm1(-past / _WARM_UP_S)
        mean_part = (1.0 - _DROOP_PER_C * (self._final_c - _REFERENCE_C)) * past
        dose_s = self._dose_s + self._strength * (mean_part - _DROOP_PER_C * excess)
        return dose_s + self._excess_dose_s(past) if self._excess else dose_s

    @property
    def _final_c(self) -> float:
        share = self.current_mA / FULL_CURRENT_MA if self.on else 0.0
        return _AMBIENT_C + self._rise_c * share

    @property
    def _strength(self) -> float:
        share = self.current_mA / FULL_CURRENT_MA if self.on else 0.0
        return self._efficacy * share * (1.0 + _CURRENT_DROOP * (1.0 - share))

    def _excess_at(self, now: float) -> float:
        if self._excess == 0.0:
            return 0.0
        return self._excess * math.exp((self._since_s - now) / self.electronics_s)

    def _excess_dose_s(self, past: float) -> float:
        """Return what the excess adds to the dose: it decays, and so does the junction's part."""
        final = 1.0 - _DROOP_PER_C * (self._final_c - _REFERENCE_C)
        apart = -_DROOP_PER_C * (self._start_c - self._final_c)
        both_s = 1.0 / (1.0 / self.electronics_s + 1.0 / _WARM_UP_S)
        return self._excess * (
            final * self.electronics_s * -math.expm1(-past / self.electronics_s)
            + apart * both_s * -math.expm1(-past / both_s)
        )

    def _keep(self, now: float) -> None:
        """Take the present as the start of a new piece."""
        kept = self.dose_s(now), self.temperature_c(now), self._excess_at(now)
        self._dose_s, self._start_c, self._excess = kept
        self._since_s = now

    def _when_too_hot(self) -> float:
        final, start = self._final_c, self._start_c
        if final <= TOO_HOT_C:
            return math.inf
        return self._since_s + _WARM_UP_S * math.log((final - start) / (final - TOO_HOT_C))
