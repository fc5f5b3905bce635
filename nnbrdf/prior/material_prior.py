"""The prior: what materials look like, before one of them is measured."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from gonio.errors import BadFileError, BadInputError
from gonio.files import write_with
from gonio.protocols import PriorKind
from nnbrdf.prior.family import Family, Settings, Traits, pivots_and_factor
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.stored import (
    digest_of,
    examples_arrays,
    families_from,
    learned_arrays,
    learned_from,
    origin_arrays,
)
from nnbrdf.prior.used import PriorUsed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from nnbrdf.prior.learned import LearnedMaterial

    Array = NDArray[np.float64]

SCHEMA = "gonio.prior/1"
EXAMPLES = 2000
KIND_SHARES = {"isotropic": 0.8, "anisotropic": 0.2}
EXPECTED = Settings(smooth=0.03, stretch=1.0, exchange=0.0, noise=0.01)
SOME_EXAMPLES, _FEW_EXAMPLES = 500, 125
"""Generated examples that choose pairs: 2000 would leave one per cent less, in thrice the time."""
_MANY, _LANDMARKS, _AT_ONCE = 20_000, 3000, 10_000
_REMEDY = "make it with: gonio prior build"
_BROKEN = (OSError, ValueError, EOFError, TypeError, BadZipFile, zlib.error, BadInputError)


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

    @property
    def learned(self) -> tuple[LearnedMaterial, ...]:
        """The materials that were measured."""
        # the second family has them all
        return self.families[1].learned

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the examples' parameters and weights, however they are kept in a file."""
        return digest_of(self._arrays)

    @property
    def used(self) -> PriorUsed:
        """What the card of a model records of the prior."""
        generated = sum(len(family.examples) for family in self.families)
        return PriorUsed(sha256=self.sha256, generated=generated, measured=len(self.learned))

    def save(self, path: Path) -> None:
        """Write the examples' parameters and weights as npz, without pickles, and their origin."""

        def write(aside: Path) -> None:
            with aside.open("wb") as file:
                arrays: dict[str, Any] = {"schema": np.array(SCHEMA), **self._arrays}
                arrays |= origin_arrays(self.learned)
                np.savez_compressed(file, **arrays)

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
                raise ValueError(f"it has schema {arrays['schema']}, not {SCHEMA}")
            return cls(families_from(arrays)).learn(learned_from(arrays))
        except FileNotFoundError:
            raise BadFileError(path, "no such file", _REMEDY) from None
        except KeyError as error:
            raise BadFileError(path, f"is no prior (it lacks {error.args[0]})", _REMEDY) from None
        except _BROKEN as error:
            # numpy would have people load such a file unsafely
            problem = "it is no npz of arrays" if "pickle" in str(error) else error
            raise BadFileError(path, f"is no prior ({problem})", _REMEDY) from None

    @property
    def _arrays(self) -> dict[str, NDArray[Any]]:
        return examples_arrays(self.families) | learned_arrays(self.learned)


def _factor(
    family: Family, pairs: Pairs, rank: int
) -> tuple[NDArray[Any], NDArray[np.int64], Array]:
    """Return a factor of the covariance of the pairs that differ, which each is, and the rest.

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
    if not many:
        return factor, which, _rest(variance, factor)
    return _spread(family, distinct, which, landmarks.part(pivots), factor[pivots])


def _rest(variance: Array, factor: NDArray[Any]) -> Array:
    return np.asarray((variance - np.einsum("ij,ij->i", factor, factor)).clip(0.0))


def thinned(family: Family, examples: int) -> Family:
    """Return the family with no more than so many of its generated examples, evenly taken."""
    rows = np.arange(0, len(family.examples), max(1, len(family.examples) // examples))
    return replace(family, examples=family.examples.select(rows))


def _spread(
    family: Family, distinct: Pairs, which: NDArray[np.int64], pivots: Traits, lower: Array
) -> tuple[NDArray[Any], NDArray[np.int64], Array]:
    """Return what `_factor` does, from the covariance with some and its lower factor there."""
    from scipy.linalg import solve_triangular

    # single precision: half a million rows of 150 numbers, and both kinds of them
    result = np.empty((len(distinct), len(lower)), np.float32)
    rest = np.empty(len(distinct))
    for start in range(0, len(distinct), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        traits = family.traits(distinct.part(rows))
        covariance = family.covariance(pivots, traits, EXPECTED)
        result[rows] = solve_triangular(lower, covariance, lower=True).T
        rest[rows] = _rest(family.variances(traits).total(EXPECTED), result[rows])
    return result, which, rest
