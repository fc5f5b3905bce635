"""Samples as a person has them: read from any file, shown as a table, made a material."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from gonio import samples as core

if TYPE_CHECKING:
    import pandas as pd

    from gonio.api.material import Material
    from gonio.api.told import Document
    from gonio.protocols import Progress

_TABLE = ".csv"


@dataclass(frozen=True, repr=False, eq=False)
class Samples(core.Samples):
    """BRDF samples with sigma: `gonio.samples.Samples`, with what a person does with them."""

    @classmethod
    def load(cls, path: Path | str) -> Self:
        """Read samples: netCDF as `gonio reduce` writes it, or a CSV table of any rig.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing or cannot be used.
        """
        if Path(path).suffix.lower() != _TABLE:
            return cls.of(super().load(path))
        from gonio.tables import read_table

        return cls.of(read_table(path))

    @classmethod
    def of(cls, samples: core.Samples) -> Self:
        """Return samples of the core with what these can."""
        return cls(**{each.name: getattr(samples, each.name) for each in fields(samples)})

    def to_table(self, quantity: str = "brdf") -> pd.DataFrame:
        """Return one row a sample: angles in degrees, values, sigmas.

        Parameters
        ----------
        quantity
            `brdf` in 1/sr, or `reflectance-factor`, which is pi times that.
        """
        import pandas as pd

        from gonio.reduce.table import columns

        return pd.DataFrame(columns(self, quantity))

    def to_csv(self, path: Path | str, quantity: str = "brdf") -> None:
        """Write the table as `gonio reduce --csv` does."""
        from gonio.reduce import write_table

        write_table(Path(path), self, quantity)

    def reconstruct(
        self,
        folder: Path | str = "model",
        *,
        estimator: str = "nn",
        compare: bool = False,
        progress: Progress | None = None,
        **settings: Any,
    ) -> Material:
        """Turn the samples into a material for the whole hemisphere, as `gonio reconstruct` does.

        Parameters
        ----------
        folder
            Where the model and its report go; what is there is replaced.
        estimator
            How: nn, prior, analytic or paper.
        compare
            Whether to fit all estimators, for the report.
        progress
            Called with how much is done and how much there is.
        settings
            Of the estimator, as the options of the command: weights, general, steps, epochs,
            activation, encoding, trainer, prior, seed.
        """
        from gonio.api.following import Following
        from gonio.api.material import Material
        from gonio.api.reconstruction import Reconstruction, recipe_of

        recipe = recipe_of(estimator, settings)
        made = Reconstruction(recipe, Following.by(progress), compare)
        return Material.load(made.of_samples(self, Path(folder)).model)

    def summary(self) -> Document:
        """Return how many there are, and how good, as `gonio reduce --json` does."""
        from gonio.api.told import samples_document

        return samples_document(self)

    def __str__(self) -> str:
        from gonio.words import several

        return f"{several(len(self), 'sample')} of {', '.join(self.channels)} ({self.color_space})"

    def __repr__(self) -> str:
        return f"<Samples: {self}>"

    def _repr_html_(self) -> str:
        return str(self.to_table().to_html(max_rows=10, float_format="{:.4g}".format))
