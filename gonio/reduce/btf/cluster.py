"""Who does the work: processes of this machine, or the workers of a Dask scheduler."""

from __future__ import annotations

import logging
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from gonio.errors import BadInputError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator

_PATIENCE_S = 15


@contextmanager
def workers(scheduler: str | None) -> Iterator[Any]:
    """Yield a client of Dask.

    Parameters
    ----------
    scheduler
        Its address, such as `tcp://host:8786`; None starts a process for each core here.

    Raises
    ------
    gonio.errors.MissingExtraError
        When Dask is not installed.
    gonio.errors.BadInputError
        When no scheduler answers, or it has no workers.
    """
    try:
        import distributed
    except ModuleNotFoundError:
        raise MissingExtraError("dask", "btf") from None
    # what goes wrong is told once, by whoever asked for the work
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    if scheduler is not None:
        with _connected(distributed, scheduler) as client:
            yield client
        return
    with (
        distributed.LocalCluster(
            n_workers=len(os.sched_getaffinity(0)), threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _connected(distributed: Any, scheduler: str) -> Any:
    try:
        client = distributed.Client(scheduler, timeout=_PATIENCE_S)
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInputError(
            f"no Dask scheduler answers at {scheduler} ({error}); start one with: dask scheduler"
        ) from None
    try:
        client.wait_for_workers(1, timeout=_PATIENCE_S)
    except TimeoutError:
        client.close()
        raise BadInputError(
            f"the scheduler at {scheduler} has no workers; start some with: dask worker "
            f"{scheduler} --nthreads 1"
        ) from None
    return client
