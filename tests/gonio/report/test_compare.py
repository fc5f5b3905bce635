"""Every estimator side by side: what each is told, what it is held against, what the page shows."""

import re
from contextlib import contextmanager

import numpy as np
import pytest
from click.testing import CliRunner

from gonio.cli.reconstruct import command
from gonio.directions import to_degrees
from gonio.errors import BadFileError, BadInputError
from gonio.materials import MeasuredTable
from gonio.report import summarize, write_report
from nnbrdf.analytic_model import MODELS, AnalyticEstimator
from nnbrdf.compare import Trial, compare, competitors, is_held_out
from nnbrdf.compared import Entry, load_entries, save_entries
from nnbrdf.paper import PaperEstimator
from nnbrdf.timing import million_seconds

QUICK = PaperEstimator(hidden=(4,), epochs=3)
ENTRIES = [
    Entry(name="nn 88", weights=86, fit_seconds=3.25, million_seconds=0.0125, eps8=6.5,
          male=0.0625, against="truth"),
    Entry(name="prior", weights=588, fit_seconds=0.5, million_seconds=168.5, eps8=4.75,
          male=0.067, against="truth"),
]  # fmt: skip


pytestmark = pytest.mark.usefixtures("small_pictures")


@pytest.fixture
def one_analytic_model(monkeypatch):
    """Let the estimator `analytic` try a single model."""
    (name, *_) = MODELS
    monkeypatch.setattr("nnbrdf.analytic_model.MODELS", {name: MODELS[name]})


@contextmanager
def quietly(name):
    yield lambda done, total: None


class Model:
    """Says what a function of the pairs says, or one value."""

    def __init__(self, says):
        self.says, self.card = says, self
        self.weights = 1

    def evaluate(self, light, view):
        return self.says(light, view)


class Recorder:
    """An estimator that keeps what it is told, and delivers a model made beforehand."""

    name = "recorder"

    def __init__(self, says):
        self.says, self.told = says, None

    def fit(self, samples, progress=None):
        self.told = samples
        return Model(self.says)


def test_with_a_truth_all_samples_are_told_and_the_grid_is_the_judge(measure):
    session, samples = measure()
    truth = MeasuredTable.load(session.truth_path)
    recorder = Recorder(truth.evaluate)
    entry = Trial.of(samples, truth).enter("recorder", recorder)
    assert recorder.told is samples
    assert (entry.eps8, entry.against) == (pytest.approx(0, abs=1e-9), "truth")
    # the model of the fixture was made by this estimator
    same = Trial.of(samples, truth).enter("same", PaperEstimator(hidden=(4,), epochs=3))
    summary = summarize(session.model, samples, truth)
    delivered = summary.against_truth.delivered
    assert (same.eps8, same.male) == pytest.approx((delivered.eps8, delivered.male), rel=1e-4)
    assert same.weights == summary.weights


@pytest.mark.parametrize("channels", [("r", "g", "b"), ("y",)])
def test_without_a_truth_the_judge_is_what_was_not_told(measure, channels):
    session, samples = measure(channels=channels)
    truth = MeasuredTable.load(session.truth_path)
    recorder = Recorder(truth.evaluate)
    entry = Trial.of(samples, None).enter("oracle", recorder)
    held = np.arange(len(samples)) % 5 == 4
    assert held.sum() == 3
    for name in ("light", "view", "value", "sigma", "flag", "shot_index", "view_solid_angle"):
        np.testing.assert_array_equal(
            getattr(recorder.told, name), getattr(samples, name)[~held], name
        )
    recorder.told.check()
    assert (entry.eps8, entry.against) == (pytest.approx(0, abs=1e-9), "held out")
    dark = Trial.of(samples, None).enter(
        "dark", Recorder(lambda *pair: np.zeros((len(pair[0]), 3)))
    )
    expected = 255 * (samples.value[held] / samples.white).clip(0, 1).mean()
    assert dark.eps8 == pytest.approx(expected)


def test_too_few_samples_to_hold_some_out(measure):
    few = measure(density=3).samples
    with pytest.raises(BadInputError, match=r"9 samples; .* needs 10, .*leave out --compare"):
        Trial.of(few, None)
    assert is_held_out(10).tolist() == [False, False, False, False, True] * 2


def test_every_estimator_takes_part_at_every_size():
    names = list(competitors())
    assert names == ["nn", "nn --general", "nn 88", "nn 1268", "nn 2595", "nn 9219", "prior",
                     "analytic", "paper 500 epochs", "paper 103000 steps"]  # fmt: skip
    estimators = competitors(prior := object())
    assert [estimators[name].general for name in ("nn", "nn --general")] == [False, True]
    assert [estimators[f"nn {size}"].size for size in (88, 9219)] == ["88", "9219"]
    assert [each.prior for each in estimators.values() if hasattr(each, "prior")] == [prior] * 7
    assert (estimators["paper 500 epochs"].epochs, estimators["paper 500 epochs"].steps) == (
        500,
        None,
    )
    assert estimators["paper 103000 steps"].steps == 103_000


def test_one_that_refuses_costs_its_row_alone(measure, caplog):
    trial = Trial.of(measure().samples, None)
    broken = PaperEstimator(hidden=(4,), epochs=3, activation="exponential")
    broken.fit = lambda samples, progress=None: (_ for _ in ()).throw(BadInputError("overflowed"))
    entries = compare(trial, {"broken": broken, "whole": QUICK}, quietly)
    assert [entry.name for entry in entries] == ["whole"]
    assert caplog.messages == ["broken is left out of the comparison: overflowed"]


class Watch:
    """A clock that evaluation moves on: so many seconds a pair."""

    def __init__(self, monkeypatch, seconds_a_pair):
        self.now, self.asked, self.seconds = 0.0, [], seconds_a_pair
        monkeypatch.setattr("nnbrdf.timing.process_time", lambda: self.now)

    def evaluate(self, light, view):
        assert light.shape == view.shape
        assert (light[:, 2] >= 0).all()
        self.asked.append(len(light))
        self.now += self.seconds * len(light)


TIMES = {
    "quick": (4e-8, [500] * 3 + [100_000] * 3),
    "slow": (2e-4, [500] * 3),
}


@pytest.mark.parametrize("kind", TIMES)
def test_time_of_a_million_pairs(monkeypatch, kind):
    seconds, asked = TIMES[kind]
    watch = Watch(monkeypatch, seconds)
    assert million_seconds(watch.evaluate) == pytest.approx(1e6 * seconds)
    assert watch.asked == asked


def test_the_table_is_read_as_it_was_written(tmp_path):
    assert load_entries(tmp_path) == []
    save_entries(tmp_path, ENTRIES)
    assert load_entries(tmp_path) == ENTRIES
    first, *rows = (tmp_path / "compare.csv").read_text().splitlines()
    assert first == "name,weights,fit_seconds,million_seconds,eps8,male,against"
    assert rows[1] == "prior,588,0.5,168.5,4.75,0.067,truth"


BROKEN = {
    "a word for a number": ("588", "many", "weights: "),
    "no number": ("0.067", "nan", "male: "),
    "another judge": ("truth", "hearsay", "against: "),
    "a cell too few": (",truth", "", "against: "),
    "a cell too many": (",truth", ",truth,truth", "is not a known key|strings"),
    "an open quote": ("prior", '"prior', "is not CSV"),
    "another column": ("weights", "mass", "weights: is missing"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_table_is_named(tmp_path, case):
    old, new, message = BROKEN[case]
    save_entries(tmp_path, ENTRIES)
    path = tmp_path / "compare.csv"
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(BadFileError, match=rf"compare\.csv: .*({message}).*--compare"):
        load_entries(tmp_path)


def page_of(measured):
    session, samples = measured
    write_report(session.report_path, model=session.model, samples=samples, session=session)
    return session.report_path.read_text()


AGAINST = {"truth": "Errors against the truth", "held out": "which was held out"}


@pytest.mark.parametrize("against", AGAINST)
def test_the_page_shows_it_and_says_against_what(measure, against):
    measured = measure(truth=False)
    entries = [entry.model_copy(update={"against": against}) for entry in ENTRIES]
    save_entries(measured.session.model, entries)
    page = page_of(measured)
    section = page[page.index("How good it is") : page.index("Run times")]
    for title in ("Error against fitting time", "Error against evaluation time"):
        drawing = re.search(rf"<h3>{title}</h3>\s*<div[^>]*><svg.*?</svg>", section, re.DOTALL)
        assert all(f">{entry.name}</text>" in drawing.group() for entry in entries)
    table = section[section.index("Every estimator") :]
    cells = re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", table)[6:]
    assert cells == ["prior", "588", "0.50", "168", "4.75", "0.067",
                     "nn 88", "86", "3.25", "0.013", "6.50", "0.062"]  # fmt: skip
    assert [name for name, words in AGAINST.items() if words in " ".join(table.split())] == [
        against
    ]


def test_every_time_says_by_which_clock_it_is(measure):
    measured = measure(truth=False)
    save_entries(measured.session.model, ENTRIES)
    page = page_of(measured)
    for name in ("time of the fit (s, by the clock)", "time of a million pairs (s, one core)"):
        assert f">{name}</text>" in page
    words = " ".join(page.split())
    assert "Of a fit, the time is that of the clock on the wall, on all cores" in words
    assert "Of a million pairs, it is the processor&#39;s, on one core." in words


class Sleeper(Recorder):
    """Fits while a clock on the wall goes on and another moves only in evaluation."""

    def __init__(self, clock):
        super().__init__(lambda light, view: np.ones(light.shape))
        self.clock = clock

    def fit(self, samples, progress=None):
        self.clock["wall"] += 5.0
        return super().fit(samples, progress)


def test_a_fit_is_timed_by_the_clock_on_the_wall(measure, monkeypatch):
    clock = {"wall": 100.0}
    monkeypatch.setattr("nnbrdf.compare.perf_counter", lambda: clock["wall"])
    entry = Trial.of(measure().samples, None).enter("sleeper", Sleeper(clock))
    assert entry.fit_seconds == 5.0


def test_the_page_says_what_leaving_out_saved(measure):
    measured = measure(truth=False)
    pair = [
        ENTRIES[0].model_copy(update={"name": name, "weights": weights, "eps8": eps8})
        for name, weights, eps8 in (("nn", 88, 2.0), ("nn --general", 1235, 3.0))
    ]
    save_entries(measured.session.model, pair)
    words = " ".join(page_of(measured).split())
    assert "weights are 88 instead of 1235" in words
    assert "eps8 / male are 2.00" in words
    save_entries(measured.session.model, pair[:1])
    assert "instead of" not in page_of(measured)


def test_an_error_of_nothing_is_a_point_all_the_same(measure):
    measured = measure(truth=False)
    save_entries(measured.session.model, [ENTRIES[0].model_copy(update={"eps8": 0.0})])
    assert "Error against fitting time" in page_of(measured)


@pytest.mark.usefixtures("one_analytic_model")
def test_a_model_takes_its_comparison_along(measure):
    measured = measure(truth=False)
    save_entries(measured.session.model, ENTRIES)
    AnalyticEstimator().fit(measured.samples).save(measured.session.model)
    files = sorted(path.name for path in measured.session.model.iterdir())
    # no weights of the network before it either
    assert files == ["grid.npz", "model.json"]
    assert "Every estimator" not in page_of(measured)


CAPTIONS = {"paper": (QUICK, True), "analytic": (AnalyticEstimator(), False)}


@pytest.mark.usefixtures("one_analytic_model")
@pytest.mark.parametrize("estimator", CAPTIONS)
def test_only_the_paper_s_network_was_told_no_more_than_white(measure, estimator):
    chosen, ends = CAPTIONS[estimator]
    measured = measure(truth=False)
    chosen.fit(measured.samples).save(measured.session.model)
    page = page_of(measured)
    assert "A dot a value; upright line: white." in page
    assert ("told no more than white" in page) == ends


def table_of(samples, path):
    angles = [np.stack(to_degrees(each), axis=1) for each in (samples.light, samples.view)]
    np.savetxt(
        path, np.concatenate([*angles, samples.value], axis=1), delimiter=",", comments="",
        header="light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,r,g,b",
    )  # fmt: skip


def test_the_command_compares_when_told_and_forgets_when_not(measure, tmp_path, monkeypatch):
    monkeypatch.setattr("nnbrdf.compare.competitors", lambda prior: {"contender": QUICK})
    table_of(measure().samples, tmp_path / "table.csv")
    arguments = [str(tmp_path / "table.csv"), "--estimator", "paper", "--epochs", "3"]
    told = CliRunner().invoke(command, [*arguments, "--compare"], catch_exceptions=False)
    assert re.search(r"compared 1 estimators in \d", told.output)
    model = tmp_path / "model"
    (entry,) = load_entries(model)
    assert (entry.name, entry.against, entry.weights) == ("contender", "held out", 43)
    assert ">contender</text>" in (model / "report.html").read_text()
    CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert not (model / "compare.csv").exists()
    assert "contender" not in (model / "report.html").read_text()


def test_the_command_refuses_before_it_works(measure, tmp_path):
    table_of(measure(density=3).samples, tmp_path / "table.csv")
    arguments = [str(tmp_path / "table.csv"), "--estimator", "paper", "--compare"]
    refused = CliRunner().invoke(command, arguments)
    assert isinstance(refused.exception, BadInputError)
    assert not (tmp_path / "model").exists()
