"""A lamp's spectral mix: as its junction warms up, some colors fade more than others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_REFERENCE_C = 25.0


def spectral_mix(junction_c: float, red_per_c: float, blue_per_c: float) -> NDArray[np.float64]:
    """Return each channel's light relative to what the flux monitor says.

    A white lamp is a blue chip under a phosphor, which lose light at different rates (Schubert
    2006); here linearly about 25 deg C, where the mix is even.

    Parameters
    ----------
    junction_c
        Temperature in deg C.
    red_per_c, blue_per_c
        Change of red and of blue against green, relative, for each deg C.

    Returns
    -------
    ndarray
        Linear sRGB, shape (3,).
    """
    slope = np.array([red_per_c, 0.0, blue_per_c])
    mix: NDArray[np.float64] = 1.0 + slope * (junction_c - _REFERENCE_C)
    return mix
