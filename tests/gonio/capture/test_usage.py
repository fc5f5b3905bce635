"""What a capture's time goes into: the parts make up the whole, and the journal keeps them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.capture.usage import Stopwatch, Usage
from gonio.clock import VirtualClock
from gonio.devices import MeanwhileClock
from gonio.errors import BadFileError
from planner.make import make_plan

SECONDS = st.floats(0.0, 1e4)
SHOTS = st.lists(st.tuples(SECONDS, SECONDS, SECONDS, SECONDS, st.booleans()), max_size=20)


@given(SHOTS)
def test_parts_make_up_the_whole_and_the_serial_order_is_no_shorter(shots):
    clock = VirtualClock(1000.0)
    watch = Stopwatch(clock)
    for move_s, exposure_s, waited_s, other_s, watched in shots:
        with watch.moving():
            clock.sleep(move_s)
        clock.sleep(exposure_s)
        watch.exposed(exposure_s)
        clock.sleep(waited_s)
        watch.fetched(move_s + waited_s, waited_s, watched=watched)
        clock.sleep(other_s)
    usage = watch.usage()
    assert usage.total_s == pytest.approx(clock.now() - 1000.0, abs=1e-6)
    assert 0.0 <= usage.serial_utilisation <= usage.utilisation <= 1.0
    assert usage.total_s <= usage.serial_s <= usage.total_s + sum(s[0] for s in shots) + 1e-6


@given(st.lists(SECONDS, max_size=10))
def test_runs_add_up(times):
    runs = [Usage(moving_s=time_s, other_s=1.0, hidden_s=2.0) for time_s in times]
    total = Usage.sum(runs)
    assert total.total_s == pytest.approx(sum(run.total_s for run in runs))
    assert total.serial_s == pytest.approx(sum(run.serial_s for run in runs))


@given(st.lists(SECONDS, min_size=1, max_size=5), st.integers(1, 40), st.floats(0.0, 0.5))
def test_a_wait_lasts_as_long_whatever_is_done_meanwhile(waits, times, takes_s):
    clock, calls = VirtualClock(), []
    meanwhile = MeanwhileClock(clock)

    def errand():
        calls.append(clock.now())
        clock.sleep(takes_s)
        return len(calls) == times

    meanwhile.errand = errand
    for wait_s in waits:
        began_s = clock.now()
        meanwhile.sleep(wait_s)
        # an errand that began in time may end late
        assert -1e-9 <= clock.now() - began_s - wait_s <= takes_s + 1e-9
    assert len(calls) <= times
    assert (meanwhile.errand is None) == (len(calls) == times)


def test_the_journal_keeps_it_run_by_run(stage):
    here = stage(lambda rig: make_plan(rig, views=2, lights=2))
    here.run_and_stop(after=3)
    first_s = here.took_s
    assert here.usage().total_s == pytest.approx(first_s)
    here.run()
    usage = here.usage()
    assert usage.total_s == pytest.approx(first_s + here.took_s)
    exposed_s = sum(exposure_s for _, exposure_s in here.shots())
    assert exposed_s < usage.exposing_s < usage.total_s - usage.moving_s


def test_a_damaged_one_is_told_in_one_line(stage, tampered):
    here = stage(lambda rig: make_plan(rig, views=2, lights=2))
    here.run()
    sql = "UPDATE event SET data = replace(data, ?, ?) WHERE kind = 'finished'"
    tampered(here.session.journal_path, sql, ("hidden_s", "hiden_s"))
    with pytest.raises(BadFileError, match=r"journal.sqlite: hiden_s: is not a known key"):
        here.usage()
