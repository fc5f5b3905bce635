"""A rig that fails again while it is put in order after a fault."""

import pytest

from gonio.errors import DeviceFaultError, TransportLostError, TransportTimeoutError
from planner.make import make_plan
from sim.faults import Fault


def small(rig):
    return make_plan(rig, views=2, lights=2)


def failing_at(moves, enablings):
    """Let that move fail, and after it so many of the drives' enablings."""
    left = [enablings]

    def meddle(twin, instrument):
        move, enable, count = instrument.arm.move, instrument.arm.enable, iter(range(10**6))

        def fail_once(*where):
            if next(count) == moves:
                instrument.arm.enable = fail_some
                raise DeviceFaultError("view_theta: stalled")
            move(*where)

        def fail_some():
            if left[0]:
                left[0] -= 1
                raise DeviceFaultError("light_phi: no power")
            enable()

        instrument.arm.move = fail_once

    return meddle


@pytest.mark.parametrize("enablings", [0, 1, 2])
def test_what_fails_while_it_is_put_in_order_is_met_too(stage, enablings):
    here = stage(small)
    here.meddle = failing_at(2, enablings)
    here.run()
    assert len(here.shots()) == 4 * len(here.session.rig().camera.exposures_s)
    assert here.noted() == [
        ("view_theta: stalled", "tried again"),
        *[("light_phi: no power", "put in order again")] * enablings,
    ]


def test_what_cannot_be_put_in_order_ends_the_capture(stage):
    here = stage(small)
    here.meddle = failing_at(2, 10**6)
    with pytest.raises(DeviceFaultError, match="light_phi: no power"):
        here.run()
    assert len(here.noted()) == 3
    here.meddle = lambda twin, instrument: None
    here.run()
    assert len(here.shots()) == 4 * len(here.session.rig().camera.exposures_s)


ON_THE_WAY_HOME = ["stall", "following error", "limit hit", "power cut", "watchdog expiry"]


@pytest.mark.parametrize("kind", ON_THE_WAY_HOME)
def test_a_fault_on_the_way_home_is_met_like_any_other(stage, kind):
    here = stage(small)
    here.faults = (Fault(kind=kind, at=(0,)),)
    here.run()
    assert here.struck[kind] == 1
    assert [did for _, did in here.noted()][:1] == ["tried again"]
    assert len(here.shots()) == 4 * len(here.session.rig().camera.exposures_s)


@pytest.mark.parametrize("error", [TransportLostError, TransportTimeoutError])
def test_a_device_that_is_not_there_is_told_at_once(stage, error):
    here = stage(small)
    asked = []

    def meddle(twin, instrument):
        def nobody():
            asked.append(error)
            raise error("lamps: nobody answers")

        instrument.lamps.identify = nobody

    here.meddle = meddle
    with pytest.raises(error, match="nobody answers"):
        here.run()
    assert asked == [error]
