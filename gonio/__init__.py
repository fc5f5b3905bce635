"""Plan, run and complete gonioreflectometer measurements.

The public names are offered lazily, so that ``import gonio`` and ``gonio --help`` stay quick;
`__init__.pyi` tells editors and type checkers of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "Clock": "gonio.clock",
    "GonioError": "gonio.errors",
    "Material": "gonio.api.material",
    "MeasuredTable": "gonio.materials",
    "Plan": "gonio.api.plan",
    "Rig": "gonio.rig",
    "Samples": "gonio.api.samples",
    "Session": "gonio.api.session",
    "Shot": "gonio.plan",
    "default_rig": "gonio.rig",
    "load_rig": "gonio.rig",
    "paper_directions": "gonio.directions",
}

__all__ = ["__version__", *sorted(_HOME)]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """Import a public name from its module on first use (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'gonio' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
