"""`gonio study encodings`: what the network is told of a pair of directions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import click

from gonio.cli._json import answers
from gonio.cli._study import names_in, networks_in, study_options
from gonio.cli._study_end import conclude

if TYPE_CHECKING:
    from gonio.cli._study import Setting

TITLE = "Encodings"
ABOUT = (
    "Every encoding on the same pairs, SoftSign. paper-literal takes the paper's formula as it is "
    "printed, degrees over 180 without pi, so that its inputs jump where azimuth passes 360 "
    "degrees, by twenty times the step between neighbors; what it costs is its distance from xyz. "
    "Cells are medians over the seeds; ranks go by the mean of the cells."
)


@click.command(name="encodings")
@study_options
@click.option("--encodings", help="Names, with commas between.  [default: all six]")
@click.option("--networks", default="15-30-20,3-6-4", show_default=True, help="Hidden layers.")
@answers
def command(setting: Setting, *, encodings: str | None, networks: str) -> None:
    """Compare encodings of view and light on MATERIALS.

    \b
    Examples:
        gonio study encodings wood-veneer
        gonio study encodings silk.npz --encodings xyz,paper-literal --subsets vs-is
    """  # noqa: D301
    from nnbrdf.encoding import ENCODINGS
    from nnbrdf.studies.designs import combinations

    names = names_in(encodings, list(ENCODINGS), "encoding")
    design = partial(combinations, encodings=names, networks=networks_in(networks))
    outcomes = setting.train(design)
    conclude(setting, "encodings", TITLE, ABOUT, outcomes, lambda job: job.encoding)
