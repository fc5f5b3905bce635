"""One training of a study, and what came of it."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, TypeAdapter

from gonio.files import canonical_json, sha256_bytes
from nnbrdf.encoding import INPUTS
from nnbrdf.network import weight_count

METRICS = ("eps8", "male", "cube_root_rmse", "sphere_psnr_db")
MOST_STEPS = 10**9
_CHECKED = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

Seconds = Annotated[float, Field(gt=0.0, lt=1e9)]
# a network that has not diverged may still say what single precision only just holds
Error = Annotated[float, Field(ge=0.0, lt=1e40)]


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
    trainer
        `fused` or `torch`: they shuffle samples by generators of their own.
    """

    __pydantic_config__: ClassVar[ConfigDict] = _CHECKED

    material: str
    digest: str
    subset: str
    activation: str
    encoding: str
    hidden: tuple[int, ...]
    steps: Annotated[int, Field(ge=1, le=MOST_STEPS)]
    top: float
    white_scale: float
    seed: int
    trainer: Annotated[str, Field(pattern="^(fused|torch)$")]

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
        Time of a processor spent in training, on one core; what other programs take is not in it.
    diverged
        Whether its gradient, or what it says on the grid, was not finite; it has no errors then.
    loss
        Mean absolute error over the samples, in units of the target's white.
    eps8, male, cube_root_rmse, sphere_psnr_db
        As in `nnbrdf.metrics.Scores`, over the 81 x 81 grid.
    """

    __pydantic_config__: ClassVar[ConfigDict] = _CHECKED

    job: Job
    seconds: Seconds
    diverged: bool
    loss: Error | None = None
    eps8: Error | None = None
    male: Error | None = None
    cube_root_rmse: Error | None = None
    sphere_psnr_db: float | None = None

    def row(self) -> dict[str, Any]:
        """Return everything flat, as a line of a table."""
        own = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "job"}
        return asdict(self.job) | {"hidden": self.job.network} | own

    @classmethod
    def from_row(cls, row: Any) -> Outcome:
        """Undo `row`.

        Raises
        ------
        ValueError
            For anything else: another shape, numbers out of range, an error missing though the
            training did not diverge.
        """
        if not isinstance(row, dict) or not isinstance(row.get("hidden"), str):
            raise ValueError("hidden is missing")
        hidden = tuple(int(size) for size in row["hidden"].split("-"))
        names = {each.name for each in fields(Job)}
        job = {name: value for name, value in row.items() if name in names} | {"hidden": hidden}
        own = {name: value for name, value in row.items() if name not in names}
        # strictly, a dataclass comes from JSON alone
        outcome = _CHECK.validate_json(json.dumps({"job": job, **own}))
        errors = (outcome.loss, outcome.eps8, outcome.male, outcome.cube_root_rmse)
        if not outcome.diverged and None in errors:
            raise ValueError("an error is missing")
        return outcome


_CHECK = TypeAdapter(Outcome)
