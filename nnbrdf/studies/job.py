"""One training of a study, and what came of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from gonio.files import canonical_json, sha256_bytes
from nnbrdf.encoding import INPUTS
from nnbrdf.network import weight_count

METRICS = ("eps8", "male", "cube_root_rmse", "sphere_psnr_db")


@dataclass(frozen=True)
class Job:
    """All that decides the result of one training.

    Attributes
    ----------
    material, digest
        Name of the material, and SHA-256 of its values.
    subset
        Name of the pairs it is trained on.
    activation, encoding, hidden
        As in `nnbrdf.paper.PaperEstimator`.
    steps
        Number of batches of 32.
    top
        What a target of white becomes: 1 in the recipe, 255 on the paper's 8-bit scale.
    white_scale
        White of the targets, over the material's own.
    seed
        Which of the recipe's members it is.
    """

    material: str
    digest: str
    subset: str
    activation: str
    encoding: str
    hidden: tuple[int, ...]
    steps: int
    top: float
    white_scale: float
    seed: int

    @property
    def key(self) -> str:
        """SHA-256 of the above: the same job has the same key on every machine."""
        return sha256_bytes(canonical_json(asdict(self)))

    @property
    def network(self) -> str:
        """Hidden layers as people write them: 15-30-20."""
        return "-".join(str(size) for size in self.hidden)

    @property
    def weights(self) -> int:
        """How many weights and biases the network has, for three channels."""
        return weight_count((INPUTS[self.encoding], *self.hidden, 3))


@dataclass(frozen=True)
class Outcome:
    """What one training came to.

    Attributes
    ----------
    job
        Which.
    seconds
        Spent in training, on one core.
    diverged
        Whether its gradient, or what it says on the grid, was not finite; it has no errors then.
    loss
        Mean absolute error over the samples, in units of the target's white.
    eps8, male, cube_root_rmse, sphere_psnr_db
        As in `nnbrdf.metrics.Scores`, over the 81 x 81 grid.
    """

    job: Job
    seconds: float
    diverged: bool
    loss: float | None = None
    eps8: float | None = None
    male: float | None = None
    cube_root_rmse: float | None = None
    sphere_psnr_db: float | None = None

    def row(self) -> dict[str, Any]:
        """Return everything flat, as a line of a table."""
        own = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "job"}
        return asdict(self.job) | {"hidden": self.job.network} | own

    @classmethod
    def from_row(cls, row: dict[str, Any]) -> Outcome:
        """Undo `row`.

        Raises
        ------
        KeyError, TypeError, ValueError
            For a row of another shape.
        """
        hidden = tuple(int(size) for size in row["hidden"].split("-"))
        names = {each.name for each in fields(Job)}
        job = Job(**({name: row[name] for name in names} | {"hidden": hidden}))
        return cls(job, **{name: value for name, value in row.items() if name not in names})
