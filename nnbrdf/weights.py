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
    from pathlib import Path

    from numpy.typing import NDArray

    from nnbrdf.card import Card

WEIGHTS_NAME = "weights.safetensors"


def write_weights(folder: Path, networks: Networks) -> None:
    """Write `layer_0`, `layer_1`, ..., float32, shape (members, outputs, inputs + 1) each."""
    tensors = {f"layer_{index}": layer for index, layer in enumerate(networks.layers)}
    write_bytes(folder / WEIGHTS_NAME, safetensors.numpy.save(tensors))


def read_weights(folder: Path, card: Card) -> Networks:
    """Read what `write_weights` wrote, and hold it against the card.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, truncated, or its tensors are not what the card says.
    """
    path = folder / WEIGHTS_NAME
    try:
        tensors = safetensors.numpy.load(path.read_bytes())
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", REMEDY) from None
    except (safetensors.SafetensorError, KeyError, ValueError, TypeError) as error:
        raise BadFileError(path, f"is broken ({error})", REMEDY) from None
    layers = tuple(_checked(tensors, *wanted, path) for wanted in _expected(card))
    return Networks(layers, card.activation)


def _expected(card: Card) -> list[tuple[str, tuple[int, ...]]]:
    members = len(card.final_losses)
    shapes = [(members, m, n + 1) for n, m in pairwise(card.layers)]
    return [(f"layer_{index}", shape) for index, shape in enumerate(shapes)]


def _checked(
    tensors: dict[str, NDArray[Any]], name: str, shape: tuple[int, ...], path: Path
) -> NDArray[Any]:
    if name not in tensors:
        raise BadFileError(path, f"{name}: is missing", REMEDY)
    tensor = tensors[name]
    if tensor.shape != shape or tensor.dtype != np.float32:
        found = f"{tensor.dtype} of shape {tensor.shape}"
        raise BadFileError(path, f"{name}: is {found}, not float32 of shape {shape}", REMEDY)
    if not np.isfinite(tensor).all():
        raise BadFileError(path, f"{name}: holds numbers that are not finite", REMEDY)
    return tensor
