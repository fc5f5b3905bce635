"""Samples that ask too much, and what each activation makes of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadInputError
from gonio.samples import Samples
from nnbrdf.paper import PaperEstimator

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

COUNT = 64
MEMBERS = 3


def _pairs(count: int = COUNT) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(0)
    directions = paper_directions()
    return directions[rng.integers(0, 81, count)], directions[rng.integers(0, 81, count)]


def _body(light: Floats, view: Floats) -> Floats:
    """Return a smooth body with a highlight, in 1/sr, shape (n, 3)."""
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    lobe = half[:, 2:] ** 60
    return np.array([0.3, 0.2, 0.1]) / np.pi + lobe * [0.5, 0.6, 0.7]


def _scaled(scale: float) -> Samples:
    light, view = _pairs()
    return Samples.from_values(light, view, scale * _body(light, view))


def _mirror() -> Samples:
    light, view = _pairs()
    values = np.full((COUNT, 3), 1e-3)
    values[0] = 1e4
    return Samples.from_values(light, view, values)


def _constant(value: float) -> Samples:
    light, view = _pairs()
    return Samples.from_values(light, view, np.full((COUNT, 3), value))


def _one() -> Samples:
    light, view = _pairs(1)
    return Samples.from_values(light, view, _body(light, view))


def _repeated() -> Samples:
    light, view = (np.repeat(each[:1], COUNT, axis=0) for each in _pairs())
    return Samples.from_values(light, view, _body(light, view))


def _contradictory() -> Samples:
    light, view = (np.repeat(each[:2], COUNT // 2, axis=0) for each in _pairs())
    values = np.random.default_rng(1).uniform(0.01, 1.0, (COUNT, 3))
    return Samples.from_values(light, view, values)


def _light_at_pole() -> Samples:
    _, view = _pairs()
    light = np.tile([0.0, 0.0, 1.0], (COUNT, 1))
    return Samples.from_values(light, view, _body(light, view))


CASES: dict[str, Callable[[], Samples]] = {
    "values of 1e-6 per sr": lambda: _scaled(1e-6),
    "values of 1e4 per sr": lambda: _scaled(1e4),
    "one pair 1e4, the others 1e-3 per sr": _mirror,
    "constant": lambda: _constant(0.2),
    "all zero": lambda: _constant(0.0),
    "one sample": _one,
    "one pair, 64 times": _repeated,
    "two pairs that contradict themselves": _contradictory,
    "all light from the pole": _light_at_pole,
}


def outcome(activation: str, case: str, steps: int = 300) -> str:
    """Return what an activation makes of a case, in a word or the error's line.

    Parameters
    ----------
    activation
        A name of `nnbrdf.activations.ACTIVATIONS`.
    case
        A key of `CASES`.
    steps
        How long to train.

    Returns
    -------
    str
        `trained`, `trained, k of 3 diverged`, or `refused: ...`.
    """
    recipe = PaperEstimator(steps=steps, members=MEMBERS, activation=activation)
    try:
        model = recipe.fit(CASES[case]())
        grid = model.grid()
    except BadInputError as error:
        return f"refused: {error}"
    if not all(np.isfinite(array).all() for array in grid.values()):
        return "NOT FINITE"
    lost = model.card.diverged
    return f"trained, {lost} of {MEMBERS} diverged" if lost else "trained"
