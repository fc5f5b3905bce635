"""Samples as a CSV table, of the BRDF or of the reflectance factor, which is pi times that."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.directions import to_degrees
from gonio.errors import BadInputError
from gonio.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.samples import Samples

FACTORS: Final = {"brdf": 1.0, "reflectance-factor": np.pi}
"""By quantity, what its values are times the BRDF in 1/sr.

A perfect diffuser's BRDF is 1/pi, and the reflectance factor is a sample's radiance over that of a
perfect diffuser in the same light (Nicodemus et al. 1977, NBS Monograph 160, section II.F).
"""

_PREFIX: Final = {"brdf": "", "reflectance-factor": "reflectance_factor_"}


def write_table(path: Path, samples: Samples, quantity: str) -> None:
    """Write one row a sample, whole or not at all.

    Columns are the four angles in degrees, value and sigma of each channel, and the color space.
    Those of the BRDF are named as `gonio reconstruct` reads them, `r` and `sigma_r`; those of the
    reflectance factor `reflectance_factor_r` and `sigma_reflectance_factor_r`, so that nobody takes
    one for the other.

    Parameters
    ----------
    path
        The table.
    samples
        In 1/sr.
    quantity
        A key of `FACTORS`.

    Raises
    ------
    gonio.errors.StorageError
        When it cannot be written.
    """
    table = columns(samples, quantity)
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(table)
    rows.writerows(zip(*table.values(), strict=True))
    write_bytes(path, text.getvalue().encode())


def columns(samples: Samples, quantity: str) -> dict[str, list[float] | list[str]]:
    """Return the columns of the table by their names (see `write_table`)."""
    if quantity not in FACTORS:
        raise BadInputError(f"quantity {quantity!r} is not known; use {', '.join(FACTORS)}")
    names = [_PREFIX[quantity] + channel for channel in samples.channels]
    heads = [
        *(f"{side}_{angle}_deg" for side in ("light", "view") for angle in ("theta", "phi")),
        *names,
        *(f"sigma_{name}" for name in names),
    ]
    angles = [*to_degrees(samples.light), *to_degrees(samples.view)]
    scaled = FACTORS[quantity] * np.hstack([samples.value, samples.sigma])
    numbers = np.vstack([angles, scaled.T]).tolist()
    return {
        **dict(zip(heads, numbers, strict=True)),
        "color_space": [samples.color_space] * len(samples),
    }
