import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.render import command
from gonio.errors import BadInputError, GonioError
from gonio.materials import MeasuredTable
from gonio.report.figures import inline_svg, page_style
from gonio.report.lobes import draw_lobes
from nnbrdf.analytic import Lambert

QUICK = ("--size", "16", "--lights", "16", "--shape", "sphere", "--renderer", "own")


def render(*arguments):
    result = CliRunner().invoke(command, [*map(str, arguments), *QUICK], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_truth_model_and_recipes_of_a_session(measure, tmp_path):
    session = measure().session
    said = render(session.root, "-o", tmp_path / "out", "--activations", "ReLU")
    for name in ("session", "paper", "relu"):
        assert f"{name}: eps8 " in said
        assert (tmp_path / "out" / f"{name}-sphere.exr").is_file()
    assert (tmp_path / "out" / "truth-sphere.exr").is_file()
    assert (tmp_path / "out" / "probe.exr").is_file()
    assert (tmp_path / "out" / "render.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_against_itself_is_identical(measure, tmp_path):
    truth = measure().session.truth_path
    said = render(truth, "--truth", truth, "-o", tmp_path / "out")
    assert "truth (2): eps8 0.00, male 0.000; PSNR sphere identical" in said.replace("\n", " ")


def test_each_of_like_names_has_its_picture(tmp_path):
    files = [tmp_path / "matt$\\foo{$.npz", tmp_path / "matt_-foo{$.npz"]
    for file in files:
        MeasuredTable.of(np.full((81, 81, 3), 0.1)).save(file)
    render(*files, "-o", tmp_path / "out")
    pictures = {path.name for path in tmp_path.glob("out/*-sphere.exr")}
    assert pictures == {"matt--foo---1-sphere.exr", "matt--foo---2-sphere.exr"}


def test_dollars_in_a_name_are_no_formula():
    with page_style():
        svg = inline_svg(draw_lobes(0.0, {"a$\\foo{$": Lambert((0.1, 0.1, 0.1))}, 1.0), "a", "a")
    assert "a$\\foo{$" in svg


def test_lobes_of_what_is_far_too_bright_are_drawn_without_a_warning():
    figure = draw_lobes(0.0, {"huge": Lambert((1e300, 1e300, 1e300))}, 1.0)
    assert figure.axes[0].get_ylim()[1] < 1e15


def test_a_material_alone_has_no_difference(tmp_path):
    assert "PSNR" not in render("velvet", "-o", tmp_path / "out")


def test_what_cannot_be_shown_is_told(measure, tmp_path):
    session = measure().session
    for arguments, says in [
        (("no-such",), "no-such: no such file, folder or material"),
        (("velvet", "--activations", "relu"), "relu needs samples; give a session"),
        (("velvet", "--activations", "wobbly"), "activation 'wobbly' is not known"),
        ((tmp_path,), "is not a session"),
        ((session.samples_path,), "is of no known format"),
    ]:
        with pytest.raises(BadInputError, match=says):
            render(*arguments, "-o", tmp_path / "out")


def test_a_session_without_a_model_says_what_to_do(measure, tmp_path):
    session = measure().session
    (session.model / "model.json").unlink()
    with pytest.raises(GonioError, match="has no model yet; make one with gonio reconstruct"):
        render(session.root, "-o", tmp_path / "out")


def test_the_truth_of_a_twin_is_its_formula_rather_than_its_table(measure):
    from gonio.api.opened import open_material
    from sim.materials import EMBEDDED

    session = measure().session
    assert np.array_equal(
        open_material(str(session.root)).truth.table.values,
        open_material(str(session.truth_path)).table.values,
    )
    (session.sim / "twin.json").write_text('{"material": "velvet", "sha256": "", "seed": 0}')
    assert open_material(str(session.root)).truth.material is EMBEDDED["velvet"].material
