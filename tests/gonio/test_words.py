"""What is said to a person."""

import pytest

from gonio.words import told_apart

NAMES = [
    (["a", "b"], ["a", "b"]),
    (["a", "b", "a"], ["a (1)", "b", "a (3)"]),
    (["a", "a", "a (1)"], ["a (2)", "a (3)", "a (1)"]),
    (["a (2)", "a", "a"], ["a (2)", "a (3)", "a (4)"]),
]


@pytest.mark.parametrize(("names", "told"), NAMES)
def test_names_are_told_apart(names, told):
    assert told_apart(names) == told
