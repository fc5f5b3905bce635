"""How well a session's material is known, and which shots would tell most."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.directions import from_degrees
from gonio.rig import AXES
from nnbrdf.prior.conditioned import ConditionedPrior
from nnbrdf.prior.geometry import Pairs
from nnbrdf.prior.ground import Grounds
from nnbrdf.prior.infer import infer
from nnbrdf.usable import check_samples
from planner.further import Before, make_further_plan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gonio.plan import Plan, Shot
    from gonio.planchain import PlanChain
    from gonio.samples import Samples
    from gonio.session import Session
    from nnbrdf.prior import MaterialPrior


class Watch:
    """Takes stock of a session as it grows.

    Parameters
    ----------
    session
        Which one.
    prior
        What materials look like.
    """

    def __init__(self, session: Session, prior: MaterialPrior) -> None:
        self._session, self._prior = session, prior
        self._grounds = Grounds()

    def take_stock(self, samples: Samples) -> Standing:
        """Return what samples tell of the material.

        Raises
        ------
        gonio.errors.BadInputError
            When they are too few or not usable.
        """
        check_samples(samples, "prior")
        chain = self._session.chain()
        inference = infer(self._prior.families, samples)
        coming = _coming(chain, samples)
        light, view = (
            np.concatenate([getattr(samples, side), _directions(coming, side)])
            for side in ("light", "view")
        )
        sites = Pairs.of(light, view)
        belief = ConditionedPrior.of(self._prior.families, inference, sites, self._grounds)
        return Standing(self._session, chain, samples, belief, self._prior.sha256)


@dataclass(frozen=True)
class Standing:
    """What is known of a session's material.

    Attributes
    ----------
    session, chain
        Where it is measured, and by which plans.
    samples
        What was measured.
    belief
        What is unknown once shots that are on their way are taken.
    prior_sha256
        Of the prior under which it is told.
    """

    session: Session
    chain: PlanChain
    samples: Samples
    belief: ConditionedPrior
    prior_sha256: str

    @property
    def deviation(self) -> float:
        """Mean posterior standard deviation of ln(f + 0.01 white) over the 81 x 81 pairs."""
        return self.belief.deviation

    def next_plan(
        self, shots: int, *, at_once: bool = False, exactly: bool = False, **choice: Any
    ) -> Plan:
        """Choose the next shots: those that leave least unknown of this material.

        Pairs that were measured are not chosen again, nor their reverses where the material keeps
        reciprocity; those whose samples the others do not explain are, where that pays.

        Parameters
        ----------
        shots
            How many; of fewer that are left, all.
        at_once
            Whether the rig, just done with the shots before, goes on without being homed again.
        exactly
            Whether to refuse where fewer are left.
        choice
            More of `planner.make.make_plan`: candidates, criterion, demand, timing, bracket.

        Raises
        ------
        gonio.errors.BadInputError
            As `planner.further.make_further_plan`.
        """
        # `choice` may say bracket="predicted": then exposures come from `self.belief.expected`
        plan = make_further_plan(
            self.session.rig(),
            self._before(at_once),
            shots,
            exactly=exactly,
            prior=lambda: self.belief,
            **({"criterion": "i-optimal"} | choice),
        )
        light, view = (_directions(plan.shots, side) for side in ("light", "view"))
        told = {
            "deviation_before": round(self.deviation, 6),
            "deviation_after": round(self.belief.deviation_after(light, view), 6),
            "prior_sha256": self.prior_sha256,
        }
        return plan.model_copy(update={"selection": plan.selection.model_copy(update=told)})

    def _before(self, at_once: bool) -> Before:
        last = self.chain.shots[-1]
        strange = set(self.samples.shot_index[self.belief.inference.outliers].tolist())
        return Before(
            parent=self.chain.last.sha256,
            next_index=self.chain.next_index,
            shots=[shot for shot in self.chain.shots if shot.index not in strange],
            reverses=self.belief.inference.posterior.reciprocal,
            calibrated_s=self.chain.exposures_s,
            at_deg=tuple(last.axis_deg(name) for name in AXES) if at_once else None,
        )


def _coming(chain: PlanChain, samples: Samples) -> list[Shot]:
    have = set(samples.shot_index.tolist())
    return [shot for shot in chain.shots if shot.index not in have]


def _directions(shots: Sequence[Shot], side: str) -> NDArray[np.float64]:
    theta_deg, phi_deg = (
        np.array([shot.axis_deg(f"{side}_{angle}") for shot in shots], np.float64)
        for angle in ("theta", "phi")
    )
    return from_degrees(theta_deg, phi_deg).reshape(-1, 3)
