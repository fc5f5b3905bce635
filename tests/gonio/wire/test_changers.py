"""Whoever changes the sample of a real rig: a person at a terminal, or a command."""

import contextlib
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time

import pytest

from gonio.capture import Instrument
from gonio.capture.hardware import CommandChanger, Person
from gonio.clock import VirtualClock
from gonio.devices import LocalFolder
from gonio.errors import DeviceFaultError
from gonio.plan import LampSetting
from gonio.rig import default_rig, load_rig
from gonio.wire import ModbusBus
from sim.twin import Twin

DISABLED, ENABLED = 0x40, 0x27


@pytest.fixture
def rig_and_twin(tmp_path):
    rig, clock = default_rig(), VirtualClock()
    twin = Twin(rig, None, clock, tmp_path, 0)
    return Instrument.of(twin.bus, twin.line, LocalFolder(tmp_path), rig, clock), twin, clock


def states(bus):
    return [bus.read(unit, 1, 1)[0] & 0x6F for unit in (1, 2, 3, 4)]


@pytest.mark.parametrize("changer", [Person, CommandChanger])
def test_drives_and_lamps_wait_out_whoever_takes_long(rig_and_twin, changer, monkeypatch):
    instrument, twin, clock = rig_and_twin
    seen = []

    def take_long(_, what):
        seen.extend((what, states(twin.bus), [led.on for led in twin.lamps.leds]))
        clock.sleep(599.0)

    monkeypatch.setattr(changer, "place", take_long)
    with instrument.ready():
        instrument.lamps.apply([LampSetting(n=3, mA=700.0)])
        instrument.place(changer.__new__(changer), "sample")
        instrument.arm.move({"view_theta": 20.0})
        assert states(twin.bus) == [ENABLED] * 4
    assert seen == ["sample", [DISABLED] * 4, [False] * 11]


def script(tmp_path, text):
    path = tmp_path / "changer.py"
    path.write_text(text)
    return CommandChanger((sys.executable, str(path), "{what}", "no; shell"))


def test_a_command_is_given_its_words_without_a_shell(tmp_path):
    said = tmp_path / "said"
    script(tmp_path, f"import sys; open({str(said)!r}, 'w').write(repr(sys.argv[1:]))").place("x y")
    assert said.read_text() == "['x y', 'no; shell']"


FAILED = {
    "it says why": ("import sys; sys.exit('no\\nsample in tray 2')", r"\(no sample in tray 2\)"),
    "it says nothing": ("import sys; sys.exit(7)", r"\(exit code 7\)"),
    "it is ended": ("import os; os.kill(os.getpid(), 9)", r"\(exit code -9\)"),
    "it goes on": ("while True: pass", r"timed out"),
}


@pytest.mark.parametrize(("text", "why"), FAILED.values(), ids=FAILED)
def test_a_command_that_fails(tmp_path, monkeypatch, text, why):
    monkeypatch.setattr("gonio.capture.hardware._CHANGER_TIMEOUT_S", 0.5)
    with pytest.raises(DeviceFaultError, match=why) as caught:
        script(tmp_path, text).place("sample")
    assert "see to the changer, then resume" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_command_that_is_not_there():
    with pytest.raises(DeviceFaultError, match="nobody-has-this sample failed"):
        CommandChanger(("/nobody-has-this", "{what}")).place("sample")


class Terminal:
    """A person's terminal, at which a command runs as a shell would run it."""

    def __init__(self, folder, *words):
        self.handle, near = pty.openpty()
        termios.tcsetwinsize(near, (24, 120))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "gonio", *map(str, words)],
            cwd=folder, stdin=near, stdout=near, stderr=near, start_new_session=True,
            env=os.environ | {"OMP_NUM_THREADS": "1", "TERM": "xterm"},
        )  # fmt: skip
        os.close(near)
        self.said, self.until_s = "", time.monotonic() + 60.0

    def read(self):
        """Take in what it says next; a line of progress that is drawn anew says much."""
        assert time.monotonic() < self.until_s, self.said
        if select.select([self.handle], [], [], 1.0)[0]:
            try:
                self.said += os.read(self.handle, 4096).decode(errors="replace")
            except OSError:
                pytest.fail(f"it ended: {self.said}")

    def wait_for(self, text):
        while text not in self.said:
            self.read()

    def press(self, keys):
        os.write(self.handle, keys)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.handle)


@pytest.fixture
def planned(gonio, manual_rig):
    """A rig whose sample a person changes, with a plan for it."""
    shots = ("--density", "2", "--criterion", "farthest")
    planned = gonio("plan", *shots, "--rig", manual_rig, "--no-page")
    assert planned.returncode == 0, planned.stderr
    return manual_rig


LEAVES = {
    "end of input": lambda terminal: terminal.press(b"\x04"),
    "Ctrl-C": lambda terminal: terminal.process.send_signal(signal.SIGINT),
}


@pytest.mark.parametrize("served", ["tcp"], indirect=True)
@pytest.mark.parametrize("leave", LEAVES.values(), ids=LEAVES)
def test_a_person_is_asked_with_the_drives_let_go_and_may_leave(planned, tmp_path, leave):
    with (
        contextlib.closing(ModbusBus(load_rig(planned).arm)) as bus,
        Terminal(tmp_path, "capture", "--rig", planned) as terminal,
    ):
        terminal.wait_for("Lay the white reference into the holder")
        assert states(bus) == [DISABLED] * 4
        leave(terminal)
        terminal.wait_for("go on with: gonio capture --resume")
        assert terminal.process.wait(30) == 130


@pytest.mark.parametrize("served", ["tcp"], indirect=True)
def test_a_person_who_has_laid_it_in_lets_it_go_on(planned, tmp_path):
    with (
        contextlib.closing(ModbusBus(load_rig(planned).arm)) as bus,
        Terminal(tmp_path, "capture", "--rig", planned) as terminal,
    ):
        terminal.wait_for("Lay the white reference into the holder")
        terminal.press(b"\r")
        while not list((tmp_path / "session/calibration").glob("*.dng")):
            terminal.read()
        assert states(bus) == [ENABLED] * 4
        terminal.process.send_signal(signal.SIGTERM)
        terminal.wait_for("go on with: gonio capture --resume")
        assert terminal.process.wait(30) == 143
        assert states(bus) == [DISABLED] * 4
