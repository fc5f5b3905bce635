"""A prior as arrays by name: what its file holds, what is checked of it, and its hash."""

from __future__ import annotations

import hashlib
from dataclasses import fields
from itertools import count, takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import Networks
from nnbrdf.prior.family import Family, grid_pairs
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.learned import LearnedMaterial

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[Any]]

_EXAMPLES = ("isotropic", "anisotropic")
_ORIGIN = ("source", "sha256")
_FEWEST = 10
LARGEST = 1e6
"""Of tints: they only say how channels differ."""
LARGEST_LOG = 50.0
"""Of the logarithms that a network says, either way: exp(50) is far beyond any mirror."""
_WEIGHT, _TURN = (0.0, 10.0), (-2 * np.pi, 2 * np.pi)
_RANGES = {
    "body": (0.0, 1.0), "roughness": (0.0, np.pi / 2), "limb": (-1.0, 1.0), "coat": (0.0, 1.0),
    "lobe": _WEIGHT, "alpha_x": (1e-3, 10.0), "alpha_y": (1e-3, 10.0), "rotation": _TURN,
    "f0": (0.0, 1.0), "tail": (0.0, 10.0), "sheen": _WEIGHT, "sheen_power": (0.0, 1000.0),
    "retro": _WEIGHT, "retro_power": (0.0, 1000.0), "fiber": _WEIGHT,
    "fiber_width": (1e-3, 10.0), "fiber_rotation": _TURN,
}  # fmt: skip
"""Of each parameter, wider than what is drawn; what lies beyond is no material."""


def examples_arrays(families: Iterable[Family]) -> dict[str, NDArray[Any]]:
    """Return the parameters of the generated examples, shape (n, ...) each, by name."""
    return {
        f"{family.name}.{field.name}": getattr(family.examples, field.name)
        for family in families
        for field in fields(GeneratedMaterials)
    }


def learned_arrays(materials: Iterable[LearnedMaterial]) -> dict[str, NDArray[Any]]:
    """Return the networks of measured materials, by name."""
    arrays: dict[str, NDArray[Any]] = {}
    for index, each in enumerate(materials):
        prefix = f"learned.{index}"
        arrays |= {f"{prefix}.layer.{i}": layer for i, layer in enumerate(each.network.layers)}
        arrays |= {
            f"{prefix}.encoding": np.array(each.encoding),
            f"{prefix}.activation": np.array(each.network.activation),
            f"{prefix}.tint": each.tint,
        }
    return arrays


def origin_arrays(materials: Iterable[LearnedMaterial]) -> dict[str, NDArray[Any]]:
    """Return which models measured materials are of, by name; no part of what a prior says."""
    return {
        f"learned.{index}.{name}": np.array(getattr(each, name))
        for index, each in enumerate(materials)
        for name in _ORIGIN
    }


def digest_of(arrays: Arrays) -> str:
    """Return the SHA-256 of arrays with their names, types and shapes, in hexadecimal."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def families_from(arrays: Arrays) -> tuple[Family, Family]:
    """Return the families of generated examples.

    Raises
    ------
    ValueError, KeyError
        For arrays that are none.
    """
    isotropic, other = (Family(name, _examples(arrays, name)) for name in _EXAMPLES)
    return isotropic, other


def learned_from(arrays: Arrays) -> list[LearnedMaterial]:
    """Return the measured materials.

    Raises
    ------
    ValueError, KeyError, gonio.errors.BadInputError
        For arrays that are none.
    """
    every = (f"learned.{index}" for index in count())
    prefixes = takewhile(lambda prefix: f"{prefix}.encoding" in arrays, every)
    return [_learned(arrays, prefix) for prefix in prefixes]


def _learned(arrays: Arrays, prefix: str) -> LearnedMaterial:
    depth = sum(name.startswith(f"{prefix}.layer.") for name in arrays)
    layers = tuple(_numbers(arrays, f"{prefix}.layer.{i}") for i in range(depth))
    encoding, tint = str(arrays[f"{prefix}.encoding"]), _numbers(arrays, f"{prefix}.tint")
    if not layers or any(layer.ndim != 3 or len(layer) != 1 for layer in layers):
        raise ValueError(f"{prefix} is not one network")
    network = Networks(layers, str(arrays[f"{prefix}.activation"]))
    if encoding not in HALFWAY or network.sizes[0] != HALFWAY_INPUTS[encoding]:
        raise ValueError(f"{prefix}.encoding is none, or has other inputs than the network")
    if tint.shape != network.sizes[-1:] or not ((tint > 0) & (tint <= LARGEST)).all():
        raise ValueError(f"{prefix}.tint is not a positive number for each output")
    if not _is_plausible(network, encoding):
        raise ValueError(f"{prefix} is no material: its values are beyond all bounds")
    origin = [str(arrays.get(f"{prefix}.{name}", "")) for name in _ORIGIN]
    return LearnedMaterial(network, encoding, tint, *origin)


def _is_plausible(network: Networks, encoding: str) -> bool:
    """Tell whether a network stays within what a material may be on the grid, either way round."""
    grid = grid_pairs()
    with np.errstate(all="ignore"):
        told = [
            network.forward(HALFWAY[encoding](*order))
            for order in ((grid.light, grid.view), (grid.view, grid.light))
        ]
    # false for what is not a number, too
    return all(bool((np.abs(log) <= LARGEST_LOG).all()) for log in told)


def _numbers(arrays: Arrays, name: str) -> NDArray[Any]:
    """Return an array of finite floating-point numbers.

    Raises
    ------
    ValueError, KeyError
        Where it holds anything else, or is missing.
    """
    array = arrays[name]
    if array.dtype.kind != "f" or not np.isfinite(array).all():
        raise ValueError(f"{name} holds other than finite numbers")
    return array


def _examples(arrays: Arrays, name: str) -> GeneratedMaterials:
    columns = {
        field.name: _numbers(arrays, f"{name}.{field.name}").astype(np.float64)
        for field in fields(GeneratedMaterials)
    }
    drawn = GeneratedMaterials.draw(1, 0, isotropic=True)
    for field, column in columns.items():
        shape = (columns["body"].size, *getattr(drawn, field).shape[1:])
        if column.shape != shape:
            raise ValueError(f"{name}.{field} is not of shape {shape}")
        _refuse_implausible(f"{name}.{field}", column, *_RANGES[field])
    if columns["body"].size < _FEWEST:
        raise ValueError(f"fewer than {_FEWEST} {name} examples tell nothing of materials")
    examples = GeneratedMaterials(**columns)
    with np.errstate(all="ignore"):
        white = Family(name, examples).white
    if not (np.isfinite(white) & (white > 0)).all():
        raise ValueError(f"{np.sum(~(white > 0))} {name} examples are no materials")
    return examples


def _refuse_implausible(name: str, column: NDArray[Any], low: float, high: float) -> None:
    bad = column[(column < low) | (column > high)]
    if bad.size:
        raise ValueError(f"{name} is {bad[0]:g}, which is not within {low:g} to {high:g}")
