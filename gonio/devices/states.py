"""The drive profile CiA 402 as a driver sees it: states and controlwords."""

from __future__ import annotations

from enum import Enum

SHUTDOWN, SWITCH_ON, ENABLE_OPERATION = 0x0006, 0x0007, 0x000F
DISABLE_VOLTAGE, QUICK_STOP, FAULT_RESET = 0x0000, 0x0002, 0x0080
START = ENABLE_OPERATION | 0x0010
"""Enable operation with bit 4: a new set-point, or the start of homing."""

TARGET_REACHED, LIMIT_ACTIVE = 1 << 10, 1 << 11
ACKNOWLEDGED = HOMING_ATTAINED = 1 << 12
FOLLOWING_ERROR = HOMING_ERROR = 1 << 13

PROFILE_POSITION, HOMING = 1, 6


class DriveState(Enum):
    """The eight states, as manuals call them."""

    NOT_READY = "not ready to switch on"
    SWITCH_ON_DISABLED = "switch on disabled"
    READY = "ready to switch on"
    SWITCHED_ON = "switched on"
    ENABLED = "operation enabled"
    QUICK_STOP = "quick stop active"
    FAULT_REACTION = "fault reaction active"
    FAULT = "fault"


_UNDER_4F = {
    0x00: DriveState.NOT_READY,
    0x40: DriveState.SWITCH_ON_DISABLED,
    0x0F: DriveState.FAULT_REACTION,
    0x08: DriveState.FAULT,
}
_UNDER_6F = {
    0x21: DriveState.READY,
    0x23: DriveState.SWITCHED_ON,
    0x27: DriveState.ENABLED,
    0x07: DriveState.QUICK_STOP,
}

STEPS = {
    DriveState.SWITCH_ON_DISABLED: (SHUTDOWN,),
    DriveState.READY: (SWITCH_ON,),
    DriveState.SWITCHED_ON: (ENABLE_OPERATION,),
    # the reset is a rising edge
    DriveState.FAULT: (DISABLE_VOLTAGE, FAULT_RESET),
}
"""What to write in each state to come one transition nearer to *operation enabled*."""

MOVING_BY_ITSELF = (DriveState.QUICK_STOP, DriveState.FAULT_REACTION)
"""States in which the drive is on its way to standstill and obeys nothing."""


def state_of(statusword: int) -> DriveState:
    """Return the state in a statusword.

    Bits outside the two masks may be anything. A pattern that the profile does not have counts as
    *not ready*.
    """
    state = _UNDER_4F.get(statusword & 0x4F) or _UNDER_6F.get(statusword & 0x6F)
    return state or DriveState.NOT_READY
