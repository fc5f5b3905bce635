"""The file of a bidirectional texture function: a Zarr group, made, and read through Dask."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.directions import from_degrees
from gonio.errors import BadFileError, MissingExtraError
from gonio.geometry import SAMPLE_SIDE_MM

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from types import ModuleType

    from numpy.typing import NDArray

    from gonio.reduce.btf.job import Maps
    from gonio.reduce.btf.layout import Layout
    from gonio.reduce.color import Coloring
    from gonio.session import Session

SCHEMA: Final = "gonio.btf/1"
FORMAT: Final = "crc32c"
"""What is in each file beside the values: what was interrupted goes on with the same."""

AXES: Final = ("light", "view", "y", "x", "channel")
PAIRS: Final = ("light", "view", "xyz")


def btf_path(session: Session) -> Path:
    """Return where a session's array lies."""
    return session.root / "btf.zarr"


def zarr() -> ModuleType:
    """Import Zarr.

    Raises
    ------
    gonio.errors.MissingExtraError
        When it is not installed.
    """
    try:
        import zarr as module
    except ModuleNotFoundError:
        raise MissingExtraError("zarr", "btf") from None
    return module


def make_store(path: Path, layout: Layout, maps: Maps) -> None:
    """Make a group whose values are all NaN yet, with axes and maps of the sensor.

    Parameters
    ----------
    path
        A new folder.
    layout
        Axes, chunks and files.
    maps
        What is known of each pixel.
    """
    group = zarr().open_group(path, mode="w-")
    from zarr.codecs import Crc32cCodec

    for name, dtype in (("value", np.float32), ("sigma", np.float16)):
        # noise does not compress
        group.create_array(
            name, shape=layout.shape, dtype=dtype, chunks=layout.chunks, shards=layout.shards,
            compressors=(Crc32cCodec(),), fill_value=np.nan, dimension_names=AXES,
        )  # fmt: skip
    for side, angles in (("light", layout.lights), ("view", layout.views)):
        theta_deg, phi_deg = np.transpose(angles)
        _put(group, side, from_degrees(theta_deg, phi_deg), (side, "xyz"))
    x_mm = layout.grid.x_mm
    _put(group, "x", x_mm, ("x",))
    _put(group, "y", -x_mm, ("y",))
    dark = group.create_group("dark")
    for exposure_s, mean in maps.darks.items():
        _put(dark, f"{exposure_s!r}", mean.mean.astype(np.float32), ("row", "column"))
    if maps.response is not None:
        _put(group, "response", maps.response, ("row", "column"))


def finish_store(
    path: Path,
    places: Mapping[str, NDArray[np.float64]],
    provenance: Mapping[str, str],
    coloring: Coloring,
) -> None:
    """Add where lamps and camera were at each pair, the space, and what all was made from."""
    group = zarr().open_group(path, mode="r+")
    for name, mm in places.items():
        _put(group, name, mm, PAIRS)
    group.attrs.update(
        schema=SCHEMA,
        units="sr-1",
        color_space=coloring.space,
        color_made_by=coloring.made_by,
        side_mm=SAMPLE_SIDE_MM,
        provenance=dict(provenance),
    )


def _put(group: Any, name: str, data: NDArray[Any], axes: tuple[str, ...]) -> None:
    array = group.create_array(name, shape=data.shape, dtype=data.dtype, dimension_names=axes)
    array[...] = data


@dataclass(frozen=True)
class Btf:
    """A finished array, opened to be read.

    Attributes
    ----------
    path
        The Zarr group.
    group
        What Zarr makes of it: `value`, `sigma`, `light`, `view`, `light_mm`, `view_mm`, `x`, `y`.
    """

    path: Path
    group: Any

    @classmethod
    def open(cls, session: Session) -> Btf:
        """Open a session's.

        Raises
        ------
        gonio.errors.BadFileError
            When there is none, or what is there is none.
        gonio.errors.MissingExtraError
            When Zarr is not installed.
        """
        path, remedy = btf_path(session), f"make it with: gonio reduce --btf {session.root}"
        if not path.is_dir():
            raise BadFileError(path, "no such folder", remedy)
        try:
            group = zarr().open_group(path, mode="r")
        except (OSError, ValueError, KeyError) as error:
            raise BadFileError(path, f"is no Zarr group ({error})", remedy) from None
        if group.attrs.get("schema") != SCHEMA:
            raise BadFileError(path, f"is not of schema {SCHEMA}", remedy)
        return cls(path, group)

    @property
    def side(self) -> int:
        """How many texels along each side."""
        return int(self.group["value"].shape[2])

    def dask(self, name: str = "value") -> Any:
        """Return `value` or `sigma` as a Dask array, chunked as the file is.

        Raises
        ------
        gonio.errors.MissingExtraError
            When Dask is not installed.
        """
        try:
            from dask import array
        except ModuleNotFoundError:
            raise MissingExtraError("dask", "btf") from None
        return array.from_zarr(self.group[name])
