"""Writing a material for another program, and saying what that keeps and loses."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadFileError, BadInputError, StorageError
from gonio.exchange.isotropy import ISOTROPIC_BELOW
from gonio.exchange.target import target_of
from gonio.files import write_with
from gonio.samples import LARGEST
from nnbrdf.metrics import errors_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.exchange.format import Format, Source
    from gonio.protocols import Material, Progress
    from nnbrdf.metrics import Errors

_LINEAR = ("linear sRGB", "luminance")


@dataclass(frozen=True, repr=False)
class Exported:
    """A file that was written, and how near it is to what was to be written.

    Attributes
    ----------
    path
        The file.
    format
        Of the file.
    errors
        Of the file, read back, against the material; None where gonio does not read the format.
    of_mean
        The same against the mean over all turns, where that is what was written.
    notes
        What this material loses in this format, a line each.
    """

    path: Path
    format: Format
    errors: Errors | None
    of_mean: Errors | None
    notes: tuple[str, ...]

    @property
    def eps8(self) -> float | None:
        """Error against the material in 8-bit steps."""
        return self.errors and self.errors.eps8

    @property
    def male(self) -> float | None:
        """Error against the material in logarithms."""
        return self.errors and self.errors.male

    def __repr__(self) -> str:
        told = "not read back"
        if self.errors:
            told = f"eps8 {self.errors.eps8:.3g}, male {self.errors.male:.3g}"
        return f"<Exported {self.path} ({self.format.name}): {told}>"


def export(
    source: Source, format_: Format, named: Path | None, progress: Progress | None = None
) -> Exported:
    """Write a material and read it back; the file is whole, or as it was before.

    Parameters
    ----------
    source, format_
        What is written, and as what.
    named
        The file; None: here, by the material's name, where there is none yet.
    progress
        Called with how much is done and how much there is.

    Raises
    ------
    gonio.errors.BadInputError
        When the format cannot hold such a material, or the file is the one that is read.
    gonio.errors.StorageError
        When the file cannot be written.
    """
    if format_.write is None:
        raise BadInputError(f"gonio reads {format_.name}, but does not write it; use another --to")
    path = target_of(named, _default(source, format_), source.file)
    if not format_.anisotropic and source.anisotropy > ISOTROPIC_BELOW:
        raise BadInputError(
            f"{source.name} changes by {source.anisotropy:.0%} when it is turned, and "
            f"{format_.name} holds isotropic materials only; add --isotropic to write the mean "
            "over all turns, or use another --to"
        )
    values = _written(source, format_, path, progress)
    mean_of = source.mean_of
    of_mean = _errors(values, source) if mean_of else None
    return Exported(
        path, format_, _errors(values, mean_of or source), of_mean, tuple(_notes(source, format_))
    )


def _default(source: Source, format_: Format) -> str:
    from gonio.exchange.networks.portable import symbol_of

    # a module's name is an identifier, or nobody can import it
    name = symbol_of(source.name) if format_.suffix == ".py" else source.name
    return f"{name}{format_.suffix}"


def _written(
    source: Source, format_: Format, path: Path, progress: Progress | None
) -> NDArray[np.float64] | None:
    """Write the file aside, and move it into place once it can be read; returns what it holds."""
    back = []

    def write(aside: Path) -> None:
        with tempfile.TemporaryDirectory(dir=aside.parent, prefix=".gonio-") as folder:
            # some formats hold the name of their file
            made = Path(folder) / path.name
            back.append(_written_aside(source, format_, made, progress))
            made.replace(aside)

    write_with(path, write)
    return back[0]


def _written_aside(
    source: Source, format_: Format, made: Path, progress: Progress | None
) -> NDArray[np.float64] | None:
    assert format_.write is not None
    try:
        # what overflows is told by its reader
        with np.errstate(over="ignore", invalid="ignore"):
            format_.write(source, made, progress)
            return None if format_.read is None else _read_back(format_.read(made))
    except BadFileError as error:
        raise _refusal(source, format_, str(error).removeprefix(f"{made}: ")) from None
    except StorageError as error:
        # it names the file aside, of which nobody knows
        if isinstance(error.__cause__, OSError):
            raise error.__cause__ from None
        raise


def _read_back(material: Material) -> NDArray[np.float64]:
    directions = paper_directions()
    return material.evaluate(directions[:, None], directions)


def _refusal(source: Source, format_: Format, problem: str) -> BadInputError:
    largest = float(source.values.max())
    if largest > LARGEST:
        problem = f"its values, up to {largest:.3g} 1/sr, are too large for {format_.name}"
    else:
        problem = f"cannot be written as {format_.name}: the file {problem}"
    return BadInputError(f"{source.name}: {problem}; use another --to")


def _errors(values: NDArray[np.float64] | None, true: Source) -> Errors | None:
    if values is None:
        return None
    return errors_of(values, true.values, true.white)


def _notes(source: Source, format_: Format) -> list[str]:
    notes = []
    if source.sigma_lost:
        notes.append(f"its sigma is not in the file: {source.sigma_lost}")
    elif source.uncertain is not None and not format_.sigma:
        notes.append(f"its sigma is not in the file: {format_.name} has no place for it")
    elif source.uncertain is None and format_.sigma:
        notes.append("no sigma is in the file: nothing is known of it")
    if source.color_space not in _LINEAR:
        notes.append(f"its colours are {source.color_space}, which readers take for linear sRGB")
    return notes
