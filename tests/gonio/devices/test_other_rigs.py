"""Register tables and command sets are data: the drivers on a rig that has other ones."""

import re
from pathlib import Path

import pytest

from gonio.devices import Arm, LampHead
from gonio.dialects import load_dialect
from gonio.errors import BadFileError, BadInputError, DeviceFaultError
from gonio.plan import LampSetting
from gonio.profiles import load_profile

EXAMPLES = Path(__file__).parents[3] / "docs/examples"
DRIVE, LAMPS = str(EXAMPLES / "other-drive.toml"), str(EXAMPLES / "other-lamps.toml")
POSE = {"view_theta": 45.0, "view_phi": 120.0, "light_theta": 15.0, "light_phi": 300.0}


class OtherBus:
    """The twin's drives at the addresses of another table."""

    def __init__(self, bus):
        ours, theirs = load_profile("cia402-modbus"), load_profile(DRIVE)
        self.bus = bus
        self.address = {
            getattr(theirs, name).address: getattr(ours, name).address
            for name in type(ours).model_fields
        }

    def read(self, unit, address, count):
        return self.bus.read(unit, self.address[address], count)

    def write(self, unit, address, values):
        self.bus.write(unit, self.address[address], values)


class OtherLine:
    """The twin's lamps behind another command set."""

    def __init__(self, line):
        ours, theirs = load_dialect("lamps-1"), load_dialect(LAMPS)
        self.line = line
        names = [name for name in type(ours).model_fields if isinstance(getattr(ours, name), str)]
        self.pairs = [
            (re.compile(self.pattern(getattr(theirs, name))), getattr(ours, name))
            for name in names
            if name != "framing"
        ]

    @staticmethod
    def pattern(command):
        return re.sub(r"\\{(\w+)\\}", r"(?P<\1>[\\d.]+)", re.escape(command)) + "$"

    def send(self, line):
        text = line.decode()
        for pattern, ours in self.pairs:
            found = pattern.match(text)
            if found:
                self.line.send(ours.format(**found.groupdict()).encode())
                return
        raise AssertionError(f"{text!r} is no command of this head")

    def receive(self, timeout_s):
        return self.line.receive(timeout_s)


def test_the_arm_by_another_register_table(bench, rig_with):
    arm = Arm(OtherBus(bench.twin.bus), rig_with("arm", profile=DRIVE), bench.clock)
    arm.enable()
    arm.home()
    arm.move(POSE)
    assert bench.true_deg() == pytest.approx(POSE, abs=0.001)
    arm.stop()


def test_the_lamps_by_another_command_set(bench, rig_with):
    lamps = LampHead(OtherLine(bench.twin.line), rig_with("lamps", dialect=LAMPS), bench.clock)
    assert lamps.identify().maker == "gonio"
    lamps.apply([LampSetting(n=2, mA=350.0)])
    assert [led.on for led in bench.twin.lamps.leds] == [n == 2 for n in range(1, 12)]
    exposure = lamps.expose(0.01)
    assert exposure.flux[1] > 0.4
    assert lamps.says(2).is_lit
    lamps.off()
    assert not any(led.on for led in bench.twin.lamps.leds)


def test_an_error_of_another_head_is_told_in_its_own_words(bench, rig_with):
    class FanStopped(OtherLine):
        def receive(self, timeout_s):
            super().receive(timeout_s)
            return b'ERR 4,"FAN"'

    rig = rig_with("lamps", dialect=LAMPS)
    lamps = LampHead(FanStopped(bench.twin.line), rig, bench.clock)
    says = "lamps: WHO was refused .4, fan stopped.; see to the head's fan, then resume"
    with pytest.raises(DeviceFaultError, match=says):
        lamps.identify()


BAD = {
    "missing.toml": (None, "no such file"),
    "text.toml": ("[[", "is not TOML"),
    "empty.toml": ("", "is missing"),
    "key.toml": ("what = 1", "is missing"),
}


@pytest.mark.parametrize("load", [load_profile, load_dialect])
@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_one_line(tmp_path, load, name):
    text, says = BAD[name]
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(BadFileError, match=says) as caught:
        load(str(tmp_path / name))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (('"I{n}={mA}"', '"I{n}"'), r"set_current: 'I\{n\}' must name \{n\}, \{mA\}"),
        (('"WHO"', '"WHO{"'), "identify: 'WHO{': "),
        (('"X={us}"', '"X={us}\\n"'), "expose: commands are one line of ASCII"),
        (('"plain"', '"loud"'), "framing"),
    ],
)
def test_a_command_that_cannot_work_is_named(tmp_path, change, says):
    path = tmp_path / "lamps.toml"
    path.write_text(Path(LAMPS).read_text().replace(*change))
    with pytest.raises(BadFileError, match=says):
        load_dialect(str(path))


@pytest.mark.parametrize("load", [load_profile, load_dialect])
def test_an_unknown_name(load):
    with pytest.raises(BadInputError, match=r"'mine' is not known; use .*, or the path of a"):
        load("mine")
