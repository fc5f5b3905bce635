"""The weights of a network for each texel as a texture: npz, [row, column, ...]."""

from __future__ import annotations

import json
import tempfile
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.files import write_with

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nnbrdf.network import Networks

SCHEMA: Final = "gonio.btf-weights/1"


class TextureWriter:
    """Gathers the weights tile by tile on the disk, so that any number of texels can be.

    Parameters
    ----------
    sizes
        Of the network: inputs, then outputs of each layer.
    rows, columns
        Of texels.
    """

    def __init__(self, sizes: tuple[int, ...], rows: int, columns: int) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="gonio-btf-")
        shapes = {
            f"layer_{index}": (outputs, inputs + 1)
            for index, (inputs, outputs) in enumerate(pairwise(sizes))
        }
        self._arrays = {
            name: np.lib.format.open_memmap(
                self._path(name), "w+", np.float32, (rows, columns, *shape)
            )
            for name, shape in {**shapes, "white": ()}.items()
        }

    def put(
        self, rows: slice, columns: slice, networks: Networks, white: NDArray[np.float64]
    ) -> None:
        """Put in a tile's networks, row by row."""
        layers = {f"layer_{index}": layer for index, layer in enumerate(networks.layers)}
        for name, values in {**layers, "white": white}.items():
            place = self._arrays[name][rows, columns]
            place[...] = values.reshape(place.shape)

    def save(self, path: Path, facts: Mapping[str, Any]) -> None:
        """Write all as npz, with `facts` as JSON in `card`; nothing can be put in afterwards.

        Raises
        ------
        gonio.errors.StorageError
            When the file cannot be written.
        """
        np.save(self._path("card"), json.dumps({"schema": SCHEMA, **facts}, sort_keys=True))
        for array in self._arrays.values():
            array.flush()

        def write(aside: Path) -> None:
            with zipfile.ZipFile(aside, "w") as archive:
                for name in ("card", *self._arrays):
                    archive.write(self._path(name), f"{name}.npy")

        write_with(path, write)
        self._folder.cleanup()

    def _path(self, name: str) -> Path:
        return Path(self._folder.name) / f"{name}.npy"
