"""NBRDF: a small network on half and difference vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import MissingExtraError
from nnbrdf.encoding import encode_half_difference

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gonio.samples import Samples

    Evaluate = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

_HIDDEN = 21
_RATE = 5e-4
_BATCH = 512
STEPS = 8000
WEIGHTS = 675


def fit_nbrdf(samples: Samples, steps: int = STEPS, seed: int = 0) -> Evaluate:
    """Train the network of Sztrajman et al. (2021) and return what evaluates it.

    6-21-21-3 with ReLU and an exponential less one at the end; mean absolute difference of
    ln(1 + f cos theta_light), Adam at 5e-4, batches of 512. Theirs were 800,000 samples of a
    material in units of 1/sr; here are few, in units of white, and `steps` batches are drawn of
    them.

    Returns
    -------
    callable
        From light and view, unit vectors of shape (n, 3), to values in 1/sr, shape (n, 3).

    Raises
    ------
    gonio.errors.MissingExtraError
        Without torch.
    """
    try:
        import torch
    except ModuleNotFoundError as error:
        if error.name != "torch":
            raise
        raise MissingExtraError("torch", "nn") from None
    torch.manual_seed(seed)
    layers = [torch.nn.Linear(6, _HIDDEN), torch.nn.ReLU(), torch.nn.Linear(_HIDDEN, _HIDDEN)]
    network = torch.nn.Sequential(*layers, torch.nn.ReLU(), torch.nn.Linear(_HIDDEN, 3))
    inputs = torch.from_numpy(encode_half_difference(samples.light, samples.view)).float()
    cosine = torch.from_numpy(samples.light[:, 2:].clip(0.0)).float()
    value = np.broadcast_to(samples.value.clip(0.0) / samples.white, (len(samples), 3))
    target = torch.log1p(torch.from_numpy(value.copy()).float() * cosine)
    optimizer = torch.optim.Adam(network.parameters(), lr=_RATE)
    for _ in range(steps):
        rows = torch.randint(len(samples), (min(_BATCH, len(samples)),))
        told = torch.log1p(_told(torch, network, inputs[rows]) * cosine[rows])
        loss: Any = (told - target[rows]).abs().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    white = samples.white

    def evaluate(light: NDArray[np.float64], view: NDArray[np.float64]) -> NDArray[np.float64]:
        with torch.no_grad():
            rows = torch.from_numpy(encode_half_difference(light, view)).float()
            return white * np.asarray(_told(torch, network, rows).double().numpy())

    return evaluate


def _told(torch: Any, network: Any, inputs: Any) -> Any:
    return torch.relu(torch.expm1(network(inputs).clamp(max=20.0)))
