"""The lamps' line at a real pseudo-terminal whose other end sends what a test says."""

import contextlib
import os
import pty
import termios
import threading
import tty

import pytest
import serial

from gonio.errors import TransportLostError, TransportTimeoutError
from gonio.wire import PortLine


class Far:
    """The far end of a line."""

    def __init__(self):
        self.handle, self.near = pty.openpty()
        tty.setraw(self.handle)
        tty.setraw(self.near)
        self.name = os.ttyname(self.near)

    def send(self, data):
        os.write(self.handle, data)

    def received(self):
        return os.read(self.handle, 4096)

    def close(self):
        for handle in (self.handle, self.near):
            with contextlib.suppress(OSError):
                os.close(handle)


@pytest.fixture
def far():
    with contextlib.closing(Far()) as end:
        yield end


@pytest.fixture
def line(far):
    with contextlib.closing(PortLine(far.name)) as made:
        made.send(b"*IDN?")
        assert far.received() == b"*IDN?\n"
        yield made


def test_the_line_is_115200_8n1(far, line):
    _, _, control, _, come, go, _ = termios.tcgetattr(far.near)
    assert (come, go) == (termios.B115200, termios.B115200)
    framing = termios.CSIZE | termios.PARENB | termios.CSTOPB
    assert control & framing == termios.CS8


@pytest.mark.parametrize("ending", [b"\n", b"\r\n", b"\r\r\n"])
def test_lines_come_one_by_one_without_their_endings(far, line, ending):
    far.send(b"one" + ending + b"#2 OK*1B" + ending + b"thr")
    assert [line.receive(1.0), line.receive(1.0)] == [b"one", b"#2 OK*1B"]
    with pytest.raises(TransportTimeoutError):
        line.receive(0.01)
    far.send(b"ee" + ending)
    assert line.receive(1.0) == b"three"


def test_bytes_are_given_as_they_came(far, line):
    noise = bytes(set(range(256)) - {10, 13})
    far.send(noise + b"\n")
    assert line.receive(1.0) == noise


def test_silence_is_a_timeout(line):
    with pytest.raises(
        TransportTimeoutError, match=r"lamps: no answer within 0\.01 s; check cable"
    ):
        line.receive(0.01)


def test_noise_without_an_end_is_a_timeout(line, monkeypatch):
    # as fast as it is read, however long
    monkeypatch.setattr(serial.Serial, "in_waiting", 100)
    monkeypatch.setattr(serial.Serial, "read", lambda _, size: b"\xff" * size)
    said = []

    def listen():
        with pytest.raises(TransportTimeoutError) as caught:
            line.receive(0.01)
        said.append(caught.value)

    listening = threading.Thread(target=listen, daemon=True)
    listening.start()
    listening.join(timeout=10)
    assert said, "listens forever"


def test_a_line_is_found_after_much_noise(far, line):
    for _ in range(10):
        far.send(b"\xff" * 1000)
        with pytest.raises(TransportTimeoutError):
            line.receive(0.0)
    far.send(b"\nOK\r\n")
    assert len(line.receive(1.0)) < 5000
    assert line.receive(1.0) == b"OK"


def test_what_came_before_the_port_was_opened_is_thrown_away(far):
    far.send(b"late\r\n")
    with contextlib.closing(PortLine(far.name)) as line:
        line.send(b"*IDN?")
        far.send(b"new\r\n")
        assert line.receive(1.0) == b"new"


def test_a_port_that_goes_and_comes_back(tmp_path):
    name = tmp_path / "port"
    line = PortLine(str(name))
    for number in range(2):
        with contextlib.closing(Far()) as far:
            name.symlink_to(far.name)
            line.send(b"%d" % number)
            far.send(b"OK\r\nhal")
            assert line.receive(1.0) == b"OK"
        name.unlink()
        with pytest.raises(TransportLostError, match=rf"lamps: {name} cannot be used .*plug it in"):
            line.receive(0.01)
        with pytest.raises(TransportLostError, match="No such file or directory"):
            line.send(b"ALL:OFF")


def gone(*_, **__):
    raise termios.error(5, "Input/output error")


@pytest.mark.parametrize("action", ["tcflush", "tcdrain", "tcsetattr", "tcgetattr"])
def test_a_port_that_goes_at_any_moment_is_gone(far, monkeypatch, action):
    line = PortLine(far.name)
    monkeypatch.setattr(termios, action, gone)
    with contextlib.closing(line), contextlib.suppress(TransportLostError):
        line.send(b"ALL:OFF")
        far.send(b"OK\r\n")
        assert line.receive(1.0) == b"OK"


UNUSABLE = {
    "/dev/nothing-here": "No such file or directory",
    "/tmp": "Is a directory",
    "/dev/null": "configure port",
    "": "No such file or directory",
}


@pytest.mark.parametrize(("device", "reason"), UNUSABLE.items())
def test_what_is_no_port(device, reason):
    with pytest.raises(TransportLostError, match=f"lamps: {device} cannot be used .*") as caught:
        PortLine(device).send(b"*IDN?")
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_port_that_another_program_holds(far, line):
    with pytest.raises(TransportLostError, match="cannot be used"):
        PortLine(far.name).send(b"*IDN?")


def test_a_far_end_that_does_not_take_what_is_sent(line):
    def send_much():
        for _ in range(2000):
            line.send(b"y" * 100)

    with pytest.raises(TransportLostError, match="cannot be used"):
        send_much()
