"""Error against the rig's time: rounds as plans and journal keep them, fewer shots by a prior."""

import numpy as np
import pytest

from gonio.clock import VirtualClock
from gonio.report import course
from gonio.report.captured import Captured
from gonio.report.chosen import discs_of
from gonio.report.course import Reached, course_drawings, foretold, rounds_of
from gonio.report.sources import Sources
from nnbrdf.prior import MaterialPrior
from planner.further import Before, make_further_plan


@pytest.fixture
def further(measure):
    """Return a session with a second plan, of which the journal tells both."""

    def make(*, ended=True):
        session, samples = measure(truth=False)
        first = session.chain().last
        before = Before(first.sha256, session.chain().next_index, first.shots)
        plan = make_further_plan(session.rig(), before, 3, criterion="farthest")
        told = {"deviation_before": 0.4, "deviation_after": 0.3}
        plan = plan.model_copy(update={"selection": plan.selection.model_copy(update=told)})
        session.add_plan(plan)
        session.journal_path.unlink()
        clock = VirtualClock()
        with session.journal(writing=True) as journal:
            for each, seconds in ((first, 1000), (plan, 200)):
                journal.append(clock, "begun", plan=each.sha256, frames=0)
                clock.sleep(seconds)
                journal.append(clock, "finished")
                # between runs the rig rests
                clock.sleep(5000)
            if ended:
                reason = "the target is reached"
                journal.append(clock, "adaptive ended", reason=reason, shots=19, deviation=0.25)
        return session, samples

    return make


@pytest.mark.parametrize("ended", [True, False])
def test_rounds_are_at_the_rigs_time(further, ended):
    session, _ = further(ended=ended)
    rounds = [tuple(each) for each in rounds_of(session.chain(), Captured.of(session))]
    expected = [(1000, 0.4, 16), (1200, 0.25, 19)]
    assert rounds == [pytest.approx(each) for each in expected[: 1 + ended]]


def test_directions_of_further_plans_are_told_apart(further):
    session, samples = further()
    sources = Sources(session.model, samples, session, None, None)
    first, second = session.chain().plans
    for disc, side in zip(discs_of(sources), ("light", "view"), strict=True):
        known, all_ = (
            {shot.direction_deg(side) for plan in plans for shot in plan.shots}
            for plans in ((first,), (first, second))
        )
        assert (len(disc.chosen), len(disc.skipped)) == (len(all_), 81 - len(all_))
        assert sum(dot.later for dot in disc.chosen) == len(all_ - known)


def test_fewer_shots_are_quicker_and_worse(measure):
    session, _ = measure(truth=False, density=8)
    chain = session.chain()
    told = foretold(chain, session.rig(), MaterialPrior.generate(examples=30))
    assert [each.shots for each in told] == [64, 32, 16, 8]
    seconds, errors = (
        np.array([getattr(each, name) for each in told]) for name in ("seconds", "error")
    )
    assert (np.diff(seconds) < 0).all()
    assert (np.diff(errors) > 0).all()
    assert seconds[0] == pytest.approx(chain.estimated_s, rel=0.05)


def test_what_came_of_it_is_within_the_axes_though_it_took_longer(monkeypatch):
    figures = []
    monkeypatch.setattr(course, "drawing", lambda _, figure, __: figures.append(figure))
    told = [Reached(1000.0, 0.1, 16), Reached(500.0, 0.2, 8)]
    ends = [("own bands", Reached(1500.0, 0.09, 16)), ("true error", Reached(4000.0, 0.11, 20))]
    list(course_drawings([], told, ends))
    (axes,) = figures[0].axes
    left, right = axes.get_xlim()
    places = [line.get_xdata() for line in axes.get_lines()]
    assert all(left <= place <= right for place in np.concatenate([np.ravel(p) for p in places]))
