"""Calibrating a camera on its rig: frames taken, and what they say of the sensor."""

from __future__ import annotations

from gonio.calibrate.run import calibrate_rig

__all__ = ["calibrate_rig"]
