"""The picture of error against time: who is on the line, and whether every name can be read."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from gonio.report.figures import page_style
from gonio.report.pareto import Point, draw_pareto, pareto_front

NAMES = [
    "linear", "sigmoid", "exponential", "tanh", "relu", "elu", "selu", "softplus", "tanhshrink",
    "softsign", "hardshrink", "lisht", "swish", "hard-sigmoid", "snake", "mish", "gelu", "softmax",
    "rrelu", "softshrink",
]  # fmt: skip


def test_the_line_is_what_nobody_beats_in_both():
    points = [Point("slow", 3.0, 1.0), Point("fast", 1.0, 5.0), Point("beaten", 2.0, 6.0),
              Point("between", 2.0, 2.0), Point("as bad, slower", 1.5, 5.0)]  # fmt: skip
    assert [point.name for point in pareto_front(points)] == ["fast", "between", "slow"]


@given(
    st.lists(
        st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)), min_size=1, max_size=12, unique=True
    )
)
def test_whoever_is_not_on_the_line_is_beaten(pairs):
    points = [Point(str(index), *pair) for index, pair in enumerate(pairs)]
    front = pareto_front(points)
    for point in points:
        beaten = any(f.seconds <= point.seconds and f.error <= point.error for f in front)
        assert beaten or point in front
    assert [f.error for f in front] == sorted((f.error for f in front), reverse=True)


def box_of(label, figure):
    """Return the box of the letters alone, without the line to the point."""
    renderer = figure.canvas.get_renderer()
    label.update_positions(renderer)
    return Text.get_window_extent(label, renderer)


def test_twenty_names_cover_neither_each_other_nor_a_point():
    rng = np.random.default_rng(1)
    points = [
        Point(name, 0.2 * np.exp(0.3 * rng.normal()), 9.0 * np.exp(0.4 * rng.normal()))
        for name in NAMES
    ]
    with page_style():
        figure = draw_pareto(points, "error", "time (s)")
        FigureCanvasAgg(figure).draw()
        axes = figure.axes[0]
        boxes = {text.get_text(): box_of(text, figure) for text in axes.texts}
    assert set(boxes) == set(NAMES)
    for (one, first), (other, second) in itertools.combinations(boxes.items(), 2):
        assert not first.overlaps(second), (one, other)
    for x, y in axes.transData.transform([(p.seconds, p.error) for p in points]):
        assert not [name for name, box in boxes.items() if box.contains(x, y)]
    for box in boxes.values():
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1


NOTHING = {
    "one of two has no error": [(1.0, 0.0), (2.0, 3.0)],
    "none has": [(1.0, 0.0), (2.0, 0.0)],
    "next to none": [(1.0, 1e-300), (2.0, 3.0)],
    "no time": [(0.0, 1.0), (0.0, 2.0)],
}


@pytest.mark.parametrize("pairs", NOTHING.values(), ids=NOTHING)
def test_what_is_nothing_is_a_point_all_the_same(pairs):
    points = [Point(str(index), *pair) for index, pair in enumerate(pairs)]
    with page_style():
        axes = draw_pareto(points, "error", "time (s)").axes[0]
    drawn = np.array([text.xy for text in axes.texts])
    assert len(drawn) == len(points)
    for values, (low, high) in zip(drawn.T, (axes.get_xlim(), axes.get_ylim()), strict=True):
        assert ((0 < low < values) & (values < high)).all()
        # the others can be told apart still
        assert high / low < 1e6


def test_one_point_is_a_picture():
    with page_style():
        assert len(draw_pareto([Point("alone", 1.0, 1.0)], "error", "time (s)").axes) == 1
