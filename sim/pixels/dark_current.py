"""Dark current: electrons that heat makes."""

from __future__ import annotations

AMBIENT_C = 23.0
"""Of the room, in which a rested sensor is."""

_REFERENCE_C = 25.0


def dark_rate(temperature_c: float, at_25_c: float, doubling_c: float) -> float:
    """Return electrons a second: they double with every few degrees (EMVA Standard 1288).

    Parameters
    ----------
    temperature_c
        Of the sensor.
    at_25_c
        Electrons a second at 25 deg C.
    doubling_c
        Degrees that double it.
    """
    rate: float = at_25_c * 2.0 ** ((temperature_c - _REFERENCE_C) / doubling_c)
    return rate
