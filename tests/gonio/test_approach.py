import pytest

from gonio.approach import first_stop_deg
from gonio.rig import default_rig

AXIS = default_rig().axis.view_theta
STOPS = [
    # approach, start, goal, first stop
    ("none", 0.0, 50.0, 40.0, 40.0),
    ("a long way up", 5.0, 10.0, 40.0, 40.0),
    ("just long enough", 5.0, 35.0, 40.0, 40.0),
    ("too short a way up", 5.0, 36.0, 40.0, 35.0),
    ("down", 5.0, 60.0, 40.0, 35.0),
    ("from above, down", -5.0, 60.0, 40.0, 40.0),
    ("from above, up", -5.0, 10.0, 40.0, 45.0),
    ("it stays", 5.0, 40.02, 40.0, 40.0),
    ("the travel ends", 5.0, 60.0, 2.0, -1.0),
    ("at the end of the travel", 5.0, 60.0, -1.0, -1.0),
]


@pytest.mark.parametrize(
    ("approach_deg", "start", "goal", "stop"), [s[1:] for s in STOPS], ids=[s[0] for s in STOPS]
)
def test_where_an_axis_goes_first(approach_deg, start, goal, stop):
    axis = AXIS.model_copy(update={"approach_deg": approach_deg})
    assert first_stop_deg(start, goal, axis) == stop
    assert first_stop_deg([start, start], goal, axis).tolist() == [stop, stop]
