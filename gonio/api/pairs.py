"""Pairs of directions that a person asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_UNIT = 1e-6
_REMEDY = "gonio.directions.from_degrees makes directions of angles from the normal"


def checked_pairs(
    light: ArrayLike, view: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return both as arrays, shapes (..., 3), that can be broadcast against each other.

    Raises
    ------
    gonio.errors.BadInputError
        For what are no unit vectors (to 1e-6) with z >= 0, or do not fit together.
    """
    lights, views = _directions("light", light), _directions("view", view)
    try:
        np.broadcast_shapes(lights.shape, views.shape)
    except ValueError:
        raise BadInputError(
            f"light and view, of shapes {lights.shape} and {views.shape}, do not fit together; "
            "give one view for each light, or shapes that broadcast"
        ) from None
    return lights, views


def _directions(name: str, given: ArrayLike) -> NDArray[np.float64]:
    try:
        direction = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise BadInputError(f"{name} is no array of numbers; {_REMEDY}") from None
    if direction.ndim == 0 or direction.shape[-1] != 3:
        raise BadInputError(f"{name} is of shape {direction.shape}, not (..., 3); {_REMEDY}")
    # NaN is within no bound
    if not (np.abs(np.linalg.norm(direction, axis=-1) - 1.0) <= _UNIT).all():
        raise BadInputError(f"{name} holds what is no unit vector; {_REMEDY}")
    if (direction[..., 2] < 0).any():
        raise BadInputError(f"{name} holds directions below the sample (z < 0); {_REMEDY}")
    return direction
