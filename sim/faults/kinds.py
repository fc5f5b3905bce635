"""The kinds of fault, and what each is counted per."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Place = Literal["bus", "line", "axis", "rig", "lamp", "camera", "folder"]


@dataclass(frozen=True)
class Kind:
    """One kind of fault.

    Attributes
    ----------
    place
        Where it strikes: the drives' bus, the lamps' line, an axis, all of the rig, a lamp, the
        camera, or the folder of its files.
    per
        What a rate counts.
    summary
        What happens.
    lasts_s
        For how long unless the file says otherwise; 0 where it is over at once.
    """

    place: Place
    per: str
    summary: str
    lasts_s: float = 0.0


KINDS: dict[str, Kind] = {
    "bus time-out": Kind("bus", "request", "request or reply is lost; which, chance decides"),
    "bus CRC error": Kind("bus", "request", "a bit of request or reply flips"),
    "bus bytes dropped": Kind("bus", "request", "a byte of request or reply is lost"),
    "bus bytes doubled": Kind("bus", "request", "a byte of request or reply comes twice"),
    "bus bytes delayed": Kind("bus", "request", "the reply comes after the time-out", 0.7),
    "bus wrong transaction": Kind("bus", "request", "the reply carries another transaction id"),
    "bus exception reply": Kind("bus", "request", "the drive is busy and answers exception 6"),
    "stale registers": Kind("bus", "read", "the reply holds what was read there before"),
    "encoder glitch": Kind("bus", "reading of an angle", "one reading is far off"),
    "line time-out": Kind("line", "request", "request or answer is lost; which, chance decides"),
    "line bytes garbled": Kind("line", "request", "a bit of request or answer flips"),
    "line bytes dropped": Kind("line", "request", "a byte of request or answer is lost"),
    "line bytes doubled": Kind("line", "request", "a byte of request or answer comes twice"),
    "line answer doubled": Kind("line", "request", "the answer comes twice"),
    "line bytes delayed": Kind("line", "request", "the answer comes after the time-out", 0.7),
    "serial port unplugged": Kind("line", "request", "the port is gone for a while", 5.0),
    "lost steps": Kind("axis", "move", "the load falls behind by a degree and stays there"),
    "stall": Kind("axis", "move", "something holds the load", 3.0),
    "following error": Kind("axis", "move", "the drive faults with 0x8611"),
    "limit hit": Kind("axis", "move", "a limit switch closes", 1.0),
    "watchdog expiry": Kind("axis", "move", "the drive faults with 0x7500"),
    "power cut": Kind("rig", "move", "all drives restart, and their positions are lost"),
    "interlock": Kind("rig", "exposure", "somebody opens the door, and closes it", 20.0),
    "lamp open": Kind("lamp", "exposure", "a lamp's contact is broken for a while", 2.0),
    "lamp over-temperature": Kind("lamp", "exposure", "a lamp gets too hot and switches off"),
    "flux drift": Kind("lamp", "exposure", "a lamp gives 3 % less from now on"),
    "camera busy": Kind("camera", "exposure", "the camera refuses to expose", 1.0),
    "frame missing": Kind("folder", "frame", "the file never comes"),
    "frame late": Kind("folder", "frame", "the file comes late", 3.0),
    "frame truncated": Kind("folder", "frame", "the file ends early"),
    "frame bit-flipped": Kind("folder", "frame", "one bit of its pixels flips on the way"),
    "disk full": Kind("folder", "frame", "the disk is full when the file is moved"),
}
"""By the name that a file of faults uses."""
