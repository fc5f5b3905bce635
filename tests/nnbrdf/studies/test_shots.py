from dataclasses import replace

import numpy as np
import pytest

from gonio.directions import from_degrees, paper_directions
from gonio.errors import BadFileError, BadInputError
from gonio.materials import MeasuredTable
from gonio.report.shots import shots_section
from gonio.samples import Samples
from nnbrdf.baselines import PcaRidge, fit_nbrdf
from nnbrdf.metrics import eps8, male
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.rows import read_rows
from nnbrdf.studies.shots import METHODS, Drawn, Shot, methods, run_shots
from nnbrdf.studies.train import Truth

PRIOR = MaterialPrior.generate(examples=120)
GRID = grid_pairs()


def read_shots(table):
    return read_rows(table, Shot, "")


def truth(seed=1008):
    drawn = GeneratedMaterials.draw(1, seed, isotropic=True)
    values = np.repeat(drawn.evaluate(GRID), 3, axis=1).reshape(81, 81, 3)
    return Truth("one", f"digest{seed}", values, 4 * float(np.median(values)))


def rows_of(count):
    return np.sort(np.random.default_rng(0).choice(6561, count, replace=False))


def test_pca_ridge_tells_a_material_of_its_kind():
    one = truth()
    rows = rows_of(200)
    values = one.values.reshape(-1, 3)[rows]
    told = PcaRidge(PRIOR).reconstruct(rows, values, 4 * float(np.median(values)))
    error = male(told.reshape(81, 81, 3), one.values, one.white)
    constant = male(np.full_like(one.values, np.median(values)), one.values, one.white)
    assert error < 0.35 * constant
    assert (told >= 0).all()


@pytest.mark.slow
def test_pca_ridge_gives_an_example_back_when_it_sees_all():
    values = np.repeat(PRIOR.families[-1].examples.select(slice(3, 4)).evaluate(GRID), 3, axis=1)
    white = 4 * float(np.median(values))
    told = PcaRidge(PRIOR).reconstruct(np.arange(6561), values, white)
    pair = (values.reshape(81, 81, 3), white)
    assert male(told.reshape(81, 81, 3), *pair) < 0.05
    assert eps8(told.reshape(81, 81, 3), *pair) < 4


def test_nbrdf_learns_what_it_sees():
    one = truth()
    rows = rows_of(400)
    value = one.values.reshape(-1, 3)[rows]
    samples = Samples.from_values(GRID.light[rows], GRID.view[rows], value)
    early, late = (
        fit_nbrdf(samples, steps=steps)(samples.light, samples.view) for steps in (5, 1500)
    )
    assert np.median(np.abs(late - value)) < 0.3 * np.median(np.abs(early - value))


def quick(told):
    return lambda samples, rows: (lambda light, view: np.full((len(light), 1), told), 1)


def test_what_is_done_is_not_done_again(tmp_path):
    seen = []
    designs = {8: rows_of(8), 16: rows_of(16)}
    table = tmp_path / "shots.csv"
    first = run_shots([truth()], designs, {"a": quick(0.1)}, table, lambda *at: seen.append(at))
    assert seen[-1] == (2, 2)

    def never(samples, rows):
        raise AssertionError

    again = run_shots([truth()], designs, {"a": never}, table, lambda *at: None)
    assert again == first
    # another method is tried, another material as well
    more = run_shots([truth()], designs, {"a": never, "b": quick(0.2)}, table, lambda *at: None)
    assert [shot.method for shot in more] == ["a", "b"] * 2
    with pytest.raises(AssertionError):
        run_shots([truth(5)], designs, {"a": never}, table, lambda *at: None)


def test_an_interrupted_study_keeps_what_it_has(tmp_path):
    def breaks(samples, rows):
        if len(rows) > 8:
            raise KeyboardInterrupt
        return quick(0.1)(samples, rows)

    table = tmp_path / "shots.csv"
    with pytest.raises(KeyboardInterrupt):
        run_shots([truth()], {8: rows_of(8), 16: rows_of(16)}, {"a": breaks}, table, lambda *at: 0)
    assert [shot.shots for shot in read_shots(table)] == [8]


HEAD = "material,sha256,method,shots,eps8,male,seconds,numbers,channels,off_eps8,off_male\n"
LINES = [
    "a,b,nn,8,nan,1,1,9,3,,", "a,b,nn,8,-1,1,1,9,3,,", "a,b,nn,8,1,1,1,0,3,,",
    "a,b,nn,8,1,1,1,9,0,,", "a,b,nn,8,1,1",
]  # fmt: skip


@pytest.mark.parametrize("line", LINES)
def test_a_damaged_line_is_refused(line, tmp_path):
    (tmp_path / "shots.csv").write_text(HEAD + "a,b,nn,8,1,1,1,9,3,,\n")
    assert read_shots(tmp_path / "shots.csv")[0].off_eps8 is None
    (tmp_path / "shots.csv").write_text(f"{HEAD}{line}\n")
    with pytest.raises(BadFileError, match=r"shots\.csv"):
        read_shots(tmp_path / "shots.csv")


@pytest.mark.parametrize("content", ["nothing\nof the kind\n", "material,sha256\na,b\n", "\x00"])
def test_a_damaged_table_is_one_line(content, tmp_path):
    (tmp_path / "shots.csv").write_text(content)
    with pytest.raises(BadFileError, match=r"shots\.csv"):
        read_shots(tmp_path / "shots.csv")


def test_an_unknown_method_lists_the_known():
    with pytest.raises(BadInputError, match=", ".join(METHODS)):
        methods(["best"])


def test_errors_are_those_of_the_metrics(tmp_path):
    one = truth()
    (shot,) = run_shots(
        [one], {8: rows_of(8)}, {"a": quick(0.1)}, tmp_path / "t.csv", lambda *at: None
    )
    flat = np.full_like(one.values, 0.1)
    assert shot.eps8 == pytest.approx(eps8(flat, one.values, one.white))
    assert shot.male == pytest.approx(male(flat, one.values, one.white))


def test_generated_materials_are_scored_between_the_nodes_too(tmp_path):
    one = Drawn(0).truth()
    table = tmp_path / "t.csv"

    def knows_all(samples, rows):
        return one.exact.evaluate, 3 * 6561

    def knows_the_grid(samples, rows):
        return MeasuredTable(one.values, one.white).evaluate, 3 * 6561

    tried = {"all": knows_all, "grid": knows_the_grid}
    exact, linear = run_shots([one], {8: rows_of(8)}, tried, table, lambda *at: None)
    assert (exact.eps8, exact.off_eps8, exact.off_male) == (0, 0, 0)
    assert linear.eps8 == pytest.approx(0, abs=1e-9)
    assert linear.off_eps8 > 1
    assert read_shots(table) == [exact, linear]
    (flat,) = run_shots([truth()], {8: rows_of(8)}, {"a": quick(0.1)}, table, lambda *at: None)
    assert flat.off_eps8 is None
    assert flat in read_shots(table)


TINTS = {"grey": ((1.0, 1.0, 1.0), 1), "tinted": ((1.0, 0.5, 0.2), 3), "two alike": ((1, 1, 2), 2)}


@pytest.mark.parametrize("kind", TINTS)
def test_channels_that_are_the_same_are_counted_once_on_both_sides(kind, tmp_path, monkeypatch):
    monkeypatch.setattr(MaterialPrior, "generate", lambda: PRIOR)
    tint, channels = TINTS[kind]
    one = truth()
    one = replace(one, values=one.values * tint)
    names = ("prior", "pca-ridge", *(("analytic",) if channels == 1 else ()))
    shots = run_shots([one], {16: rows_of(16)}, methods(names), tmp_path / "t.csv", lambda *_: None)
    numbers = {shot.method: shot.numbers for shot in shots}
    assert numbers["prior"] == 16 * channels
    assert numbers["pca-ridge"] == 300 * channels
    # a few of the shape, and one a term
    assert numbers.get("analytic", 0) < 10
    (grid,) = shots_section("one", shots).grids
    compression = {line.cells[0].split(",")[0]: line.cells[-1] for line in grid.lines}
    assert compression["pca-ridge"] == f"{6561 / 300:.1f}"
    assert compression["prior"] == f"{6561 / 16:.1f}"


def test_no_material_at_all_is_refused(tmp_path, monkeypatch, capsys):
    from gonio.cli import main

    monkeypatch.setattr("sys.argv", ["gonio", "study", "shots", "-o", str(tmp_path)])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert "give --generated 10" in capsys.readouterr().err


@pytest.mark.slow
def test_the_command_writes_a_page(tmp_path, monkeypatch, capsys):
    from gonio.cli import main

    values = truth().values
    MeasuredTable.of(values).save(tmp_path / "one.npz")
    words = ["study", "shots", str(tmp_path / "one.npz"), "--shots", "8,16", "--methods"]
    monkeypatch.setattr("sys.argv", ["gonio", *words, "pca-ridge", "-o", str(tmp_path / "out")])
    main()
    page = (tmp_path / "out" / "shots.html").read_text()
    assert page.count("<svg") == 3
    assert "pca-ridge, 16" in capsys.readouterr().out


def test_bad_numbers_of_shots_are_refused(tmp_path, monkeypatch, capsys):
    from gonio.cli import main

    for shots in ("7", "6562", "many", "", "16,,64"):
        monkeypatch.setattr(
            "sys.argv", ["gonio", "study", "shots", "satin", "--shots", shots, "-o", str(tmp_path)]
        )
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code == 2
        assert "numbers from 8 to 6561" in capsys.readouterr().err


def test_directions_and_pairs_agree():
    assert (GRID.light[:81] == from_degrees([0.0], [0.0])).all()
    assert (Pairs.of(GRID.light, GRID.view).view[:81] == paper_directions()).all()
