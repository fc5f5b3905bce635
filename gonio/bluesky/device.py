"""What the devices of Bluesky share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gonio.bluesky.status import Worker
    from gonio.capture import Instrument

    Readings = dict[str, dict[str, Any]]


class Device:
    """What all four share: a name, no parent, and the rig's thread."""

    parent = None

    def __init__(self, name: str, instrument: Instrument, worker: Worker) -> None:
        self.name = name
        self._instrument = instrument
        self._worker = worker

    def _readings(self, values: Mapping[str, object]) -> Readings:
        now = self._instrument.clock.utc().timestamp()
        return {f"{self.name}_{key}": {"value": v, "timestamp": now} for key, v in values.items()}

    def _keys(self, shapes: Mapping[str, tuple[str, list[int], str | None]]) -> Readings:
        return {
            f"{self.name}_{key}": {"source": f"gonio:{self.name}", "dtype": dtype, "shape": shape}
            | ({} if units is None else {"units": units})
            for key, (dtype, shape, units) in shapes.items()
        }
