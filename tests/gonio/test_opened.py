"""What a person calls the materials that are held against each other."""

import numpy as np
import pytest

from gonio.api.opened import distinct, open_material
from gonio.materials import MeasuredTable

NAMES = [
    (("monday/wood.npz", "satin"), ["wood", "satin"]),
    (("monday/wood.npz", "tuesday/wood.npz"), ["monday/wood.npz", "tuesday/wood.npz"]),
    (("satin", "monday/satin.npz"), ["satin", "satin.npz"]),
    (("satin", "satin"), ["satin (1)", "satin (2)"]),
    (("./monday/wood.npz", "../here/tuesday/wood.npz"), ["monday/wood.npz", "tuesday/wood.npz"]),
]


@pytest.mark.parametrize(("sources", "names"), NAMES)
def test_those_of_one_name_are_called_what_was_typed(tmp_path, monkeypatch, sources, names):
    tmp_path = tmp_path / "here"
    tmp_path.mkdir()
    monkeypatch.chdir(tmp_path)
    table = MeasuredTable.of(np.full((81, 81, 3), 0.1))
    for folder, name in (("monday", "wood"), ("tuesday", "wood"), ("monday", "satin")):
        (tmp_path / folder).mkdir(exist_ok=True)
        table.save(tmp_path / folder / f"{name}.npz")
    assert [one.name for one in distinct([open_material(each) for each in sources])] == names
