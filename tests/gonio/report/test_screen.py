"""Values of every color space as a page shows them, and the truth that they are held against."""

from types import SimpleNamespace

import numpy as np
import pytest

from gonio.color import CAMERA, SPACES, SRGB
from gonio.materials import MeasuredTable
from gonio.report import truth_of
from gonio.report.screen import Screen

VALUES = np.random.default_rng(3).uniform(0.01, 1.0, (81, 81, 3))


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_a_page_shows_the_same_colors_from_every_space(space):
    screen = Screen.of(space.name)
    np.testing.assert_allclose(screen.shown(VALUES @ space.from_srgb.T), VALUES, rtol=1e-9)
    assert screen.words == "sRGB"


def test_channels_of_no_known_look_are_shown_as_they_are_and_it_says_so():
    screen = Screen.of(CAMERA)
    np.testing.assert_array_equal(screen.shown(VALUES), VALUES)
    assert screen.words == "camera RGB as if it were sRGB"


def test_the_truth_is_in_the_space_of_the_samples(tmp_path, caplog):
    path = tmp_path / "truth.npz"
    MeasuredTable(VALUES, 3.0).save(path)
    session = SimpleNamespace(truth_path=path)
    assert truth_of(session, SRGB).white == 3.0
    for space in SPACES.values():
        truth = truth_of(session, space.name)
        np.testing.assert_allclose(truth.values, VALUES @ space.from_srgb.T, rtol=1e-9)
    assert not caplog.messages
    assert truth_of(session, CAMERA) is None
    assert caplog.messages == [
        f"the truth is in {SRGB}, and nothing in {CAMERA} is held against it"
    ]
