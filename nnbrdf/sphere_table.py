"""A table on the same sphere, fast: its picture is linear in its values."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.materials import SphericalMesh
from nnbrdf.sphere import sphere_rays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nnbrdf.sphere import Rays


def shade_table(values: NDArray[Any], size_px: int) -> NDArray[np.float64]:
    """Render a table as `nnbrdf.sphere.shade_sphere` renders `gonio.materials.MeasuredTable`.

    The first picture of a size takes a second or two, and each further one milliseconds.

    Parameters
    ----------
    values
        1/sr, shape (81, 81, 3), [light, view, channel].
    size_px
        Side of the square picture.

    Returns
    -------
    ndarray
        Linear RGB, shape (size_px, size_px, 3); a white diffuser facing the softbox is 1.

    Raises
    ------
    gonio.errors.BadInputError
        For another shape.
    """
    if values.shape != (81, 81, 3):
        raise BadInputError(f"a table of shape {values.shape} has no sphere; use (81, 81, 3)")
    flat = values.astype(np.float64).reshape(-1, 3)
    picture: NDArray[np.float64] = _operator(size_px) @ flat
    return picture.reshape(size_px, size_px, 3)


@lru_cache(maxsize=2)
def _operator(size_px: int) -> Any:
    """Return the sparse matrix, pixels x pairs of the grid, that makes a picture of a table."""
    from scipy.sparse import csr_array

    mesh = SphericalMesh(paper_directions())
    shape = (size_px**2, len(paper_directions()) ** 2)
    return sum((_look(rays, mesh, shape) for rays in sphere_rays(size_px)), csr_array(shape))


def _look(rays: Rays, mesh: SphericalMesh, shape: tuple[int, int]) -> Any:
    from scipy.sparse import csr_array

    (light, light_weight), (view, view_weight) = mesh.locate(rays.light), mesh.locate(rays.view)
    pair = light[:, :, None] * len(paper_directions()) + view[:, None, :]
    weight = rays.weight[:, None, None] * light_weight[:, :, None] * view_weight[:, None, :]
    pixel = np.broadcast_to(rays.pixel[:, None, None], pair.shape)
    return csr_array((weight.ravel(), (pixel.ravel(), pair.ravel())), shape)
