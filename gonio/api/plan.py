"""A plan as a person has one: made, looked at, measured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from gonio import plan as core

if TYPE_CHECKING:
    from gonio.api.session import Session
    from gonio.api.told import Document
    from gonio.protocols import Progress


class Plan(core.Plan):
    """Which shots, in which order, and why: `gonio.plan.Plan`, with what a person does with it."""

    @classmethod
    def make(
        cls,
        density: str | int | None = None,
        *,
        views: str | int | None = None,
        lights: str | int | None = None,
        shots: int | None = None,
        hours: float | None = None,
        criterion: str = "i-optimal",
        weight: str = "alike",
        candidates: str = "paper-81",
        view_candidates: str | None = None,
        light_candidates: str | None = None,
        max_theta_deg: float | None = None,
        scene: Path | str | None = None,
        material: str | None = None,
        isotropic: bool = False,
        mono: bool = False,
        prior: Path | str | None = None,
        rig: Path | str | None = None,
        timing: Path | str | None = None,
        bracket: str | None = None,
        anchors: int | None = None,
        seed: int | None = None,
        progress: Progress | None = None,
    ) -> Self:
        """Choose what to measure, and the order that takes the arm the least time.

        Parameters are the options of `gonio plan`, whose help says more of each, and have the same
        defaults.

        Parameters
        ----------
        density
            How many views and lights: `all`, `sixth` (the default), a number, or `va-is` and such.
        views, lights
            The same for one side alone.
        shots
            Rather so many pairs, chosen freely.
        hours
            Rather as many pairs as the rig can take in so many hours.
        criterion
            How they are chosen: i-optimal, d-optimal, energy, farthest, random.
        weight
            How much a pair counts: alike, or by the cosine of both directions.
        candidates
            The directions to choose from: paper-81, klems, rings:0x1,30x8, fibonacci:300, a file.
        view_candidates, light_candidates
            The same for one side alone.
        max_theta_deg
            The angle beyond which directions are left out.
        scene
            A file of how the material will be used; `material` is its id in a Mitsuba scene.
        material
            See `scene`.
        isotropic
            Whether the material has no grain.
        mono
            Whether color does not count.
        prior
            A file of what materials look like; by default generated ones.
        rig
            A rig's file; by default the built-in rig.
        timing
            What the rig takes, from gonio rig bench; by default what is found here.
        bracket
            Exposures of a shot: all, or predicted, the fewest that show it.
        anchors
            Before how many shots one pair is taken again; by default never.
        seed
            Of the random criterion.
        progress
            Called with how much is done and how much there is.

        Raises
        ------
        gonio.errors.BadInputError
            For what does not go together, or asks for what cannot be had.
        """
        from gonio.api.numbers import check_real, check_whole
        from gonio.api.planning import PlanRequest

        check_whole("shots", shots)
        check_whole("anchors", anchors, 2)
        check_whole("seed", seed, 0)
        check_real("hours", hours, 0, 10_000)
        check_real("max_theta_deg", max_theta_deg, 0, 90)
        request = PlanRequest(
            density=_words(density), views=_words(views), lights=_words(lights), shots=shots,
            hours=hours, criterion=criterion.lower(), weight=weight.lower(),
            candidates=candidates, view_candidates=view_candidates,
            light_candidates=light_candidates, max_theta_deg=max_theta_deg, scene=path_of(scene),
            material=material, isotropic=isotropic, mono=mono, prior_path=path_of(prior),
            rig_path=path_of(rig), timing_path=path_of(timing), bracket=bracket, anchors=anchors,
            seed=seed,
        )  # fmt: skip
        return cls.of(request.make(progress))

    @classmethod
    def of(cls, plan: core.Plan) -> Self:
        """Return a plan of the core with what this one can."""
        # of the schema there is only one
        return cls.model_validate({name: each for name, each in plan if name != "schema_"})

    def capture(self, folder: Path | str = "session", **options: Any) -> Session:
        """Measure it into a new session (see `gonio.Session.capture` for the options)."""
        from gonio.api.session import Session

        return Session.capture(self, folder, **options)

    def summary(self) -> Document:
        """Return how it was chosen and what it will cost, as `gonio plan --json` does."""
        from gonio.api.told import plan_document

        return plan_document(self)

    def __str__(self) -> str:
        from gonio.words import duration, several

        chosen = self.selection
        sides = f"{several(chosen.views, 'view')}, {several(chosen.lights, 'light')}"
        time = duration(self.estimates.total_s)
        return f"{several(len(self.shots), 'shot')} ({sides}), about {time}"

    def __repr__(self) -> str:
        return f"<Plan {self.sha256[:12]}: {self}>"

    def _repr_html_(self) -> str:
        from gonio.api.showing import html_table
        from gonio.api.told import plan_rows

        return html_table(f"Plan {self.sha256[:12]}", plan_rows(self))


def path_of(named: Path | str | None) -> Path | None:
    """Return the path that a person named, if one was."""
    return None if named is None else Path(named)


def _words(amount: str | int | None) -> str | None:
    return None if amount is None else str(amount).lower()
