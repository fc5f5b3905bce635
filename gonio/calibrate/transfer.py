"""Photon transfer: levels of the white reference, and the gain that their noise tells."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gonio.calibrate.linearity import slope
from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.calibration import Linearity

# above it the full well's own noise law may set in
_HIGHEST = 0.8
# weights follow the gain, which hardly moves after the first
_ROUNDS = 3


class Level(NamedTuple):
    """Repeats of one level, evaluated over the same pixels.

    Attributes
    ----------
    dose
        Mean light of a frame, in any unit.
    signal
        Mean above dark, in raw units.
    variance
        Of one pixel from frame to frame, in raw units squared.
    freedom
        Degrees of freedom of the variance.
    saturated
        Whether a pixel was.
    values
        How many pixels of all frames.
    """

    dose: float
    signal: float
    variance: float
    freedom: int
    saturated: bool
    values: int

    @property
    def relative_noise(self) -> float:
        """Of the mean, by the noise of its pixels."""
        return float(np.sqrt(self.variance / self.values) / max(self.signal, 1.0))


def level_of(signals: NDArray[np.float64], doses: NDArray[np.float64], *, saturated: bool) -> Level:
    """Evaluate repeats of one level.

    Parameters
    ----------
    signals
        Of each frame's pixels above dark, shape (frames, pixels).
    doses
        Of each frame, shape (frames,).
    saturated
        Whether a pixel of them was.
    """
    means = signals.mean(axis=1)
    # shutter and lamps vary from frame to frame, by more than photons do: take that out
    even = signals * (means.mean() / means)[:, None]
    # with each frame's own level its share of the noise is gone as well
    freedom = (len(signals) - 1) * (signals.shape[1] - 1)
    variance = float(((even - even.mean(axis=0)) ** 2).sum()) / freedom
    dose, mean = float(doses.mean()), float(means.mean())
    return Level(dose, mean, variance, freedom, saturated, signals.size)


def fit_gain(
    levels: Sequence[Level], read_variance: float, linearity: Linearity
) -> tuple[float, float]:
    """Return raw units per electron, and one standard uncertainty of it.

    Signals and their noise are made linear first; then variance = gain x signal + read variance
    (Janesick, Photon Transfer, 2007, chapter 5; EMVA Standard 1288), fitted by least squares
    under the uncertainty of a variance, variance x sqrt(2 / degrees of freedom). That is the
    variance which the fit foretells: by its own value one that is low by chance would weigh more.
    What the linearity errs by, whose slope noise grows with, counts as well.

    Parameters
    ----------
    levels
        Of which those below 80 % of the range count.
    read_variance
        In raw units squared.
    linearity
        As it was fitted to the same levels.

    Raises
    ------
    gonio.errors.BadInputError
        When the noise does not grow with the signal.
    """
    gain, sigma = _fit(levels, read_variance, linearity)
    bends = [np.add(linearity.coefficients, error) for error in linearity.errors]
    others = [linearity.model_copy(update={"coefficients": tuple(bend)}) for bend in bends]
    off = [_fit(levels, read_variance, other)[0] - gain for other in others]
    return gain, float(np.linalg.norm([sigma, *off]))


def _fit(
    levels: Sequence[Level], read_variance: float, linearity: Linearity
) -> tuple[float, float]:
    counted = [level for level in levels if level.signal <= _HIGHEST * linearity.raw_range]
    raw, variance = (
        np.array([getattr(level, name) for level in counted]) for name in ("signal", "variance")
    )
    freedom = np.array([level.freedom for level in counted])
    signal = linearity.undo(raw)
    excess = (variance - read_variance) * slope(linearity, raw) ** 2
    gain, information = float(excess.sum() / signal.sum()), 0.0
    for _ in range(_ROUNDS):
        weight = freedom / (2.0 * (max(gain, 0.0) * signal + read_variance) ** 2)
        information = float((weight * signal**2).sum())
        gain = float((weight * signal * excess).sum()) / information
    if not gain > 0:
        raise BadInputError(
            "the noise of the white reference does not grow with its signal, so it tells no gain; "
            "switch noise reduction off in the camera, and calibrate again"
        )
    return gain, information**-0.5
