"""Directions join a product so that it loses no pair where that can be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.rig import Rig, default_rig
from planner.candidates import paper_candidates
from planner.criteria import CRITERIA, PRIOR_CRITERIA, criterion_named
from planner.field import Field
from planner.pairing import may_join
from planner.reach import reach_of

BLIND = [name for name in CRITERIA if name not in PRIOR_CRITERIA]

# rows are lights, columns views
ALLOWED = np.array([[1, 1, 1, 1], [0, 1, 1, 1], [0, 0, 1, 1], [0, 0, 0, 0]], bool)

JOIN = [
    # chosen lights, chosen views, wanted, axis, who may join
    ([], [], (1, 1), 0, [0, 1, 2]),
    ([], [], (1, 4), 0, [0]),
    ([], [], (1, 3), 0, [0, 1]),
    ([], [0], (1, 1), 0, [0]),
    ([], [3], (2, 3), 0, [0, 1]),
    ([0], [0], (2, 1), 0, [1, 2]),
    ([0], [1], (2, 2), 0, [1]),
    ([1], [], (1, 2), 1, [1, 2, 3]),
    ([0, 2], [], (2, 2), 1, [2, 3]),
    ([0, 2], [2, 3], (2, 3), 1, [0, 1]),
    ([0, 1], [2, 3], (2, 3), 1, [1]),
    ([0, 1, 2], [0, 1, 2, 3], (3, 4), 1, []),
]


@pytest.mark.parametrize(("lights", "views", "wanted", "axis", "joins"), JOIN)
def test_who_may_join(lights, views, wanted, axis, joins):
    assert np.flatnonzero(may_join(ALLOWED, (lights, views), wanted, axis)).tolist() == joins


@given(st.integers(0, 2**32 - 1), st.integers(0, 1))
def test_where_everything_is_allowed_anything_may_join(seed, axis):
    rng = np.random.default_rng(seed)
    chosen = tuple(rng.permutation(9)[: rng.integers(9)].tolist() for _ in range(2))
    may = may_join(np.ones((9, 9), bool), chosen, (9, 9), axis)
    assert sorted(np.flatnonzero(may).tolist() + chosen[axis]) == list(range(9))


@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.integers(1, 6))
def test_a_product_that_is_there_is_found_light_by_light(seed, lights, views):
    """With the lights first, no pair is lost where the lights leave enough views in common."""
    rng = np.random.default_rng(seed)
    allowed = rng.random((12, 12)) < 0.5
    kept = rng.permutation(12)[:lights], rng.permutation(12)[:views]
    allowed[np.ix_(*kept)] = True
    chosen = ([], [])
    for axis, count in enumerate((lights, views)):
        for _ in range(count):
            may = may_join(allowed, chosen, (lights, views), axis)
            assert may.any()
            assert not may[chosen[axis]].any()
            chosen[axis].append(int(rng.choice(np.flatnonzero(may))))
    lost = (~allowed[np.ix_(*chosen)]).sum()
    common = allowed[chosen[0]].all(axis=0).sum()
    assert lost == 0 if common >= views else lost > 0


def field_of(degrees):
    data = default_rig().model_dump()
    data["arm"]["min_separation_deg"] = degrees
    candidates = paper_candidates()
    return Field(
        candidates, candidates, reach_of(candidates, candidates, Rig.model_validate(data)).allowed
    )


@pytest.mark.parametrize("name", BLIND)
@pytest.mark.parametrize("degrees", [12.0, 15.0, 30.0, 45.0, 60.0])
def test_fourteen_by_fourteen_are_kept(name, degrees):
    field = field_of(degrees)
    measured = criterion_named(name).product(field, 14, 14).measured
    assert (measured.any(axis=1).sum(), measured.any(axis=0).sum()) == (14, 14)
    assert not (measured & ~field.allowed).any()


@pytest.mark.parametrize("name", BLIND)
def test_what_cannot_be_had_is_lost_and_the_rest_kept(name):
    field = field_of(100.0)
    measured = criterion_named(name).product(field, 14, 14).measured
    assert (measured & field.allowed).any()
    assert (measured & ~field.allowed).any()
