"""Formulas that are written once and printed in every language."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

CONSTANT, INPUT = "constant", "input"


@dataclass(frozen=True, eq=False)
class Expression:
    """One operation on other expressions, a constant or an input.

    Attributes
    ----------
    operation
        A name that every language's table of operations knows, or `CONSTANT`, `INPUT`.
    operands
        What it works on.
    value
        Of a constant.
    name
        Of an input.
    """

    operation: str
    operands: tuple[Expression, ...] = ()
    value: float = 0.0
    name: str = ""

    def __add__(self, other: Expression | float) -> Expression:
        return _two("add", self, other)

    def __radd__(self, other: float) -> Expression:
        return _two("add", other, self)

    def __sub__(self, other: Expression | float) -> Expression:
        return _two("subtract", self, other)

    def __rsub__(self, other: float) -> Expression:
        return _two("subtract", other, self)

    def __mul__(self, other: Expression | float) -> Expression:
        return _two("multiply", self, other)

    def __rmul__(self, other: float) -> Expression:
        return _two("multiply", other, self)

    def __truediv__(self, other: Expression | float) -> Expression:
        return _two("divide", self, other)

    def __rtruediv__(self, other: float) -> Expression:
        return _two("divide", other, self)


def input_named(name: str) -> Expression:
    """Return an input, by the name that the printed text gives it."""
    return Expression(INPUT, name=name)


def sqrt(x: Expression) -> Expression:
    """Return the square root."""
    return Expression("sqrt", (x,))


def exp(x: Expression) -> Expression:
    """Return e to the x."""
    return Expression("exp", (x,))


def log(x: Expression) -> Expression:
    """Return the natural logarithm."""
    return Expression("log", (x,))


def absolute(x: Expression) -> Expression:
    """Return the absolute value."""
    return Expression("absolute", (x,))


def sin(x: Expression) -> Expression:
    """Return the sine."""
    return Expression("sin", (x,))


def cos(x: Expression) -> Expression:
    """Return the cosine."""
    return Expression("cos", (x,))


def tanh(x: Expression) -> Expression:
    """Return the hyperbolic tangent."""
    return Expression("tanh", (x,))


def erf(x: Expression) -> Expression:
    """Return the error function."""
    return Expression("erf", (x,))


def atan2(y: Expression, x: Expression) -> Expression:
    """Return the angle of (x, y) from -pi to pi."""
    return Expression("atan2", (y, x))


def maximum(a: Expression | float, b: Expression | float) -> Expression:
    """Return the larger."""
    return _two("maximum", a, b)


def minimum(a: Expression | float, b: Expression | float) -> Expression:
    """Return the smaller."""
    return _two("minimum", a, b)


def where_less(
    a: Expression | float,
    b: Expression | float,
    then: Expression | float,
    otherwise: Expression | float,
) -> Expression:
    """Return `then` where a < b, and `otherwise` elsewhere; both are computed."""
    return Expression("where_less", tuple(map(_wrapped, (a, b, then, otherwise))))


def in_order(results: Sequence[Expression]) -> Iterator[Expression]:
    """Yield what the results are made of, each once, after its operands."""
    seen: set[int] = set()

    def visit(each: Expression) -> Iterator[Expression]:
        if id(each) in seen:
            return
        seen.add(id(each))
        for operand in each.operands:
            yield from visit(operand)
        yield each

    for result in results:
        yield from visit(result)


def _two(operation: str, a: Expression | float, b: Expression | float) -> Expression:
    return Expression(operation, (_wrapped(a), _wrapped(b)))


def _wrapped(value: Expression | float) -> Expression:
    return value if isinstance(value, Expression) else Expression(CONSTANT, value=float(value))
