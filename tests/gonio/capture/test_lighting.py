"""Lamps that must warm up, and rest."""

import pytest

from gonio.capture.lighting import Lighting
from gonio.clock import VirtualClock
from gonio.plan import LampSetting
from gonio.rig import default_rig

SETTING = (LampSetting(n=1, mA=700),)


class Head:
    """Writes down what it is told, and when."""

    def __init__(self, clock):
        self.clock, self.told = clock, []

    def apply(self, settings):
        self.told.append((round(self.clock.now(), 6), "on"))

    def off(self):
        self.told.append((round(self.clock.now(), 6), "off"))


@pytest.fixture
def lit():
    def make(**waits):
        clock = VirtualClock()
        spec = default_rig().lamps.model_copy(update=waits)
        head = Head(clock)
        return Lighting(head, spec, clock), head, clock

    return make


def test_nobody_waits_unless_told(lit):
    lighting, head, clock = lit()
    lighting.apply(SETTING)
    clock.sleep(1e6)
    lighting.apply(SETTING)
    assert head.told == [(0.0, "on"), (1e6, "on")]


def test_the_head_is_asked_while_lamps_warm_up(lit):
    lighting, head, clock = lit(warm_up_s=25.0)
    lighting.apply(SETTING)
    # its watchdog is 30 s
    assert head.told == [(0.0, "on"), (10.0, "on"), (20.0, "on"), (25.0, "on")]
    lighting.apply(SETTING)
    assert clock.now() == 25.0


def test_they_warm_up_again_after_dark_frames(lit):
    lighting, _, clock = lit(warm_up_s=5.0)
    lighting.apply(SETTING)
    lighting.off()
    lighting.apply(SETTING)
    assert clock.now() == 10.0


def test_a_rest_is_taken_when_due_and_warmed_up_after(lit):
    lighting, head, clock = lit(warm_up_s=5.0, rest_after_s=100.0, rest_s=40.0)
    lighting.apply(SETTING)
    clock.sleep(94.0)
    lighting.apply(SETTING)
    assert clock.now() == 99.0
    clock.sleep(1.0)
    lighting.apply(SETTING)
    assert (100.0, "off") in head.told
    assert clock.now() == 100.0 + 40.0 + 5.0
