"""Tables of measured reflectance on the 81 x 81 grid, interpolated over the hemisphere."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import from_spherical, normalize, paper_directions, to_spherical
from gonio.errors import BadFileError
from gonio.files import write_with
from gonio.samples import WHITE_PER_MEDIAN

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.lib.npyio import NpzFile
    from numpy.typing import NDArray

    from gonio.protocols import Material
    from gonio.rig import Rig

_REMEDY = "expected: npz with values (81, 81, 3), light first, linear RGB in 1/sr"
_RIM = np.radians(75.0)
# directions whose weights on all faces stay in the cache
_AT_ONCE = 1 << 9
# of a table's array in double complex, the widest type, with its header
_LARGEST_ARRAY = 81 * 81 * 3 * 16 + 4096


@dataclass(frozen=True)
class MeasuredTable:
    """A material known at the 81 x 81 pairs; between them, spherical barycentric interpolation.

    Attributes
    ----------
    values
        Shape (81 light, 81 view, 3), linear RGB in 1/sr.
    white
        Exposure scale of the error metrics, in 1/sr.
    """

    values: NDArray[np.float64]
    white: float

    @classmethod
    def of(cls, values: NDArray[np.float64]) -> MeasuredTable:
        """Make a table whose white is 4 x the median of its values."""
        return cls(values, WHITE_PER_MEDIAN * float(np.median(values)))

    @classmethod
    def load(cls, path: Path | str) -> MeasuredTable:
        """Read an npz file (pickled content is never loaded).

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, is no npz, or its arrays do not fit.
        """
        path = Path(path)
        try:
            # opened here, since numpy leaves a broken file open
            with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                check_unpacked(arrays, ("values", "white", "directions"), _LARGEST_ARRAY)
                values = np.asarray(arrays["values"]).astype(np.float64, casting="same_kind")
                white = float(arrays["white"]) if "white" in arrays else None
                directions = arrays.get("directions")
        except FileNotFoundError:
            raise BadFileError(path, "no such file", _REMEDY) from None
        except KeyError as error:
            raise BadFileError(path, f"lacks an array ({error.args[0]})", _REMEDY) from None
        except Exception as error:  # zipfile, zlib and numpy's header parser raise a dozen kinds
            problem = f"is not a table ({type(error).__name__})"
            raise BadFileError(path, problem, _REMEDY) from None
        if values.shape != (81, 81, 3):
            raise BadFileError(path, f"values has shape {values.shape}", _REMEDY)
        if directions is not None and not _are_the_grid(directions):
            raise BadFileError(path, "directions are not the 81 in their order", _REMEDY)
        if bad := _bad_values(values):
            raise BadFileError(path, bad, _REMEDY)
        table = cls.of(values) if white is None else cls(values, white)
        if not 0 < table.white < np.inf:
            raise BadFileError(path, _no_scale(table.white, stated=white is not None), _REMEDY)
        return table

    def save(self, path: Path) -> None:
        """Write the npz layout that `load` reads, whole or not at all."""

        def write(aside: Path) -> None:
            with aside.open("wb") as file:
                np.savez_compressed(
                    file, values=self.values, directions=paper_directions(), white=self.white
                )

        write_with(path, write)

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the BRDF in 1/sr, shape (..., 3); exact at the nodes, theta clamped at 75 deg."""
        light, view = np.broadcast_arrays(light, view)
        light_node, light_weight = self._mesh.locate(light)
        view_node, view_weight = self._mesh.locate(view)
        result = np.zeros(light.shape)
        for i in range(3):
            for j in range(3):
                weight = (light_weight[..., i] * view_weight[..., j])[..., None]
                result += weight * self.values[light_node[..., i], view_node[..., j]]
        return result

    @cached_property
    def _mesh(self) -> SphericalMesh:
        return SphericalMesh(paper_directions())


@dataclass(frozen=True)
class Lambertian:
    """A perfect diffuser: reflectance factor `reflectance` at every pair of directions."""

    reflectance: float

    def evaluate(
        self, light: NDArray[np.float64], view: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return reflectance / pi in 1/sr, shape (..., 3)."""
        shape = np.broadcast_shapes(np.shape(light), np.shape(view))
        return np.full(shape, self.reflectance / np.pi)


def reference_material(rig: Rig) -> Material:
    """Return the white reference that a rig file names: a constant factor, or a measured table."""
    reference = rig.holder.reference
    if isinstance(reference, str):
        return MeasuredTable.load(reference)
    return Lambertian(reference)


class SphericalMesh:
    """Triangles between nodes of the upper hemisphere, from the convex hull of their directions.

    Parameters
    ----------
    nodes
        Unit vectors, shape (n, 3), their outermost ring at 75 deg.
    """

    def __init__(self, nodes: NDArray[np.float64]) -> None:
        from scipy.spatial import ConvexHull

        faces = np.asarray(ConvexHull(nodes).simplices)
        # the hull closes itself below with faces between nodes of the rim alone
        rim = nodes[:, 2] < np.cos(_RIM) + 1e-9
        self._faces = faces[~rim[faces].all(axis=1)]
        corners = nodes[self._faces]
        self._inverse = np.linalg.inv(np.swapaxes(corners, 1, 2))
        self._centre = normalize(corners.mean(axis=1))
        self._radius = _angle(corners, self._centre[:, None]).max(axis=1)

    def locate(
        self, direction: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the nodes around each direction and their barycentric weights, shapes (..., 3).

        The weights solve direction = sum of weight x node, scaled to add up to one.
        """
        theta, phi = to_spherical(direction)
        inside = from_spherical(np.minimum(theta, _RIM), phi).reshape(-1, 3)
        nodes = np.empty((len(inside), 3), np.int64)
        weights = np.empty((len(inside), 3))
        for part in range(0, len(inside), _AT_ONCE):
            chosen = slice(part, part + _AT_ONCE)
            nodes[chosen], weights[chosen] = self._locate(inside[chosen])
        shape = direction.shape
        return nodes.reshape(shape), weights.reshape(shape)

    def _locate(
        self, direction: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        near = self._faces_near(direction)
        # corner by corner: matrix products, three times as fast as one einsum
        first, second, third = (direction @ self._inverse[near, i].T for i in range(3))
        best = np.argmax(np.minimum(np.minimum(first, second), third), axis=1)
        rows = np.arange(len(direction))
        chosen = np.stack([each[rows, best] for each in (first, second, third)], axis=1).clip(0.0)
        return self._faces[near[best]], chosen / chosen.sum(axis=1, keepdims=True)

    def _faces_near(self, direction: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the faces that meet the cap around all directions: few, for one camera image."""
        centre = normalize(direction.mean(axis=0))
        reach = _angle(direction, centre).max() + 1e-6
        return np.flatnonzero(_angle(self._centre, centre) <= self._radius + reach)


def check_unpacked(arrays: NpzFile, names: Iterable[str], largest: int) -> None:
    """Refuse arrays that would fill the memory when they are unpacked.

    Raises
    ------
    ValueError
        When one of those `names` that are there is longer than `largest` bytes.
    """
    for name in names:
        # numpy sets zip to None only once the file is closed
        packed = arrays.zip.NameToInfo.get(f"{name}.npy") if arrays.zip else None
        if packed is not None and packed.file_size > largest:
            raise ValueError(f"{name} is longer than {largest} bytes")


def _bad_values(values: NDArray[np.float64]) -> str | None:
    """Say which values are no reflectance: how many, and where the first is."""
    bad = np.argwhere(~(np.isfinite(values) & (values >= 0)))
    if not len(bad):
        return None
    light, view, channel = bad[0].tolist()
    value = values[light, view, channel]
    return (
        f"values[{light}, {view}, {channel}] (light, view, channel) is {value:g}, "
        + ("negative" if np.isfinite(value) else "not finite")
        + (f"; in all, {len(bad)} values are no reflectance" if len(bad) > 1 else "")
    )


def _no_scale(white: float, *, stated: bool) -> str:
    if stated:
        return f"white is {white:g}, no positive number"
    return f"has no white, and 4 x the median of its values, used instead, is {white:g}; add white"


def _are_the_grid(directions: NDArray[np.float64]) -> bool:
    grid = paper_directions()
    return directions.shape == grid.shape and bool(np.allclose(directions, grid, atol=1e-5))


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle between unit vectors; by chord, which is exact for small angles."""
    chord = np.linalg.norm(a - b, axis=-1)
    angle: NDArray[np.float64] = 2.0 * np.arcsin(np.clip(chord / 2.0, 0.0, 1.0))
    return angle
