"""The 81 x 81 map in several lights: values, how sure, what was measured, the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gonio.report.expected import relative_sigma
from gonio.report.images import png_uri
from gonio.report.maps import enlargement, measured_map
from nnbrdf.sphere import encode_srgb

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from gonio.materials import MeasuredTable
    from gonio.report.screen import Screen
    from gonio.samples import Samples

UNSURE = ("#30549c", "#8054a8", "#cf5a82", "#f2a25c")
"""Colors from sure to unsure: each is seen on white and on black, and each is brighter."""
_MOST = 99.0


class Layer(NamedTuple):
    """A picture of the map, a pixel a pair, light down and view to the right.

    Attributes
    ----------
    title, caption
        What it shows.
    uri
        The picture, 81 x 81.
    ends_at
        What the last of the colors `UNSURE` stands for; empty where the picture has others.
    """

    title: str
    uri: str
    caption: str
    ends_at: str = ""


def layers_of(
    grid: dict[str, NDArray[Any]],
    white: float,
    samples: Samples,
    truth: MeasuredTable | None,
    screen: Screen,
) -> list[Layer]:
    """Return the layers, the reconstruction first; those of the truth only where it is known.

    Parameters
    ----------
    grid
        As in `grid.npz`, in 1/sr.
    white
        Of the model, in 1/sr.
    """
    shown_white = white if truth is None else truth.white
    exposed = f"White is {shown_white:.3g} 1/sr, then {screen.words}."
    layers = [
        Layer("Reconstruction", _colored(screen.shown(grid["values"]) / shown_white), exposed),
        _uncertainty(relative_sigma(grid, white)),
        Layer("Measured", _measured(samples, screen), _where(samples)),
    ]
    if truth is not None:
        layers += _of_truth(grid["values"].astype(np.float64), truth, screen, exposed)
    return layers


def largest_unsure(relative: NDArray[np.float64]) -> float:
    """Return where the colors `UNSURE` end: a few huge ones would leave all else the same."""
    return max(float(np.percentile(relative, _MOST)), 1e-9)


def _uncertainty(relative: NDArray[np.float64]) -> Layer:
    from matplotlib.colors import LinearSegmentedColormap

    most = largest_unsure(relative)
    colors = LinearSegmentedColormap.from_list("unsure", UNSURE)
    caption = "One standard uncertainty over the value, mean of the channels."
    uri = png_uri(colors(relative / most, bytes=True)[..., :3])
    return Layer("Uncertainty", uri, caption, f"{100 * most:.2g} %")


def _measured(samples: Samples, screen: Screen) -> str:
    values = measured_map(samples)
    known = np.isfinite(values[..., 0])
    color = _eight_bit(screen.shown(np.where(known[..., None], values, 0.0)) / samples.white)
    return png_uri(np.dstack([color, np.where(known, 255, 0).astype(np.uint8)]))


def _where(samples: Samples) -> str:
    return f"Each sample at the nearest pair of the grid; white is {samples.white:.3g} 1/sr."


def _of_truth(
    values: NDArray[np.float64], truth: MeasuredTable, screen: Screen, exposed: str
) -> Iterator[Layer]:
    white = truth.white
    yield Layer("Truth", _colored(screen.shown(truth.values) / white), exposed)
    difference = np.abs(values.clip(max=white) - truth.values.clip(max=white))
    factor = enlargement(difference, white)
    yield Layer(
        f"Difference × {factor}",
        _colored(factor * difference / white),
        "Absolute, channel by channel, both clipped at white as eps8 does, enlarged "
        f"{factor} times.",
    )


def _colored(share: NDArray[np.float64]) -> str:
    return png_uri(_eight_bit(share))


def _eight_bit(share: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.asarray(np.round(255.0 * encode_srgb(share)), np.uint8)
