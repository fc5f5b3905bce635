"""Modbus TCP and RTU by pymodbus."""

from __future__ import annotations

import contextlib
import logging
from typing import TYPE_CHECKING, Any

from gonio.errors import RegisterError, TransportLostError, TransportTimeoutError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from gonio.rig import Arm

# a unit's reply starts within 0.5 s, and has its way on the wire then
_REPLY_TIMEOUT_S = 0.6
_BAUD = 115200
_READ, _WRITE, _REFUSED = 3, 16, 0x80


class ModbusBus:
    """A `gonio.transports.RegisterBus` over a real wire; it connects when it is first asked.

    A connection that broke is made anew at the next request.

    Parameters
    ----------
    arm
        Says where the drives are.
    """

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._client: Any = None
        # it says in a log of its own what the errors raised here say as well
        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

    def read(self, unit: int, address: int, count: int) -> list[int]:
        """Read registers (see `gonio.transports.RegisterBus`)."""
        answer = self._ask(
            unit,
            address,
            _READ,
            lambda client: client.read_holding_registers(address, count=count, device_id=unit),
        )
        registers: list[int] = answer.registers
        if len(registers) != count:
            raise self._silent(unit)
        return registers

    def write(self, unit: int, address: int, values: Sequence[int]) -> None:
        """Write registers (see `gonio.transports.RegisterBus`)."""
        words = list(values)
        answer = self._ask(
            unit,
            address,
            _WRITE,
            lambda client: client.write_registers(address, words, device_id=unit),
        )
        if (answer.address, answer.count) != (address, len(words)):
            raise self._silent(unit)

    def close(self) -> None:
        """Let go of the bus."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def _ask(self, unit: int, address: int, function: int, request: Callable[[Any], Any]) -> Any:
        from pymodbus.exceptions import ConnectionException, ModbusException

        client = self._connected()
        try:
            answer = request(client)
        except (ConnectionException, OSError):
            self.close()
            raise self._gone() from None
        except ModbusException:
            # whatever came or did not: an answer to this request it is not
            raise self._silent(unit) from None
        # RTU replies have no number: a late one of an earlier request is told by what it says
        if answer.function_code & ~_REFUSED != function:
            raise self._silent(unit)
        if answer.isError():
            raise RegisterError(unit, address, answer.exception_code)
        return answer

    def _connected(self) -> Any:
        if self._client is None:
            client = self._new_client()
            # a name that no host can have is a UnicodeError
            with contextlib.suppress(UnicodeError):
                if client.connect():
                    self._client = client
                    return client
            raise self._gone()
        return self._client

    def _new_client(self) -> Any:
        # asking again is the drivers' part, who read back first
        if self._arm.transport == "tcp":
            from pymodbus.client import ModbusTcpClient

            return ModbusTcpClient(
                self._arm.host or "", port=self._arm.port or 0, timeout=_REPLY_TIMEOUT_S, retries=0
            )
        from pymodbus.client import ModbusSerialClient

        return ModbusSerialClient(
            self._arm.device or "", baudrate=_BAUD, timeout=_REPLY_TIMEOUT_S, retries=0
        )

    def _gone(self) -> TransportLostError:
        arm = self._arm
        if arm.transport == "tcp":
            where, what = f"{arm.host}:{arm.port}", "host and port"
        else:
            where, what = str(arm.device), "who may use the device, and its name"
        return TransportLostError(
            f"arm: no connection to {where}; switch the controller on, and check the cable, {what} "
            "in the rig file"
        )

    def _silent(self, unit: int) -> TransportTimeoutError:
        return TransportTimeoutError(
            f"unit {unit}: no sound reply within {_REPLY_TIMEOUT_S:g} s; check the cable, and the "
            "unit in the rig file"
        )
