"""What became of a block, kept beside its files, so that an interrupted reduction can go on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pydantic import ValidationError

from gonio.files import write_json
from gonio.journal import FrameRecord
from gonio.reduce.btf.shard import mark_of
from gonio.validation import Document

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.reduce.btf.job import Block, Job

DONE: Final = "done"

Place = tuple[float, float, float]


class Outcome(Document):
    """What became of a block.

    Attributes
    ----------
    made_from
        See `gonio.reduce.btf.job.Block.made_from`.
    light, views
        Which pairs are in the array now.
    light_mm, view_mm
        Where lamps and camera were at each.
    used
        The records of their frames.
    problems
        Why other shots were left out.
    useless
        See `gonio.reduce.frames.Frames`.
    files
        Size and CRC-32C of what was written, by path in the array's folder.
    """

    made_from: str
    light: int
    views: tuple[int, ...] = ()
    light_mm: tuple[Place, ...] = ()
    view_mm: tuple[Place, ...] = ()
    used: tuple[FrameRecord, ...] = ()
    problems: tuple[str, ...] = ()
    useless: dict[str, str]
    files: dict[str, tuple[int, int]]

    def save(self, store: Path, first: int) -> None:
        """Keep it beside the array; `first` is the block's first view."""
        write_json(_path(store, self.light, first), self.model_dump(mode="json"))


def done_before(job: Job, block: Block) -> Outcome | None:
    """Return what became of a block, when all of it is there and made from what is there now."""
    path = _path(job.store, block.light, block.views[0])
    try:
        outcome = Outcome.model_validate_json(path.read_bytes())
    except (OSError, ValidationError):
        return None
    # a frame that was of no use may be back
    if outcome.problems or outcome.made_from != block.made_from(job):
        return None
    whole = all(mark_of(job.store / name) == mark for name, mark in outcome.files.items())
    return outcome if whole else None


def _path(store: Path, light: int, first: int) -> Path:
    return store / DONE / f"{light:05d}-{first:05d}.json"
