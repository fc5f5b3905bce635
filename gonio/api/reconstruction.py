"""From a session, or from samples, to an NN-BRDF and its report."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from gonio.api.following import Following
    from gonio.protocols import Estimator
    from gonio.report.summary import Summary
    from gonio.samples import Samples
    from gonio.session import Session
    from nnbrdf.compare import Trial
    from nnbrdf.compared import Entry

_PAPER_SIZES = {"1268": (15, 30, 20), "88": (3, 6, 4)}
_OF = {
    "weights": ("nn", "paper"), "general": ("nn",), "steps": ("nn", "paper"), "epochs": ("paper",),
    "encoding": ("paper",), "activation": ("nn", "paper"), "trainer": ("nn", "paper"),
    "seed": ("nn", "analytic", "paper"), "prior": ("nn", "prior"),
}  # fmt: skip


@dataclass(frozen=True)
class Reconstructed:
    """What came of samples.

    Attributes
    ----------
    model, report
        The folder of the model, and its page.
    summary
        How good it is.
    compared
        What other estimators came to, where they were asked for.
    """

    model: Path
    report: Path
    summary: Summary
    compared: tuple[Entry, ...] = ()


@dataclass(frozen=True)
class Reconstruction:
    """How samples become a material.

    Attributes
    ----------
    recipe
        The estimator.
    following
        How it is followed.
    compare
        Whether every other estimator is fitted, too.
    """

    recipe: Estimator
    following: Following
    compare: bool = False

    def of_samples(self, samples: Samples, folder: Path) -> Reconstructed:
        """Make the model in a folder of its own."""
        from gonio.report import write_report

        page = folder / "report.html"
        _check_places(folder, page)
        trial = _trial(samples, None) if self.compare else None
        self._fit(samples, folder, page)
        entries = self._compared(trial, folder)
        summary = write_report(page, model=folder, samples=samples)
        return Reconstructed(folder, page, summary, entries)

    def of_session(self, session: Session, output: Path | None) -> Reconstructed:
        """Make the model in the session, or elsewhere; reduce its frames before, where need be."""
        from gonio.report import write_report

        if output is None:
            session.check_writable("name a folder for the model with -o")
        folder = output or session.model
        page = folder / "report.html" if output else session.report_path
        _check_places(folder, page)
        with session.lock():
            samples = self._reduced(session)
            trial = _trial(samples, session) if self.compare else None
            session.note_timing("reconstruct", self._fit(samples, folder, page))
            entries = self._compared(trial, folder)
            prior = getattr(self.recipe, "prior", None)
            summary = write_report(
                page, model=folder, samples=samples, session=session, prior=prior
            )
        return Reconstructed(folder, page, summary, entries)

    def _reduced(self, session: Session) -> Samples:
        from gonio.api.reduction import reduced
        from gonio.files import sha256_file

        samples = reduced(session, self.following.bars)
        made_from = samples.provenance | {"samples": sha256_file(session.samples_path)}
        return replace(samples, provenance=made_from)

    def _fit(self, samples: Samples, folder: Path, page: Path) -> float:
        from gonio.files import remove_file
        from gonio.words import several

        trusted = samples.trusted()
        if suspect := len(samples) - len(trusted):
            self.following.tell(
                f"{several(suspect, 'suspect shot')} left out (gonio capture --retake)"
            )
        if (folder / "model.json").is_file():
            self.following.tell(f"{folder}: the model of before is replaced")
        began = time.perf_counter()
        with self.following.bars("training") as progress:
            estimate = self.recipe.fit(trusted, progress)
        # a page tells of the model beside it or is not there, even if this is killed before the
        # next
        remove_file(page)
        estimate.save(folder)
        return time.perf_counter() - began

    def _compared(self, trial: Trial | None, folder: Path) -> tuple[Entry, ...]:
        from nnbrdf.compare import compare, competitors
        from nnbrdf.compared import save_entries

        if trial is None:
            return ()
        estimators = competitors(getattr(self.recipe, "prior", None))
        bars = self.following.bars
        entries = compare(trial, estimators, lambda name: bars(f"comparing {name}"))
        save_entries(folder, entries)
        return tuple(entries)


def recipe_of(name: str, settings: dict[str, Any]) -> Estimator:
    """Return an estimator; settings of others are refused, since they would do nothing.

    Parameters
    ----------
    name
        Of the estimator: nn, prior, analytic or paper.
    settings
        By the names of the options of `gonio reconstruct`; None where not given.

    Raises
    ------
    gonio.errors.BadInputError
        Naming what does not go together.
    """
    from gonio.api.prior import material_prior
    from gonio.errors import BadInputError
    from nnbrdf.estimators import estimator_named

    given = {option: value for option, value in settings.items() if value is not None}
    for option in given:
        if option not in _OF:
            raise BadInputError(f"there is no setting {option!r}; use {', '.join(_OF)}")
        if name not in _OF[option]:
            known = " and ".join(_OF[option])
            raise BadInputError(f"--{option} is an option of estimator {known}, not of {name}")
    if "prior" in given:
        given["prior"] = material_prior(given["prior"])
    size = given.pop("weights", None)
    if size is not None and name == "nn":
        given["size"] = str(size)
    elif size is not None:
        if str(size) not in _PAPER_SIZES:
            raise BadInputError(f"--weights {size}: estimator paper knows 88 and 1268")
        given["hidden"] = _PAPER_SIZES[str(size)]
    return estimator_named(name)(**given)


def _check_places(folder: Path, page: Path) -> None:
    """Refuse, before the training, where model and page could not be written after it."""
    from gonio.errors import StorageError
    from gonio.files import check_room

    # a model is written aside first
    for place in (folder.parent, folder, page.parent):
        check_room(place)
    if page.is_dir():
        raise StorageError(f"{page}: is a folder, where the report goes; move it away")


def _trial(samples: Samples, session: Session | None) -> Trial:
    from gonio.report import truth_of
    from nnbrdf.compare import Trial

    return Trial.of(samples, truth_of(session, samples.color_space))
