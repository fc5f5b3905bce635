"""Frames of Modbus and of cameras as bytes, so that what spoils one is found out as it would be."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


def sealed(content: bytes) -> bytes:
    """Return a frame of Modbus RTU: `content` and its CRC-16 (Modbus over serial line, 6.2.2)."""
    return content + struct.pack("<H", _crc16(content))


def is_intact(frame: bytes) -> bool:
    """Return whether a frame of Modbus RTU carries the CRC of its content."""
    return len(frame) > 2 and sealed(frame[:-2]) == frame


def flipped(data: bytes, random: np.random.Generator) -> bytes:
    """Return bytes with one bit of them flipped."""
    bit = int(random.integers(8 * len(data)))
    spoiled = bytearray(data)
    spoiled[bit // 8] ^= 1 << bit % 8
    return bytes(spoiled)


def dropped(data: bytes, random: np.random.Generator) -> bytes:
    """Return bytes without one of them."""
    at = int(random.integers(len(data)))
    return data[:at] + data[at + 1 :]


def doubled(data: bytes, random: np.random.Generator) -> bytes:
    """Return bytes with one of them twice."""
    at = int(random.integers(len(data)))
    return data[: at + 1] + data[at:]


def broken(file: bytes, kind: str, random: np.random.Generator) -> bytes:
    """Return what a kind of fault leaves of a camera's file; most leave it whole."""
    if kind == "frame truncated":
        return file[: len(file) // 2]
    if kind == "frame bit-flipped":
        pixels = 7 * len(file) // 8  # what follows is nothing else
        return file[:pixels] + flipped(file[pixels:], random)
    return file


def _crc16(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc
