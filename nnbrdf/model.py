"""A reconstructed material: networks that agree or not, and the folder that holds them."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import StorageError
from gonio.files import move_into, write_json, write_with
from nnbrdf.card import CARD_NAME, Card, read_card
from nnbrdf.ensemble import Ensemble, grid_pairs
from nnbrdf.history import FILE_NAME as HISTORY_NAME
from nnbrdf.history import History
from nnbrdf.weights import WEIGHTS_NAME, read_weights, write_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from nnbrdf.network import Networks

    Pairwise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

GRID_NAME = "grid.npz"
_CHUNK = 1 << 12
_UPPER = 0.95


@dataclass(frozen=True)
class NNBRDF:
    """A material learned by several networks that differ in their random start only.

    Attributes
    ----------
    card
        What `model.json` says.
    networks
        All members; `card.delivered` is the one whose values count, the others tell its sigma.
    history
        How the training went, unless the model was loaded from its folder.
    """

    card: Card
    networks: Networks
    history: History | None = None

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the delivered member's BRDF in 1/sr, not below zero, shape (..., 3).

        Light and view are unit vectors, shapes (..., 3), broadcast against each other. A single
        channel is repeated three times. What was above white in training counts as white.
        """
        delivered = self._ensemble.member(self.card.delivered)
        return _in_chunks(lambda *pairs: delivered.predict(*pairs)[0].clip(0.0), light, view)

    def sigma(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the standard deviation of the members' predictions in 1/sr, shape (..., 3).

        It is taken before they are clipped at zero: where all of them are, none is sure.
        """
        ensemble = self._ensemble
        return _in_chunks(lambda *pairs: ensemble.predict(*pairs).std(0, ddof=1), light, view)

    def quantiles(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the 5 and 95 % quantiles in 1/sr, not below zero, shape (..., 3) each.

        Student's t about the delivered value, with as many degrees of freedom as sigma has.
        """
        from scipy.special import stdtrit

        reach = stdtrit(self.networks.members - 1, _UPPER) * self.sigma(light, view)
        value = self.evaluate(light, view)
        return (value - reach).clip(0.0), value + reach

    def grid(self) -> dict[str, NDArray[np.float32]]:
        """Return `values`, `sigma`, `lo` and `hi` on the 81 x 81 grid, shape (81, 81, 3) each."""
        light, view = grid_pairs()
        lo, hi = self.quantiles(light, view)
        arrays = {
            "values": self.evaluate(light, view), "sigma": self.sigma(light, view),
            "lo": lo, "hi": hi,
        }  # fmt: skip
        return {name: array.astype(np.float32) for name, array in arrays.items()}

    def save(self, folder: Path | str) -> None:
        """Write `weights.safetensors`, `model.json`, `grid.npz` and, with a history, `history.npz`.

        The same samples give the same bytes of the first three. Everything is written aside before
        an older model is touched. While the files are exchanged there is no `model.json`, so a
        folder holds a whole model or none.

        Raises
        ------
        gonio.errors.StorageError
            When the operating system refuses; an older model is then as it was.
        """
        folder = Path(folder).resolve()
        aside = folder.parent / f".{folder.name}.part"
        shutil.rmtree(aside, ignore_errors=True)
        try:
            self._write(aside)
            _exchange(aside, folder)
        except OSError as error:
            raise StorageError.from_os(folder, error) from error
        finally:
            shutil.rmtree(aside, ignore_errors=True)

    @classmethod
    def load(cls, folder: Path | str) -> NNBRDF:
        """Read a model; nothing in it is ever executed.

        Raises
        ------
        gonio.errors.BadFileError
            When a file is missing, broken, of another version, or does not fit the others.
        """
        folder = Path(folder)
        card = read_card(folder)
        return cls(card, read_weights(folder, card))

    @property
    def _ensemble(self) -> Ensemble:
        return Ensemble(self.networks, self.card.encoding, self.card.white)

    def _write(self, folder: Path) -> None:
        write_weights(folder, self.networks)
        write_with(folder / GRID_NAME, lambda path: _write_npz(path, self.grid()))
        if self.history is not None:
            self.history.save(folder)
        write_json(folder / CARD_NAME, self.card.model_dump(mode="json", by_alias=True))


def _exchange(aside: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name in (CARD_NAME, HISTORY_NAME):
        (folder / name).unlink(missing_ok=True)
    for name in (WEIGHTS_NAME, GRID_NAME, HISTORY_NAME, CARD_NAME):
        if (aside / name).exists():
            move_into(aside / name, folder / name)


def _write_npz(path: Path, arrays: dict[str, Any]) -> None:
    with path.open("wb") as file:
        np.savez(file, **arrays)


def _in_chunks(
    function: Pairwise, light: NDArray[np.float64], view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Apply `function` to a bounded number of pairs at a time; a million do not fill the memory."""
    light, view = np.broadcast_arrays(np.asarray(light, float), np.asarray(view, float))
    result = np.empty(light.shape)
    flat, flat_light, flat_view = (array.reshape(-1, 3) for array in (result, light, view))
    for start in range(0, len(flat), _CHUNK):
        part = slice(start, start + _CHUNK)
        flat[part] = function(flat_light[part], flat_view[part])
    return result
