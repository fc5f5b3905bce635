"""Patches under a lamp of known spectrum."""

import numpy as np
import pytest

from gonio.chart import PATCHES, published_xyz
from gonio.color import D65
from gonio.colorimetry.difference import delta_e_2000
from gonio.colorimetry.spectra import lit_xyz, read_chart_spectra, read_lamp
from gonio.errors import BadFileError

NM = np.arange(380, 731, 10)


def table(path, columns):
    header = ["wavelength_nm", *(f"c{n}" for n in range(columns.shape[1]))]
    rows = [",".join(map(str, row)) for row in np.column_stack([NM, columns])]
    path.write_text("\n".join([",".join(header), *rows]))
    return path


def test_greys_are_grey_under_every_lamp_and_a_warm_one_moves_colors(tmp_path):
    warm = read_lamp(table(tmp_path / "warm.csv", (NM / 500.0)[:, None] ** 4))
    factor = np.linspace(0.05, 0.95, PATCHES)
    grey = read_chart_spectra(table(tmp_path / "grey.csv", np.tile(factor, (len(NM), 1))))
    np.testing.assert_allclose(lit_xyz(warm, grey), factor[:, None] * D65, rtol=1e-6)
    # measured charts in even light are near to what is published of theirs, in warm light less so
    even, lit = (lit_xyz(lamp) for lamp in (np.ones_like(warm), warm))
    assert delta_e_2000(even, published_xyz()).mean() < 1.5
    assert delta_e_2000(lit, published_xyz()).mean() > 1.5


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("nm,power\n400,1\n700,1\n", "has no columns wavelength_nm and 1 more"),
        ("wavelength_nm,power\n400,1\n600,1\n", "does not reach from 400 to 700 nm"),
        ("wavelength_nm,power\n400,1\n700,1\n400,2\n", "a wavelength of 400 nm twice"),
        ("wavelength_nm,power\n400,1\n550,x\n700,1\n", "line 3: holds what is no number"),
        ("wavelength_nm,power\n400,1\n550,-1\n700,1\n", "line 3: 2 numbers of at least zero"),
        ("wavelength_nm,power\n400,0\n700,0\n", "is zero throughout"),
        ("", "has no columns"),
    ],
)
def test_a_wrong_table_is_refused_in_one_line(tmp_path, text, problem):
    (tmp_path / "lamp.csv").write_text(text)
    with pytest.raises(BadFileError, match=problem):
        read_lamp(tmp_path / "lamp.csv")
