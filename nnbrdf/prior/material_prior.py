"""The prior: what materials look like, before one of them is measured."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import BadFileError
from gonio.files import write_with
from gonio.protocols import PriorKind
from nnbrdf.prior.family import Family, Settings, pivoted_cholesky
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.prior.geometry import Pairs

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SCHEMA = "gonio.prior/1"
EXAMPLES = 2000
ISOTROPIC_SHARE = 0.8
_EXPECTED = Settings(smooth=0.03, stretch=1.0, exchange=0.0, noise=0.01)
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
        shares = (ISOTROPIC_SHARE, 1 - ISOTROPIC_SHARE)
        return [
            PriorKind(family.name, share, *_factor(family, pairs, rank))
            for family, share in zip(self.families, shares, strict=True)
        ]

    def save(self, path: Path) -> None:
        """Write the examples' parameters as npz, without pickles."""
        arrays = {
            f"{family.name}.{field.name}": getattr(family.examples, field.name)
            for family in self.families
            for field in fields(GeneratedMaterials)
        }

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
                if str(file["schema"]) != SCHEMA:
                    raise BadFileError(path, f"has schema {file['schema']}, not {SCHEMA}", _REMEDY)
                isotropic, other = (
                    Family(name, _examples(dict(file), name))
                    for name in ("isotropic", "anisotropic")
                )
        except (OSError, ValueError, KeyError, EOFError) as error:
            raise BadFileError(path, f"is no prior ({error})", _REMEDY) from None
        return cls((isotropic, other))


def _examples(arrays: dict[str, Array], name: str) -> GeneratedMaterials:
    return GeneratedMaterials(
        *(arrays[f"{name}.{field.name}"] for field in fields(GeneratedMaterials))
    )


def _factor(family: Family, pairs: Pairs, rank: int) -> tuple[Array, NDArray[np.int64]]:
    """Return a factor of the covariance of the pairs that differ, and which each pair is."""
    distinct, which = family.distinct(pairs)
    traits = family.traits(distinct)
    variance = family.variances(traits).total(_EXPECTED)

    def column(index: int) -> Array:
        one = traits.part(np.array([index]))
        return family.covariances(traits, one, 1.0).total(_EXPECTED)[:, 0]

    return pivoted_cholesky(variance, column, rank), which
