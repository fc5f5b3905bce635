"""Turns of the phi axes, and the pole at any azimuth, from the plan through the twin to samples."""

import json
import sqlite3

import numpy as np
import pytest

from gonio.directions import from_degrees
from gonio.plan import Plan
from gonio.samples import Samples

POSES = [
    # view theta, phi, turn, light theta, phi, turn
    (30.0, 0.0, 1, 0.0, 77.0, 0),
    (45.0, 357.0, -1, 60.0, 90.0, 0),
    (0.0, 200.0, 0, 30.0, 3.0, 1),
]
NAMES = ("view_theta_deg", "view_phi_deg", "view_turn", "light_theta_deg", "light_phi_deg",
         "light_turn")  # fmt: skip


def write_plan(gonio, path):
    assert gonio("plan", "--density", "2", "-o", path).returncode == 0
    plan = Plan.load(path)
    shots = tuple(
        shot.model_copy(update=dict(zip(NAMES, pose, strict=True)))
        for shot, pose in zip(plan.shots, POSES, strict=False)
    )
    plan.model_copy(update={"shots": shots}).save(path)


def encoders(session):
    """Return the axes' angles, as the encoders told them, by shot."""
    with sqlite3.connect(session / "journal.sqlite") as journal:
        rows = journal.execute("SELECT data FROM event WHERE kind = 'frame'").fetchall()
    frames = [json.loads(row[0]) for row in rows]
    return {frame["shot_index"]: frame for frame in frames if frame["role"] == "shot"}


def test_axes_turn_as_planned_and_samples_keep_the_directions(gonio, tmp_path):
    write_plan(gonio, tmp_path / "plan.json")
    captured = gonio("capture", "--sim")
    assert captured.returncode == 0, captured.stderr
    assert gonio("reduce", "session").returncode == 0
    told = encoders(tmp_path / "session")
    for shot, pose in enumerate(POSES):
        for side, (theta, phi, turn) in (("view", pose[:3]), ("light", pose[3:])):
            assert told[shot][f"{side}_theta_deg"] == pytest.approx(theta, abs=0.05)
            assert told[shot][f"{side}_phi_deg"] == pytest.approx(phi + 360 * turn, abs=0.05)
    samples = Samples.load(tmp_path / "session/samples.nc")
    poses = np.array(POSES)
    assert samples.view == pytest.approx(from_degrees(*poses[:, :2].T), abs=2e-3)
    assert samples.light == pytest.approx(from_degrees(*poses[:, 3:5].T), abs=2e-3)


def test_a_turn_beyond_the_travel_is_refused_before_anything_moves(gonio, tmp_path):
    path = tmp_path / "plan.json"
    write_plan(gonio, path)
    plan = Plan.load(path)
    beyond = plan.shots[1].model_copy(update={"light_turn": 1})
    plan.model_copy(update={"shots": (beyond,)}).save(path)
    result = gonio("capture", "--sim")
    assert result.returncode == 2
    assert "light_phi 450 deg is beyond the axis' travel" in result.stderr
