"""A pause in which devices fail: nothing moves before it ends."""

import pytest

from gonio.errors import DeviceFaultError
from gonio.wishes import forget, wish
from planner.make import make_plan

POLLS = 12


class Person:
    """Whoever wished for the pause, and looks so many times before going on."""

    def __init__(self, root, said):
        self.root, self.said = root, said

    def sleep(self, seconds):
        self.said.append("looked")
        if self.said.count("looked") == POLLS:
            forget(self.root)
            self.said.append("went on")


@pytest.mark.parametrize("failing", ["arm", "lamps"])
def test_what_fails_in_a_pause_is_put_in_order_after_it(stage, monkeypatch, failing):
    here, said = stage(lambda rig: make_plan(rig, views=2, lights=2)), []
    monkeypatch.setattr("gonio.capture.run.SystemClock", lambda: Person(here.session.root, said))

    def told(call, word):
        def tell():
            said.append(word)
            call()

        return tell

    def until_it_ends(call):
        def fail():
            if said and "went on" not in said:
                raise DeviceFaultError("nobody answers")
            call()

        return fail

    def meddle(twin, instrument):
        device, name = {"arm": (instrument.arm, "attend"), "lamps": (instrument.lamps, "off")}[
            failing
        ]
        setattr(device, name, until_it_ends(getattr(device, name)))
        instrument.arm.attend = told(instrument.arm.attend, "attended")
        instrument.arm.enable = told(instrument.arm.enable, "enabled")
        wish(here.session.root, "pause")

    here.meddle = meddle
    here.run()
    paused = said[said.index("looked") : said.index("went on")]
    assert "enabled" not in paused
    assert paused.count("attended") == POLLS - 1
    assert [did for _, did in here.noted()] == ["left until the pause ends", "tried again"]
    assert said[said.index("went on") :].count("enabled") == 1
    assert len(here.shots()) == 4 * len(here.session.rig().camera.exposures_s)
