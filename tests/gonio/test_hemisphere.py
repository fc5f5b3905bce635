import numpy as np
from matplotlib.figure import Figure

from gonio.directions import from_degrees, paper_directions
from gonio.report.hemisphere import draw_hemisphere, save_hemispheres


def test_discs_lie_at_azimuth_and_theta():
    axes = Figure().add_subplot(projection="polar")
    draw_hemisphere(axes, from_degrees([30.0, 75.0], [90.0, 345.0]), paper_directions(), "two")
    rings, discs = axes.collections
    assert len(rings.get_offsets()) == 81
    np.testing.assert_allclose(
        discs.get_offsets(), [[np.pi / 2, 30.0], [np.radians(345.0), 75.0]], atol=1e-9
    )
    assert axes.get_title() == "two"


def test_the_same_directions_give_the_same_file(tmp_path):
    candidates = paper_directions()
    for name in ("a.png", "b.png"):
        chosen = {"x": (candidates[:9], candidates), "y": (candidates[9:], candidates)}
        save_hemispheres(tmp_path / name, chosen)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
