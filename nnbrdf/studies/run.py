"""Carrying out a study: all cores, resumable, the same results on any number of them."""

from __future__ import annotations

from concurrent.futures import FIRST_COMPLETED, CancelledError, ThreadPoolExecutor, wait
from threading import Lock
from typing import TYPE_CHECKING

from nnbrdf.cores import cores
from nnbrdf.studies.store import appending, read_results
from nnbrdf.studies.train import carry_out

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from concurrent.futures import Future
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from nnbrdf.studies.job import Job, Outcome
    from nnbrdf.studies.train import Truth

_LOOK_S = 0.25


def run_jobs(
    jobs: Sequence[Job],
    truths: Mapping[str, Truth],
    subsets: Mapping[str, NDArray[np.int64]],
    folder: Path,
    report: Progress = lambda done, total: None,
) -> list[Outcome]:
    """Carry out those jobs that the folder has no outcome of.

    Parameters
    ----------
    jobs
        In any order; long ones are begun first, so that no core waits at the end.
    truths
        By `Job.material`.
    subsets
        By `Job.subset`, indices of the flattened 81 x 81 grid.
    folder
        Where `results.jsonl` is or will be; outcomes of other jobs in it stay.
    report
        Called with the steps done and all there are, of all jobs, several times a second.

    Returns
    -------
    list of Outcome
        In the order of the jobs.

    Raises
    ------
    gonio.errors.BadFileError
        When a line of `results.jsonl` is no outcome.
    gonio.errors.BadInputError
        When another process carries out a study in this folder.
    gonio.errors.StorageError
        When an outcome cannot be written.
    """
    # settings may share a training: once is enough
    different = {job.key: job for job in jobs}
    # what is known is read once nobody else writes here
    with appending(folder) as append, ThreadPoolExecutor(cores()) as pool:
        known = read_results(folder)
        wanted = [job for key, job in different.items() if key not in known]
        watch = _Watch()
        try:
            running = {
                pool.submit(carry_out, job, truths[job.material], subsets, watch.tick)
                for job in sorted(wanted, key=lambda job: -job.steps)
            }
            total = sum(job.steps for job in different.values())
            before = total - sum(job.steps for job in wanted)
            for outcome in _finished(running, lambda: report(before + watch.steps, total)):
                append(outcome)
                known[outcome.job.key] = outcome
        except BaseException:
            watch.is_over = True
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [known[job.key] for job in jobs]


def _finished(running: set[Future[Outcome]], look: Callable[[], None]) -> Iterator[Outcome]:
    """Yield outcomes as they come; look at them several times a second, and at the end."""
    look()
    while running:
        finished, running = wait(running, _LOOK_S, return_when=FIRST_COMPLETED)
        for future in finished:
            yield future.result()
        look()


class _Watch:
    """What the threads that train and the one that waits know of each other."""

    def __init__(self) -> None:
        self.is_over = False
        self.steps = 0
        self._lock = Lock()

    def tick(self, steps: int) -> None:
        """Count steps; end the training once nobody waits for it."""
        with self._lock:
            self.steps += steps
        if self.is_over:
            raise CancelledError
