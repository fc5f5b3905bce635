"""Opening anything that is a material: a session, a model's folder, a file, an embedded name."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.color import SRGB, InSpace, srgb_from
from gonio.directions import paper_directions
from gonio.errors import BadFileError, BadInputError, ResumeRefusedError
from gonio.materials import MeasuredTable
from gonio.words import told_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gonio.exchange import Source
    from gonio.protocols import Material
    from gonio.samples import Samples
    from gonio.session import Session

_CARD = "model.json"
_REMEDY = (
    "give a session, a model's folder, a file that gonio import reads, or a name that gonio "
    "materials shows"
)


@dataclass(frozen=True)
class Opened:
    """A material, and what is known with it.

    Attributes
    ----------
    name
        As a person calls it.
    material
        Its reflectance.
    white
        Exposure scale of the error metrics, in 1/sr; None: 4 x the median of its values.
    model
        The folder of its model, where it is one.
    samples
        What was measured, of a session.
    truth
        What the twin carried, of a simulated session; with white as `table` has it.
    source
        What a person typed to have it, where somebody did.
    """

    name: str
    material: Material
    white: float | None = None
    model: Path | None = None
    samples: Samples | None = None
    truth: Opened | None = None
    source: str = ""

    @cached_property
    def table(self) -> MeasuredTable:
        """Its values on the 81 x 81 grid, where that is not itself."""
        if isinstance(self.material, MeasuredTable):
            return self.material
        grid = paper_directions()
        values = np.asarray(self.material.evaluate(grid[:, None], grid[None]), np.float64)
        return MeasuredTable.of(values) if self.white is None else MeasuredTable(values, self.white)


def distinct(opened: Sequence[Opened]) -> list[Opened]:
    """Tell those of one name apart: by what was typed for them, then by their place in the row."""
    given = [one.name for one in opened]
    parts = [_parts(one) for one in opened]
    for length in range(1, max(map(len, parts), default=0) + 1):
        # the shortest ends of paths that differ
        names = [
            "/".join(path[-length:]) if given.count(name) > 1 else name
            for name, path in zip(given, parts, strict=True)
        ]
        if len(set(names)) == len(names):
            break
    else:
        names = told_apart(given)
    return [replace(one, name=name) for one, name in zip(opened, names, strict=True)]


def _parts(one: Opened) -> tuple[str, ...]:
    """Return what was typed, part by part; of a path from the root on, so that "." has a name."""
    path = Path(one.source)
    return path.resolve().parts[1:] if one.source and path.exists() else (one.source or one.name,)


def open_material(source: str) -> Opened:
    """Open a material.

    Parameters
    ----------
    source
        The folder of a session or of a model, the path of a file, or an embedded name.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, damaged, or a session without a model.
    gonio.errors.BadInputError
        For an unknown name.
    """
    path = Path(source)
    is_session = path.is_dir() and not (path / _CARD).is_file()
    opened = _of_session(path) if is_session else _shown(source_named(source))
    return replace(opened, source=source.rstrip("/") or source)


def source_named(name: str) -> Source:
    """Return what is to be exported: a session, a model, a file, or an embedded material.

    Raises
    ------
    gonio.errors.BadFileError
        When it is missing, damaged, or a session without a model.
    gonio.errors.BadInputError
        For an unknown name.
    """
    from gonio.exchange import Source, source_of
    from sim.materials import EMBEDDED

    path = Path(name)
    if path.exists() or path.suffix:
        return source_of(path)
    if name.lower() not in EMBEDDED:
        raise BadInputError(f"{name}: no such file, folder or material; {_REMEDY}")
    return Source(EMBEDDED[name.lower()].material, name.lower())


@dataclass(frozen=True)
class _Evaluating:
    evaluate: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def evaluating(
    function: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]],
) -> Material:
    """Return the material that a function of light and view, shape (n, 3) each, evaluates."""

    def evaluate(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        light, view = np.broadcast_arrays(light, view)
        return function(light.reshape(-1, 3), view.reshape(-1, 3)).reshape(light.shape)

    return _Evaluating(evaluate)


def truth_in(source: str) -> Opened:
    """Open what others are held against: of a simulated session its truth, else as it is."""
    opened = open_material(source)
    return opened.truth or opened


def _shown(source: Source) -> Opened:
    """Return a material as it is compared and drawn: quickly, and in linear sRGB."""
    return Opened(source.name, _in_srgb(source), source.stated_white, source.model)


def _in_srgb(source: Source) -> Material:
    if source.model is None:
        return source.material
    from gonio.report.gridded import quick_to_evaluate

    material = quick_to_evaluate(source.material)
    # materials of any space are compared, and shown, in one
    matrix = srgb_from(source.color_space)
    if matrix is not None and not np.allclose(matrix, np.eye(3)):
        return InSpace(material, matrix)
    return material


def _of_session(root: Path) -> Opened:
    from gonio.exchange import source_of_session
    from gonio.samples import Samples
    from gonio.session import Session

    session = Session.open(root)
    model = _shown(source_of_session(session))
    measured = Samples.load(session.samples_path) if session.samples_path.is_file() else None
    truth = _truth(session)
    return Opened(model.name, model.material, model.white, model.model, measured, truth)


def _truth(session: Session) -> Opened | None:
    from gonio.api.twin import carried
    from gonio.report import truth_of

    table = truth_of(session, SRGB)
    if table is None:
        return None
    try:
        # between the nodes a formula tells more than its table
        material = carried(session)
    except (ResumeRefusedError, BadFileError):
        material = None
    return Opened("truth", material or table, table.white)
