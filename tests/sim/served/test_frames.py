"""Requests that no client library sends, byte for byte."""

import contextlib
import socket

import pytest
import serial
from pymodbus.framer import FramerRTU

# from the function code on; replies likewise
PDUS = {
    "a quantity of 0": ("03 0000 0000", "83 03"),
    "a quantity of 126": ("03 0000 007E", "83 03"),
    "a bad quantity before a bad address": ("03 0100 0000", "83 03"),
    "nothing written": ("10 0000 0000 00", "90 03"),
    "a byte count that is not the quantity's": ("10 0004 0002 02 0001", "90 03"),
    "read and write at once": ("17 0000 0001 0004 0002 04 0000 0001", "97 01"),
    "coils": ("01 0000 0001", "81 01"),
    "a mask": ("16 0000 FFFF 0000", "96 01"),
    "who are you": ("2B 0E 01 00", "AB 01"),
    "no function": ("00", "80 01"),
    "a reply": ("83 02", "83 01"),
    "beyond the last address": ("03 FFFF 0002", "83 02"),
}
OVER_TCP_ONLY = {
    "a body too short": ("03 0000 00", "83 03"),
    "a body too long": ("06 0010 0000 00", "86 03"),
    "a byte count that lies": ("10 0004 0002 02 0001 0002", "90 03"),
    "no words": ("10 0004 0002 04", "90 03"),
}


def mbap(request, transaction=0x1234, protocol=0, unit=1):
    header = (transaction, protocol, len(request) + 1)
    return b"".join(part.to_bytes(2, "big") for part in header) + bytes([unit]) + request


def rtu_frame(request, unit=1):
    frame = bytes([unit]) + request
    return frame + FramerRTU.compute_CRC(frame).to_bytes(2, "big")


@pytest.fixture
def port(tcp):
    with socket.create_connection((tcp.rig.arm.host, tcp.rig.arm.port), timeout=2.0) as port:
        yield port


@pytest.fixture
def wire(rtu):
    with serial.Serial(rtu.rig.arm.device, 115200, timeout=1.0) as wire:
        yield wire


ASK = bytes.fromhex("0300020001")
MODE = bytes.fromhex("03020000")


@pytest.mark.parametrize(("request_", "reply"), (PDUS | OVER_TCP_ONLY).values())
def test_over_tcp(port, request_, reply):
    port.sendall(mbap(bytes.fromhex(request_)))
    assert port.recv(300) == mbap(bytes.fromhex(reply))


@pytest.mark.parametrize(("request_", "reply"), PDUS.values())
def test_over_rtu(wire, request_, reply):
    expected = rtu_frame(bytes.fromhex(reply))
    wire.write(rtu_frame(bytes.fromhex(request_)))
    assert wire.read(len(expected)) == expected


def test_two_requests_in_one_packet_and_one_in_many(port, tcp, arrived):
    port.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    port.sendall(mbap(ASK, 1) + mbap(ASK, 2))
    for piece in (mbap(ASK, 3)[:5], mbap(ASK, 3)[5:9], mbap(ASK, 3)[9:]):
        port.sendall(piece)
        arrived(tcp)
    expected = b"".join(mbap(MODE, transaction) for transaction in (1, 2, 3))
    with port.makefile("rb") as answers:
        assert answers.read(len(expected)) == expected


def test_a_client_that_leaves_within_a_request_takes_nothing_with_it(tcp, port):
    with socket.create_connection((tcp.rig.arm.host, tcp.rig.arm.port)) as other:
        other.sendall(mbap(ASK) + mbap(ASK)[:9])
    port.sendall(mbap(ASK))
    assert port.recv(300) == mbap(MODE)


def test_another_protocol_is_passed_over(port):
    port.sendall(mbap(ASK, 1, protocol=7) + mbap(ASK, 2))
    assert port.recv(300) == mbap(MODE, 2)


@pytest.mark.parametrize("length", [0, 1, 255, 65535])
def test_a_length_that_cannot_be_ends_the_connection(port, length):
    port.sendall(b"\0\1\0\0" + length.to_bytes(2, "big") + b"\1" + ASK)
    with contextlib.suppress(ConnectionResetError):
        assert port.recv(300) == b""


def test_rtu_is_silent_after_a_bad_crc_and_after_garbage(wire):
    good = rtu_frame(ASK)
    wire.write(good[:-1] + bytes([good[-1] ^ 1]))
    assert wire.read(1) == b""
    wire.write(bytes(range(256)) * 4)
    assert wire.read(1) == b""
    wire.write(good)
    assert wire.read(7) == rtu_frame(MODE)


def test_rtu_is_silent_for_other_units_and_to_all(wire):
    for unit in (0, 9, 247):
        wire.write(rtu_frame(ASK, unit))
    assert wire.read(1) == b""


def test_a_request_in_pieces_over_rtu(wire, rtu, arrived):
    for piece in (rtu_frame(ASK)[:1], rtu_frame(ASK)[1:5], rtu_frame(ASK)[5:]):
        wire.write(piece)
        arrived(rtu)
    assert wire.read(7) == rtu_frame(MODE)
