"""Evaluation by the compiled kernel: from directions to BRDF in one pass, each lane a pair."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.halfway import HALFWAY, HALFWAY_INPUTS
from nnbrdf.prior.log import OFFSET

try:
    from nnbrdf import _evaluate
except ImportError:
    _evaluate = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nnbrdf.network import Networks


def is_available() -> bool:
    """Tell whether the kernel was compiled when gonio was installed."""
    return _evaluate is not None


def evaluate(
    networks: Networks,
    encoding: str,
    light: NDArray[Any],
    view: NDArray[Any],
    scale: float = 1.0,
    tint: Sequence[float] = (1.0, 1.0, 1.0),
    threads: int = 1,
) -> NDArray[Any]:
    """Return what a network says, which is ln(value / scale + 0.01), as values.

    Computed in single precision: against `Networks.forward` the logarithm is off by at most 2e-5
    of the range that the network's outputs span. A value hangs on its own pair only, not on which
    others are asked for or on the number of threads.

    Parameters
    ----------
    networks
        A stack of one, with one output or three.
    encoding
        A name of `nnbrdf.halfway.HALFWAY`.
    light, view
        Unit vectors, shapes (..., 3), broadcast against each other.
    scale
        In 1/sr.
    tint
        What each of the three channels multiplies its output with.
    threads
        How many to share the pairs among.

    Returns
    -------
    ndarray
        Shape (..., 3), in 1/sr, not below 0; float32 if both directions are, else float64.

    Raises
    ------
    gonio.errors.BadInputError
        When the kernel was not compiled, or the network does not fit the encoding.
    """
    _check(networks, encoding, threads)
    single = np.result_type(light, view) == np.float32
    kernel = _evaluate.evaluate32 if single else _evaluate.evaluate64
    dtype = np.float32 if single else np.float64
    shape = np.broadcast_shapes(np.shape(light), np.shape(view))
    lights, views = (_rows(each, shape, dtype) for each in (light, view))
    values = np.empty_like(lights)
    layers = [layer[0] for layer in networks.layers]
    numbers = list(ACTIVATIONS).index(networks.activation), list(HALFWAY).index(encoding)

    def run(start: int, end: int) -> None:
        part = slice(start, end)
        kernel(layers, *numbers, scale, OFFSET, tint, lights[part], views[part], values[part])

    bounds = [len(values) * part // threads for part in range(threads + 1)]
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(run, bounds[:-1], bounds[1:]))
    return values.reshape(shape)


def _rows(directions: NDArray[Any], shape: tuple[int, ...], dtype: type) -> NDArray[Any]:
    rows = np.broadcast_to(directions, shape).reshape(-1, 3)
    return np.ascontiguousarray(rows, dtype)


def _check(networks: Networks, encoding: str, threads: int) -> None:
    if not is_available():
        raise BadInputError(
            "the compiled evaluation is missing; install a C++ compiler and gonio again, "
            "or evaluate with Networks.forward"
        )
    if encoding not in HALFWAY:
        raise BadInputError(f"encoding {encoding!r} is not known; use {', '.join(HALFWAY)}")
    inputs, outputs = networks.sizes[0], networks.sizes[-1]
    if inputs != HALFWAY_INPUTS[encoding] or outputs not in (1, 3):
        raise BadInputError(
            f"the network takes {inputs} inputs and has {outputs} outputs; {encoding} makes "
            f"{HALFWAY_INPUTS[encoding]}, and outputs are one or three"
        )
    if networks.members != 1 or threads < 1:
        raise BadInputError("one network is evaluated at a time, by at least one thread")
