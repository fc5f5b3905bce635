"""How the twin's arms stand otherwise than their encoders and the rig file say."""

from __future__ import annotations

from gonio.alignment import Alignment, Length, Offset
from gonio.validation import Document


class Misalignment(Document):
    """Errors of the axes of both arms, as `gonio.alignment.Alignment` has them; 0 is none."""

    arm_view_theta_offset_deg: Offset = 0.0
    arm_view_phi_offset_deg: Offset = 0.0
    arm_view_phi_tilt_x_deg: Offset = 0.0
    arm_view_phi_tilt_y_deg: Offset = 0.0
    arm_view_theta_tilt_deg: Offset = 0.0
    arm_view_roll_deg: Offset = 0.0
    arm_view_distance_mm: Length = 0.0
    arm_view_centre_x_mm: Length = 0.0
    arm_view_centre_y_mm: Length = 0.0
    arm_view_centre_z_mm: Length = 0.0
    arm_light_theta_offset_deg: Offset = 0.0
    arm_light_phi_offset_deg: Offset = 0.0
    arm_light_phi_tilt_x_deg: Offset = 0.0
    arm_light_phi_tilt_y_deg: Offset = 0.0
    arm_light_theta_tilt_deg: Offset = 0.0
    arm_light_roll_deg: Offset = 0.0
    arm_light_distance_mm: Length = 0.0
    arm_light_centre_x_mm: Length = 0.0
    arm_light_centre_y_mm: Length = 0.0
    arm_light_centre_z_mm: Length = 0.0

    def alignment(self, arm: str) -> Alignment:
        """Return those of one arm, `"view"` or `"light"`."""
        names = Alignment.model_fields
        return Alignment(**{name: getattr(self, f"arm_{arm}_{name}") for name in names})
