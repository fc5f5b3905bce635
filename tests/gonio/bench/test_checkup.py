"""What a look at a rig remarks of lamps that somebody left on."""

import pytest

from gonio.bench import look_over
from gonio.capture import Instrument
from gonio.clock import VirtualClock
from gonio.devices import LocalFolder
from gonio.plan import LampSetting
from gonio.rig import default_rig
from sim.twin import Twin


@pytest.mark.parametrize(
    ("on", "found", "remedy"), [([], "none", ""), ([3, 7], "3, 7", "rig stop")]
)
def test_lamps_left_on_are_something_to_see_to(tmp_path, on, found, remedy):
    rig, clock = default_rig(), VirtualClock()
    rig = rig.model_copy(update={"camera": rig.camera.model_copy(update={"folder": str(tmp_path)})})
    twin = Twin(rig, None, clock, tmp_path, 0)
    instrument = Instrument.of(twin.bus, twin.line, LocalFolder(tmp_path), rig, clock)
    instrument.lamps.apply([LampSetting(n=n, mA=100.0) for n in on])
    (lit,) = (each for each in look_over(instrument, rig) if each.what == "lit")
    assert (lit.found, lit.is_well) == (found, not on)
    assert remedy in lit.remedy
