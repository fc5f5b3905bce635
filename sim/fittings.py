"""What an axis is fitted with beside its motor: the arm that it shakes, its gear, its encoder."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gonio.rig import AXES
from sim.encoder import Encoder
from sim.flexible_arm import FlexibleArm
from sim.vibration import Vibration

if TYPE_CHECKING:
    from gonio.rig import Rig
    from sim.arm_imperfections import ArmImperfections

ARMS = ("view", "light")


@dataclass(frozen=True)
class Fittings:
    """Of one axis.

    Attributes
    ----------
    name
        The axis'.
    vibration
        Of the arm that it belongs to.
    half_play
        How far the load may trail what drives it, in counts.
    encoder
        Reads where the load is.
    """

    name: str
    vibration: Vibration
    half_play: float = 0.0
    encoder: Encoder = field(default_factory=Encoder)


def fittings_of(rig: Rig, wanted: ArmImperfections, seed: int) -> dict[str, Fittings]:
    """Return what the four axes are fitted with, by their names."""
    arms = {arm: _vibration(wanted) for arm in ARMS}
    trail_deg = 0.5 * wanted.arm_backlash_deg + wanted.arm_friction_deg
    return {
        name: Fittings(
            name,
            arms[name.partition("_")[0]],
            trail_deg * abs(rig.axis[name].counts_per_deg),
            Encoder(
                wanted.arm_encoder_step_counts, wanted.arm_encoder_noise_counts, (seed, number)
            ),
        )
        for number, name in enumerate(AXES)
    }


def _vibration(wanted: ArmImperfections) -> Vibration:
    if wanted.arm_resonance_hz:
        return FlexibleArm(wanted.arm_resonance_hz, wanted.arm_damping)
    return Vibration()
