"""Which samples an estimator can use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from gonio.samples import Samples

MIN_SAMPLES = 8


def check_samples(samples: Samples, estimator: str) -> None:
    """Refuse samples that an estimator cannot use.

    Raises
    ------
    gonio.errors.BadInputError
        Saying why.
    """
    samples.check()
    if len(samples) < MIN_SAMPLES:
        raise BadInputError(
            f"there {counted(samples)}; estimator {estimator} takes at least "
            f"{MIN_SAMPLES}, so measure more directions"
        )
    if len(samples.channels) not in (1, 3):
        raise BadInputError(
            f"the samples have {len(samples.channels)} channels; estimator {estimator} takes one "
            "or three"
        )


def counted(samples: Samples) -> str:
    """Say how many samples there are, as in "there {counted(samples)}"."""
    return "is 1 sample" if len(samples) == 1 else f"are {len(samples)} samples"
