"""The reduction of a whole session to pictures of the sample, on as many processes as there are."""

from __future__ import annotations

import shutil
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadInputError, StorageError
from gonio.files import canonical_json, sha256_bytes
from gonio.photogrammetry.grid import TexelGrid
from gonio.reduce.btf.block import reduce_block
from gonio.reduce.btf.cluster import PATIENCE_S, check_workers, met, workers
from gonio.reduce.btf.job import Job, Maps
from gonio.reduce.btf.layout import Layout
from gonio.reduce.btf.store import FORMAT, Btf, btf_path, finish_store
from gonio.reduce.btf.unfinished import already, begin, tidy
from gonio.reduce.calibrate import calibrate
from gonio.reduce.color import wanted_in
from gonio.reduce.correction import correction_in
from gonio.reduce.opening import open_frames
from gonio.reduce.patch import PatchFinder, usual_patch_mm
from gonio.reduce.provenance import provenance_of, shot_exposures
from gonio.reduce.radiance import pixels_of
from gonio.reduce.reduce import reject, warn

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from gonio.protocols import Progress
    from gonio.reduce.btf.job import Block
    from gonio.reduce.btf.outcome import Outcome
    from gonio.reduce.calibrate import Calibration
    from gonio.reduce.opening import Opened
    from gonio.session import Session

_LAMPS = 11


def reduce_btf(
    session: Session,
    *,
    texels: int | None = None,
    space: str | None = None,
    scheduler: str | None = None,
    anew: bool = False,
    progress: Progress | None = None,
) -> Btf:
    """Reduce a session's raw frames to a picture for each pair; write its `btf.zarr`.

    A shot is left out, with one warning for all, when a frame of it is missing or damaged. What
    one process holds does not depend on the number of shots. What an interrupted run has done is
    kept in `.btf.zarr.part`, and gone on with.

    Parameters
    ----------
    session
        The session, locked by the caller.
    texels
        Along each side of the sample; by default a texel is a pixel seen from above.
    space
        One of `gonio.reduce.color.CHOICES`; by default linear sRGB.
    scheduler
        Address of a Dask scheduler whose workers see the session under the same name.
    anew
        Whether what an interrupted run has done shall go.
    progress
        Called with the number of shots done and of all.

    Raises
    ------
    gonio.errors.ResumeRefusedError
        When an interrupted run had other inputs than there are now.
    gonio.errors.BadInputError
        As `gonio.reduce.reduce_session`, or when the scheduler does not answer.
    gonio.errors.MissingExtraError
        When Zarr or Dask is not installed.
    gonio.errors.StorageError
        When the array cannot be written; the one before is then still there.
    """
    opened = open_frames(session)
    camera = opened.rig.camera
    grid = TexelGrid.of_camera(camera) if texels is None else TexelGrid(texels)
    layout = Layout.of_shots(opened.shots, grid)
    calibration = _calibrated(session, opened, space)
    response = pixels_of(calibration, opened.frames.sensor).response
    path = btf_path(session).absolute()
    aside, inputs = path.with_name(".btf.zarr.part"), _inputs(session, calibration, layout)
    job = _job(opened, calibration, grid, aside, sha256_bytes(canonical_json(inputs)))
    try:
        begin(aside, inputs, layout, Maps(calibration.darks, response), anew=anew)
        blocks = list(layout.blocks(opened.shots, opened.records))
        outcomes = _done(scheduler, job, blocks, progress)
        _tell(session, opened, outcomes)
        used = [*calibration.records, *(record for each in outcomes for record in each.used)]
        provenance = provenance_of(session, used)
        finish_store(aside, _places(outcomes, layout), provenance, calibration.coloring)
        tidy(aside)
        _replace(path, aside)
    except OSError as error:
        raise StorageError.from_os(path, error) from error
    return Btf.open(session)


def _calibrated(session: Session, opened: Opened, space: str | None) -> Calibration:
    correction = correction_in(session.sensor_calibration)
    patches = PatchFinder(opened.rig.camera, usual_patch_mm(opened.rig.camera), correction.bad)
    try:
        exposures_s = shot_exposures(opened.records)
        wanted = wanted_in(session, space, opened.shots)
        return calibrate(opened.frames, opened.rig, patches, exposures_s, correction, wanted)
    except BadInputError:
        opened.frames.look_over()  # a resume takes all of them again
        raise
    finally:
        reject(session, opened.frames.useless)


def _inputs(session: Session, calibration: Calibration, layout: Layout) -> dict[str, str]:
    """Return hashes of all that texels are made from, but for the shots' frames, by name."""
    made_from = provenance_of(session, calibration.records)
    pairs = {"lights": layout.lights, "views": layout.views, "files": layout.shards}
    return {
        "format of files": FORMAT,
        "texels": str(layout.grid.side),
        "color space": calibration.coloring.space,
        "color matrix": sha256_bytes(calibration.coloring.camera_from_space.tobytes()),
        "pairs": sha256_bytes(canonical_json(pairs)),
        "dark and white frames": made_from.pop("frames"),
        # a plan that was added matters by its pairs alone
        **{name: sha256 for name, sha256 in made_from.items() if name != "plan"},
    }


def _job(
    opened: Opened, calibration: Calibration, grid: TexelGrid, store: Path, made_from: str
) -> Job:
    response, correction = calibration.response, calibration.correction
    sensor = opened.frames.sensor
    return Job(
        root=store.parent,
        store=store,
        made_from=made_from,
        rig=opened.rig,
        sensor=sensor,
        grid=grid,
        gain=calibration.gain,
        saturation=correction.saturation(sensor),
        linearity=correction.linearity,
        stray_light=opened.rig.camera.stray_light or correction.stray_light,
        strengths=tuple(correction.flux((1.0,) * _LAMPS)),
        rate_per_brdf=response.rate_per_brdf,
        relative_variance=response.rate.variance / response.rate.value**2,
        camera_from_space=response.camera_from_space,
        darks={
            each: (dark.read_variance, dark.repeats) for each, dark in calibration.darks.items()
        },
        remedy=opened.frames.remedy,
        geometry=opened.geometry,
    )


def _done(
    scheduler: str | None, job: Job, blocks: Sequence[Block], progress: Progress | None
) -> list[Outcome]:
    outcomes = already(job, blocks)
    known = {each.made_from for each in outcomes}
    left = [block for block in blocks if block.made_from(job) not in known]
    total = sum(len(block.shots) for block in blocks)
    if left:
        with workers(scheduler) as client:
            for outcome in _worked(client, job, left):
                outcomes.append(outcome)
                if progress is not None:
                    progress(sum(len(o.views) + len(o.problems) for o in outcomes), total)
    return sorted(outcomes, key=lambda each: (each.light, each.views))


def _worked(client: Any, job: Job, blocks: Sequence[Block]) -> Iterator[Outcome]:
    from distributed import wait

    # a block that was begun by a worker that died is begun anew by another
    left = client.map(partial(reduce_block, job), blocks, pure=False)
    while left:
        with met():
            try:
                ended, left = wait(left, timeout=PATIENCE_S, return_when="FIRST_COMPLETED")
            except TimeoutError:
                check_workers(client)
                continue
            outcomes = [future.result() for future in ended]
        yield from outcomes
        left = list(left)


def _tell(session: Session, opened: Opened, outcomes: Sequence[Outcome]) -> None:
    useless = {file: why for each in outcomes for file, why in each.useless.items()}
    reject(session, useless)
    problems = [problem for each in outcomes for problem in each.problems]
    warn(session, problems, len(opened.shots), opened.frames)


def _places(outcomes: Sequence[Outcome], layout: Layout) -> dict[str, NDArray[np.float64]]:
    lights, views = layout.shape[:2]
    places = {name: np.full((lights, views, 3), np.nan) for name in ("light_mm", "view_mm")}
    for each in outcomes:
        for name, where in places.items():
            for view, place in zip(each.views, getattr(each, name), strict=True):
                where[each.light, view] = place
    return places


def _replace(path: Path, aside: Path) -> None:
    old = path.with_name(".btf.zarr.old")
    shutil.rmtree(old, ignore_errors=True)
    if path.exists():
        path.rename(old)
    aside.rename(path)
    shutil.rmtree(old, ignore_errors=True)
