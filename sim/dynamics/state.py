"""The numbers that say all of an axis at an instant, by their place in its state."""

from __future__ import annotations

CURRENT, MOTOR_SPEED, MOTOR, LOAD_SPEED, LOAD, WARMTH, LOST, DEMAND, DEMAND_SPEED = range(9)
"""A; rad/s and rad of the motor; of the load; K above the room; J turned to heat less those
supplied; rad and rad/s that are asked for."""

SIZE = 9

SCALES = (1.0, 1e-2, 1e-2, 1e-2, 1e-2, 1.0, 1.0, 1.0, 1.0)
"""What one unit of a tolerance means for each."""
