"""Which file is written: never the one that is read, and no other unless it was named."""

from __future__ import annotations

from pathlib import Path

from gonio.errors import BadInputError


def target_of(named: Path | None, default: str, source: Path | None) -> Path:
    """Return the file to write.

    Parameters
    ----------
    named
        As a person named it; such a file is replaced.
    default
        Its name where none was given.
    source
        The file that is read, if one is.

    Raises
    ------
    gonio.errors.BadInputError
        When it is the source, or there already without having been named.
    """
    path = Path(default) if named is None else named
    if not path.exists():
        return path
    if source is not None and source.exists() and path.samefile(source):
        raise BadInputError(f"{path}: is the file that is read; name another with -o")
    if named is None:
        raise BadInputError(f"{path}: is there already; name it with -o to replace it")
    return path
