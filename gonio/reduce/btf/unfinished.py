"""An array that is being made: begun, or gone on with where an earlier run was interrupted."""

from __future__ import annotations

import json
import logging
import shutil
from typing import TYPE_CHECKING, Final

from gonio.errors import ResumeRefusedError
from gonio.files import write_json
from gonio.reduce.btf.outcome import DONE, done_before
from gonio.reduce.btf.store import make_store

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from gonio.reduce.btf.job import Block, Job, Maps
    from gonio.reduce.btf.layout import Layout
    from gonio.reduce.btf.outcome import Outcome

_INPUTS: Final = "inputs.json"

_log = logging.getLogger(__name__)


def begin(
    store: Path, inputs: Mapping[str, str], layout: Layout, maps: Maps, *, anew: bool
) -> None:
    """Make the store, or leave the one that was made from the same.

    Parameters
    ----------
    store
        Beside the finished array.
    inputs
        Hash of all that texels are made from, but for the shots' own frames, by name.
    layout, maps
        What the store begins with.
    anew
        Whether what is there shall go.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        When texels were made from something else, and nobody said that they shall go.
    """
    before = _read(store)
    if before == inputs and not anew:
        return
    if before and not anew and any((store / DONE).glob("*.json")):
        names = sorted(name for name in {*before, *inputs} if before.get(name) != inputs.get(name))
        old = "format of files" in names  # nothing that somebody could go on with
        raise ResumeRefusedError(
            f"{store.parent}: the reduction to texels that was interrupted had other "
            f"{', '.join(names)}; {'' if old else 'go on with those, or '}begin afresh with --anew"
        )
    shutil.rmtree(store, ignore_errors=True)
    make_store(store, layout, maps)
    # written last: without it there is nothing to go on with
    write_json(store / _INPUTS, dict(inputs))


def _read(store: Path) -> dict[str, str]:
    try:
        inputs = json.loads((store / _INPUTS).read_bytes())
    except (OSError, ValueError):
        return {}
    return inputs if isinstance(inputs, dict) else {}


def already(job: Job, blocks: Sequence[Block]) -> list[Outcome]:
    """Return what became of the blocks that are done, and say so."""
    found = [outcome for block in blocks if (outcome := done_before(job, block))]
    if found:
        _log.warning(
            "%s: going on with a reduction that was interrupted; %d of %d shots are done",
            job.root, sum(len(each.views) for each in found), sum(len(b.shots) for b in blocks),
        )  # fmt: skip
    return found


def tidy(store: Path) -> None:
    """Remove what is no part of the array."""
    shutil.rmtree(store / DONE, ignore_errors=True)
    (store / _INPUTS).unlink(missing_ok=True)
