from typing import NamedTuple

import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.creation import create_session
from gonio.directions import from_degrees
from gonio.materials import MeasuredTable
from gonio.notes import Notes
from gonio.rig import default_rig, default_rig_text
from gonio.samples import Samples
from gonio.session import Session
from nnbrdf.paper import PaperEstimator
from planner.make import make_plan


class Measured(NamedTuple):
    session: Session
    samples: Samples


def a_truth(rng):
    return MeasuredTable.of(rng.lognormal(-2.0, 0.5, (81, 81, 3)))


def samples_of(plan, truth, channels):
    light, view = (
        from_degrees(
            [shot.axis_deg(f"{side}_theta") for shot in plan.shots],
            [shot.axis_deg(f"{side}_phi") for shot in plan.shots],
        )
        for side in ("light", "view")
    )
    value = truth.evaluate(light, view)[:, : len(channels)]
    value[0] = -1e-4  # noise about zero
    return Samples.from_values(light, view, value, 0.01 * abs(value), channels)


@pytest.fixture
def measure(tmp_path):
    """Make a session with samples, a quickly trained model and, unless told, its truth."""

    def make(*, channels=("r", "g", "b"), truth=True, name="oak, unvarnished", density=4):
        plan = make_plan(default_rig(), views=density, lights=density)
        notes = Notes(sample=name, orientation="grain", mounting="flat", operator=name)
        session = create_session(tmp_path / "session", plan, default_rig_text(), notes)
        material = a_truth(np.random.default_rng(0))
        if truth:
            material.save(session.truth_path)
        samples = samples_of(plan, material, channels)
        samples.save(session.samples_path)
        PaperEstimator(hidden=(4,), epochs=3).fit(samples).save(session.model)
        session.note_timing("reconstruct", 1.5)
        clock = VirtualClock()
        with session.journal(writing=True) as journal:
            journal.append(clock, "begun")
            clock.sleep(3723)
            journal.append(clock, "finished")
        return Measured(session, samples)

    return make
