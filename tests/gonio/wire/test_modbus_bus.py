"""The Modbus bus at real sockets and pseudo-terminals whose other end answers what a test says."""

import contextlib
import os
import pty
import select
import socket
import struct
import termios
import threading
import time
import tty

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gonio.errors import DeviceFaultError, RegisterError, TransportLostError, TransportTimeoutError
from gonio.rig import default_rig
from gonio.wire import ModbusBus, modbus

READ_REPLY, WRITE_REPLY = bytes([3, 4, 0, 1, 0, 2]), struct.pack(">BHH", 16, 4, 2)
HANG_UP = object()


def crc(data):
    """CRC-16 of the Modbus specification."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return struct.pack("<H", value)


class Far:
    """The far end of a wire: `answers` are called in turn with (frame, request), the last forever.

    `frame` makes a reply on the wire of a reply; what an answer returns is sent as it is.
    """

    def __init__(self, transport):
        self.requests, self.answers, self.closed = [], [], False
        self.make = {"tcp": self._tcp, "rtu": self._rtu}[transport]
        self.arm = self.make()
        threading.Thread(target=self._serve, daemon=True).start()

    def _tcp(self):
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.handle = self.listening.fileno()
        return arm_at(transport="tcp", host="127.0.0.1", port=self.listening.getsockname()[1])

    def _rtu(self):
        self.handle, self.near = pty.openpty()
        tty.setraw(self.handle)
        tty.setraw(self.near)
        return arm_at(transport="rtu", device=os.ttyname(self.near))

    def _serve(self):
        with contextlib.suppress(OSError):
            while True:
                if self.arm.transport == "rtu":
                    self._talk(lambda: os.read(self.handle, 300), self._write)
                else:
                    client, _ = self.listening.accept()
                    with client:
                        self._talk(lambda client=client: client.recv(300), client.sendall)

    def _write(self, data):
        os.write(self.handle, data)

    def _talk(self, receive, send):
        while packet := receive():
            answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
            request = packet[7:] if self.arm.transport == "tcp" else packet[1:-2]
            self.requests.append(request)
            reply = answer(lambda body, packet=packet: self._frame(packet, body), request)
            if reply is HANG_UP:
                return
            send(reply)

    def _frame(self, packet, body):
        if self.arm.transport == "rtu":
            framed = packet[:1] + body
            return framed + crc(framed)
        return packet[:4] + struct.pack(">H", len(body) + 1) + packet[6:7] + body

    def close(self):
        if self.closed:
            return
        self.closed = True
        if self.arm.transport == "tcp":
            self.listening.shutdown(socket.SHUT_RDWR)
            self.listening.close()
        else:
            os.close(self.near)
            os.close(self.handle)


def arm_at(**keys):
    blank = {"host": None, "port": None, "device": None}
    return default_rig().arm.model_copy(update=blank | keys)


def says(*bodies):
    """Answer with replies on the wire."""
    return lambda frame, _: b"".join(map(frame, bodies))


def well(frame, request):
    return frame(READ_REPLY if request[0] == 3 else WRITE_REPLY)


def silence(*_):
    return b""


@pytest.fixture
def hurried(monkeypatch):
    """What does not come has not come sooner."""
    monkeypatch.setattr(modbus, "_REPLY_TIMEOUT_S", 0.1)


@pytest.fixture(params=["tcp", "rtu"])
def far(request):
    with contextlib.closing(Far(request.param)) as end:
        yield end


@pytest.fixture
def bus(far):
    with contextlib.closing(ModbusBus(far.arm)) as made:
        yield made


def test_what_goes_over_the_wire(far, bus):
    far.answers = [well]
    assert bus.read(2, 4, 2) == [1, 2]
    bus.write(2, 4, [0xFFFF, 7])
    assert far.requests == [bytes([3, 0, 4, 0, 2]), bytes([16, 0, 4, 0, 2, 4, 255, 255, 0, 7])]


@pytest.mark.parametrize("far", ["rtu"], indirect=True)
def test_rtu_is_115200_8n1(far, bus):
    far.answers = [well]
    bus.read(1, 4, 2)
    _, _, control, _, come, go, _ = termios.tcgetattr(far.near)
    assert (come, go) == (termios.B115200, termios.B115200)
    framing = termios.CSIZE | termios.PARENB | termios.CSTOPB
    assert control & framing == termios.CS8


def test_replies_in_pieces(far, bus, hurried):
    far.answers = [lambda frame, _: frame(READ_REPLY)[:5], lambda frame, _: frame(READ_REPLY)]
    with pytest.raises(TransportTimeoutError):
        bus.read(1, 4, 2)
    assert bus.read(1, 4, 2) == [1, 2]


UNSOUND = {
    "nothing": silence,
    "garbage": lambda *_: bytes(range(50, 90)),
    "half a reply": lambda frame, request: well(frame, request)[:6],
    "a reply to a read of another length": says(bytes([3, 2, 0, 1])),
    "a reply to another function": says(struct.pack(">BHH", 6, 4, 2)),
    "an exception of another function": says(bytes([0x86, 2])),
    "a write elsewhere acknowledged": says(struct.pack(">BHH", 16, 8, 2)),
    "less acknowledged than was written": says(struct.pack(">BHH", 16, 4, 1)),
    "a bit that fell over": lambda frame, request: flipped(well(frame, request)),
}


def flipped(reply):
    """Flip a bit of the unit on TCP (which has checksums of its own), of the body on RTU."""
    return reply[:6] + bytes([reply[6] ^ 4]) + reply[7:]


@pytest.mark.parametrize("answer", UNSOUND.values(), ids=UNSOUND)
@pytest.mark.parametrize("request_", ["read", "write"])
def test_what_is_no_answer_to_the_request_is_no_answer(far, bus, hurried, answer, request_):
    far.answers = [answer]
    with pytest.raises(TransportTimeoutError, match=r"unit 3: no sound reply within .* the cable"):
        bus.read(3, 4, 2) if request_ == "read" else bus.write(3, 4, [1, 2])
    # and the wire is in order for the next one
    far.answers = [well]
    assert bus.read(3, 4, 2) == [1, 2]
    bus.write(3, 4, [1, 2])


@pytest.mark.parametrize("far", ["tcp"], indirect=True)
def test_a_reply_with_another_transaction_id_is_passed_over(far, bus):
    def late_and_right(frame, _):
        late = bytearray(frame(bytes([3, 4, 0, 9, 0, 9])))
        late[1] ^= 0x55
        return bytes(late) + frame(READ_REPLY)

    far.answers = [late_and_right]
    assert bus.read(1, 4, 2) == [1, 2]


@pytest.mark.parametrize("code", [1, 2, 3, 6, 0x0B])
def test_an_exception_reply_is_an_error_with_its_code(far, bus, code):
    far.answers = [lambda frame, request: frame(bytes([request[0] | 0x80, code]))]
    for request in (lambda: bus.read(2, 0x11, 1), lambda: bus.write(2, 0x11, [1])):
        with pytest.raises(RegisterError, match="unit 2, register 0x0011") as caught:
            request()
        assert caught.value.code == code


@pytest.mark.parametrize("far", ["tcp"], indirect=True)
def test_a_connection_that_was_closed_is_made_anew(far, bus):
    far.answers = [lambda *_: HANG_UP, well]
    with pytest.raises(TransportLostError, match=r"arm: no connection to 127\.0\.0\.1:"):
        bus.read(1, 4, 2)
    assert bus.read(1, 4, 2) == [1, 2]


def test_an_end_that_goes_away(far, bus):
    far.answers = [well]
    bus.read(1, 4, 2)
    far.answers = [lambda *_: far.close() or HANG_UP]
    for _ in range(2):
        with pytest.raises(TransportLostError, match="switch the controller on"):
            bus.read(1, 4, 2)


NOWHERE = {
    "a port where nobody listens": ({"host": "127.0.0.1", "port": 1}, "cable, host and port"),
    "a name that no host can have": ({"host": "a..b", "port": 502}, "cable, host and port"),
    "a long name": ({"host": "x" * 70, "port": 502}, "cable, host and port"),
    "no device": ({"device": "/dev/nothing-here"}, "who may use the device"),
    "a folder": ({"device": "/tmp"}, "who may use the device"),
    "no terminal": ({"device": "/dev/null"}, "who may use the device"),
}


@pytest.mark.parametrize(("where", "remedy"), NOWHERE.values(), ids=NOWHERE)
def test_nobody_is_there(where, remedy):
    bus = ModbusBus(arm_at(transport="rtu" if "device" in where else "tcp", **where))
    with pytest.raises(TransportLostError, match=f"arm: no connection to .*{remedy}") as caught:
        bus.read(1, 0, 1)
    assert "\n" not in str(caught.value)


def test_a_reply_may_start_after_half_a_second(far, bus):
    def at_the_last_moment(frame, request):
        select.select([], [], [], 0.5)
        return well(frame, request)

    far.answers = [at_the_last_moment]
    began = time.monotonic()
    assert bus.read(1, 4, 2) == [1, 2]
    assert time.monotonic() - began >= 0.5


@settings(max_examples=40)
@given(st.lists(st.binary(max_size=40), min_size=1, max_size=4), st.booleans())
def test_whatever_comes_is_an_answer_or_a_fault(endless, replies, as_frame):
    far, bus = endless
    far.answers = [
        lambda frame, _, body=body: frame(body) if as_frame else body for body in replies
    ]
    for _ in replies:
        for request in (lambda: bus.read(1, 4, 2), lambda: bus.write(1, 4, [1, 2])):
            with contextlib.suppress(DeviceFaultError):
                request()


@pytest.fixture(scope="module", params=["tcp", "rtu"])
def endless(request):
    with pytest.MonkeyPatch.context() as patch, contextlib.closing(Far(request.param)) as end:
        patch.setattr(modbus, "_REPLY_TIMEOUT_S", 0.01)
        with contextlib.closing(ModbusBus(end.arm)) as bus:
            yield end, bus
