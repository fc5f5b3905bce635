"""What a scene's plan spares, with a prior that is soon told."""

from functools import partial

import numpy as np
import pytest

from gonio.errors import BadInputError
from gonio.protocols import PriorKind
from gonio.rig import default_rig
from planner.candidates import candidates_named
from planner.locate import rows_of
from planner.make import field_within, make_plan
from planner.scene.expected import expected_error
from planner.scene.pairs import sample_pairs
from planner.scene.scene import Scene
from planner.scene.sparing import FREELY, IN_COLOR, Wanted, plan_for_use, without_color
from planner.scene.use import NOT_ASKED, SAME_AZIMUTH, Use

RIG, SET = default_rig(), candidates_named("rings:0x1,30x6,60x12")
SCENE = Scene.model_validate(
    {
        "surface": [{"shape": "flat", "tilt_deg": 0}],
        "light": [{"kind": "direction", "elevation_deg": 60, "azimuth_deg": 90}],
        "viewer": [{"kind": "direction", "elevation_deg": 60, "spread_deg": 20}],
    }
)
PAIRS = sample_pairs(SCENE, log2_samples=12)


class Smooth:
    """Believes that what is near is alike, without symmetries but isotropy in its first kind."""

    def kinds(self, light, view, rank):
        cosines = np.stack([light[:, 2], view[:, 2], np.sum(light * view, axis=1)], axis=1)
        every = {"isotropic": (0.8, cosines), "any": (0.2, np.hstack([light, view]))}
        return [
            PriorKind(name, share, factor_of(features, rank), np.arange(len(light)))
            for name, (share, features) in every.items()
        ]


def factor_of(features, rank):
    square = ((features[:, None] - features[None]) ** 2).sum(axis=-1)
    values, vectors = np.linalg.eigh(np.exp(-square / 0.5))
    # the first columns tell most, as those of a pivoted factor do
    return (vectors * np.sqrt(values.clip(min=0)))[:, ::-1][:, :rank]


class Recorded:
    """A maker that remembers how it was asked, and what it made."""

    def __init__(self, **settled):
        self.asked, self.made = [], []
        self._make = partial(make_plan, RIG, criterion="i-optimal", view_candidates=SET,
                             light_candidates=SET, **settled)  # fmt: skip

    def __call__(self, **how):
        self.asked.append(how)
        self.made.append(self._make(**how))
        return self.made[-1]


def plan_of(use, wanted, make=None):
    make = make or Recorded(views=6, lights=6)
    return plan_for_use(use, wanted, make, partial(field_within, RIG, SET, SET, None), Smooth), make


def row(plan, reason):
    return next(each for each in plan.left_out if each.reason == reason)


def errors(use, plan):
    """Return the expected error inside, of the plan's own pairs, under what the use believes."""
    kinds = Smooth().kinds(*field_within(RIG, SET, SET, None, {}).pairs, 400)
    if use.isotropic:
        kinds = [kinds[0]._replace(share=1.0)]
    measured = np.zeros((len(SET), len(SET)), bool)
    # by place: the route is free to choose the azimuth at the pole
    measured[rows_of(plan, "light", SET), rows_of(plan, "view", SET)] = True
    return expected_error(kinds, measured, use.demand(SET, SET), use.asked(SET, SET))


USES = [Use(PAIRS), Use(PAIRS, isotropic=True), Use(isotropic=True)]


@pytest.mark.parametrize("use", USES, ids=["scene", "scene, isotropic", "isotropic"])
def test_accuracy_is_kept_in_fewer_shots(use):
    plan, make = plan_of(use, Wanted(fewest=True))
    plain = make.made[0]
    before, after = errors(use, plain), errors(use, plan)
    assert len(plan.shots) < len(plain.shots) == 36
    assert after.inside <= before.inside * 1.001
    spared = [each for each in plan.left_out if each.spared_shots is not None]
    assert [each.reason for each in spared] == [FREELY, *use.omissions()]
    assert sum(each.spared_shots for each in spared) == 36 - len(plan.shots)
    seconds = plain.estimates.total_s - plan.estimates.total_s
    assert sum(each.spared_min for each in spared) == pytest.approx(seconds / 60)
    change = sum(each.error_inside for each in spared)
    assert change == pytest.approx(after.inside - before.inside, abs=1e-9)
    assert sum(each.shots for each in plan.left_out) == len(SET) ** 2 - len(plan.shots)


def test_there_are_enough_to_make_something_of_them():
    plan, _ = plan_of(Use(PAIRS), Wanted(fewest=True, least=30))
    assert len(plan.shots) == 30


def test_the_demand_decides_where_shots_go():
    use = Use(PAIRS)
    plan, make = plan_of(use, Wanted(shots=8))
    alike = make(prior=Smooth, shots=8, leave_out=use.omissions())
    assert errors(use, plan).inside < errors(use, alike).inside
    assert [how["shots"] for how in make.asked[:2]] == [8, 8]
    assert row(plan, NOT_ASKED).spared_shots == 0
    assert row(plan, NOT_ASKED).error_inside < 0


def test_views_and_lights_may_be_settled():
    plan, make = plan_of(Use(PAIRS), Wanted(), Recorded(views=3, lights=3))
    assert plan.selection.views <= 3
    assert [how["shots"] for how in make.asked] == [None, None]


def test_without_an_outside_nothing_is_said_of_it():
    plan, _ = plan_of(Use(isotropic=True), Wanted(shots=9))
    assert row(plan, SAME_AZIMUTH).error_outside is None


def test_more_shots_than_count_are_refused_before_any_are_chosen():
    make = Recorded(views=6, lights=6)
    with pytest.raises(
        BadInputError, match=r"shots is 361; give 1 to \d+, all pairs that .* count"
    ):
        plan_of(Use(PAIRS), Wanted(shots=361), make)
    assert make.asked == []


def test_color_is_no_more_than_a_row():
    plan = make_plan(RIG, views=2, lights=2)
    mono = without_color(plan)
    assert mono.shots == plan.shots
    assert mono.left_out[:-1] == plan.left_out
    assert mono.left_out[-1].reason == IN_COLOR
