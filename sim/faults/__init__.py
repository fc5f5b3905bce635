"""Faults as data: what goes wrong on a rig, when, and how often."""

from __future__ import annotations

from sim.faults.document import Fault, load_faults
from sim.faults.kinds import KINDS, Kind
from sim.faults.wires import Wires, faulty_ends, faulty_wires

__all__ = ["KINDS", "Fault", "Kind", "Wires", "faulty_ends", "faulty_wires", "load_faults"]
