"""Why an axis stopped, in words, and what a person can do about it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.devices.states import state_of

if TYPE_CHECKING:
    from gonio.devices.registers import DriveRegisters

_ERRORS = {
    0x2310: ("over-current", "find what blocks or drags the arm"),
    0x4310: ("over-temperature", "let the drive cool down and check its fan"),
    0x7500: ("communication lost, the drive's watchdog stopped it", "check the bus cable"),
    0x8611: ("following error", "find what blocks or drags the arm"),
}
_NEGATIVE_LIMIT, _POSITIVE_LIMIT, INTERLOCK_OPEN = 0x1, 0x2, 0x8


def cause_of(registers: DriveRegisters) -> tuple[str, str]:
    """Return the cause as far as the drive tells, and the remedy."""
    code = registers.read("error_code")
    inputs = registers.read("digital_inputs")
    if code:
        words, remedy = _ERRORS.get(code, ("see the drive's manual", "follow the drive's manual"))
        return f"error 0x{code:04X}, {words}", remedy
    if inputs & INTERLOCK_OPEN:
        return "interlock open", "close the door or release the emergency stop"
    if inputs & (_NEGATIVE_LIMIT | _POSITIVE_LIMIT):
        end = "negative" if inputs & _NEGATIVE_LIMIT else "positive"
        return f"{end} limit switch", "compare travel and zero_counts in the rig file"
    state = state_of(registers.read("statusword"))
    return f"drive is in '{state.value}'", "check that nothing else drives this rig"
