"""A material as a person has one: loaded from anything, asked, compared, shown, exported."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from gonio.errors import BadInputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from gonio.api.opened import Opened
    from gonio.api.rendered import Rendered
    from gonio.api.samples import Samples
    from gonio.exchange import Exported, Source
    from gonio.materials import MeasuredTable
    from gonio.protocols import Progress
    from gonio.report.versus import Versus

    Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Material:
    """A reflectance, and what is known with it; it is a `gonio.protocols.Material`.

    Attributes
    ----------
    source
        It as it is: of a model, in the color space of its samples.
    opened
        It as it is compared and drawn: quick to evaluate, in linear sRGB.
    """

    source: Source
    opened: Opened

    @classmethod
    def load(cls, what: Path | str) -> Self:
        """Open a session, a model's folder, a file that gonio import reads, or an embedded name.

        Raises
        ------
        gonio.errors.BadFileError
            When it is missing, damaged, or a session without a model.
        gonio.errors.BadInputError
            For an unknown name.
        """
        from gonio.api.opened import open_material, source_named

        return cls(source_named(str(what)), open_material(str(what)))

    @property
    def name(self) -> str:
        """As a person calls it."""
        return self.source.name

    @property
    def color_space(self) -> str:
        """What the channels are that `evaluate`, `sigma` and `quantiles` tell."""
        return self.source.color_space

    @property
    def white(self) -> float:
        """Exposure scale of the error metrics, in 1/sr."""
        return self.source.white

    @property
    def table(self) -> MeasuredTable:
        """Its values at the 81 x 81 pairs in 1/sr, linear sRGB."""
        return self.opened.table

    @property
    def samples(self) -> Samples | None:
        """What it was made from, of a session."""
        from gonio.api.samples import Samples

        measured = self.opened.samples
        return None if measured is None else Samples.of(measured)

    @property
    def truth(self) -> Material | None:
        """What the twin carried, of a simulated session."""
        from gonio.exchange import Source

        true = self.opened.truth
        if true is None:
            return None
        return Material(Source(true.material, true.name, stated_white=true.table.white), true)

    def evaluate(self, light: ArrayLike, view: ArrayLike) -> Array:
        """Return the BRDF in 1/sr, shape (..., 3).

        Parameters
        ----------
        light, view
            Unit vectors (to 1e-6) away from the sample, z >= 0, shapes (..., 3), broadcast against
            each other; of degrees `gonio.directions.from_degrees` makes them.

        Raises
        ------
        gonio.errors.BadInputError
            For what are no such directions.
        """
        from gonio.api.pairs import checked_pairs

        return self.source.material.evaluate(*checked_pairs(light, view))

    def sigma(self, light: ArrayLike, view: ArrayLike) -> Array:
        """Return one standard uncertainty in 1/sr, shaped as `evaluate`.

        Raises
        ------
        gonio.errors.BadInputError
            When nothing is known of it, as of a table, or for directions that `evaluate` refuses.
        """
        from gonio.api.pairs import checked_pairs

        if self.source.uncertain is None:
            raise BadInputError(f"{self.name}: is no model, so its sigma is not known")
        return self.source.uncertain.sigma(*checked_pairs(light, view))

    def export(
        self,
        to: str,
        path: Path | str | None = None,
        *,
        isotropic: bool = False,
        progress: Progress | None = None,
    ) -> Exported:
        """Write it for another program, as `gonio export` does.

        Parameters
        ----------
        to
            The format's name.
        path
            The file, replaced if it is there; by default here, by the material's name, where no
            such file is yet.
        isotropic
            Whether to write the mean over all turns.
        progress
            Called with how much is done and how much there is.

        Returns
        -------
        gonio.exchange.Exported
            How near the file, read back, is to the material.

        Raises
        ------
        gonio.errors.BadInputError
            When the format cannot hold it, or the file may not be replaced.
        gonio.errors.StorageError
            When the file cannot be written.
        """
        from gonio.exchange import export, format_named

        format_ = format_named(to.lower())
        source = self.source.averaged() if isotropic else self.source
        return export(source, format_, None if path is None else Path(path), progress)

    def render(
        self,
        shape: str = "sphere",
        *,
        probe: str = "studio",
        size_px: int = 256,
        lights: int = 192,
        stops: float = 0.0,
        renderer: str = "auto",
    ) -> Rendered:
        """Show it on a shape under a probe of light, as `gonio render` does.

        Parameters
        ----------
        shape
            sphere, drape or panel.
        probe
            studio, sky or furnace.
        size_px
            Side of the picture, from 16 to 2048.
        lights
            Directions that stand for the probe, from 16 to 8192: more for glossy materials.
        stops
            Brighter by so many doublings, from -10 to 10; 0 makes the mean 18 %.
        renderer
            auto (Mitsuba 3 where it is installed), own (direct light) or mitsuba.
        """
        from gonio.api.rendered import render_alone

        return render_alone(self.opened, shape, probe, size_px, lights, stops, renderer)

    def compare(self, reference: Material | Path | str) -> Versus:
        """Hold it against a reference at the 81 x 81 pairs, as `gonio compare` does.

        Parameters
        ----------
        reference
            A material, or what `Material.load` opens.

        Raises
        ------
        gonio.errors.BadInputError
            When it is neither, or cannot be opened.
        """
        from gonio.report.versus import Versus

        if isinstance(reference, Path | str):
            reference = Material.load(reference)
        if not isinstance(reference, Material):
            raise BadInputError(f"{reference!r} is no material; give one, its name or its path")
        return Versus.of(self.name, self.table, reference.table)

    def __repr__(self) -> str:
        model = " (model)" if self.source.model else ""
        return f"<Material {self.name}{model}, white {self.white:.4g} 1/sr>"

    def _repr_html_(self) -> str:
        from html import escape

        from gonio.color import SRGB
        from gonio.report.renders import renders_of
        from gonio.report.screen import Screen

        (seen,) = renders_of(self.opened.material, None, Screen.of(SRGB), ["sphere"])
        name = escape(self.name)
        return (
            f'<figure><img alt="{name}" src="{seen.uri}"><figcaption>{name}</figcaption></figure>'
        )
