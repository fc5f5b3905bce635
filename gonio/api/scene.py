"""What a plan is for, where that is a scene: read it, plan for it, say what that spares."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from gonio.errors import BadInputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from gonio.plan import Plan
    from gonio.protocols import Prior
    from planner.field import Field
    from planner.make import Omission
    from planner.scene.pairs import LocalPairs
    from planner.scene.sparing import Maker

_TRACED = ".xml"


@dataclass(frozen=True)
class SceneOptions:
    """What is said of the use of a material, checked.

    Raises
    ------
    gonio.errors.BadInputError
        For options that do not go together.
    """

    scene: Path | None
    material: str | None
    isotropic: bool
    mono: bool

    def __post_init__(self) -> None:
        traced = self.scene is not None and self.scene.suffix.lower() == _TRACED
        if self.material is not None and not traced:
            raise BadInputError("--material is one of a Mitsuba scene; give --scene FILE.xml")
        if traced and self.material is None:
            raise BadInputError(f"{self.scene}: of which material? name its id with --material")

    @property
    def given(self) -> bool:
        """Whether they change which pairs count."""
        return bool(self.named)

    @property
    def named(self) -> list[str]:
        """Those of the options that change which pairs count."""
        named = {"--scene": self.scene is not None, "--isotropic": self.isotropic}
        return [name for name, there in named.items() if there]

    def check(self, criterion: str, weight: str) -> None:
        """Refuse what does not go with how pairs are chosen.

        Raises
        ------
        gonio.errors.BadInputError
            Saying which.
        """
        if self.given and criterion != "i-optimal":
            raise BadInputError(
                f"criterion {criterion} does not ask what counts; use i-optimal, or leave out "
                "--scene and --isotropic"
            )
        if self.given and weight != "alike":
            raise BadInputError(
                "--scene and --isotropic say how much a pair counts; leave out --weight"
            )

    @cached_property
    def pairs(self) -> LocalPairs | None:
        """What the scene asks for; None without one."""
        from planner.scene.pairs import sample_pairs
        from planner.scene.scene import load_scene
        from planner.scene.traced import trace_pairs

        if self.scene is None:
            return None
        if self.material is not None:
            return trace_pairs(self.scene, self.material)
        return sample_pairs(load_scene(self.scene))

    def plan(
        self,
        make: Maker,
        field_of: Callable[[Mapping[str, Omission]], Field],
        prior: Callable[[], Prior],
        shots: int | None,
        hours: float | None,
        *,
        fewest: bool,
    ) -> Plan:
        """Make the plan (see `planner.scene.sparing`)."""
        from nnbrdf.usable import MIN_SAMPLES
        from planner.scene.sparing import Wanted, plan_for_use
        from planner.scene.use import Use

        use = Use(self.pairs, self.isotropic)
        wanted = Wanted(shots, hours, fewest, least=MIN_SAMPLES)
        return plan_for_use(use, wanted, make, field_of, prior)

    def finish(self, plan: Plan) -> Plan:
        """Add what leaving out color saves, where it is left out, and name the scene."""
        from gonio.files import sha256_file
        from planner.scene.sparing import without_color

        if self.mono:
            plan = without_color(plan)
        if self.scene is None:
            return plan
        return plan.of_demand(f"what {self.scene.name} asks for", sha256_file(self.scene))
