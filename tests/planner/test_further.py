"""Plans that go on from shots that were measured."""

from dataclasses import replace

import numpy as np
import pytest

from gonio.errors import BadInputError, NothingLeftError
from gonio.rig import default_rig
from planner.candidates import Candidates
from planner.field import paper_field
from planner.further import Further
from planner.make import make_plan

RIG = default_rig()
FIELD = paper_field()


class Flat:
    """A prior under which every pair is as unknown as any other, and all by itself."""

    def kinds(self, light, view, rank):
        from gonio.protocols import PriorKind

        few = np.arange(len(light)) % 97
        return [PriorKind("flat", 1.0, np.eye(97), few)]


def plan_of(shots, after=None, **more):
    return make_plan(RIG, shots=shots, criterion="i-optimal", prior=Flat, after=after, **more)


def pairs_of(shots):
    return {
        ((s.light_theta_deg, s.light_phi_deg), (s.view_theta_deg, s.view_phi_deg)) for s in shots
    }


@pytest.mark.parametrize("reverses", [True, False])
def test_what_was_measured_is_left_out_and_the_rest_counted_on(reverses):
    first = plan_of(300)
    after = Further(first.sha256, 300, first.shots, reverses, (0.02,))
    second = plan_of(200, after)
    old, new = pairs_of(first.shots), pairs_of(second.shots)
    assert not old & new
    assert bool({(b, a) for a, b in old} & new) != reverses
    assert [shot.index for shot in second.shots] == list(range(300, 500))
    assert second.parent == first.sha256
    known = int(after.known(FIELD).sum())
    counts = {each.reason: each.shots for each in second.left_out}
    assert counts["measured before, as they are or reversed"] == known
    assert sum(counts.values()) + len(second.shots) == 6561
    # of four exposures, one has its dark and white frames
    assert second.estimates.frames == 200 * 4 + 3 * 8


def test_nothing_measured_leaves_nothing_out():
    assert not Further().known(FIELD).any()
    assert plan_of(20).sha256 == plan_of(20, Further()).sha256


def test_all_that_are_left_and_then_nothing():
    few = Candidates("few", np.array([0.0, 30.0, 30.0, 60.0]), np.array([0.0, 0.0, 90.0, 45.0]))
    sets = {"view_candidates": few, "light_candidates": few}
    first = plan_of(13, **sets)
    rest = plan_of(50, Further(first.sha256, 13, first.shots, reverses=False), **sets)
    assert len(rest.shots) == 3
    everything = Further(rest.sha256, 16, (*first.shots, *rest.shots), reverses=False)
    with pytest.raises(NothingLeftError, match="every pair that the rig can take"):
        plan_of(1, everything, **sets)
    with pytest.raises(BadInputError, match="shots is 0"):
        plan_of(0, Further(first.sha256, 13, first.shots[:3]), **sets)


def test_directions_of_other_sets_are_told_apart():
    shot = plan_of(1).shots[0]
    near = shot.model_copy(update={"view_theta_deg": shot.view_theta_deg + 0.5})
    assert Further(shots=[shot]).known(FIELD).sum() in (1, 2)
    assert not Further(shots=[near]).known(FIELD).any()
    lights = replace(FIELD, lights=replace(FIELD.lights, theta_deg=FIELD.lights.theta_deg + 1.0))
    assert not Further(shots=[shot], reverses=False).known(lights).any()
