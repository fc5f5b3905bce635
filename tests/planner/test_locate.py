import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gonio.rig import default_rig
from planner.candidates import Candidates
from planner.locate import rows_of
from planner.make import make_plan

PLAN = make_plan(default_rig(), views=1, lights=1)


@given(st.integers(0, 2**32 - 1), st.integers(1, 200))
def test_each_shot_is_found_where_it_was_chosen(seed, count):
    rng = np.random.default_rng(seed)
    candidates = Candidates("any", rng.uniform(0, 90, 40), rng.uniform(0, 360, 40))
    rows = rng.integers(0, 40, count)
    shots = tuple(
        PLAN.shots[0].model_copy(
            update={
                "light_theta_deg": float(candidates.theta_deg[row]),
                "light_phi_deg": float(candidates.phi_deg[row]),
            }
        )
        for row in rows
    )
    plan = PLAN.model_copy(update={"shots": shots})
    assert rows_of(plan, "light", candidates).tolist() == rows.tolist()


def test_at_the_pole_azimuth_is_nothing():
    pole = Candidates("two", np.array([10.0, 0.0]), np.array([90.0, 200.0]))
    shots = (PLAN.shots[0].model_copy(update={"light_theta_deg": 0.0, "light_phi_deg": 5.0}),)
    assert rows_of(PLAN.model_copy(update={"shots": shots}), "light", pole).tolist() == [1]
