"""Runs of `gonio` that are killed at an event of their journal, or whose lamps do not drift."""

import os
import signal


class KillingForks:
    """`tests.forks.Forks` that meddle with what they run."""

    def __init__(self, forks):
        self._forks = forks

    def run(self, cwd, *arguments, kill_at=None, drift=True):
        """Run `gonio` with these arguments.

        `kill_at` is (n, "before" or "after"): SIGKILL before or after the n-th event of this run is
        in the journal. Without `drift`, lamps give the same light cold and warm.
        """
        meddle = ("tests.system.kills:meddle", kill_at, drift)
        return self._forks.run(cwd, *arguments, before=meddle)


def meddle(kill_at, drift):
    if kill_at:
        kill_at_event(*kill_at)
    if not drift:
        import sim.led

        sim.led._DROOP_PER_C = 0.0


def kill_at_event(number, when):
    from gonio.journal import Journal

    insert, count = Journal._insert, 0

    def counted(self, *row):
        nonlocal count
        count += 1
        if (count, when) == (number, "before"):
            os.kill(os.getpid(), signal.SIGKILL)
        insert(self, *row)
        if (count, when) == (number, "after"):
            os.kill(os.getpid(), signal.SIGKILL)

    Journal._insert = counted
