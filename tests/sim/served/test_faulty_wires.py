"""What faults do to the bytes on a real socket and on real pseudo-terminals."""

import re
import socket
import struct
import time

import pytest
import serial
import tomli_w
from pymodbus.framer import FramerRTU

EACH = 8
SILENT_S = 0.15
LATE_S = 0.4
READ = bytes.fromhex("0300020001")
MODE = bytes.fromhex("03020000")
BUSY = bytes.fromhex("8306")
BUS = [
    "bus time-out", "bus CRC error", "bus bytes dropped", "bus bytes doubled",
    "bus wrong transaction", "bus exception reply",
]  # fmt: skip
LINE = [
    "line time-out", "line bytes garbled", "line bytes dropped", "line bytes doubled",
    "line answer doubled",
]  # fmt: skip


def in_blocks(kinds):
    """Each kind strikes eight requests, one kind after the other; then one answer is late."""
    rows = [
        {"kind": kind, "at": [*range(EACH * turn, EACH * (turn + 1))]}
        for turn, kind in enumerate(kinds)
    ]
    late = {"kind": f"{kinds[0].partition(' ')[0]} bytes delayed", "at": [EACH * len(kinds)]}
    return [*rows, late | {"lasts_s": LATE_S}]


@pytest.fixture
def faulty(serve, tmp_path):
    """Serve a twin with faults: faulty(list_of_faults, "--rtu")."""

    def start(faults, *options):
        (tmp_path / "faults.toml").write_text(tomli_w.dumps({"fault": faults}))
        return serve("--faults", str(tmp_path / "faults.toml"), *options)

    return start


def sealed(content):
    return content + FramerRTU.compute_CRC(content).to_bytes(2, "big")


def is_sealed(frame):
    return len(frame) > 2 and sealed(frame[:-2]) == frame


def timed(ask):
    began = time.monotonic()
    return ask(), time.monotonic() - began


def test_over_rtu(faulty):
    served = faulty(in_blocks(BUS), "--rtu")
    whole = sealed(b"\x01" + MODE)
    with serial.Serial(served.rig.arm.device, 115200, timeout=SILENT_S) as wire:

        def ask():
            wire.write(sealed(b"\x01" + READ))
            return wire.read(64)

        came = {kind: [ask() for _ in range(EACH)] for kind in BUS}
        wire.timeout = 2 * LATE_S
        wire.write(sealed(b"\x01" + READ))
        late, after_s = timed(lambda: wire.read(len(whole)))
    assert {*came["bus time-out"]} == {b""}
    for kind, size in (("bus CRC error", 7), ("bus bytes dropped", 6), ("bus bytes doubled", 8)):
        spoiled = [frame for frame in came[kind] if frame]
        assert 0 < len(spoiled) < EACH, "request and reply are struck by turns"
        assert {len(frame) for frame in spoiled} == {size}
        assert not any(map(is_sealed, spoiled))
    assert {*came["bus wrong transaction"]} == {sealed(b"\x02" + MODE)}
    assert {*came["bus exception reply"]} == {sealed(b"\x01" + BUSY)}
    assert (late, after_s) == (whole, pytest.approx(LATE_S, abs=0.2))


def test_over_tcp(faulty):
    arm = faulty(in_blocks(BUS)).rig.arm
    with socket.create_connection((arm.host, arm.port), timeout=SILENT_S) as port:

        def ask(transaction=0x1234):
            port.sendall(struct.pack(">HHHB", transaction, 0, 6, 1) + READ)
            try:
                return port.recv(64)
            except TimeoutError:
                return b""

        came = {kind: [ask() for _ in range(EACH)] for kind in BUS}
        port.settimeout(2 * LATE_S)
        late, after_s = timed(lambda: ask(1))
        assert ask(2) == struct.pack(">HHHB", 2, 0, 5, 1) + MODE
    behind_the_gateway = BUS[:4]
    assert {frame for kind in behind_the_gateway for frame in came[kind]} == {b""}
    another = struct.pack(">HHHB", 0x9234, 0, 5, 1) + MODE
    assert {*came["bus wrong transaction"]} == {another}
    assert {*came["bus exception reply"]} == {struct.pack(">HHHB", 0x1234, 0, 3, 1) + BUSY}
    assert late == struct.pack(">HHHB", 1, 0, 5, 1) + MODE
    assert after_s == pytest.approx(LATE_S, abs=0.2)


def test_over_the_lamps_line(faulty):
    served = faulty(
        [*in_blocks(LINE), {"kind": "serial port unplugged", "at": [41], "lasts_s": 0.5}]
    )
    request, answer = b"#07 LED1:STAT?*6F\n", b"#07 0*34\r\n"
    with serial.Serial(served.rig.lamps.device, 115200, timeout=SILENT_S) as line:

        def ask():
            line.write(request)
            return line.read(200)

        came = {kind: [ask() for _ in range(EACH)] for kind in LINE}
        line.timeout = 2 * LATE_S
        line.write(request)
        late, after_s = timed(line.readline)
        line.write(request)
        with pytest.raises(serial.SerialException):
            line.read(1)
    assert {*came["line time-out"]} == {b""}
    for kind in ("line bytes garbled", "line bytes dropped", "line bytes doubled"):
        assert answer not in came[kind]
        refused = [line for line in came[kind] if re.search(rb"ERR 10[01]", line)]
        assert 0 < len(refused) < EACH, "request and answer are struck by turns"
    assert {*came["line answer doubled"]} == {answer + answer}
    assert (late, after_s) == (answer, pytest.approx(LATE_S, abs=0.2))
    with serial.Serial(back_again(served.folder / "lamps"), 115200, timeout=2.0) as line:
        line.write(request)
        assert line.readline() == answer


def back_again(link):
    until_s = time.monotonic() + 10.0
    while not link.exists():
        assert time.monotonic() < until_s
    return str(link)
