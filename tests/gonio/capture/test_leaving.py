"""How a rig is left: in order, whatever fails, and soon, whatever does not answer."""

import contextlib

import pytest

from gonio.capture import Instrument
from gonio.clock import VirtualClock
from gonio.devices import LocalFolder
from gonio.errors import DeviceFaultError, TransportLostError, TransportTimeoutError
from gonio.plan import LampSetting
from gonio.rig import default_rig
from sim.twin import Twin

ENABLED = 0x27
# as on a real wire: what is gone is known at once, what is mute is not
TAKES_S = {TransportLostError: 0.0, TransportTimeoutError: 0.6}


class Wire:
    """A wire that fails from when `error` is set on, for `failures` requests."""

    def __init__(self, wire, clock):
        self._wire, self._clock, self.error, self.failures = wire, clock, None, 10**6

    def __getattr__(self, name):
        def request(*arguments):
            if self.error and self.failures and name != "close":
                self.failures -= 1
                self._clock.sleep(TAKES_S[self.error])
                raise self.error("the wire is cut; mend it")
            return getattr(self._wire, name)(*arguments)

        return request


@pytest.fixture
def rig(tmp_path):
    """A lit rig on wires that can be cut."""

    class Parts:
        clock = VirtualClock()
        twin = Twin(default_rig(), None, clock, tmp_path, 0)
        bus, line = Wire(twin.bus, clock), Wire(twin.line, clock)
        instrument = Instrument.of(bus, line, LocalFolder(tmp_path), default_rig(), clock)

        def lit(self):
            return sum(led.on for led in self.twin.lamps.leds)

        def enabled(self):
            return [
                unit for unit in range(1, 5) if self.twin.bus.read(unit, 1, 1)[0] & 0x6F == ENABLED
            ]

    return Parts()


def cut(rig, bus, line):
    rig.instrument.lamps.apply([LampSetting(n=3, mA=700.0)])
    rig.bus.error, rig.line.error = bus, line


def interrupted(rig, bus, line):
    """Press Ctrl-C when wires are cut; return how long it takes then."""
    with contextlib.suppress(KeyboardInterrupt), rig.instrument.ready():
        cut(rig, bus, line)
        began_s = rig.clock.now()
        raise KeyboardInterrupt
    return rig.clock.now() - began_s


ERRORS = [None, TransportLostError, TransportTimeoutError]


@pytest.mark.parametrize("line", ERRORS)
@pytest.mark.parametrize("bus", ERRORS)
def test_ctrl_c_leaves_soon_and_stops_what_still_answers(rig, bus, line):
    assert interrupted(rig, bus, line) < (1.0 if TransportTimeoutError not in (bus, line) else 25.0)
    assert bool(rig.enabled()) == bool(bus)
    assert bool(rig.lit()) == bool(line)


def test_a_connection_that_broke_is_made_anew_to_stop(rig):
    rig.bus.failures = rig.line.failures = 1
    interrupted(rig, TransportLostError, TransportLostError)
    assert (rig.enabled(), rig.lit()) == ([], 0)


def test_drives_are_let_go_at_the_end_though_the_lamps_fail(rig):
    with pytest.raises(DeviceFaultError, match="the wire is cut"), rig.instrument.ready():
        cut(rig, None, TransportLostError)
    assert rig.enabled() == []


def test_what_stays_away_is_waited_for_once(rig):
    mended = []
    with rig.instrument.ready():
        cut(rig, TransportLostError, None)
        rig.instrument.troubles.listener = lambda what, did: mended.append(did)
        waits_s = []
        for _ in range(3):
            began_s = rig.clock.now()
            with pytest.raises(TransportLostError):
                rig.instrument.arm.shaking_urad("view_phi")
            waits_s.append(rig.clock.now() - began_s)
        assert waits_s == pytest.approx([60.0, 0.0, 0.0], abs=1.0)
        assert mended == ["waits up to 60 s"]
        # what came back is waited for again
        rig.bus.error = None
        rig.instrument.arm.enable()
        rig.bus.error, rig.bus.failures = TransportLostError, 10
        rig.instrument.arm.shaking_urad("view_phi")
        assert mended == ["waits up to 60 s"] * 2
