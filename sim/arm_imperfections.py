"""How far the twin's arms are from ideal ones: one size for each imperfection."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import model_validator

from gonio.validation import within
from sim.misalignment import Misalignment

_LARGEST_HZ, _DAY_S = 100.0, 86400.0


class ArmImperfections(Misalignment):
    """Imperfections of all four axes and both arms; 0 is none.

    Attributes
    ----------
    arm_resonance_hz, arm_damping
        Of an arm that swings after a move, and blurs frames meanwhile; the damping is a share of
        the critical one.
    arm_backlash_deg
        Play of the gears, from flank to flank.
    arm_friction_deg
        How far short of its target friction stops the load.
    arm_sag_urad
        How far the arm's end bends under its weight when the arm is level, behind the encoder.
    arm_expansion_urad_k, arm_room_k, arm_warm_up_k, arm_thermal_s
        How far warmth turns the arm's end; half the room's swing over a day; how much warmer a
        powered arm gets; and how slowly.
    arm_encoder_step_counts, arm_encoder_noise_counts
        What the encoder can tell apart, and its noise (one standard deviation).
    """

    arm_resonance_hz: Annotated[float, within(0, _LARGEST_HZ)] = 0.0
    arm_damping: Annotated[float, within(0.001, 0.9)] = 0.05
    arm_backlash_deg: Annotated[float, within(0, 1)] = 0.0
    arm_friction_deg: Annotated[float, within(0, 1)] = 0.0
    arm_sag_urad: Annotated[float, within(0, 1e5)] = 0.0
    arm_expansion_urad_k: Annotated[float, within(-1e4, 1e4)] = 0.0
    arm_room_k: Annotated[float, within(0, 50)] = 0.0
    arm_warm_up_k: Annotated[float, within(0, 100)] = 0.0
    arm_thermal_s: Annotated[float, within(1, _DAY_S)] = 1000.0
    arm_encoder_step_counts: Annotated[float, within(0, 1e6)] = 0.0
    arm_encoder_noise_counts: Annotated[float, within(0, 1e6)] = 0.0

    @model_validator(mode="after")
    def _rings_down(self) -> ArmImperfections:
        if 0 < self.arm_resonance_hz < 0.5:
            raise ValueError(f"arm_resonance_hz {self.arm_resonance_hz:g}: use 0, or 0.5 to 100")
        return self


# a ramp of 1 s, as the built-in rig's, ends its own swing at a whole number of Hz: none of these is
MILD: Final = ArmImperfections(
    arm_resonance_hz=7.3,
    arm_damping=0.06,
    arm_backlash_deg=0.002,
    arm_friction_deg=0.001,
    arm_sag_urad=50.0,
    arm_expansion_urad_k=5.0,
    arm_room_k=1.0,
    arm_warm_up_k=3.0,
    arm_encoder_noise_counts=0.5,
)
"""Of good arms, well kept."""

ALL: Final = ArmImperfections(
    arm_resonance_hz=4.6,
    arm_damping=0.03,
    arm_backlash_deg=0.01,
    arm_friction_deg=0.005,
    arm_sag_urad=500.0,
    arm_expansion_urad_k=20.0,
    arm_room_k=3.0,
    arm_warm_up_k=10.0,
    arm_encoder_step_counts=4.0,
    arm_encoder_noise_counts=2.0,
)
"""Each large enough to be seen."""
