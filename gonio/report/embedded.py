"""What the page's script draws from: arrays as base64, packed as its `data.js` unpacks them."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.directions import paper_angles_deg, paper_directions
from gonio.report import fans
from gonio.report.expected import relative_sigma
from gonio.report.layers import UNSURE, largest_unsure

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.materials import MeasuredTable
    from gonio.protocols import Estimate
    from gonio.report.sources import Sources
    from gonio.samples import Samples

_NEAR_DEG = 3.0
# logarithms as 16-bit numbers: a step is 0.04 %, from a millionth of white to a million times it
_LOG_MOST, _LOG_STEPS = 14.0, 65535


def embedded(sources: Sources) -> dict[str, Any]:
    """Return what the script is given, as JSON has it; all values in 1/sr."""
    theta, phi = paper_angles_deg()
    grid, truth = sources.grid, sources.truth
    bands = {name: _floats(grid[name]) for name in ("values", "sigma", "lo", "hi")}
    return {
        "channels": list(sources.samples.channels),
        "theta": theta.tolist(),
        "phi": phi.tolist(),
        "grid": bands | ({} if truth is None else {"truth": _floats(truth.values)}),
        "samples": _samples(sources.samples),
        "fans": _fans(sources.quick, sources.white, truth),
        "unsure": {
            "colors": list(UNSURE),
            "most": largest_unsure(relative_sigma(grid, sources.white)),
        },
    }


def _samples(samples: Samples) -> dict[str, str]:
    """Return the samples that lie near a pair of the grid, and how far; the last there counts."""
    grid = paper_directions()
    light, view = (at @ grid.T for at in (samples.light, samples.view))
    off_deg = np.degrees(np.arccos(np.minimum(light.max(axis=1), view.max(axis=1)).clip(max=1.0)))
    at_pair = off_deg < _NEAR_DEG
    pair = light.argmax(axis=1) * len(grid) + view.argmax(axis=1)
    ends = (samples.value, samples.sigma)
    value, sigma = (np.broadcast_to(each, (len(samples), 3)) for each in ends)
    return {
        "pair": _packed(pair[at_pair].astype("<u2")),
        "off_deg": _floats(off_deg[at_pair]),
        "value": _floats(value[at_pair]),
        "sigma": _floats(sigma[at_pair]),
    }


def _fans(estimate: Estimate, white: float, truth: MeasuredTable | None) -> dict[str, Any]:
    lobes, slices = fans.lobes_of(estimate, white), fans.slices_of(estimate, truth)
    told = {
        "lobe": lobes.value, "slice": slices.value, "low": slices.lo, "high": slices.hi,
        "truth": slices.truth,
    }  # fmt: skip
    packed = {name: _logs(each / white) for name, each in told.items() if each is not None}
    return packed | {
        "relative": _logs(lobes.relative),
        "white": white,
        "log": [_LOG_MOST, _LOG_STEPS],
        "rings": [fans.RINGS, fans.RING_DEG],
        "azimuths": [fans.AZIMUTHS, fans.AZIMUTH_DEG],
        "steps": [fans.STEPS, fans.STEP_DEG],
    }


def _logs(share: NDArray[np.float64]) -> str:
    log = np.log(share.clip(np.exp(-_LOG_MOST))).clip(max=_LOG_MOST)
    return _packed(np.round((log / _LOG_MOST + 1.0) / 2.0 * _LOG_STEPS).astype("<u2"))


def _floats(array: NDArray[Any]) -> str:
    return _packed(array.astype("<f4"))


def _packed(array: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()
