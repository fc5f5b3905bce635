"""A reconstructed material: networks that agree or not, and the folder that holds them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gonio.files import write_json
from nnbrdf.card import CARD_NAME, Card, read_card
from nnbrdf.ensemble import Ensemble
from nnbrdf.folder import grid_of, in_chunks, save_model, write_grid
from nnbrdf.weights import read_weights, write_weights

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nnbrdf.history import History
    from nnbrdf.network import Networks

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
        return in_chunks(lambda *pairs: delivered.predict(*pairs)[0].clip(0.0), light, view)

    def sigma(self, light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the standard deviation of the members' predictions in 1/sr, shape (..., 3).

        It is taken before they are clipped at zero: where all of them are, none is sure.
        """
        ensemble = self._ensemble
        return in_chunks(lambda *pairs: ensemble.predict(*pairs).std(0, ddof=1), light, view)

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
        return grid_of(self)

    def save(self, folder: Path | str) -> None:
        """Write `weights.safetensors`, `model.json`, `grid.npz` and, with a history, `history.npz`.

        The same samples give the same bytes of the first three (see `nnbrdf.folder.save_model`).

        Raises
        ------
        gonio.errors.StorageError
            When the operating system refuses; an older model is then as it was.
        """
        save_model(folder, self._write)

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
        write_grid(folder, self.grid())
        if self.history is not None:
            self.history.save(folder)
        write_json(folder / CARD_NAME, self.card.model_dump(mode="json", by_alias=True))
