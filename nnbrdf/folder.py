"""What every model's folder has: written whole or not at all, with a grid of its values."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.errors import StorageError
from gonio.files import move_into, write_with
from nnbrdf.card import CARD_NAME
from nnbrdf.compared import FILE_NAME as COMPARE_NAME
from nnbrdf.ensemble import grid_pairs
from nnbrdf.history import FILE_NAME as HISTORY_NAME
from nnbrdf.weights import WEIGHTS_NAME

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.protocols import Estimate

    Pairwise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

GRID_NAME = "grid.npz"
PRIOR_NAME = "prior.npz"
_CHUNK = 1 << 12


def save_model(folder: Path | str, write: Callable[[Path], None]) -> None:
    """Write a model's files aside, then exchange them for those of an older model.

    While the files are exchanged there is no `model.json`, so a folder holds a whole model or none.

    Parameters
    ----------
    folder
        Where the model is to be; made where it is missing.
    write
        Writes all files into the folder that it is given.

    Raises
    ------
    gonio.errors.StorageError
        When the operating system refuses; an older model is then as it was.
    """
    folder = Path(folder).resolve()
    aside = folder.parent / f".{folder.name}.part"
    shutil.rmtree(aside, ignore_errors=True)
    try:
        write(aside)
        _exchange(aside, folder)
    except OSError as error:
        raise StorageError.from_os(folder, error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def grid_of(estimate: Estimate) -> dict[str, NDArray[np.float32]]:
    """Return `values`, `sigma`, `lo` and `hi` on the 81 x 81 grid, shape (81, 81, 3) each."""
    light, view = grid_pairs()
    lo, hi = estimate.quantiles(light, view)
    arrays = {
        "values": estimate.evaluate(light, view), "sigma": estimate.sigma(light, view),
        "lo": lo, "hi": hi,
    }  # fmt: skip
    return {name: array.astype(np.float32) for name, array in arrays.items()}


def write_grid(folder: Path, grid: dict[str, NDArray[np.float32]]) -> None:
    """Write `grid.npz`."""

    def write(path: Path) -> None:
        with path.open("wb") as file:
            np.savez(file, **grid)  # type: ignore[arg-type]

    write_with(folder / GRID_NAME, write)


def in_chunks(
    function: Pairwise, light: NDArray[np.float64], view: NDArray[np.float64], columns: int = 3
) -> NDArray[np.float64]:
    """Apply `function` to a bounded number of pairs at a time; a million do not fill the memory.

    Parameters
    ----------
    function
        From unit vectors of shape (n, 3) each to shape (n, columns).
    light, view
        Unit vectors, shapes (..., 3), broadcast against each other.

    Returns
    -------
    ndarray
        Shape (..., columns).
    """
    light, view = np.broadcast_arrays(np.asarray(light, float), np.asarray(view, float))
    result = np.empty((*light.shape[:-1], columns))
    flat = result.reshape(-1, columns)
    flat_light, flat_view = light.reshape(-1, 3), view.reshape(-1, 3)
    for start in range(0, len(flat), _CHUNK):
        part = slice(start, start + _CHUNK)
        flat[part] = function(flat_light[part], flat_view[part])
    return result


def _exchange(aside: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name in (CARD_NAME, WEIGHTS_NAME, HISTORY_NAME, PRIOR_NAME, COMPARE_NAME):
        (folder / name).unlink(missing_ok=True)
    for name in (WEIGHTS_NAME, GRID_NAME, HISTORY_NAME, PRIOR_NAME, CARD_NAME):
        if (aside / name).exists():
            move_into(aside / name, folder / name)
