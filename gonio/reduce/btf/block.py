"""One file of the array: what a single process does at a time."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError, StorageError
from gonio.reduce.btf.develop import Tiles
from gonio.reduce.btf.job import Maps
from gonio.reduce.btf.outcome import Outcome
from gonio.reduce.btf.radiance import source_of, texels_of
from gonio.reduce.btf.shard import Shard
from gonio.reduce.btf.store import zarr
from gonio.reduce.dark import Dark
from gonio.reduce.frames import Frames

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gonio.reduce.btf.job import Block, Job
    from gonio.reduce.frames import Frame

_MM_PER_M = 1000.0


def reduce_block(job: Job, block: Block) -> Outcome:
    """Reduce the shots of a block and write its files; done twice, they come out the same.

    Raises
    ------
    gonio.errors.StorageError
        When a file cannot be written.
    """
    group = zarr().open_group(job.store, mode="r")
    first, names = _files_of(group["value"], block)
    room = group["value"].shards[1], -(-job.grid.side // group["value"].chunks[2])
    tiles = Tiles.empty(job.grid.side, group["value"].chunks[2])
    frames = Frames(job.root, job.rig.camera, block.records, job.remedy, job.geometry, job.sensor)
    notes = _Notes(job)
    try:
        with (
            Shard(job.store / names[0], *room) as value,
            Shard(job.store / names[1], *room) as sigma,
        ):
            for view, shot in zip(block.views, block.shots, strict=True):
                try:
                    bracket = frames.of_shot(shot)
                    texels_of(bracket, _maps(job), job, tiles)
                except BadInputError as error:
                    notes.problems.append(str(error))
                    continue
                value.put(view - first, tiles.value)
                sigma.put(view - first, tiles.sigma)
                notes.add(view, bracket)
        marks = {names[0]: value.mark, names[1]: sigma.mark} if notes.views else {}
        outcome = notes.outcome(block, frames.useless, marks)
        outcome.save(job.store, block.views[0])
    except OSError as error:
        raise StorageError.from_os(job.store, error) from error
    return outcome


def _files_of(array: Any, block: Block) -> tuple[int, tuple[str, str]]:
    """Return the first view that the block's files hold, and their names in the store."""
    number = block.views[0] // array.shards[1]
    place = f"c/{block.light}/{number}/0/0/0"
    return number * array.shards[1], (f"value/{place}", f"sigma/{place}")


def _maps(job: Job) -> Maps:
    return _maps_in(str(job.store), job.made_from, tuple(job.darks.items()))


# a process has one job at a time
@lru_cache(maxsize=1)
def _maps_in(
    store: str, made_from: str, darks: tuple[tuple[float, tuple[float, int]], ...]
) -> Maps:
    del made_from
    group = zarr().open_group(store, mode="r")
    response = group["response"][...] if "response" in group else None
    return Maps(
        {each: Dark(group[f"dark/{each!r}"][...], *noise) for each, noise in darks}, response
    )


class _Notes:
    """What is noted shot by shot."""

    def __init__(self, job: Job) -> None:
        self._job = job
        self.views: list[int] = []
        self.problems: list[str] = []
        self._places: dict[str, list[Any]] = {"light_mm": [], "view_mm": [], "used": []}

    def add(self, view: int, bracket: Sequence[Frame]) -> None:
        first = bracket[0]
        self.views.append(view)
        distance_mm = _MM_PER_M * self._job.rig.camera.distance_m
        self._places["light_mm"].append(_point(source_of(first, self._job).centre_mm))
        self._places["view_mm"].append(_point(first.view.place(distance_mm)))
        self._places["used"].extend(frame.record for frame in bracket)

    def outcome(
        self, block: Block, useless: dict[str, str], files: dict[str, tuple[int, int]]
    ) -> Outcome:
        return Outcome(
            made_from=block.made_from(self._job),
            light=block.light,
            views=tuple(self.views),
            problems=tuple(self.problems),
            useless=useless,
            files=files,
            **{name: tuple(values) for name, values in self._places.items()},
        )


def _point(place: Any) -> tuple[float, float, float]:
    x, y, z = np.asarray(place).tolist()
    return x, y, z
