"""How a training went: loss, seconds and weights at a few steps."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadFileError
from gonio.files import write_with
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.encoding import ENCODINGS
from nnbrdf.ensemble import GRID_CHANNELS, Ensemble, grid_pairs
from nnbrdf.network import Networks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

SCHEMA = "gonio.history/1"
FILE_NAME = "history.npz"
_REMEDY = "make the model again with: gonio reconstruct"


@dataclass(frozen=True)
class Checkpoint:
    """The members after some steps.

    Attributes
    ----------
    step
        Steps taken.
    seconds
        Time spent training until then.
    loss
        Mean absolute error of each member over all samples, in units of white, shape (members,).
    networks
        The members as they were.
    diverged
        Which of them have stopped since their gradient was not finite, shape (members,).
    """

    step: int
    seconds: float
    loss: NDArray[np.float64]
    networks: Networks
    diverged: NDArray[np.bool_]

    def select(self, members: Sequence[int]) -> Checkpoint:
        """Return some of the members, in that order."""
        chosen = list(members)
        return replace(
            self,
            loss=self.loss[chosen],
            networks=self.networks.select(chosen),
            diverged=self.diverged[chosen],
        )


@dataclass(frozen=True)
class History:
    """The checkpoints of a training, in the order of their steps; `len` tells how many.

    Attributes
    ----------
    checkpoints
        At least one.
    encoding, white
        As in `nnbrdf.ensemble.Ensemble`.
    """

    checkpoints: tuple[Checkpoint, ...]
    encoding: str
    white: float

    def __len__(self) -> int:
        return len(self.checkpoints)

    def grids(self, index: int) -> NDArray[np.float64]:
        """Return what each member said at a checkpoint, not below zero.

        Returns
        -------
        ndarray
            1/sr, shape (members, 81, 81, 3), [member, light, view, channel].
        """
        light, view = grid_pairs()
        ensemble = Ensemble(self.checkpoints[index].networks, self.encoding, self.white)
        values = ensemble.predict(light.reshape(-1, 3), view.reshape(-1, 3))
        return values.clip(0.0).reshape(-1, *light.shape[:2], GRID_CHANNELS)

    def save(self, folder: Path) -> None:
        """Write `history.npz`; seconds differ from run to run, and so do its bytes."""
        points = self.checkpoints
        layers = zip(*(point.networks.layers for point in points), strict=True)
        arrays: dict[str, Any] = {
            "schema": SCHEMA,
            "encoding": self.encoding,
            "white": self.white,
            "step": [point.step for point in points],
            "seconds": [point.seconds for point in points],
            "loss": [point.loss for point in points],
            "diverged": [point.diverged for point in points],
            "activation": points[0].networks.activation,
        } | {f"layer_{index}": np.stack(layer) for index, layer in enumerate(layers)}

        def write(aside: Path) -> None:
            with aside.open("wb") as file:
                np.savez(file, **arrays)

        write_with(folder / FILE_NAME, write)

    @classmethod
    def load(cls, folder: Path | str) -> History:
        """Read what `save` wrote to a model's folder.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, broken, or of another schema.
        """
        path = Path(folder) / FILE_NAME
        try:
            # opened here, since numpy leaves the file of a broken archive open
            with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                return cls._from_arrays(dict(arrays), path)
        except FileNotFoundError:
            raise BadFileError(path, "no such file", _REMEDY) from None
        except KeyError as error:
            raise BadFileError(path, f"{error.args[0]}: is missing", _REMEDY) from None
        except (OSError, ValueError, TypeError, EOFError, zipfile.BadZipFile) as error:
            raise BadFileError(path, f"is not a training history ({error})", _REMEDY) from None

    @classmethod
    def _from_arrays(cls, arrays: Mapping[str, NDArray[Any]], path: Path) -> History:
        schema, encoding = str(arrays["schema"]), str(arrays["encoding"])
        activation = str(arrays["activation"])
        if schema != SCHEMA or encoding not in ENCODINGS or activation not in ACTIVATIONS:
            found = f"has schema {schema!r}, encoding {encoding!r}, activation {activation!r}"
            raise BadFileError(path, found, _REMEDY)
        count = sum(name.startswith("layer_") for name in arrays)
        layers = [arrays[f"layer_{index}"] for index in range(count)]
        networks = [Networks(each, activation) for each in zip(*layers, strict=True)]
        points = zip(
            arrays["step"].tolist(), arrays["seconds"].tolist(), arrays["loss"],
            networks, arrays["diverged"], strict=True,
        )  # fmt: skip
        checkpoints = tuple(Checkpoint(*point) for point in points)
        return cls(checkpoints, encoding, float(arrays["white"]))
