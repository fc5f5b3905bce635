"""What a capture met and mended, and what its time went into, told at its end."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gonio.journal import Journal


@contextlib.contextmanager
def tell_faults(journal: Journal) -> Iterator[None]:
    """Say, however the work within ends, how many faults it met and where."""
    from gonio.cli._console import console
    from gonio.faultlog import faults_of, spoken

    before = len(faults_of(journal))
    try:
        yield
    finally:
        met = faults_of(journal)[before:]
        if met:
            console.print(f"faults met: {spoken(met)}; each is in the journal")


@contextlib.contextmanager
def tell_usage(journal: Journal) -> Iterator[None]:
    """Say, however the captures within end, what the rig's time went into."""
    from gonio.capture.usage import Usage, usages_of
    from gonio.cli._console import console

    before = len(usages_of(journal))
    try:
        yield
    finally:
        runs = usages_of(journal)[before:]
        if runs:
            console.print(f"rig in use {Usage.sum(runs).sentence}")
