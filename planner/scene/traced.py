"""Pairs of directions that a Mitsuba scene asks for: camera paths that meet the material.

The extra `mitsuba` brings the renderer (Jakob et al. 2022, version 3).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadFileError, BadInputError, MissingExtraError
from planner.scene.pairs import LocalPairs

if TYPE_CHECKING:
    from pathlib import Path

    from planner.scene.quantities import Array

    Met = tuple[Array, Array]

PATHS = 1 << 15
DEPTH = 4
_REMEDY = "give a scene file of Mitsuba 3"
_REFLECTANCE = 0.5
"""Of the material, which is not known yet, for light that goes on from it."""
_GRAZING = 1e-6
_NUMBERS = 5


def trace_pairs(
    path: Path, material: str, seed: int = 0, paths: int = PATHS, depth: int = DEPTH
) -> LocalPairs:
    """Follow paths from the camera, and collect light and view wherever they meet the material.

    Each light found from any point of a path counts for all points of the material before it, with
    what that path brings to the camera, were the material a perfect diffuser.

    Parameters
    ----------
    path
        Scene of Mitsuba 3, as XML.
    material
        Id of the BSDF that stands for it.
    seed
        Of all random numbers.
    paths, depth
        How many paths, and how many surfaces each may meet.

    Raises
    ------
    MissingExtraError
        When Mitsuba is not installed.
    gonio.errors.BadFileError
        When the scene cannot be loaded, or lacks a camera, a light or the material.
    gonio.errors.BadInputError
        When no light that reaches the material reaches the camera.
    """
    scene = _load(path, material)
    tracer = _Tracer(scene, material)
    random = np.random.default_rng(seed).random((paths, 4 + depth * _NUMBERS))
    for numbers in random.tolist():
        tracer.follow(numbers, depth)
    if not tracer.weight:
        raise BadInputError(
            f"{path}: no light that falls on material {material!r} reaches the camera; check that "
            "it is in sight and lit"
        )
    return LocalPairs.weighed(*map(np.array, (tracer.light, tracer.view, tracer.weight)))


def _load(path: Path, material: str) -> Any:
    try:
        import mitsuba
    except ImportError:
        raise MissingExtraError("mitsuba", "mitsuba") from None
    if not path.is_file():
        raise BadFileError(path, "no such file", _REMEDY)
    mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    try:
        # not optimized: that makes materials of equal looks one, and loses the names of the others
        scene = mitsuba.load_file(str(path), optimize=False)
    except Exception as error:  # whatever its parser and its plugins raise
        problem = " ".join(str(error).split())
        raise BadFileError(path, f"cannot be loaded ({problem})", _REMEDY) from None
    for what, found in (("camera", scene.sensors()), ("light", scene.emitters())):
        if not found:
            raise BadFileError(path, f"has no {what}", _REMEDY)
    known = sorted({each.bsdf().id() for each in scene.shapes() if each.bsdf() is not None})
    if material not in known:
        there = f"has no shape with material {material!r}, but with {', '.join(known)}"
        raise BadFileError(path, there, "give one of these as --material")
    return scene


@dataclass
class _Tracer:
    """Camera paths through a scene, one at a time, and what they have found so far."""

    scene: Any
    material: str
    light: list[Array] = field(default_factory=list)
    view: list[Array] = field(default_factory=list)
    weight: list[float] = field(default_factory=list)

    def follow(self, numbers: list[float], depth: int) -> None:
        """Follow one path, by numbers from 0 to 1."""
        ray, through = self.scene.sensors()[0].sample_ray(
            0.0, numbers[0], numbers[1:3], [numbers[3], numbers[4]]
        )
        through, mirrored = np.array(through), False
        met: list[Met] = []
        for step in range(depth):
            at = 4 + step * _NUMBERS
            hit = self.scene.ray_intersect(ray)
            if mirrored:
                self._meet_light(hit, through, met)
            if not hit.is_valid():
                return
            bsdf = hit.bsdf(ray)
            ours = bsdf.id() == self.material
            if ours and not _is_seen(hit, bsdf):
                return
            self._look_for_light(hit, bsdf, ours, through, met, numbers[at : at + 2])
            local, factor, mirrored = self._go_on(hit, bsdf, ours, numbers[at + 2 : at + 5])
            through = through * factor
            if not through.any():
                return
            if ours:
                met = [*met, (np.array(local), np.array(hit.wi))]
            ray = hit.spawn_ray(hit.to_world(local))

    def _look_for_light(
        self, hit: Any, bsdf: Any, ours: bool, through: Array, met: list[Met], numbers: list[float]
    ) -> None:
        """Take a light from here, for the material here and that which the path has met."""
        found, arriving = self.scene.sample_emitter_direction(hit, numbers, True)
        local = hit.to_local(found.d)
        if ours:
            light, view = np.array(local), np.array(hit.wi)
            cosine = abs(light[2]) if light[2] * view[2] > 0 else 0.0
            weight = through * np.array(arriving) * cosine * _REFLECTANCE / np.pi
            met = [*met, (light, view)]
        else:
            from mitsuba import BSDFContext

            weight = through * np.array(arriving) * np.array(bsdf.eval(BSDFContext(), hit, local))
        self._keep(float(np.mean(weight)), met)

    def _meet_light(self, hit: Any, through: Array, met: list[Met]) -> None:
        """Take what the path has run into: seen in a mirror, a light is found in no other way."""
        emitter = hit.emitter(self.scene)
        if emitter is not None:
            self._keep(float(np.mean(through * np.array(emitter.eval(hit)))), met)

    def _go_on(
        self, hit: Any, bsdf: Any, ours: bool, numbers: list[float]
    ) -> tuple[Any, Array, bool]:
        """Return where the path goes from here, what it keeps, and whether that is a mirror."""
        from mitsuba import BSDFContext, BSDFFlags, has_flag

        if ours:
            return *_diffusely(hit, numbers), False
        sample, factor = bsdf.sample(BSDFContext(), hit, numbers[0], numbers[1:])
        return sample.wo, np.array(factor), has_flag(sample.sampled_type, BSDFFlags.Delta)

    def _keep(self, weight: float, met: list[Met]) -> None:
        """Count a path for each point of the material that it has met, on the side it is seen."""
        if not weight > 0:
            return
        for light, view in met:
            if light[2] * view[2] > 0 and min(abs(light[2]), abs(view[2])) > _GRAZING:
                # the back is the front turned over about the marked edge
                over = np.array([1.0, 1.0, 1.0] if view[2] > 0 else [1.0, -1.0, -1.0])
                self.light.append(light * over)
                self.view.append(view * over)
                self.weight.append(weight)


def _is_seen(hit: Any, bsdf: Any) -> bool:
    """Return whether the material has the side that a path meets."""
    from mitsuba import BSDFFlags, has_flag

    side = BSDFFlags.FrontSide if hit.wi.z > 0 else BSDFFlags.BackSide
    return bool(has_flag(bsdf.flags(), side))


def _diffusely(hit: Any, numbers: list[float]) -> tuple[Any, Array]:
    """Return a direction on the side of the view, likely as its cosine, and what it keeps."""
    from mitsuba import Vector3f

    # as a perfect diffuser's: evenly over the disc below (Malley's method)
    radius, angle = np.sqrt(numbers[0]), 2 * np.pi * numbers[1]
    up = np.sqrt(max(0.0, 1 - numbers[0])) * np.sign(hit.wi.z)
    local = Vector3f(radius * np.cos(angle), radius * np.sin(angle), up)
    return local, np.full(3, _REFLECTANCE)
