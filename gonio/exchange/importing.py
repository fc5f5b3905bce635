"""Files of other programs as materials, and as npz files that keep all of them."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadFileError, BadInputError
from gonio.exchange.format import Format, Source, WithoutSigma
from gonio.exchange.limits import LARGEST_FILE, read_whole
from gonio.exchange.registry import FORMATS, TABLE, format_named, format_of_file, formats
from gonio.exchange.target import target_of
from gonio.files import write_with
from gonio.materials import MeasuredTable, check_unpacked

if TYPE_CHECKING:
    from gonio.protocols import Material

_REMEDY = "import it again with: gonio import"


@dataclass(frozen=True)
class Imported:
    """A material from a file of another program.

    Attributes
    ----------
    source
        The material as that file holds it, on its own grid.
    format
        Of the file.
    path
        The table's file.
    """

    source: Source
    format: Format
    path: Path

    @property
    def notes(self) -> tuple[str, ...]:
        """What the table loses of this file, a line each."""
        lost = sigma_lost(self.source.material)
        return (f"its sigma is not in the table: {lost}",) if lost else ()

    @property
    def table(self) -> MeasuredTable:
        """Its values at the 81 x 81 pairs."""
        return MeasuredTable(self.source.values.clip(0.0), self.source.white)


def read_material(path: Path) -> Material:
    """Return the material that a file of any known format holds, on the file's own grid.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, broken, or of no format that gonio reads.
    """
    return _read(path, format_of_file(path))


def sigma_lost(material: Material) -> str:
    """Say why the sigma of a file that was read is not known; empty where it states none."""
    return "tables keep values alone" if isinstance(material, WithoutSigma) else ""


def import_file(path: Path, output: Path | None = None, name: str | None = None) -> Imported:
    """Write a file of another program as npz: a table of the 81 x 81 pairs, and the file itself.

    Whatever reads tables reads the one; `read_material` goes on with the other, so that no finer
    grid is lost.

    Parameters
    ----------
    path
        The file.
    output
        The npz file; None: here, by the file's name, where there is none yet.
    name
        Of its format; by default its content tells.

    Raises
    ------
    gonio.errors.BadInputError
        For a name that is of no format that is imported, or an output that may not be written.
    gonio.errors.BadFileError
        When the file is missing, broken, of no format that gonio reads, or black throughout.
    gonio.errors.StorageError
        When the output cannot be written.
    """
    if output is not None and output.suffix.lower() != ".npz":
        raise BadInputError(f"{output}: a table's name ends in .npz; name it so with -o")
    format_ = format_of_file(path) if name is None else _imported_as(name)
    material = _read(path, format_)
    if format_.name == TABLE:
        raise BadFileError(path, "is a table already", "use it as it is: --material")
    # what is wrong with the file is told before what is wrong with the table's name
    target = target_of(output, f"{path.stem}.npz", path)
    imported = Imported(Source(material, path.stem), format_, target)
    if not (np.isfinite(imported.source.values).all() and imported.source.values.max() > 0):
        raise BadFileError(path, "is black at all 81 x 81 pairs", "give a material that reflects")
    _save(imported, path)
    return imported


def imported_formats() -> list[Format]:
    """Return the formats that other programs write and gonio reads."""
    return [each for each in formats() if each.read is not None and each.name != TABLE]


def _imported_as(name: str) -> Format:
    known = {each.name: each for each in imported_formats()}
    if name not in known:
        raise BadInputError(f"--from {name}: no format that is imported; use {', '.join(known)}")
    return known[name]


def read_npz(path: Path) -> Material:
    """Return the material of an npz file: of the file that was imported, where it holds one.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is no table, or what it holds is damaged.
    """
    table = MeasuredTable.load(path)
    held = _held(path)
    if held is None:
        return table
    name, content = held
    # a table in a table in a table might never end
    if name not in FORMATS or name == TABLE:
        raise BadFileError(path, f"holds a file of unknown format {name[:20]!r}", _REMEDY)
    format_ = format_named(name)
    with tempfile.TemporaryDirectory() as folder:
        original = Path(folder) / f"{path.stem}{format_.suffix}"
        original.write_bytes(content)
        return _read(original, format_)


def _read(path: Path, format_: Format) -> Material:
    if format_.read is None:
        raise BadFileError(path, f"is {format_.name}, which gonio only writes", _REMEDY)
    return format_.read(path)


def _held(path: Path) -> tuple[str, bytes] | None:
    """Return format and content of the file that an npz file holds."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            if "original" not in arrays:
                return None
            check_unpacked(arrays, ("original", "original_format"), LARGEST_FILE + 4096)
            content, name = arrays["original"], str(arrays["original_format"])
    except Exception as error:  # zipfile, zlib and numpy's header parser raise a dozen kinds
        raise BadFileError(path, f"is damaged ({type(error).__name__})", _REMEDY) from None
    if content.dtype != np.uint8 or content.ndim != 1 or content.size > LARGEST_FILE:
        raise BadFileError(path, "holds an original that is no file", _REMEDY)
    return name, content.tobytes()


def _save(imported: Imported, path: Path) -> None:
    table = imported.table
    arrays = {"values": table.values, "directions": paper_directions(), "white": table.white}
    if not isinstance(imported.source.material, MeasuredTable):
        arrays["original"] = np.frombuffer(read_whole(path), np.uint8)
        arrays["original_format"] = np.array(imported.format.name)

    def write(aside: Path) -> None:
        with aside.open("wb") as file:
            np.savez_compressed(file, **arrays)  # type: ignore[arg-type]

    write_with(imported.path, write)
