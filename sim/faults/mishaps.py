"""What goes wrong with the rig itself: axes, drives, doors, lamps."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from gonio.clock import VirtualClock
    from sim.faults.document import Fault
    from sim.faults.injector import Injector
    from sim.twin import Twin

_FOLLOWING_ERROR, _COMMUNICATION_LOST = 0x8611, 0x7500
# long enough after the start of a move that it is well under way
_UNDER_WAY_S = 0.15
_SLIP_DEG = 1.0
_DIMMER = 0.97


class Mishaps:
    """Lets faults happen to a twin.

    Parameters
    ----------
    twin
        The twin.
    clock
        On which they begin and end.
    injector
        Says what strikes.
    """

    def __init__(self, twin: Twin, clock: VirtualClock, injector: Injector) -> None:
        self._twin = twin
        self._clock = clock
        self._injector = injector

    def moved(self, axis: str) -> None:
        """Let happen what strikes a move that starts now; one of no length is none."""
        if not self._twin.drives[axis].axis.moving:
            return
        fault = self._injector.strike("axis", "move", axis)
        if fault is not None:
            self._after(_UNDER_WAY_S, lambda: self._axis(axis, fault))
        if self._injector.strike("rig", "move"):
            self._after(_UNDER_WAY_S, self._cut_power)

    def exposed(self) -> None:
        """Let happen what strikes an exposure that starts now."""
        fault = self._injector.strike("rig", "exposure")
        if fault is not None:
            self._twin.set_interlock(True)
            self._after(fault.duration_s, lambda: self._twin.set_interlock(False))
        fault = self._injector.strike("lamp", "exposure")
        if fault is not None:
            self._lamp(fault)

    def _axis(self, name: str, fault: Fault) -> None:
        now = self._clock.now()
        drive = self._twin.drives[name]
        drive.control.advance(now)
        if fault.kind == "following error":
            drive.control.trip(_FOLLOWING_ERROR, now)
        elif fault.kind == "watchdog expiry":
            drive.control.trip(_COMMUNICATION_LOST, now)
        elif fault.kind == "lost steps":
            drive.axis.slip(_SLIP_DEG)
        elif fault.kind == "stall":
            drive.axis.jam(now)
            self._after(fault.duration_s, drive.axis.free)
        else:
            drive.control.hit_limit(now)
            self._after(fault.duration_s, drive.axis.open_switch)

    def _cut_power(self) -> None:
        now = self._clock.now()
        for drive in self._twin.drives.values():
            drive.control.advance(now)
            drive.power_up(now)

    def _lamp(self, fault: Fault) -> None:
        head, now = self._twin.lamps, self._clock.now()
        n = self._injector.lamp(fault, [n for n, led in enumerate(head.leds, 1) if led.on])
        if n is None:
            return
        if fault.kind == "lamp open":
            head.break_circuit(n)
            self._after(fault.duration_s, lambda: head.mend_circuit(n))
        elif fault.kind == "lamp over-temperature":
            head.overheat(n)
        else:
            head.leds[n - 1].fade(now, _DIMMER)

    def _after(self, seconds: float, action: Callable[[], None]) -> None:
        self._clock.call_at(self._clock.now() + seconds, action)
