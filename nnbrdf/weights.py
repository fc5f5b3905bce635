"""`weights.safetensors`: the layers of all members."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import safetensors
import safetensors.numpy

from gonio.errors import BadFileError
from gonio.files import write_bytes
from nnbrdf.card import REMEDY
from nnbrdf.network import Networks

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from nnbrdf.card import Card

WEIGHTS_NAME = "weights.safetensors"


def write_weights(folder: Path, networks: Networks) -> None:
    """Write `layer_0`, `layer_1`, ..., float32, shape (members, outputs, inputs + 1) each."""
    write_tensors(folder, {f"layer_{index}": layer for index, layer in enumerate(networks.layers)})


def read_weights(folder: Path, card: Card) -> Networks:
    """Read what `write_weights` wrote, and hold it against the card.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, truncated, or its tensors are not what the card says.
    """
    tensors = read_tensors(folder, shapes_of(card.layers, len(card.final_losses)))
    return Networks(tuple(tensors.values()), card.activation)


def write_tensors(folder: Path, tensors: dict[str, NDArray[Any]]) -> None:
    """Write arrays by name."""
    whole = {name: np.ascontiguousarray(tensor) for name, tensor in tensors.items()}
    write_bytes(folder / WEIGHTS_NAME, safetensors.numpy.save(whole))


def read_tensors(
    folder: Path, shapes: dict[str, tuple[int, ...]], dtype: type[np.generic] = np.float32
) -> dict[str, NDArray[Any]]:
    """Read arrays, in the order of the names and shapes that are expected.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, truncated, or its tensors are not what is expected.
    """
    path = folder / WEIGHTS_NAME
    try:
        tensors = safetensors.numpy.load(path.read_bytes())
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", REMEDY) from None
    except (safetensors.SafetensorError, KeyError, ValueError, TypeError) as error:
        raise BadFileError(path, f"is broken ({error})", REMEDY) from None
    return {name: _checked(tensors, name, shape, dtype, path) for name, shape in shapes.items()}


def shapes_of(sizes: Sequence[int], members: int, prefix: str = "") -> dict[str, tuple[int, ...]]:
    """Return the shapes of a stack's layers by their names in the file."""
    return {
        f"{prefix}layer_{index}": (members, m, n + 1)
        for index, (n, m) in enumerate(pairwise(sizes))
    }


def _checked(
    tensors: dict[str, NDArray[Any]],
    name: str,
    shape: tuple[int, ...],
    dtype: type[np.generic],
    path: Path,
) -> NDArray[Any]:
    if name not in tensors:
        raise BadFileError(path, f"{name}: is missing", REMEDY)
    tensor = tensors[name]
    if tensor.shape != shape or tensor.dtype != dtype:
        found = f"{tensor.dtype} of shape {tensor.shape}"
        raise BadFileError(
            path, f"{name}: is {found}, not {np.dtype(dtype)} of shape {shape}", REMEDY
        )
    if not np.isfinite(tensor).all():
        raise BadFileError(path, f"{name}: holds numbers that are not finite", REMEDY)
    return tensor
