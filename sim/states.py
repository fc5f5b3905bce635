"""The drive's state machine: states, commands and transitions of CiA 402 (IEC 61800-7-201)."""

from __future__ import annotations

from enum import Enum


class State(Enum):
    """The eight states; the value is what each puts into the statusword."""

    NOT_READY = 0x0000
    SWITCH_ON_DISABLED = 0x0040
    READY = 0x0021
    SWITCHED_ON = 0x0023
    ENABLED = 0x0027
    QUICK_STOP = 0x0007
    FAULT_REACTION = 0x000F
    FAULT = 0x0008


class Command(Enum):
    """What the four lowest bits of the controlword ask for."""

    SHUTDOWN = "x110"
    SWITCH_ON = "0111"
    ENABLE = "1111"
    DISABLE_VOLTAGE = "xx0x"
    QUICK_STOP = "x01x"


_NEXT = {
    (State.SWITCH_ON_DISABLED, Command.SHUTDOWN): State.READY,
    (State.READY, Command.SWITCH_ON): State.SWITCHED_ON,
    # the profile lets one command take transitions 3 and 4 together
    (State.READY, Command.ENABLE): State.ENABLED,
    (State.READY, Command.QUICK_STOP): State.SWITCH_ON_DISABLED,
    (State.READY, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.SWITCHED_ON, Command.ENABLE): State.ENABLED,
    (State.SWITCHED_ON, Command.SHUTDOWN): State.READY,
    (State.SWITCHED_ON, Command.QUICK_STOP): State.SWITCH_ON_DISABLED,
    (State.SWITCHED_ON, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.ENABLED, Command.SWITCH_ON): State.SWITCHED_ON,
    (State.ENABLED, Command.SHUTDOWN): State.READY,
    (State.ENABLED, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
    (State.ENABLED, Command.QUICK_STOP): State.QUICK_STOP,
    (State.QUICK_STOP, Command.DISABLE_VOLTAGE): State.SWITCH_ON_DISABLED,
}


def command_of(controlword: int) -> Command:
    """Return the command in a controlword."""
    if not controlword & 0b0010:
        return Command.DISABLE_VOLTAGE
    if not controlword & 0b0100:
        return Command.QUICK_STOP
    if not controlword & 0b0001:
        return Command.SHUTDOWN
    return Command.ENABLE if controlword & 0b1000 else Command.SWITCH_ON


def next_state(state: State, command: Command) -> State:
    """Return where a command leads; a command that a state does not know changes nothing."""
    return _NEXT.get((state, command), state)
