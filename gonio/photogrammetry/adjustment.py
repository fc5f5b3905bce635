"""Bundle adjustment: camera, arm and every view's pose at once, by least squares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gonio.errors import BadInputError
from gonio.photogrammetry.model import ENCODER_DEG, BundleModel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.photogrammetry.detection import BoardView
    from gonio.photogrammetry.model import State
    from gonio.rig import CameraSpec

LEAST_VIEWS: Final = 6
LEAST_CORNERS: Final = 12
"""Of a view that counts."""

# what corners are found to before their own spread is known, and what no detector is better than
_FIRST_PX, _BEST_PX = 0.1, 0.01
# of a spread from which on an error counts for less than its square
_ROBUST_FROM = 3.0
_SD_PER_MAD = 1.4826
# the smallest singular value against the largest: 2e-3 of good views, below 3e-6 of one ring
_SINGULAR = 1e-5
_FIRST_STEPS, _STEPS = 4, 50


@dataclass(frozen=True)
class Adjustment:
    """What the views tell.

    Attributes
    ----------
    state
        Camera, alignment, and what each view's angles are off it.
    names
        Of the parameters, in the order of values and covariance.
    values, covariance
        Shapes (n,) and (n, n), in the units that the names end in.
    errors_px
        Of each corner, shape (corners, 2).
    view
        Which view each corner is of, shape (corners,).
    """

    state: State
    names: tuple[str, ...]
    values: NDArray[np.float64]
    covariance: NDArray[np.float64]
    errors_px: NDArray[np.float64]
    view: NDArray[np.intp]


def adjust(spec: CameraSpec, views: Sequence[BoardView]) -> Adjustment:
    """Find camera and arm from views of the board.

    Triggs, McLauchlan, Hartley and Fitzgibbon, *Bundle Adjustment - A Modern Synthesis* (2000). The
    corners' spread is that of the errors themselves, by their median; gross ones count for less
    than their square. That of the views' angles is their own, where it is more than expected.

    Raises
    ------
    gonio.errors.BadInputError
        When there are too few views, or they leave a parameter open.
    """
    views = [view for view in views if len(view.ids) >= LEAST_CORNERS]
    if len(views) < LEAST_VIEWS:
        raise BadInputError(
            f"the board was found in {len(views)} views, and {LEAST_VIEWS} are needed; take more "
            "views, lit and sharp, of theta from 0 to 60 deg and azimuths all round"
        )
    model = BundleModel(spec, views)
    # what is open is told before time is lost on it
    guess = _FIRST_PX, ENCODER_DEG
    _covariance(_solve(model, model.start, guess, "linear", 1).jac.toarray(), model.names)
    first = _solve(model, model.start, guess, "linear", _FIRST_STEPS)
    spread_px = _SD_PER_MAD * float(np.median(np.abs(model.errors_px(first.x))))
    spreads = max(spread_px, _BEST_PX), model.play_deg(first.x)
    last = _solve(model, first.x, spreads, "soft_l1", _STEPS)
    shared = len(model.names)
    return Adjustment(
        state=model.state(last.x),
        names=model.names,
        values=last.x[:shared],
        covariance=_covariance(last.jac.toarray(), model.names),
        errors_px=model.errors_px(last.x),
        view=model.view,
    )


def _solve(
    model: BundleModel,
    start: NDArray[np.float64],
    spreads: tuple[float, float],
    loss: str,
    steps: int,
) -> Any:
    """Solve by least squares; spreads are of corners in pixels, and of angles in degrees."""
    from scipy.optimize import least_squares

    return least_squares(
        model.residuals,
        start,
        args=spreads,
        jac_sparsity=model.structure(),
        x_scale="jac",
        loss=loss,
        f_scale=_ROBUST_FROM,
        # focal length and distance nearly trade places: loose inner solutions would stop early
        tr_options={"atol": 1e-12, "btol": 1e-12, "maxiter": 300},
        xtol=1e-12,
        ftol=1e-8,
        gtol=1e-8,
        max_nfev=steps,
    )


def _covariance(jacobian: NDArray[np.float64], names: tuple[str, ...]) -> NDArray[np.float64]:
    """Return the inverse of the normal matrix, of the parameters that all views share."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0] = 1.0
    _, sizes, ways = np.linalg.svd(jacobian / scale, full_matrices=False)
    if sizes[-1] < _SINGULAR * sizes[0]:
        open_ = names[int(np.argmax(np.abs(ways[-1, : len(names)])))]
        raise BadInputError(
            f"the views leave {open_} open; take views of several theta from 0 to 60 deg, each at "
            "azimuths all round"
        )
    root = (ways / sizes[:, None] / scale)[:, : len(names)]
    return np.asarray(root.T @ root)
