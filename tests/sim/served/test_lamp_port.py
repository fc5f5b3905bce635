"""The lamps' line at a real pseudo-terminal."""

import os
import select
from pathlib import Path

import pytest
import serial

IDENTITY = b"gonio,simulated lamp head,0001,1.0\r\n"
UNKNOWN = b'ERR 100,"Unknown command"\r\n'


@pytest.fixture
def open_line(tcp):
    """Open the port; what was there before is gone."""
    return lambda: serial.Serial(tcp.rig.lamps.device, 115200, timeout=2.0)


LINES = {
    "a question": (b"*IDN?\n", [IDENTITY]),
    "a carriage return before": (b"*IDN?\r\n", [IDENTITY]),
    "a number and a checksum": (b"#07 LED1:STAT?*6F\n", [b"#07 0*34\r\n"]),
    "a bad checksum": (b"#07 LED1:STAT?*00\n", [b'#07 ERR 101,"Bad checksum"*17\r\n']),
    "several in one write": (
        b"*IDN?\nLED1:STAT?\n#1 LED2:STAT?\n",
        [IDENTITY, b"0\r\n", b"#1 0\r\n"],
    ),
    "nothing": (b"\n", [UNKNOWN]),
    "lower case": (b"*idn?\n", [UNKNOWN]),
    "overlong": (b"#3 " + 400 * b"x" + b"\n", [b"#3 " + UNKNOWN]),
    "one byte too long": (b"*IDN?" + 115 * b" " + b"\n", [UNKNOWN]),
    "endless": (20000 * b"y" + b"\n*IDN?\n", [UNKNOWN, IDENTITY]),
    "eight bits": (b"\xff\xfe\x80\n*IDN?\n", [UNKNOWN, IDENTITY]),
    "what a terminal would act on": (b"\x03\x04\x1a\x11\x13\n*IDN?\n", [UNKNOWN, IDENTITY]),
    "a camera's state": (b"TRIG:STAT?\n", [b"IDLE\r\n"]),
}


@pytest.mark.parametrize(("sent", "answers"), LINES.values(), ids=LINES)
def test_lines(open_line, sent, answers):
    with open_line() as line:
        line.write(sent)
        assert [line.readline() for _ in answers] == answers


def test_a_line_in_pieces(open_line, tcp, arrived):
    with open_line() as line:
        for piece in (b"*I", b"DN?", b"\n"):
            line.write(piece)
            arrived(tcp)
        assert line.readline() == IDENTITY


def test_a_program_that_sets_nothing_finds_a_plain_line(serve):
    handle = os.open(serve().rig.lamps.device, os.O_RDWR | os.O_NOCTTY)
    try:
        os.write(handle, b"*IDN?\n")
        assert select.select([handle], [], [], 5.0)[0]
        assert os.read(handle, 100) == IDENTITY
    finally:
        os.close(handle)


def test_a_driver_that_never_reads_leaves_the_line_to_the_next(open_line):
    with open_line() as line:
        line.write(1000 * b"*IDN?\n")
    with open_line() as line:
        line.timeout = 0.3
        for number in (1, 2, 3):
            line.write(b"#%d LED1:STAT?\n" % number)
            answers = list(iter(line.readline, b""))
        assert answers == [b"#3 0\r\n"]


def test_no_echo(open_line, tcp):
    with open_line() as line:
        line.write(b"TRIG:STAT?\n")
        assert line.readline() == b"IDLE\r\n"
        assert line.in_waiting == 0
    assert str(Path(tcp.rig.lamps.device).readlink()).startswith("/dev/")
