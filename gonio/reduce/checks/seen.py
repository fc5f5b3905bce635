"""What the checks look at, shot by shot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from gonio.directions import normalize
from gonio.uncertainty import COMPONENTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gonio.journal import FrameRecord
    from gonio.plan import Shot
    from gonio.reduce.holder import HolderLevel
    from gonio.reduce.reading import Reading
    from gonio.reduce.surroundings import Surroundings


class Measured(Protocol):
    """A shot as the reduction holds it (fields as of `Seen`)."""

    @property
    def shot(self) -> Shot: ...  # noqa: D102
    @property
    def records(self) -> tuple[FrameRecord, ...]: ...  # noqa: D102
    @property
    def readings(self) -> tuple[Reading, ...]: ...  # noqa: D102
    @property
    def value(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def sigma(self) -> NDArray[np.float64]: ...  # noqa: D102
    @property
    def components(self) -> Mapping[str, NDArray[np.float64]]: ...  # noqa: D102
    @property
    def flag(self) -> NDArray[np.uint32]: ...  # noqa: D102
    @property
    def around(self) -> Surroundings: ...  # noqa: D102

    def mean(self, name: str) -> NDArray[np.float64]:
        """Return the mean of a reading's field over the bracket."""


@dataclass(frozen=True)
class Seen:
    """A shot as it was measured.

    Attributes
    ----------
    shot, records, readings
        What was wanted, what was taken, and what each frame of it says.
    value, sigma, components, flag
        The sample (see `gonio.samples.Samples`), shape (3,).
    light, view
        Unit vectors, shape (3,).
    around
        The holder.
    taken
        Place of its first frame in the journal: the order of time.
    """

    shot: Shot
    records: tuple[FrameRecord, ...]
    readings: tuple[Reading, ...]
    value: NDArray[np.float64]
    sigma: NDArray[np.float64]
    components: Mapping[str, NDArray[np.float64]]
    flag: NDArray[np.uint32]
    light: NDArray[np.float64]
    view: NDArray[np.float64]
    around: Surroundings
    taken: int

    @property
    def index(self) -> int:
        """The shot's."""
        return self.shot.index

    @property
    def holder(self) -> HolderLevel | None:
        """The white squares of the holder."""
        return self.around.holder

    @property
    def blur_px(self) -> float | None:
        """Width of the sample's edge."""
        return self.around.blur_px

    def scatter(self, *also: str) -> NDArray[np.float64]:
        """Return sigma of what errs in each shot by itself, and of these components, shape (3,).

        What all shots of a session share cancels where two of them are compared.
        """
        names = [each.name for each in COMPONENTS if not each.common or each.name in also]
        return np.asarray(np.sqrt(sum(self.components[name] ** 2 for name in names)))

    @classmethod
    def of(cls, row: Measured, taken: int) -> Seen:
        """Return a row as the checks look at it."""
        return cls(
            shot=row.shot,
            records=row.records,
            readings=row.readings,
            value=row.value,
            sigma=row.sigma,
            components=row.components,
            flag=row.flag,
            light=normalize(row.mean("light")),
            view=normalize(row.mean("view")),
            around=row.around,
            taken=taken,
        )
