"""A session as a person has one: captured, gone on with, reduced, reconstructed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from gonio import session as core
from gonio.api.measuring import NOT_NOTED
from gonio.api.plan import path_of

if TYPE_CHECKING:
    from gonio import plan as core_plan
    from gonio.api.capturing import CaptureRequest, Ready
    from gonio.api.material import Material
    from gonio.api.samples import Samples
    from gonio.api.told import Document
    from gonio.checks import Checks
    from gonio.protocols import Progress


@dataclass(frozen=True, repr=False)
class Session(core.Session):
    """The folder of one measurement: `gonio.session.Session`, with what a person does with it."""

    @classmethod
    def capture(
        cls,
        plan: core_plan.Plan | Path | str | None = None,
        folder: Path | str = core.DEFAULT_ROOT,
        *,
        sim: bool = False,
        material: str | None = None,
        seed: int | None = None,
        imperfections: str | None = None,
        faults: Path | str | None = None,
        rehearse: bool = False,
        rig: Path | str | None = None,
        adaptive: bool = False,
        until: float | None = None,
        batch: int | None = None,
        max_shots: int | None = None,
        hours: float | None = None,
        prior: Path | str | None = None,
        calibration: Path | str | None = None,
        max_age_days: float | None = None,
        sample: str | None = None,
        orientation: str = "marked edge along +x",
        mounting: str = "flat in the holder",
        operator: str = NOT_NOTED,
        temperature_c: float | None = None,
        progress: Progress | None = None,
    ) -> Self:
        """Measure a plan into a new session.

        Parameters are the options of `gonio capture`, whose help says more of each, and have the
        same defaults.

        Parameters
        ----------
        plan
            It or its file; by default plan.json where there is one, else density sixth.
        folder
            The session's; one that is there is never overwritten.
        sim
            Whether to measure on the simulated twin; else `rig` is needed.
        material
            What the twin carries: a name of gonio materials, or a file.
        seed
            Of all noise of the twin.
        imperfections
            How far the twin is from ideal: none, mild, all, or a file.
        faults
            A file of what goes wrong with the twin, and when.
        rehearse
            Whether the twin goes through the motions without a picture.
        rig
            A rig's file.
        adaptive
            Whether to choose further shots by what was measured, round by round.
        until
            Mean posterior standard deviation at which that ends.
        batch
            Shots of a round.
        max_shots, hours
            Shots, or hours of the rig, at which that ends.
        prior
            A file of what materials look like, for choosing.
        calibration
            Folder of the camera's calibration.
        max_age_days
            How old that may be.
        sample, orientation, mounting, operator
            Notes, for whoever reads the session years later.
        temperature_c
            The room's, a note as well.
        progress
            Called with how much is done and how much there is.

        Raises
        ------
        gonio.errors.BadInputError
            For what does not go together or cannot be measured.
        gonio.errors.DeviceFaultError
            When the rig does not do what it is told; `resume` goes on from there.
        """
        from gonio.api.capturing import CaptureRequest
        from gonio.api.following import as_warning

        request = CaptureRequest(
            plan=Path(plan) if isinstance(plan, str) else plan, output=Path(folder), sim=sim,
            material=material, seed=seed, imperfections=imperfections, faults_path=path_of(faults),
            rehearse=rehearse or None, rig_path=path_of(rig), adaptive=adaptive, until=until,
            batch=batch, max_shots=max_shots, hours=hours, prior_path=path_of(prior),
            calibration_path=path_of(calibration), max_age_days=max_age_days, sample=sample,
            orientation=orientation, mounting=mounting, operator=operator,
            temperature_c=temperature_c,
        )  # fmt: skip
        return cls(Path(folder))._taken(request.begin(as_warning), progress)

    @property
    def samples(self) -> Samples:
        """The samples as they were last reduced."""
        from gonio.api.samples import Samples

        return Samples.load(self.samples_path)

    @property
    def checks(self) -> Checks:
        """What the last reduction thought of the frames."""
        from gonio.checks import Checks

        return Checks.load(self.checks_path)

    @property
    def material(self) -> Material:
        """The material as it was last reconstructed."""
        from gonio.api.material import Material

        return Material.load(self.root)

    def resume(self, *, faults: Path | str | None = None, progress: Progress | None = None) -> Self:
        """Take what is missing, as `gonio capture --resume` does; return itself.

        Raises
        ------
        gonio.errors.ResumeRefusedError
            When it is not as it was.
        """
        return self._taken(self._request(faults).resume(), progress)

    def retake(self, *, progress: Progress | None = None) -> Self:
        """Take the shots again that a check flagged; return itself."""
        return self._taken(self._request(None).resume(retake=True), progress, retake=True)

    def extend(
        self,
        shots: int | None = None,
        *,
        criterion: str = "i-optimal",
        weight: str = "alike",
        candidates: str = "paper-81",
        view_candidates: str | None = None,
        light_candidates: str | None = None,
        max_theta_deg: float | None = None,
        prior: Path | str | None = None,
        timing: Path | str | None = None,
        bracket: str | None = None,
        progress: Progress | None = None,
    ) -> Self:
        """Choose further shots by what was measured, and take them; return itself.

        It is `gonio plan --continue` and then `gonio capture --resume`.

        Parameters
        ----------
        shots
            How many; by default 16, or fewer where fewer are left.
        criterion, weight, candidates, view_candidates, light_candidates, max_theta_deg
            By what to choose, and from what.
        prior, timing, bracket
            See `gonio.Plan.make`.
        progress
            Called with how much is done and how much there is.

        Raises
        ------
        gonio.errors.NothingLeftError
            When every pair has been measured.
        """
        from gonio.api.continuing import go_on
        from gonio.api.following import Following
        from gonio.api.planning import PlanRequest

        request = PlanRequest(
            shots=shots, criterion=criterion.lower(), weight=weight.lower(),
            candidates=candidates, view_candidates=view_candidates,
            light_candidates=light_candidates, max_theta_deg=max_theta_deg,
            prior_path=path_of(prior), timing_path=path_of(timing), bracket=bracket,
        )  # fmt: skip
        go_on(self, request, Following.by(progress).bars)
        return self.resume(progress=progress)

    def reduce(
        self,
        *,
        patch_mm: float | None = None,
        space: str | None = None,
        geometry: Path | str | None = None,
        color: Path | str | None = None,
        progress: Progress | None = None,
    ) -> Samples:
        """Turn the raw frames into samples with sigma, as `gonio reduce` does.

        Parameters
        ----------
        patch_mm
            Side of the square that each sample is the mean over.
        space
            Color space: linear-srgb, xyz, acescg or camera.
        geometry, color
            Files of `gonio geometry` and `gonio color`, which the session keeps.
        progress
            Called with how much is done and how much there is.
        """
        from gonio.api.reduction import reduce_anew
        from gonio.api.samples import Samples

        files = (path_of(geometry), path_of(color))
        return Samples.of(reduce_anew(self, *files, progress, patch_mm=patch_mm, space=space))

    def reconstruct(
        self,
        folder: Path | str | None = None,
        *,
        estimator: str = "nn",
        compare: bool = False,
        progress: Progress | None = None,
        **settings: Any,
    ) -> Material:
        """Turn the session into a material, as `gonio reconstruct` does.

        Parameters
        ----------
        folder
            Of the model; by default in the session.
        estimator, compare, progress, settings
            See `gonio.Samples.reconstruct`.
        """
        from gonio.api.following import Following
        from gonio.api.material import Material
        from gonio.api.reconstruction import Reconstruction, recipe_of

        recipe = recipe_of(estimator, settings)
        Reconstruction(recipe, Following.by(progress), compare).of_session(self, path_of(folder))
        return Material.load(self.root if folder is None else folder)

    def summary(self) -> Document:
        """Return what was measured, what it took, and what it met, as `gonio capture --json`."""
        from gonio.api.told import session_document

        return session_document(self)

    def _request(self, faults: Path | str | None) -> CaptureRequest:
        from gonio.api.capturing import CaptureRequest

        return CaptureRequest(output=self.root, sim=self.sim.is_dir(), faults_path=path_of(faults))

    def _taken(self, ready: Ready, progress: Progress | None, *, retake: bool = False) -> Self:
        from gonio.api.following import Following

        ready.capture(Following.by(progress), retake=retake)
        return self

    def __str__(self) -> str:
        from gonio.words import several

        shots, plans = len(self.chain().shots), len(self.chain().plans)
        of = f"{several(shots, 'shot')} in {several(plans, 'plan')}"
        return f"{self.root}: {self.notes().sample}, {of}"

    def __repr__(self) -> str:
        return f"<Session {self}>"

    def _repr_html_(self) -> str:
        from gonio.api.showing import html_table
        from gonio.words import duration

        notes, chain = self.notes(), self.chain()
        made = {"samples": self.samples_path, "model": self.model, "report": self.report_path}
        rows = [
            ("sample", notes.sample),
            ("shots", str(len(chain.shots))),
            ("plans", str(len(chain.plans))),
            ("estimated time", duration(chain.estimated_s)),
            *((name, str(path) if path.exists() else "not yet") for name, path in made.items()),
        ]
        return html_table(f"Session {self.root}", rows)
