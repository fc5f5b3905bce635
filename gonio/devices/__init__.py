"""Drivers of arm, lamps and camera, each talking through a transport."""

from __future__ import annotations

from gonio.devices.arm import Arm
from gonio.devices.attended import AttendedClock
from gonio.devices.camera import FolderCamera
from gonio.devices.folder import LocalFolder
from gonio.devices.lamps import Exposure, Identity, LampHead
from gonio.devices.latent import Camera, LatentFrame
from gonio.devices.meanwhile import MeanwhileClock
from gonio.devices.tethered import TetheredCamera
from gonio.devices.troubles import Troubles

__all__ = [
    "Arm", "AttendedClock", "Camera", "Exposure", "FolderCamera", "Identity", "LampHead",
    "LatentFrame", "LocalFolder", "MeanwhileClock", "TetheredCamera", "Troubles",
]  # fmt: skip
