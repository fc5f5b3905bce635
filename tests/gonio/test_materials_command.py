import os
import subprocess
import sys

import numpy as np
import pytest

from nnbrdf.analytic import AnisotropicGGX, Lambert
from nnbrdf.sphere import shade_sphere, sphere_cover, tone_map
from sim.materials import EMBEDDED

GONIO = [sys.executable, "-c", "from gonio.cli import main; main()", "materials"]
WHITE = Lambert((1.0, 1.0, 1.0))


def run(*arguments, **environment):
    plain = {name: value for name, value in os.environ.items() if name != "FORCE_COLOR"}
    return subprocess.run(
        [*GONIO, *arguments],
        capture_output=True,
        encoding="utf-8",
        env=plain | {"PYTHONIOENCODING": "utf-8"} | environment,
        check=False,
    )


def test_lists_names_and_descriptions_where_there_is_no_terminal():
    done = run()
    assert done.returncode == 0
    assert done.stderr == ""
    for name, embedded in EMBEDDED.items():
        assert name in done.stdout
        assert embedded.description in done.stdout
    assert "▀" not in done.stdout
    assert "\x1b" not in done.stdout


def test_shows_a_sphere_each_in_a_terminal_of_true_color():
    done = run(FORCE_COLOR="1", COLORTERM="truecolor", TERM="xterm-256color", COLUMNS="100")
    assert done.returncode == 0
    assert done.stdout.count("\x1b[38;2;") > 20 * len(EMBEDDED)
    assert sum("▀" in line for line in done.stdout.splitlines()) == 6 * len(EMBEDDED)


def test_draws_a_contact_sheet(tmp_path):
    from PIL import Image

    path = tmp_path / "sheets" / "materials.png"
    done = run("-o", str(path))
    assert done.returncode == 0
    assert str(path) in done.stdout.replace("\n", "")
    with Image.open(path) as sheet:
        pixels = np.asarray(sheet.convert("RGB")).reshape(-1, 3)
        assert sheet.format == "PNG"
    # nine spheres on white paper
    assert 0.3 < (pixels.max(axis=1) < 250).mean() < 0.9
    assert [entry.name for entry in path.parent.iterdir()] == ["materials.png"]


def test_a_sheet_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    done = run("-o", str(tmp_path / "file" / "sheet.png"))
    assert done.returncode == 3
    assert done.stderr.startswith("gonio: ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("size", [12, 33])
def test_a_white_sphere_is_1_towards_the_light_and_dark_outside(size):
    color, cover = shade_sphere(WHITE, size), sphere_cover(size)
    assert color.shape == (size, size, 3)
    assert color.max() == pytest.approx(1.0, abs=0.02)
    assert not color[cover == 0].any()
    assert cover.sum() == pytest.approx(np.pi * size**2 / 4, rel=0.01)
    brightest = np.unravel_index(np.argmax(color[..., 0]), (size, size))
    assert max(brightest) < size / 2
    assert color[0, size // 2, 0] > color[-1, size // 2, 0]


def test_grooves_from_left_to_right_draw_the_highlight_out_up_and_down():
    metal = AnisotropicGGX((1.0, 1.0, 1.0), alpha_x=0.05, alpha_y=0.5)
    bright = shade_sphere(metal, 48)[..., 1] > 1
    rows, columns = np.nonzero(bright)
    assert np.ptp(rows) > 2 * np.ptp(columns[columns < 24])


def test_tone_map_is_srgb_below_the_knee_and_never_clips_flat():
    linear = np.array([0.0, 0.002, 0.18, 0.5, 1.0, 2.0])
    mapped = tone_map(linear)
    np.testing.assert_array_equal(mapped[:4], [0, 7, 118, 188])
    assert (np.diff(mapped.astype(int)) > 0).all()


def test_help_keeps_its_examples_on_lines_of_their_own():
    assert "\n      gonio materials -o materials.png\n" in run("--help").stdout
