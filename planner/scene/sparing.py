"""A plan for what a scene asks for, and what it spares beside one that knows of no scene."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from gonio.errors import BadInputError
from gonio.plan import LeftOut
from planner.beliefs import IsotropicOnly, RememberedPrior
from planner.expected import rank_for
from planner.information import Unknown
from planner.locate import rows_of
from planner.optimal import unknown_of
from planner.scene.expected import Expected, expected_error
from planner.scene.use import NOT_ASKED, SAME_AZIMUTH, Use
from planner.search import Measure, best_pairs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from gonio.plan import Plan
    from gonio.protocols import Prior, PriorKind
    from planner.candidates import Candidates
    from planner.field import Field
    from planner.scene.use import Omission

IN_COLOR = (
    "shots for color: the camera takes all of it in one frame, under all lamps at once, so the rig "
    "saves nothing; only reconstruction has less to do"
)

FREELY = "by choosing pairs freely, rather than all of some views and lights"

_GAIN = Measure(Unknown.gains, Unknown.block_gains)


class Maker(Protocol):
    """Makes a plan: `planner.make.make_plan` with all that does not hang on the use settled."""

    def __call__(
        self,
        *,
        prior: Callable[[], Prior],
        shots: int | None,
        hours: float | None,
        demand: Callable[[Candidates, Candidates], NDArray[np.float64]] | None = None,
        leave_out: Mapping[str, Omission] | None = None,
    ) -> Plan:
        """Make it of some shots or for some hours, or of the views and lights that are settled."""


@dataclass(frozen=True)
class Wanted:
    """How much is to be measured.

    Attributes
    ----------
    shots
        So many pairs, chosen freely.
    hours
        As many pairs as can be had in so many hours. With neither, the views and lights that the
        maker has settled.
    fewest
        Rather as few pairs as keep what the plan without a scene is expected to know of the demand.
    least
        Not fewer than that, so that something can be made of them.
    """

    shots: int | None = None
    hours: float | None = None
    fewest: bool = False
    least: int = 1


def plan_for_use(
    use: Use,
    wanted: Wanted,
    make: Maker,
    field_of: Callable[[Mapping[str, Omission]], Field],
    prior: Callable[[], Prior],
) -> Plan:
    """Make a plan for a use; its `left_out` says what each omission spares.

    Each omission is told beside the plan before it: first one that knows of no scene, then, where
    as few pairs as can be are wanted, one of such pairs, then one that leaves out what the scene
    does not ask for, then one that leaves out azimuths.

    Parameters
    ----------
    use
        What counts.
    wanted
        How much is to be measured.
    make
        Makes plans.
    field_of
        Returns the pairs to choose from when some are left out.
    prior
        Makes what is believed of the material.

    Raises
    ------
    BadInputError
        When nothing is left to measure, or fewer pairs than are asked for.
    """
    _check_count(wanted, field_of(use.omissions()))
    whole = field_of({})
    remembered = RememberedPrior(prior, rank_for(whole))
    judge = _Judge.of(use, whole, remembered)
    last = judge.step(make(prior=lambda: remembered, shots=wanted.shots, hours=wanted.hours))
    most, target = len(last.plan.shots), last.expected.inside
    spared = {}
    for reason, part in _parts(use, wanted):
        belief = IsotropicOnly(remembered) if part.isotropic else remembered
        omissions = part.omissions()
        shots = wanted.shots
        if wanted.fewest:
            field = replace(field_of(omissions), demand=part.demand(judge.lights, judge.views))
            shots = judge.fewest(field, belief, target, most)
            shots = max(shots, min(wanted.least, int(field.allowed.sum())))
        plan = make(
            prior=lambda belief=belief: belief,  # type: ignore[misc]
            shots=shots,
            hours=wanted.hours,
            demand=part.demand,
            leave_out=omissions,
        )
        step = judge.step(plan)
        spared[reason] = _difference(last, step)
        last = step
    return _telling(last.plan, spared)


def _telling(plan: Plan, spared: Mapping[str, dict[str, float | int | None]]) -> Plan:
    """Return the plan that says what was spared, by reason."""
    rows = [row.model_copy(update=spared.get(row.reason, {})) for row in plan.left_out]
    if FREELY in spared:
        rows.insert(0, LeftOut.model_validate({"reason": FREELY, "shots": 0, **spared[FREELY]}))
    return plan.model_copy(update={"left_out": tuple(rows)})


def _check_count(wanted: Wanted, field: Field) -> None:
    """Refuse more shots than there are pairs, before any time is spent on choosing them."""
    most = int(field.allowed.sum())
    if wanted.shots is not None and wanted.shots > most:
        raise BadInputError(
            f"shots is {wanted.shots}; give 1 to {most}, all pairs that the rig can take and that "
            "count"
        )


def without_color(plan: Plan) -> Plan:
    """Return the plan that says what measuring no color saves: nothing, on rigs of this version."""
    row = LeftOut(reason=IN_COLOR, shots=0, spared_shots=0, spared_min=0.0)
    return plan.model_copy(update={"left_out": (*plan.left_out, row)})


class _Step(NamedTuple):
    """A plan on the way, and what it is expected to leave unknown of the whole use."""

    plan: Plan
    expected: Expected


@dataclass(frozen=True)
class _Judge:
    """Expects errors of choices for a use, whatever they were chosen for."""

    lights: Candidates
    views: Candidates
    kinds: Sequence[PriorKind]
    demand: NDArray[np.float64]
    asked: NDArray[np.bool_]

    @classmethod
    def of(cls, use: Use, field: Field, prior: Prior) -> _Judge:
        belief = IsotropicOnly(prior) if use.isotropic else prior
        kinds = belief.kinds(*field.pairs, rank_for(field))
        sides = field.lights, field.views
        return cls(*sides, kinds, use.demand(*sides), use.asked(*sides))

    def step(self, plan: Plan) -> _Step:
        measured = np.zeros(self.asked.shape, bool)
        measured[rows_of(plan, "light", self.lights), rows_of(plan, "view", self.views)] = True
        return _Step(plan, self._expected(measured))

    def fewest(self, field: Field, prior: Prior, target: float, most: int) -> int:
        """Return how many pairs of a field, at most `most`, leave a target inside the demand.

        Chosen one after the other, so that fewer are always part of more.
        """
        most = min(most, int(field.allowed.sum()))
        order = best_pairs(unknown_of(field, prior), field.allowed.ravel(), most, _GAIN, sweeps=0)

        def reached(count: int) -> bool:
            measured = np.zeros(self.asked.shape, bool)
            measured.flat[order[:count]] = True
            return self._expected(measured).inside <= target

        return 1 + bisect_left(range(1, most), True, key=reached)

    def _expected(self, measured: NDArray[np.bool_]) -> Expected:
        return expected_error(self.kinds, measured, self.demand, self.asked)


def _parts(use: Use, wanted: Wanted) -> Iterator[tuple[str, Use]]:
    """Yield the use as it grows, each time with the reason that is new."""
    if wanted.fewest:
        yield FREELY, Use()
    if use.pairs is not None:
        yield NOT_ASKED, replace(use, isotropic=False)
    if use.isotropic:
        yield SAME_AZIMUTH, use


def _difference(before: _Step, after: _Step) -> dict[str, float | int | None]:
    """Return what the fields of a `LeftOut` say of going from one plan to another."""
    outside = [each.expected.outside for each in (before, after)]
    seconds = before.plan.estimates.total_s - after.plan.estimates.total_s
    return {
        "spared_shots": len(before.plan.shots) - len(after.plan.shots),
        "spared_min": seconds / 60,
        "error_inside": after.expected.inside - before.expected.inside,
        "error_outside": None if None in outside else outside[1] - outside[0],  # type: ignore[operator]
    }
