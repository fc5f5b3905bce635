"""The real wires: Modbus, a serial line, a camera, and who holds the rig."""

from __future__ import annotations

from gonio.wire.gphoto import GPhotoPort
from gonio.wire.lock import hold_rig
from gonio.wire.modbus import ModbusBus
from gonio.wire.serial_line import PortLine

__all__ = ["GPhotoPort", "ModbusBus", "PortLine", "hold_rig"]
