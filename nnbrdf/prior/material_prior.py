"""The prior: what materials look like, before one of them is measured."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import count
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from gonio.errors import BadFileError
from gonio.files import write_with
from gonio.protocols import PriorKind
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.network import Networks
from nnbrdf.prior.family import Family, Settings, Traits, pivots_and_factor
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.learned import LearnedMaterial

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SCHEMA = "gonio.prior/1"
EXAMPLES = 2000
KIND_SHARES = {"isotropic": 0.8, "anisotropic": 0.2}
EXPECTED = Settings(smooth=0.03, stretch=1.0, exchange=0.0, noise=0.01)
SOME_EXAMPLES, _FEW_EXAMPLES = 500, 125
"""Generated examples that choose pairs: 2000 would leave one per cent less, in thrice the time."""
_MANY, _LANDMARKS, _AT_ONCE = 20_000, 3000, 10_000
_REMEDY = "make it with: gonio prior build"


@dataclass(frozen=True)
class MaterialPrior:
    """Two kinds of material, isotropic and any, each as examples drawn from a seed.

    Attributes
    ----------
    families
        The isotropic one first.
    """

    families: tuple[Family, Family]

    @classmethod
    def generate(cls, examples: int = EXAMPLES, seed: int = 0) -> MaterialPrior:
        """Draw `examples` materials of each kind."""
        return cls(
            (
                Family(
                    "isotropic", GeneratedMaterials.draw(examples, 2 * seed + 1, isotropic=True)
                ),
                Family("anisotropic", GeneratedMaterials.draw(examples, 2 * seed, isotropic=False)),
            )
        )

    def kinds(self, light: Array, view: Array, rank: int) -> list[PriorKind]:
        """Return the covariance of each kind at pairs (see `gonio.protocols.Prior`)."""
        pairs = Pairs.of(light, view)
        return [
            PriorKind(family.name, KIND_SHARES[family.name], *_factor(family, pairs, rank))
            for family in self.families
        ]

    def expected(self, light: Array, view: Array) -> tuple[Array, Array]:
        """Return mean and deviation of the logarithm at pairs (see `gonio.protocols.Prior`)."""
        pairs = Pairs.of(light, view)
        shares = np.array([KIND_SHARES[family.name] for family in self.families])
        told = [family.expected(pairs, EXPECTED) for family in self.families]
        mean, variance = (np.array(each) for each in zip(*told, strict=True))
        middle = shares @ mean
        return middle, np.sqrt(shares @ (variance + (mean - middle) ** 2))

    def learn(self, materials: Sequence[LearnedMaterial]) -> MaterialPrior:
        """Return the prior with materials that were measured added to what it has.

        Isotropic ones are examples of both kinds, the others of the second alone.
        """
        isotropic, other = self.families
        flat = tuple(each for each in materials if each.isotropic)
        return MaterialPrior(
            (
                replace(isotropic, learned=isotropic.learned + flat),
                replace(other, learned=other.learned + tuple(materials)),
            )
        )

    def save(self, path: Path) -> None:
        """Write the examples' parameters and weights as npz, without pickles."""
        arrays = {
            f"{family.name}.{field.name}": getattr(family.examples, field.name)
            for family in self.families
            for field in fields(GeneratedMaterials)
        }
        # the second family has them all
        for index, each in enumerate(self.families[1].learned):
            arrays |= _arrays_of(f"learned.{index}", each)

        def write(aside: Path) -> None:
            with aside.open("wb") as file:
                np.savez_compressed(file, schema=np.array(SCHEMA), **arrays)

        write_with(path, write)

    @classmethod
    def load(cls, path: Path) -> MaterialPrior:
        """Read what `save` wrote.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, broken, or none of these.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = dict(file)
            if str(arrays["schema"]) != SCHEMA:
                raise BadFileError(path, f"has schema {arrays['schema']}, not {SCHEMA}", _REMEDY)
            isotropic, other = (
                Family(name, _examples(arrays, name)) for name in ("isotropic", "anisotropic")
            )
            return cls((isotropic, other)).learn(_learned(arrays))
        except FileNotFoundError:
            raise BadFileError(path, "no such file", _REMEDY) from None
        except (OSError, ValueError, KeyError, EOFError, TypeError, BadZipFile) as error:
            # numpy would have people load such a file unsafely
            problem = "it is no npz of arrays" if "pickle" in str(error) else error
            raise BadFileError(path, f"is no prior ({problem})", _REMEDY) from None


def _examples(arrays: dict[str, Array], name: str) -> GeneratedMaterials:
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


def _arrays_of(prefix: str, material: LearnedMaterial) -> dict[str, Any]:
    layers = {f"{prefix}.layer.{i}": layer for i, layer in enumerate(material.network.layers)}
    return layers | {
        f"{prefix}.encoding": np.array(material.encoding),
        f"{prefix}.activation": np.array(material.network.activation),
        f"{prefix}.tint": material.tint,
    }


def _learned(arrays: dict[str, Array]) -> list[LearnedMaterial]:
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


def _factor(family: Family, pairs: Pairs, rank: int) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return a factor of the covariance of the pairs that differ, and which each pair is.

    Of very many pairs a few are drawn, which choose the columns, and the others follow from these
    (Nystroem's way; Williams and Seeger 2001), so that nothing grows with their square.
    """
    distinct, which = family.distinct(pairs)
    many = len(distinct) > _MANY
    family = thinned(family, _FEW_EXAMPLES if many else SOME_EXAMPLES)
    drawn = np.arange(len(distinct))
    if many:
        drawn = np.sort(np.random.default_rng(0).choice(drawn, _LANDMARKS, replace=False))
    landmarks = family.traits(distinct.part(drawn))
    variance = family.variances(landmarks).total(EXPECTED)

    def column(index: int) -> Array:
        one = landmarks.part(np.array([index]))
        return family.covariance(landmarks, one, EXPECTED)[:, 0]

    pivots, factor = pivots_and_factor(variance, column, rank)
    if many:
        factor = _spread(family, distinct, landmarks.part(pivots), factor[pivots])
    return factor, which


def thinned(family: Family, examples: int) -> Family:
    """Return the family with no more than so many of its generated examples, evenly taken."""
    rows = np.arange(0, len(family.examples), max(1, len(family.examples) // examples))
    return replace(family, examples=family.examples.select(rows))


def _spread(family: Family, distinct: Pairs, pivots: Traits, lower: Array) -> NDArray[Any]:
    """Return the factor at all pairs from the covariance with some and its lower factor there."""
    from scipy.linalg import solve_triangular

    # single precision: half a million rows of 150 numbers, and both kinds of them
    result = np.empty((len(distinct), len(lower)), np.float32)
    for start in range(0, len(distinct), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        covariance = family.covariance(pivots, family.traits(distinct.part(rows)), EXPECTED)
        result[rows] = solve_triangular(lower, covariance, lower=True).T
    return result
