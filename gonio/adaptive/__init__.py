"""Measuring a material by what was measured of it: the next shots, and rounds until a target."""

from __future__ import annotations

from gonio.adaptive.goal import Goal, begin, ending, goal_under_way, last_goal
from gonio.adaptive.rounds import Round, Rounds, rig_time
from gonio.adaptive.standing import Standing, Watch

__all__ = [
    "Goal", "Round", "Rounds", "Standing", "Watch", "begin", "ending", "goal_under_way",
    "last_goal", "rig_time",
]  # fmt: skip
