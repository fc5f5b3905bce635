"""What a format is, and what is written to one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from gonio.directions import paper_directions
from gonio.exchange.isotropy import Averaged, anisotropy_of_grid
from gonio.materials import MeasuredTable
from gonio.samples import SMALLEST_WHITE, WHITE_PER_MEDIAN

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Material, Progress


class Write(Protocol):
    """Writes a source to a file, whole or not at all."""

    def __call__(self, source: Source, path: Path, progress: Progress | None) -> None:
        """Write the file; `progress` is told of how many evaluations of how many are done."""


class Knows(Protocol):
    """A material that knows how sure it is."""

    def sigma(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return one standard uncertainty in 1/sr, shape (..., 3)."""


@dataclass(frozen=True)
class Format:
    """A file format of another program.

    Attributes
    ----------
    name
        What a person types after --to.
    suffix
        With the dot.
    title
        What it is and who reads it, in half a line.
    keeps, loses
        What of a material it holds and what not: isotropy, angular range, colour, sigma.
    write
        Writes one; None where gonio only reads it.
    read
        Makes a material of a file, for `gonio import` and to measure what an export lost; None
        where that cannot be. Raises `gonio.errors.BadFileError`.
    claims
        Tells from the first 64 kB of a file and its size in bytes whether it is one.
    anisotropic
        Whether it holds materials that change when they are turned.
    sigma
        Whether it holds sigma.
    """

    name: str
    suffix: str
    title: str
    keeps: str
    loses: str
    write: Write | None
    read: Callable[[Path], Material] | None
    claims: Callable[[bytes, int], bool] | None = None
    anisotropic: bool = True
    sigma: bool = False


@dataclass(frozen=True)
class Source:
    """A material to be exported.

    Attributes
    ----------
    material
        Its reflectance.
    name
        For the file's name and its description.
    color_space
        What its channels are.
    stated_white
        Exposure scale of the error metrics in 1/sr; None: 4 x the median over the 81 x 81 pairs.
    uncertain
        What knows its sigma; None where nothing does.
    model
        Folder of the model that it is; None where it is none.
    file
        The file that it was read from; None where it was none.
    sigma_lost
        Why its sigma is not known here although there was one; empty otherwise.
    mean_of
        What it is the mean of over all turns; None where it is none.
    """

    material: Material
    name: str
    color_space: str = "linear sRGB"
    stated_white: float | None = None
    uncertain: Knows | None = None
    model: Path | None = None
    file: Path | None = None
    sigma_lost: str = ""
    mean_of: Source | None = None

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """BRDF at the 81 x 81 pairs in 1/sr, shape (81, 81, 3), [light, view, channel]."""
        directions = paper_directions()
        return self.material.evaluate(directions[:, None], directions)

    @cached_property
    def white(self) -> float:
        """Exposure scale of the error metrics in 1/sr."""
        if self.stated_white is not None:
            return self.stated_white
        return max(WHITE_PER_MEDIAN * float(np.median(self.values)), SMALLEST_WHITE)

    @cached_property
    def anisotropy(self) -> float:
        """How much it changes when it is turned (see `gonio.exchange.isotropy`)."""
        return anisotropy_of_grid(self.values)

    def averaged(self) -> Source:
        """Return the isotropic mean over all turns of the sample; of a mean there is no sigma."""
        lost = self.sigma_lost if self.uncertain is None else "of a mean over turns it is not known"
        return replace(
            self, material=Averaged(self.material), stated_white=self.white, uncertain=None,
            model=None, sigma_lost=lost, mean_of=self,
        )  # fmt: skip


class WithoutSigma(MeasuredTable):
    """A table whose file states sigma, which tables do not keep."""
