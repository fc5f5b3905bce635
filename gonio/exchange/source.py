"""What a person may name to be exported: a session, a model, a table, any file that is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadFileError
from gonio.exchange.format import Source
from gonio.exchange.importing import read_material, sigma_lost
from gonio.materials import MeasuredTable
from gonio.session import Session

if TYPE_CHECKING:
    from pathlib import Path

_MODEL = "model.json"


def source_of(path: Path) -> Source:
    """Return the material of a session's folder, a model's folder, or a file.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing or damaged, or a session without a model.
    """
    if not path.is_dir():
        material = read_material(path)
        white = material.white if isinstance(material, MeasuredTable) else None
        return Source(
            material, path.stem, stated_white=white, file=path, sigma_lost=sigma_lost(material)
        )
    if (path / _MODEL).is_file():
        return _of_model(path, path.resolve().name)
    return source_of_session(Session.open(path))


def source_of_session(session: Session) -> Source:
    """Return the model of a session.

    Raises
    ------
    gonio.errors.BadFileError
        When it has none, or that is damaged.
    """
    if not (session.model / _MODEL).is_file():
        remedy = f"make one with {session.reconstruct_command}"
        raise BadFileError(session.root, "has no model yet", remedy)
    return _of_model(session.model, session.root.resolve().name)


def _of_model(folder: Path, name: str) -> Source:
    from nnbrdf.load import load_model

    model = load_model(folder)
    # a model keeps the colour space of its samples in its card, whatever kind of card that is
    color_space = getattr(model.card, "color_space", "linear sRGB")
    return Source(
        material=model,
        name=name,
        color_space=color_space,
        stated_white=model.card.white,
        uncertain=model,
        model=folder,
    )
