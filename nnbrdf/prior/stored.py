"""A prior as arrays by name: what its file holds, what is checked of it, and its hash."""

from __future__ import annotations

import hashlib
from dataclasses import fields
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import Networks
from nnbrdf.prior.family import Family
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.learned import LearnedMaterial

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[Any]]

_EXAMPLES = ("isotropic", "anisotropic")


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
    result: list[LearnedMaterial] = []
    for index in count():
        prefix = f"learned.{index}"
        if f"{prefix}.encoding" not in arrays:
            return result
        depth = sum(name.startswith(f"{prefix}.layer.") for name in arrays)
        layers = tuple(arrays[f"{prefix}.layer.{i}"] for i in range(depth))
        encoding = str(arrays[f"{prefix}.encoding"])
        if encoding not in HALFWAY or not all(np.isfinite(layer).all() for layer in layers):
            raise ValueError(f"learned material {index} cannot be evaluated")
        network = Networks(layers, str(arrays[f"{prefix}.activation"]))
        if network.sizes[0] != HALFWAY_INPUTS[encoding]:
            raise ValueError(f"learned material {index} has other inputs")
        result.append(LearnedMaterial(network, encoding, arrays[f"{prefix}.tint"]))
    return result


def _examples(arrays: Arrays, name: str) -> GeneratedMaterials:
    columns = [arrays[f"{name}.{field.name}"].astype(float) for field in fields(GeneratedMaterials)]
    examples = GeneratedMaterials(*columns)
    drawn = GeneratedMaterials.draw(1, 0, isotropic=True)
    for field, column in zip(fields(GeneratedMaterials), columns, strict=True):
        shape = (len(examples), *getattr(drawn, field.name).shape[1:])
        if column.shape != shape or not len(examples) or not np.isfinite(column).all():
            raise ValueError(f"{name}.{field.name} is not finite and of shape {shape}")
    with np.errstate(all="ignore"):
        white = Family(name, examples).white
    if not (np.isfinite(white) & (white > 0)).all():
        raise ValueError(f"{np.sum(~(white > 0))} {name} examples are no materials")
    return examples
