"""Plans that go on from shots that were measured."""

from dataclasses import replace

import numpy as np
import pytest

from gonio.errors import BadInputError, NothingLeftError
from gonio.rig import default_rig
from planner.candidates import Candidates
from planner.field import paper_field
from planner.further import MEASURED, Before, make_further_plan
from planner.make import make_plan

RIG = default_rig()
FIELD = paper_field()


class Flat:
    """A prior under which every pair is as unknown as any other, and all by itself."""

    def kinds(self, light, view, rank):
        from gonio.protocols import PriorKind

        few = np.arange(len(light)) % 97
        return [PriorKind("flat", 1.0, np.eye(97), few)]


FLAT = {"criterion": "i-optimal", "prior": Flat}


def pairs_of(shots):
    return {
        ((s.light_theta_deg, s.light_phi_deg), (s.view_theta_deg, s.view_phi_deg)) for s in shots
    }


@pytest.mark.parametrize("reverses", [True, False])
def test_what_was_measured_is_left_out_and_the_rest_counted_on(reverses):
    first = make_plan(RIG, shots=300, **FLAT)
    before = Before(first.sha256, 300, first.shots, reverses, (0.02,))
    second = make_further_plan(RIG, before, 200, **FLAT)
    old, new = pairs_of(first.shots), pairs_of(second.shots)
    assert not old & new
    assert bool({(b, a) for a, b in old} & new) != reverses
    assert [shot.index for shot in second.shots] == list(range(300, 500))
    assert second.parent == first.sha256
    counts = {each.reason: each.shots for each in second.left_out}
    assert counts[MEASURED] == before.known(FIELD).sum()
    assert sum(counts.values()) + len(second.shots) == 6561
    # of four exposures, one has its dark and white frames
    assert second.estimates.frames == 200 * 4 + 3 * 8


def test_calibration_that_is_there_costs_nothing():
    first = make_plan(RIG, shots=20, **FLAT)
    told = [
        make_further_plan(RIG, Before(first.sha256, 20, first.shots, True, done), 20, **FLAT)
        for done in ((), RIG.camera.exposures_s[:2], RIG.camera.exposures_s)
    ]
    nothing, half, everything = (plan.estimates for plan in told)
    assert nothing.frames - half.frames == half.frames - everything.frames == 16
    assert nothing.total_s > half.total_s > everything.total_s
    # not even the way to where the white reference is measured
    assert half.exposing_s - everything.exposing_s == pytest.approx(8 * (0.2 + 2.0))
    assert half.moving_s > everything.moving_s


def test_all_that_are_left_and_then_nothing():
    few = Candidates("few", np.array([0.0, 30.0, 30.0, 60.0]), np.array([0.0, 0.0, 90.0, 45.0]))
    choice = FLAT | {"view_candidates": few, "light_candidates": few}
    first = make_plan(RIG, shots=13, **choice)
    some = Before(first.sha256, 13, first.shots, reverses=False)
    rest = make_further_plan(RIG, some, 50, **choice)
    assert len(rest.shots) == 3
    everything = Before(rest.sha256, 16, (*first.shots, *rest.shots), reverses=False)
    with pytest.raises(NothingLeftError, match="every pair that the rig can take"):
        make_further_plan(RIG, everything, 1, **choice)
    with pytest.raises(BadInputError, match="shots is 0"):
        make_further_plan(RIG, some, 0, **choice)


def test_directions_of_other_sets_are_told_apart():
    shot = make_plan(RIG, shots=1, **FLAT).shots[0]
    near = shot.model_copy(update={"view_theta_deg": shot.view_theta_deg + 0.5})
    assert Before("", 1, [shot]).known(FIELD).sum() in (1, 2)
    assert not Before("", 1, [near]).known(FIELD).any()
    lights = replace(FIELD, lights=replace(FIELD.lights, theta_deg=FIELD.lights.theta_deg + 1.0))
    assert not Before("", 1, [shot], reverses=False).known(lights).any()
