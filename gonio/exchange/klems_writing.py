"""A material as a Klems matrix: means over pairs of patches by projected solid angle of both."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.exchange.blocks import evaluate_in_blocks
from gonio.exchange.klems import BASES, FULL, points_in
from gonio.exchange.window_xml import write_window, xyz_of
from gonio.steps import Steps

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.exchange.format import Source
    from gonio.protocols import Material, Progress

    Array = NDArray[np.float64]

_WAVELENGTHS: Final = ("CIE-X", "Visible", "CIE-Z")
# incident directions come from where a patch of theirs does not lie
_TURNED: Final = np.array([-1.0, -1.0, 1.0])
_ACROSS, _ALONG = 2, 3
# where a few points differ by so much of their mean (standard deviation): log2 of how many instead
_FINER = ((0.2, 9), (1.0, 12))
_PAIRS_A_BLOCK = 32


def write_matrix(source: Source, path: Path, progress: Progress | None) -> None:
    """Write luminance and, for Radiance, X and Z of the colours."""
    xyz = xyz_of(averages(source.material, FULL, progress).clip(0.0))
    data = {_WAVELENGTHS[i]: _rows(xyz[..., i].T) for i in (1, 0, 2)}
    bases = f"<ColumnAngleBasis>{FULL}</ColumnAngleBasis><RowAngleBasis>{FULL}</RowAngleBasis>\n"
    write_window(path, source.name, "Columns", _definition(), bases, data)


def averages(material: Material, basis: str, progress: Progress | None = None) -> Array:
    """Return the mean BRDF of each pair of patches in 1/sr, incident first.

    Of 6 points a patch; of 512 or 4096 points of a pair of them where those few differ much.

    Returns
    -------
    NDArray
        Of shape (patches, patches, 3).
    """
    outgoing = points_in(basis, np.arange(sum(BASES[basis][1])), few_points())
    patches, points = outgoing.shape[:2]
    shape = (patches, patches, points, points, 3)
    light = np.broadcast_to((outgoing * _TURNED)[:, None, :, None], shape).reshape(-1, 3)
    view = np.broadcast_to(outgoing[None, :, None, :], shape).reshape(-1, 3)
    values = evaluate_in_blocks(material, light, view, progress).reshape(shape)
    mean, gray = values.mean(axis=(2, 3)), values.mean(axis=-1)
    spread = gray.std(axis=(2, 3)) / np.maximum(gray.mean(axis=(2, 3)), 1e-12)
    limits = [limit for limit, _ in _FINER]
    for (_, log2), low, high in zip(_FINER, limits, [*limits[1:], np.inf], strict=True):
        uneven = np.argwhere((spread > low) & (spread <= high))
        mean[tuple(uneven.T)] = _finer(material, basis, uneven, log2, progress)
    return np.asarray(mean)


def few_points() -> Array:
    """Return places in a patch that halve and third its projected solid angle, shape (6, 2)."""
    across, along = (np.arange(_ACROSS) + 0.5) / _ACROSS, (np.arange(_ALONG) + 0.5) / _ALONG
    return np.stack(np.meshgrid(across, along, indexing="ij"), axis=-1).reshape(-1, 2)


def _finer(
    material: Material, basis: str, pairs: NDArray[np.int64], log2: int, progress: Progress | None
) -> Array:
    """Return the means of pairs of patches, shape (n, 2), over Sobol's points: shape (n, 3)."""
    from scipy.stats import qmc

    place = qmc.Sobol(4, rng=np.random.default_rng(0)).random_base2(log2)
    blocks = np.array_split(pairs, -(-len(pairs) // _PAIRS_A_BLOCK) or 1)
    step, means = Steps(len(blocks), progress), []
    for incident, outgoing in (block.T for block in blocks):
        light = points_in(basis, incident, place[:, :2]) * _TURNED
        view = points_in(basis, outgoing, place[:, 2:])
        values = evaluate_in_blocks(material, light.reshape(-1, 3), view.reshape(-1, 3))
        means.append(values.reshape(light.shape).mean(axis=1))
        step()
    return np.concatenate(means)


def _rows(matrix: Array) -> str:
    return "\n".join(", ".join(f"{value:.6g}" for value in row) for row in matrix)


def _definition() -> str:
    bounds, counts = BASES[FULL]
    rings = [
        f"<AngleBasisBlock><Theta>{0 if low == 0 else (low + high) / 2:g}</Theta>"
        f"<nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{low:g}</LowerTheta>"
        f"<UpperTheta>{high:g}</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        for low, high, count in zip(bounds, bounds[1:], counts, strict=False)
    ]
    return f"<AngleBasis>\n<AngleBasisName>{FULL}</AngleBasisName>\n{''.join(rings)}</AngleBasis>\n"
