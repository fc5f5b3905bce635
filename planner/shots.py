"""From chosen pairs to shots: their order, their exposures, their lamps, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gonio.plan import LampSetting, Shot
from gonio.rig import AXES
from gonio.timemodel import estimate
from planner.budget import Priced, Terms
from planner.exposures import with_predicted_exposures
from planner.metric import TimeMetric
from planner.route import WORK, plan_route
from planner.ways import seconds_of_ways

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.protocols import Prior
    from gonio.rig import Rig
    from gonio.timing import Timing
    from planner.field import Field
    from planner.route import Route

FULL_CURRENT_MA = 700.0

_QUICK = WORK // 10
"""Work on the route of a set that is only priced: a longer search goes on from there."""


@dataclass(frozen=True)
class ShotMaker:
    """Makes shots of the pairs of a field.

    Attributes
    ----------
    field
        The pairs; one is known by its place in the flattened table, light by light.
    rig, timing
        What takes them, and how it acts.
    prior
        By which exposures are predicted; None: each shot takes all of the rig's.
    """

    field: Field
    rig: Rig
    timing: Timing
    prior: Prior | None = None

    def ordered(
        self, measured: NDArray[np.bool_], work: int = WORK
    ) -> tuple[tuple[Shot, ...], Route]:
        """Return the shots of `measured`, shape (L, V), in route order, and their route.

        `work` is that of `planner.route.plan_route`.

        Raises
        ------
        gonio.errors.BadInputError
            When the arms cannot get from one to the next.
        """
        angles_deg = self._angles_deg(np.flatnonzero(measured))
        ways = seconds_of_ways(self.rig, self.timing)
        route = plan_route(angles_deg, self.rig, self.timing, way_s=ways, work=work)
        columns = {
            "view_theta_deg": angles_deg[route.order, 0],
            "light_theta_deg": angles_deg[route.order, 2],
            "view_phi_deg": route.phi_deg[:, 0],
            "light_phi_deg": route.phi_deg[:, 1],
            "view_turn": route.turns[:, 0],
            "light_turn": route.turns[:, 1],
        }
        return self._shots(columns), route

    def terms(self) -> Terms:
        """Return what pairs cost, for a choice within a time."""
        every = np.arange(self.field.allowed.size)
        moves = TimeMetric.of(self._angles_deg(every), self.rig, self.timing)
        return Terms(moves, self._shot_s(every), self.price)

    def price(self, pairs: Sequence[int]) -> Priced:
        """Put pairs in order and estimate the whole capture of them."""
        measured = np.zeros_like(self.field.allowed)
        measured.flat[list(pairs)] = True
        shots, route = self.ordered(measured, _QUICK)
        order = np.flatnonzero(measured)[route.order].tolist()
        return Priced(order, estimate(shots, self.rig, self.timing).total_s)

    @cached_property
    def _lamps(self) -> tuple[LampSetting, ...]:
        return tuple(LampSetting(n=lamp.n, mA=FULL_CURRENT_MA) for lamp in self.rig.lamps.lamp)

    def _angles_deg(self, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the axes' angles at pairs, shape (n, 4), in the order of `gonio.rig.AXES`."""
        light, view = np.unravel_index(pairs, self.field.allowed.shape)
        sides = (self.field.views, view), (self.field.lights, light)
        return np.stack(
            [angle[rows] for each, rows in sides for angle in (each.theta_deg, each.phi_deg)],
            axis=1,
        )

    def _shots(self, columns: dict[str, NDArray[np.float64]]) -> tuple[Shot, ...]:
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        shots = tuple(
            Shot(
                index=index,
                exposures_s=self.rig.camera.exposures_s,
                lamps=self._lamps,
                **dict(zip(columns, row, strict=True)),
            )
            for index, row in enumerate(rows)
        )
        if self.prior is None:
            return shots
        return with_predicted_exposures(shots, self.prior, self.rig, self.timing)

    def _shot_s(self, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return about what each shot takes beside its move, in seconds, shape (n,)."""
        names = ("view_theta_deg", "view_phi_deg", "light_theta_deg", "light_phi_deg")
        shots = self._shots(dict(zip(names, self._angles_deg(pairs).T, strict=True)))
        exposing_s = np.array([sum(shot.exposures_s) for shot in shots])
        frames = np.array([len(shot.exposures_s) for shot in shots])
        each_s = self.timing.hold.mean_s + self.timing.read_out.mean_s
        settle_s = max(self.timing.axis[name].settle.mean_s for name in AXES)
        return np.asarray(exposing_s + frames * each_s + self.timing.lamps.mean_s + settle_s)
