import hashlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.directions import from_degrees
from gonio.errors import BadFileError
from gonio.exchange import format_named
from gonio.samples import Flag
from gonio.tables import read_table

HEADER = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg"
RGB = f"{HEADER},r,g,b"


def write(folder, text, encoding="utf-8"):
    path = folder / "samples.csv"
    path.write_bytes(text.encode(encoding))
    return path


def test_what_never_ends_and_what_is_too_long_is_refused(tmp_path):
    (tmp_path / "endless.csv").symlink_to("/dev/zero")
    with (tmp_path / "long.csv").open("wb") as file:
        file.truncate(20_000_000)
    for name in ("endless.csv", "long.csv"):
        with pytest.raises(BadFileError, match=r"is longer than 16\.8 MB"):
            read_table(tmp_path / name)
    for name, problem in (("endless.csv", "is no file"), ("long.csv", r"is longer than 4\.19 MB")):
        with pytest.raises(BadFileError, match=problem):
            format_named("csv").read(tmp_path / name)


def test_reads_directions_values_and_where_they_came_from(tmp_path):
    path = write(tmp_path, f"{RGB}\n0,0,45,90,0.1,0.2,0.3\n30,-350,90,-90,1,2,3\n")
    samples = read_table(path)
    assert np.allclose(samples.light, from_degrees([0, 30], [0, 10]))
    assert np.allclose(samples.view, from_degrees([45, 90], [90, 270]))
    assert samples.value.tolist() == [[0.1, 0.2, 0.3], [1, 2, 3]]
    assert samples.channels == ("r", "g", "b")
    assert samples.color_space == "linear sRGB"
    assert np.isnan(samples.sigma).all()
    assert (samples.flag == Flag.NO_SIGMA).all()
    assert samples.provenance == {"table": hashlib.sha256(path.read_bytes()).hexdigest()}


def test_reads_one_channel_with_its_sigma(tmp_path):
    path = write(tmp_path, f"{HEADER},y,sigma_y\n0,0,45,90,0.1,0.01\n0,0,30,90,0.2,\n")
    samples = read_table(path)
    assert samples.channels == ("y",)
    assert samples.value.tolist() == [[0.1], [0.2]]
    assert samples.sigma[0] == 0.01
    assert np.isnan(samples.sigma[1])
    assert samples.flag.tolist() == [[0], [Flag.NO_SIGMA]]


PLAIN = f"{RGB},sigma_r,sigma_g,sigma_b\n1,2,3,4,5,6,7,.1,.2,.3\n5,6,7,8,9,10,11,.4,.5,.6\n"
SAME = {
    "byte order mark": "\ufeff" + PLAIN,
    "carriage returns": PLAIN.replace("\n", "\r\n"),
    "no newline at the end": PLAIN.rstrip("\n"),
    "comments and empty lines": "# by hand\n\n" + PLAIN.replace("\n", "\n  # again\n\n"),
    "spaces": PLAIN.replace(",", " , "),
    "quotes": PLAIN.replace("light_phi_deg", '"light_phi_deg"').replace("1,2,", '"1", "2",'),
    "another order": (
        "sigma_b,sigma_g,sigma_r,b,g,r,view_phi_deg,view_theta_deg,light_phi_deg,light_theta_deg\n"
        ".3,.2,.1,7,6,5,4,3,2,1\n.6,.5,.4,11,10,9,8,7,6,5\n"
    ),
    "other columns": (
        f"lab,{RGB},sigma_r,sigma_g,sigma_b,\nx,1,2,3,4,5,6,7,.1,.2,.3,\ny,5,6,7,8,9,10,11,.4,.5,.6,\n"
    ),
}


@pytest.mark.parametrize("text", SAME.values(), ids=SAME)
def test_forms_that_mean_the_same(tmp_path, text):
    plain = read_table(write(tmp_path, PLAIN))
    same = read_table(write(tmp_path, text))
    for name in ("light", "view", "value", "sigma", "flag"):
        assert np.array_equal(getattr(same, name), getattr(plain, name)), name
    assert plain.sigma.tolist() == [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]


ROW = "1,2,3,4,5,6,7"
BAD = {
    "empty file": ("", "is empty"),
    "comments alone": ("# nothing\n", "is empty"),
    "header alone": (f"\n{RGB}\n", "line 2: no samples follow the header"),
    "missing column": (
        f"{RGB.replace('view_phi_deg', 'view_phi')}\n{ROW}\n",
        "line 1: column view_phi_deg is missing",
    ),
    "no values": (f"{HEADER}\n1,2,3,4\n", "line 1: column r is missing"),
    "some of the colors": (f"{HEADER},r,b\n1,2,3,4,5,6\n", "line 1: column g is missing"),
    "both kinds of value": (f"{RGB},y\n{ROW},8\n", "line 1: has both y and r, g, b"),
    "some of the sigmas": (f"{RGB},sigma_g\n{ROW},1\n", "line 1: column sigma_r is missing"),
    "column twice": (f"{RGB},g\n{ROW},8\n", "line 1: column g is there twice"),
    "short line": (f"{RGB}\n{ROW}\n1,2,3\n", "line 3: has 3 cells where the header has 7"),
    "no number": (
        f"# x\n{RGB}\n{ROW}\n1,2,3,4,5,six,7\n",
        "line 4, column g: 'six' is not a number",
    ),
    "empty cell": (f"{RGB}\n1,2,3,4,5,,7\n", "line 2, column g: is empty"),
    "NaN": (f"{RGB}\n1,2,3,4,5,6,nan\n", "line 2, column b: nan is not a finite number"),
    "infinity": (f"{RGB}\n1,inf,3,4,5,6,7\n", "line 2, column light_phi_deg: inf is not"),
    "transmission": (
        f"{RGB}\n1,2,90.5,4,5,6,7\n",
        "line 2, column view_theta_deg: 90.5 deg is beyond 90 deg: that would be transmission",
    ),
    "negative theta": (f"{RGB}\n-5,2,3,4,5,6,7\n", "line 2, column light_theta_deg: -5 deg"),
    "negative sigma": (
        f"{HEADER},y,sigma_y\n1,2,3,4,5,-1\n",
        "line 2, column sigma_y: -1 is not positive; leave the cell empty",
    ),
    "sigma of zero": (f"{HEADER},y,sigma_y\n1,2,3,4,5,0\n", "line 2, column sigma_y: 0 is not pos"),
    "endless sigma": (f"{HEADER},y,sigma_y\n1,2,3,4,5,inf\n", "line 2, column sigma_y: inf is not"),
    "sigma of no use": (
        f"{HEADER},y,sigma_y\n1,2,3,4,5,1e30\n",
        "line 2, column sigma_y: 1e30 is beyond 1e+12 1/sr",
    ),
    "value of no material": (
        f"{RGB}\n1,2,3,4,5,1e30,7\n",
        "line 2, column g: 1e30 is beyond 1e+12",
    ),
    "many turns": (f"{RGB}\n1,1e9,3,4,5,6,7\n", "line 2, column light_phi_deg: 1e9 deg is more"),
    "below noise": (
        f"{HEADER},y,sigma_y\n1,2,3,4,5,.1\n1,2,3,4,-.6,.1\n",
        "line 3, column y: -0.6 is below zero by more than 5 sigma",
    ),
    "below the median": (
        f"{RGB}\n1,2,3,4,.1,.2,.3\n1,2,3,4,.1,-1,.3\n",
        "line 3, column g: -1 is below zero by more than the table's median",
    ),
    "open quote": (f'{RGB}\n1,2,3,4,5,6,"7\n', "line 2: is not CSV"),
    "semicolons": (
        f"{RGB}\n{ROW}\n".replace(",", ";"),
        "line 1: the cells seem to be separated by semicolons",
    ),
    "tabs": (
        f"{RGB}\n{ROW}\n".replace(",", "\t"),
        "line 1: the cells seem to be separated by tabs",
    ),
    "decimal commas": (
        f"{HEADER},y\n0,5,45,5,90,0,0,5,0,112\n",
        "line 2: has 10 cells where the header has 5 (decimal commas? write 0.5, not 0,5)",
    ),
    "decimal comma in quotes": (
        f'{RGB}\n1,2,3,4,5,6,"0,7"\n',
        "line 2, column b: '0,7' is not a number (decimal commas?",
    ),
}


@pytest.mark.parametrize(("text", "problem"), BAD.values(), ids=BAD)
def test_says_in_one_line_what_is_wrong_and_where(tmp_path, text, problem):
    path = write(tmp_path, text)
    with pytest.raises(BadFileError) as caught:
        read_table(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: {problem}")
    assert "\n" not in message
    assert "docs/topics/samples-table.md" in message


NOISE = {
    "by sigma": f"{HEADER},y,sigma_y\n1,2,3,4,5,.1\n1,2,3,4,-.4,.1\n",
    "by the median": f"{RGB}\n1,2,3,4,.1,.2,.3\n1,2,3,4,.1,-.1,.3\n",
}


@pytest.mark.parametrize("text", NOISE.values(), ids=NOISE)
def test_noise_below_zero_is_kept(tmp_path, text):
    assert read_table(write(tmp_path, text)).value.min() < 0


def test_a_missing_file_a_folder_and_another_encoding(tmp_path):
    with pytest.raises(BadFileError, match="no such file"):
        read_table(tmp_path / "none.csv")
    with pytest.raises(BadFileError, match="cannot be read"):
        read_table(tmp_path)
    with pytest.raises(BadFileError, match="is not text"):
        read_table(write(tmp_path, f"# 45\N{DEGREE SIGN}\n{RGB}\n{ROW}\n", "latin-1"))


numbers = st.floats(0, 1e6)
theta, phi = st.floats(0, 90), st.floats(-360, 360)


@given(st.lists(st.tuples(theta, phi, theta, phi, numbers), min_size=1, max_size=5))
def test_any_table_of_numbers_comes_back(tmp_path_factory, rows):
    lines = [",".join(map(repr, row)) for row in rows]
    path = write(tmp_path_factory.mktemp("table"), "\n".join([f"{HEADER},y", *lines]))
    samples = read_table(path)
    columns = np.array(rows).T
    assert np.array_equal(samples.value[:, 0], columns[4])
    assert np.array_equal(samples.light, from_degrees(columns[0], columns[1]))
    assert np.array_equal(samples.view, from_degrees(columns[2], columns[3]))


def test_a_sigma_of_no_channel_is_refused(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(
        "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,y,sigma_r\n0,0,0,0,1,0.1\n"
    )
    with pytest.raises(BadFileError, match="column sigma_r fits no value; use sigma_y"):
        read_table(path)
