"""The study's extreme cases, as far as they are quick."""

import pytest

from sim.dynamics import cases, held
from sim.dynamics.findings import Finding

QUICK = {
    "swing": held.undamped_week,
    "step": lambda: held.any_step((1e-7, 60.0)),
    "locked": held.locked_rotor,
    "creep": cases.creep,
    "work": lambda: cases.work(0.1),
}


@pytest.mark.parametrize("case", QUICK.values(), ids=QUICK)
def test_every_bound_holds(case):
    findings = list(case())
    assert findings
    assert [each for each in findings if not each.holds] == []


@pytest.mark.parametrize(("measured", "holds"), [(1.0, True), (1.1, False), (float("nan"), False)])
def test_what_is_no_number_holds_nothing(measured, holds):
    assert Finding("case", "what", measured, 1.0, "").holds is holds
