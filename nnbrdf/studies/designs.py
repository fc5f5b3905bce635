"""Which trainings make up each study."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

from nnbrdf.activations import ACTIVATIONS
from nnbrdf.studies.job import Job
from nnbrdf.training import default_trainer, epoch_steps

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nnbrdf.studies.train import Truth

PAPER_NETWORKS = ((15, 30, 20), (3, 6, 4))
TOPOLOGIES = (
    (3, 6, 4), (8,), (16,), (32,), (64,), (8, 8), (16, 16), (32, 32), (15, 30, 20), (16, 16, 16),
    (32, 32, 32), (64, 64), (48, 48, 48), (16, 16, 16, 16),
)  # fmt: skip
WHITE_SCALES = (0.5, 2.0)


@dataclass(frozen=True)
class Extent:
    """How much of a study to carry out.

    Attributes
    ----------
    sizes
        Number of pairs of each subset, by name.
    seeds
        How many networks for each case.
    epochs, steps
        How long to train; `steps` goes before `epochs` where it is given.
    """

    sizes: Mapping[str, int]
    seeds: int = 5
    epochs: int = 500
    steps: int | None = None

    def steps_on(self, subset: str) -> int:
        """Return how many batches a training on a subset takes."""
        return self.steps or self.epochs * epoch_steps(self.sizes[subset])


def combinations(
    truth: Truth,
    extent: Extent,
    *,
    activations: Sequence[str] = ("softsign",),
    encodings: Sequence[str] = ("xyz",),
    networks: Sequence[tuple[int, ...]] = PAPER_NETWORKS,
) -> list[Job]:
    """Return every activation with every encoding, on all networks, subsets and seeds.

    With all twenty activations it is the paper's table 2.
    """
    trainer = default_trainer()
    cases = product(activations, encodings, networks, extent.sizes, range(extent.seeds))
    return [
        Job(
            material=truth.name,
            digest=truth.digest,
            subset=subset,
            activation=activation,
            encoding=encoding,
            hidden=hidden,
            steps=extent.steps_on(subset),
            top=1.0,
            white_scale=1.0,
            seed=seed,
            trainer=trainer,
        )
        for activation, encoding, hidden, subset, seed in cases
    ]


def targets(
    truth: Truth, extent: Extent, names: Sequence[str] = tuple(ACTIVATIONS)
) -> dict[str, list[Job]]:
    """Return what the paper leaves unsaid, by the name of the setting.

    Equal epochs or equal steps for all subsets, targets to 1 or to 255, and another white. A
    setting whose trainings are those of an earlier one, as equal steps are where all subsets have
    one number of steps, is left out.
    """
    most = max(extent.steps_on(subset) for subset in extent.sizes)
    plain = combinations(truth, extent, activations=names, networks=PAPER_NETWORKS[:1])
    settings = {
        "as in the recipe": plain,
        "equal steps": [replace(job, steps=most) for job in plain],
        "targets to 255": [replace(job, top=255.0) for job in plain],
        "targets to 255, equal steps": [replace(job, top=255.0, steps=most) for job in plain],
    } | {
        f"white x {scale:g}": [replace(job, white_scale=scale) for job in plain]
        for scale in WHITE_SCALES
    }
    earliest = {tuple(jobs): name for name, jobs in reversed(settings.items())}
    return {name: list(jobs) for jobs, name in reversed(earliest.items())}
