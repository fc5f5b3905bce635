"""Drivers of arm, lamps and camera, each talking through a transport."""

from __future__ import annotations

from gonio.devices.arm import Arm
from gonio.devices.camera import FolderCamera
from gonio.devices.folder import LocalFolder
from gonio.devices.lamps import Exposure, Identity, LampHead

__all__ = ["Arm", "Exposure", "FolderCamera", "Identity", "LampHead", "LocalFolder"]
