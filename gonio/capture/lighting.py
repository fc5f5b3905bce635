"""Lamps over a capture: they warm up before they are trusted, and rest when they must."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.clock import Clock
    from gonio.devices import LampHead
    from gonio.plan import LampSetting
    from gonio.rig import Lamps

_LONGEST_SILENCE_S = 10.0


class Lighting:
    """Lights the lamps of a shot, and waits as the rig file says.

    Parameters
    ----------
    lamps
        The head.
    spec
        `warm_up_s` after they were dark, `rest_s` in the dark after `rest_after_s` of light.
    clock
        To wait on.
    """

    def __init__(self, lamps: LampHead, spec: Lamps, clock: Clock) -> None:
        self._lamps, self._spec, self._clock = lamps, spec, clock
        # a head that hears nothing takes the host for dead and switches its lamps off
        self._silence_s = spec.watchdog_ms / 3000.0 or _LONGEST_SILENCE_S
        self._lit_since_s: float | None = None

    def off(self) -> None:
        """Switch all off (errors as for `gonio.devices.LampHead.off`)."""
        self._lamps.off()
        self._lit_since_s = None

    def apply(self, settings: Sequence[LampSetting]) -> None:
        """Light some (errors as for `gonio.devices.LampHead.apply`)."""
        if self._needs_rest():
            self.off()
            self._clock.sleep(self._spec.rest_s)
        self._lamps.apply(settings)
        if self._lit_since_s is None:
            self._lit_since_s = self._clock.now()
            self._warm_up(settings)

    def _needs_rest(self) -> bool:
        if not self._spec.rest_s or self._lit_since_s is None:
            return False
        return self._clock.now() - self._lit_since_s >= self._spec.rest_after_s

    def _warm_up(self, settings: Sequence[LampSetting]) -> None:
        until_s = self._clock.now() + self._spec.warm_up_s
        while (left_s := until_s - self._clock.now()) > 0:
            self._clock.sleep(min(left_s, self._silence_s))
            self._lamps.apply(settings)
