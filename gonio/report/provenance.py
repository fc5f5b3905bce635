"""From what, by what and when a report was made."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from gonio.files import sha256_file

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from gonio.samples import Samples
    from gonio.session import Session

_PACKAGES = ("gonio", "numpy", "torch")
_MODEL_FILES = ("model.json", "weights.safetensors", "grid.npz")


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that decide about results."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def hashes(model: Path, samples: Samples, session: Session | None) -> list[tuple[str, str]]:
    """Return what the report stands on, each with its SHA-256."""
    return [*_of_session(session), *_of_samples(samples), *_of_model(model)]


def _of_session(session: Session | None) -> Iterator[tuple[str, str]]:
    if session is None:
        return
    for number, plan in enumerate(session.chain().plans):
        yield f"plan {number:03d}", plan.sha256
    yield "rig", session.rig().sha256
    if session.samples_path.is_file():
        yield session.samples_path.name, sha256_file(session.samples_path)


def _of_samples(samples: Samples) -> Iterator[tuple[str, str]]:
    for name, digest in samples.provenance.items():
        # their own file is in the line above
        if name == "samples":
            continue
        yield f"samples made from {name}", digest


def _of_model(model: Path) -> Iterator[tuple[str, str]]:
    from nnbrdf.card import read_json
    from nnbrdf.prior.used import PriorUsed

    card = read_json(model)
    if isinstance(card, dict) and card.get("prior"):
        used = PriorUsed.model_validate(card["prior"])
        yield f"prior ({used})", used.sha256
    for name in _MODEL_FILES:
        if (model / name).is_file():
            yield name, sha256_file(model / name)
