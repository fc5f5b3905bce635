"""Formulas as lines of a language."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio.exchange.networks.expression import CONSTANT, INPUT, in_order

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from gonio.exchange.networks.expression import Expression

ARITHMETIC = {
    "add": "{0} + {1}",
    "subtract": "{0} - {1}",
    "multiply": "{0} * {1}",
    "divide": "{0} / {1}",
}
"""Of every language."""


@dataclass(frozen=True)
class Language:
    """How a language says a formula.

    Attributes
    ----------
    operations
        A template for each operation, its operands numbered.
    declaration
        A template for `name` and `text` of an intermediate result.
    suffix
        Of a number.
    """

    operations: Mapping[str, str]
    declaration: str
    suffix: str = ""

    def number(self, value: float) -> str:
        """Return a number in single precision, so that no digit is lost."""
        text = str(np.float32(value))
        return f"{text}{self.suffix}" if "." in text or "e" in text else f"{text}.0{self.suffix}"

    def lines(
        self, results: Sequence[Expression], prefix: str = "t"
    ) -> tuple[list[str], list[str]]:
        """Return the lines that compute formulas, and the names of their results."""
        names: dict[int, str] = {}
        lines: list[str] = []
        for each in in_order(results):
            if each.operation == INPUT:
                names[id(each)] = each.name
            elif each.operation == CONSTANT:
                names[id(each)] = self.number(each.value)
            else:
                operands = [names[id(operand)] for operand in each.operands]
                text = self.operations[each.operation].format(*operands)
                names[id(each)] = name = f"{prefix}{len(lines)}"
                lines.append(self.declaration.format(name=name, text=text))
        return lines, [names[id(each)] for each in results]

    def numbers(self, values: Iterable[float], a_line: int = 8) -> str:
        """Return numbers with commas, some a line."""
        texts = [self.number(value) for value in values]
        rows = (texts[start : start + a_line] for start in range(0, len(texts), a_line))
        return ",\n    ".join(", ".join(row) for row in rows)
