"""Who does the work: processes of this machine, or the workers of a Dask scheduler."""

from __future__ import annotations

import logging
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

from gonio.errors import BadInputError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE_S: Final = 15
"""How long workers may be silent before they are looked for."""


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
    for name in ("distributed", "distributed.client", "distributed.core", "distributed.comm"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if scheduler is not None:
        with _connected(distributed, scheduler) as client:
            yield client
        return
    with (
        distributed.LocalCluster(
            n_workers=len(os.sched_getaffinity(0)),
            threads_per_worker=1,
            # any free port: none at all becomes the usual one, and a warning where that is taken
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def _connected(distributed: Any, scheduler: str) -> Any:
    try:
        client = distributed.Client(scheduler, timeout=PATIENCE_S)
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInputError(
            f"no Dask scheduler answers at {scheduler} ({error}); start one with: dask scheduler"
        ) from None
    try:
        client.wait_for_workers(1, timeout=PATIENCE_S)
    except TimeoutError:
        client.close()
        raise BadInputError(
            f"the scheduler at {scheduler} has no workers; start some with: dask worker "
            f"{scheduler} --nthreads 1"
        ) from None
    return client


def check_workers(client: Any) -> None:
    """Find out whether anybody is left to work.

    Raises
    ------
    gonio.errors.BadInputError
        When there is nobody.
    """
    try:
        threads = client.nthreads()
    except OSError:  # the scheduler does not answer either
        threads = {}
    if not threads:
        raise BadInputError(
            "all workers of the scheduler are gone; start some, and run the command again: it goes "
            "on where it was"
        )


@contextmanager
def met() -> Iterator[None]:
    """Say in one line that the scheduler went while something was asked of it.

    Raises
    ------
    gonio.errors.BadInputError
        For whatever Dask says of that.
    """
    from concurrent.futures import CancelledError

    from distributed.client import FuturesCancelledError
    from distributed.comm.core import CommClosedError

    try:
        yield
    except (CancelledError, FuturesCancelledError, CommClosedError):
        raise BadInputError(
            "the scheduler is gone; start another, or leave out --scheduler, and run the command "
            "again: it goes on where it was"
        ) from None
