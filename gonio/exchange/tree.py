"""Trees that are fine where a function varies, as Radiance writes them in braces.

A node is {value}, {2^(d k) values} on a grid whose last dimension runs fastest, or {2^d nodes},
of which bit i of the number tells the half along dimension i (Radiance's `bsdf_t.c`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

DEEPEST: Final = 12
"""Halvings of a tree that is read."""

_MOST_NODES: Final = 1 << 18
"""Four times those of the finest tree of gonio export."""

_TOKEN = re.compile(r"[{}]|[^\s,{}]+")


@dataclass(frozen=True)
class Tree:
    """A tree that was read.

    Attributes
    ----------
    dimensions
        3 or 4.
    children
        Nodes below each branch, shape (branches, 2^d).
    first
        A branch's row in `children`, a leaf's first place in `values`, shape (nodes,).
    halvings
        How often each leaf's grid halves it, shape (nodes,); -1 for what is no leaf.
    values
        Of all leaves.
    """

    dimensions: int
    children: NDArray[np.int64]
    first: NDArray[np.int64]
    halvings: NDArray[np.int64]
    values: Array

    def at(self, place: Array) -> Array:
        """Return the values at places in [0, 1]^d, shape (n, d): shape (n,)."""
        place = place.clip(0.0, 1.0 - 1e-12)
        node = np.zeros(len(place), np.int64)
        bits = 1 << np.arange(self.dimensions)
        for _ in range(DEEPEST):
            inside = self.halvings[node] < 0
            if not inside.any():
                break
            twice = 2.0 * place[inside]
            half = twice >= 1.0
            node[inside] = self.children[self.first[node[inside]], half @ bits]
            place[inside] = twice - half
        return self._on_grid(node, place)

    def _on_grid(self, node: NDArray[np.int64], place: Array) -> Array:
        halvings = self.halvings[node]
        offset = np.zeros(len(place), np.int64)
        for part in place.T:
            offset = (offset << halvings) + (part * (1 << halvings)).astype(np.int64)
        return np.asarray(self.values[self.first[node] + offset])


def parse(text: str, dimensions: int) -> Tree:
    """Return the tree that a text holds.

    Raises
    ------
    ValueError
        Saying what is wrong with it.
    """
    return _Parsing(text, dimensions).tree()


class _Parsing:
    def __init__(self, text: str, dimensions: int) -> None:
        self._tokens: Iterator[str] = (match[0] for match in _TOKEN.finditer(text))
        self._dimensions = dimensions
        self._children: list[list[int]] = []
        self._first: list[int] = []
        self._halvings: list[int] = []
        self._values: list[float] = []

    def tree(self) -> Tree:
        if next(self._tokens, "") != "{":
            raise ValueError("does not begin with a brace")
        self._node(0)
        if next(self._tokens, ""):
            raise ValueError("goes on after its last brace")
        values = np.array(self._values)
        if not np.isfinite(values).all() or np.abs(values).max() > np.finfo(np.float32).max:
            raise ValueError("holds values that are not finite")
        children = np.array(self._children, np.int64).reshape(-1, 1 << self._dimensions)
        first, halvings = np.array(self._first), np.array(self._halvings)
        return Tree(self._dimensions, children, first, halvings, values.clip(0.0))

    def _node(self, depth: int) -> int:
        """Read what follows an opening brace, and its closing one; return the node's number."""
        if depth > DEEPEST:
            raise ValueError(f"is deeper than {DEEPEST}")
        number, ways = len(self._halvings), 1 << self._dimensions
        if number == _MOST_NODES:
            raise ValueError(f"has more than {_MOST_NODES} nodes")
        first = len(self._values)
        self._first.append(first)
        self._halvings.append(-1)
        below: list[int] = []
        for token in self._tokens:
            if token == "{" and len(self._values) >= first and len(below) < ways:
                below.append(self._node(depth + 1))
            elif token == "}":
                break
            elif below or token == "{":
                raise ValueError("mixes values with branches, or has too many of them")
            else:
                self._values.append(float(token))
        else:
            raise ValueError("ends within a brace")
        self._finish(number, below, first, depth)
        return number

    def _finish(self, number: int, below: list[int], first: int, depth: int) -> None:
        if below:
            if len(below) != 1 << self._dimensions:
                raise ValueError(f"has a node of {len(below)} branches")
            self._first[number] = len(self._children)
            self._children.append(below)
            return
        count = len(self._values) - first
        halvings = max(count.bit_length() - 1, 0) // self._dimensions
        if count != 1 << halvings * self._dimensions or depth + halvings > DEEPEST:
            raise ValueError(f"has a leaf of {count} values")
        self._halvings[number] = halvings


def serialise(grid: Array, relative: float, absolute: float) -> str:
    """Return a tree of a grid of 2^k values along each dimension, as text.

    Cubes whose values differ by no more than `relative` of their mean and `absolute` are one leaf.
    """
    levels = [(grid, np.ones(grid.shape, np.bool_))]
    low = high = mean = grid
    while len(mean) > 1:
        low, high, mean = _halved(low).min(-1), _halved(high).max(-1), _halved(mean).mean(-1)
        levels.append((mean, high - low <= relative * np.abs(mean) + absolute))
    return _text(levels[::-1], 0, (0,) * grid.ndim)


def _halved(grid: Array) -> Array:
    """Return each cube of 2^d values along one last axis."""
    dimensions = grid.ndim
    pairs = grid.reshape(*(each for size in grid.shape for each in (size // 2, 2)))
    order = (*range(0, 2 * dimensions, 2), *range(1, 2 * dimensions, 2))
    cubes = pairs.transpose(order)
    return cubes.reshape(*cubes.shape[:dimensions], -1)


def _text(levels: list[tuple[Array, NDArray[np.bool_]]], depth: int, place: tuple[int, ...]) -> str:
    mean, alike = levels[depth]
    if alike[place]:
        return f"{{{mean[place]:.5g}}}"
    if depth + 2 == len(levels):
        box = levels[-1][0][tuple(slice(2 * each, 2 * each + 2) for each in place)]
        return "{" + " ".join(f"{value:.5g}" for value in box.ravel()) + "}"
    below = (
        _text(levels, depth + 1, tuple(2 * each + (n >> i & 1) for i, each in enumerate(place)))
        for n in range(1 << mean.ndim)
    )
    return "{" + "\n".join(below) + "}"
