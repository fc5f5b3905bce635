"""Jobs, their store and their tables; what a training is, test_training says."""

import errno
import json
import os
import resource
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from gonio.errors import BadFileError, BadInputError, StorageError
from nnbrdf.activations import ACTIVATIONS
from nnbrdf.metrics import eps8
from nnbrdf.paper import PaperEstimator
from nnbrdf.studies import designs, run
from nnbrdf.studies.analytic import compare_networks
from nnbrdf.studies.job import Job, Outcome
from nnbrdf.studies.run import run_jobs
from nnbrdf.studies.settings import agreement, rank_setting
from nnbrdf.studies.store import RESULTS_NAME, appending, read_results
from nnbrdf.studies.tables import kendall_tau, mean_ranks, ranking, tabulate
from nnbrdf.studies.train import Truth, carry_out

JOB = Job("felt", "ab" * 32, "vs-is", "softsign", "xyz", (4, 3), 20, 1.0, 1.0, 0, "fused")


def a_truth(top=1.0):
    values = top * np.random.default_rng(0).random((81, 81, 3))
    return Truth("felt", "ab" * 32, values, 2.0 * top)


SUBSETS = {"vs-is": np.arange(0, 6561, 33), "va-ia": np.arange(0, 6561, 8)}
EXTENT = designs.Extent({name: len(pairs) for name, pairs in SUBSETS.items()}, seeds=2, epochs=2)


def some_jobs(*activations):
    return designs.combinations(a_truth(), EXTENT, activations=activations, networks=[(4, 3)])


def an_outcome(error, seed=0, diverged=False, **changes):
    job = replace(JOB, seed=seed, **changes)
    errors = dict.fromkeys(("loss", "male", "cube_root_rmse"), None if error is None else 0.1)
    return Outcome(job, 0.5, diverged, eps8=error, sphere_psnr_db=error, **errors)


def test_the_key_hangs_on_everything():
    changes = {
        "material": "silk", "digest": "cd" * 32, "subset": "va-ia", "activation": "tanh",
        "encoding": "sincos", "hidden": (4, 4), "steps": 21, "top": 255.0, "white_scale": 2.0,
        "seed": 1, "trainer": "torch",
    }  # fmt: skip
    keys = {replace(JOB, **{name: value}).key for name, value in changes.items()}
    assert len(keys | {JOB.key}) == len(changes) + 1
    assert replace(JOB).key == JOB.key


def test_an_outcome_comes_back_from_its_row():
    outcome = Outcome(JOB, 0.1, False, 0.2, 3.0, 0.4, 0.5, None)
    assert Outcome.from_row(json.loads(json.dumps(outcome.row()))) == outcome


def test_a_job_trains_the_member_of_the_estimator():
    from gonio.directions import paper_directions
    from gonio.samples import Samples

    truth, pairs = a_truth(), SUBSETS["vs-is"]
    light, view = np.divmod(pairs, 81)
    directions = paper_directions()
    samples = Samples.from_values(
        directions[light], directions[view], truth.values.reshape(-1, 3)[pairs]
    )
    model = PaperEstimator(hidden=(4, 3), steps=20).fit(samples)
    truth = replace(truth, white=samples.white)
    outcome = carry_out(replace(JOB, seed=1), truth, SUBSETS)
    grid = model.history.grids(-1)[1]
    assert outcome.eps8 == pytest.approx(eps8(grid, truth.values, truth.white), rel=1e-6)
    assert outcome.loss == pytest.approx(model.card.final_losses[1], rel=1e-5)


@pytest.mark.parametrize("threads", [1, 3])
def test_results_do_not_hang_on_the_number_of_threads(tmp_path, monkeypatch, threads):
    monkeypatch.setattr(run, "cores", lambda: threads)
    jobs = some_jobs("gelu", "rrelu")
    calls = []
    outcomes = run_jobs(
        jobs, {"felt": a_truth()}, SUBSETS, tmp_path, lambda *each: calls.append(each)
    )
    assert [outcome.job for outcome in outcomes] == jobs
    alone = [carry_out(job, a_truth(), SUBSETS) for job in jobs]
    assert [outcome.eps8 for outcome in outcomes] == [outcome.eps8 for outcome in alone]
    total = sum(job.steps for job in jobs)
    assert calls[-1] == (total, total)


def test_what_is_there_is_not_trained_again(tmp_path, monkeypatch):
    jobs = some_jobs("gelu")
    first = run_jobs(jobs, {"felt": a_truth()}, SUBSETS, tmp_path)
    content = (tmp_path / RESULTS_NAME).read_bytes()
    (tmp_path / RESULTS_NAME).write_bytes(content[:-20])  # cut in the last line
    trained = []

    def remember(job, *_):
        trained.append(job)
        return replace(first[-1], job=job)

    monkeypatch.setattr(run, "carry_out", remember)
    again = run_jobs(jobs, {"felt": a_truth()}, SUBSETS, tmp_path)
    assert len(trained) == 1
    assert {outcome.job.key for outcome in again} == {job.key for job in jobs}


def test_what_another_study_finished_just_before_is_not_trained_again(tmp_path, monkeypatch):
    jobs = some_jobs("gelu")
    trained = []

    @contextmanager
    def after_another(folder):
        with appending(folder) as append:
            append(replace(an_outcome(1.0), job=jobs[0]))
        with appending(folder) as append:
            yield append

    def remember(job, *_):
        trained.append(job)
        return replace(an_outcome(2.0), job=job)

    monkeypatch.setattr(run, "appending", after_another)
    monkeypatch.setattr(run, "carry_out", remember)
    run_jobs(jobs, {"felt": a_truth()}, SUBSETS, tmp_path)
    assert {job.key for job in trained} == {job.key for job in jobs[1:]}


def test_what_two_settings_share_is_trained_once(tmp_path):
    jobs = some_jobs("gelu")
    calls = []
    outcomes = run_jobs(
        jobs + jobs, {"felt": a_truth()}, SUBSETS, tmp_path, lambda *each: calls.append(each)
    )
    assert [outcome.job for outcome in outcomes] == jobs + jobs
    assert len((tmp_path / RESULTS_NAME).read_text().splitlines()) == len(jobs)
    total = sum(job.steps for job in jobs)
    assert calls[-1] == (total, total)


GOOD = json.dumps(an_outcome(1.0).row())
DAMAGED = {
    "another object": '{"a": 1}',
    "no object": "[1]",
    "no JSON": GOOD[:-20],
    "deep": "[" * 100_000,
    "words for an error": GOOD.replace('"eps8": 1.0', '"eps8": "abc"'),
    "a negative error": GOOD.replace('"eps8": 1.0', '"eps8": -1.0'),
    "an error beyond all": GOOD.replace('"eps8": 1.0', '"eps8": 1e308'),
    "NaN": GOOD.replace('"eps8": 1.0', '"eps8": NaN'),
    "infinity": GOOD.replace('"eps8": 1.0', '"eps8": Infinity'),
    "no error": GOOD.replace('"eps8": 1.0', '"eps8": null'),
    "an error left out": GOOD.replace('"eps8": 1.0, ', ""),
    "no time": GOOD.replace('"seconds": 0.5', '"seconds": 0.0'),
    "words for a time": GOOD.replace('"seconds": 0.5', '"seconds": "x"'),
    "words for yes and no": GOOD.replace('"diverged": false', '"diverged": "no"'),
    "no trainer": GOOD.replace(', "trainer": "fused"', ""),
    "another trainer": GOOD.replace('"fused"', '"keras"'),
    "not text": "\udcff",
}


@pytest.mark.parametrize("line", DAMAGED.values(), ids=DAMAGED)
def test_a_line_that_is_no_outcome_is_named(tmp_path, line):
    assert line != GOOD
    content = f"{GOOD}\n{line}\n{GOOD}\n".encode(errors="surrogateescape")
    (tmp_path / RESULTS_NAME).write_bytes(content)
    with pytest.raises(BadFileError, match=r"line 2 is no outcome \(.+\).*delete line 2"):
        read_results(tmp_path)


def test_a_training_that_is_stopped_ends_within_its_next_steps(tmp_path, monkeypatch):
    jobs = [replace(job, steps=10**9) for job in some_jobs("gelu")]

    def stop(done, total):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_jobs(jobs, {"felt": a_truth()}, SUBSETS, tmp_path, stop)
    assert (tmp_path / RESULTS_NAME).read_bytes() == b""


def test_one_that_is_stopped_while_trainings_are_laid_out_ends_as_soon(tmp_path, monkeypatch):
    submit = ThreadPoolExecutor.submit
    asked = []

    def stop_at_the_second(pool, *arguments):
        asked.append(arguments)
        if len(asked) == 2:
            raise KeyboardInterrupt
        return submit(pool, *arguments)

    monkeypatch.setattr(ThreadPoolExecutor, "submit", stop_at_the_second)
    jobs = [replace(job, steps=10**9) for job in some_jobs("gelu")]
    with pytest.raises(KeyboardInterrupt):
        run_jobs(jobs, {"felt": a_truth()}, SUBSETS, tmp_path)


def test_the_time_of_a_training_is_the_time_of_its_own_thread():
    spent = []
    outcome = carry_out(
        replace(JOB, steps=2000), a_truth(), SUBSETS, lambda _: spent.append(busy())
    )
    assert len(spent) == 4
    assert outcome.seconds < 0.5 * sum(spent)


def busy():
    """Work in another thread, while a clock on the wall goes on; return its seconds."""
    from threading import Thread
    from time import perf_counter

    began = perf_counter()
    thread = Thread(target=lambda: sum(range(1_000_000)))
    thread.start()
    thread.join()
    return perf_counter() - began


class Constant:
    """A trainer whose network says 0.25 of the top, whatever it is shown."""

    def __init__(self, network, inputs, targets, seeds, trainer):
        self.top = 255.0 if targets.max() > 1 else 1.0
        self.diverged = [False]

    def run(self, steps):
        pass

    def predict(self, inputs):
        return np.full((1, len(inputs), 3), 0.25 * self.top)


@pytest.mark.parametrize("top", [1.0, 255.0])
@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
def test_targets_are_in_units_of_their_white_and_losses_of_their_top(monkeypatch, top, scale):
    monkeypatch.setattr("nnbrdf.studies.train.make_trainer", Constant)
    truth = a_truth()
    outcome = carry_out(replace(JOB, top=top, white_scale=scale), truth, SUBSETS)
    ends = scale * truth.white
    inside = truth.values.reshape(-1, 3)[SUBSETS["vs-is"]].clip(0, ends) / ends
    assert outcome.loss == pytest.approx(np.abs(inside - 0.25).mean())
    told = np.full_like(truth.values, 0.25 * ends)
    assert outcome.eps8 == pytest.approx(eps8(told, truth.values, truth.white))


def test_a_training_that_overflows_has_no_errors_and_says_so():
    job = replace(JOB, activation="exponential", encoding="rusinkiewicz", hidden=(30,) * 6)
    outcome = carry_out(job, a_truth(), SUBSETS)
    assert outcome.diverged
    assert outcome.eps8 is None


def test_cells_are_medians_and_ranks_go_by_their_mean():
    errors = {"a": ([1.0, 2.0, 9.0], [4.0, 4.0, 4.0]), "b": ([2.0, 2.0, 2.0], [2.0, 2.0, 2.0])}
    outcomes = [
        an_outcome(error, seed, activation=name, subset=subset)
        for name, cells in errors.items()
        for subset, values in zip(("s", "t"), cells, strict=True)
        for seed, error in enumerate(values)
    ]
    (table,) = tabulate(outcomes, "eps8", lambda job: job.activation)
    assert table.columns == ("4-3 s", "4-3 t")
    a, b = table.rows
    assert (a.cells, a.mean, a.rank, a.percent_from_best) == ((2.0, 4.0), 3.0, 2, 50.0)
    assert (b.cells, b.mean, b.rank, b.percent_from_best) == ((2.0, 2.0), 2.0, 1, 0.0)
    assert ranking(table) == ["b", "a"]
    (table,) = tabulate(outcomes, "sphere_psnr_db", lambda job: job.activation)
    assert ranking(table) == ["a", "b"]  # of decibels, more is better


def test_a_cell_stands_unless_most_of_its_trainings_diverged():
    outcomes = [
        *[an_outcome(1.0, seed, activation="a") for seed in range(3)],
        *[an_outcome(None, seed, diverged=seed < 1, activation="b") for seed in range(1)],
        *[an_outcome(2.0, seed, activation="b") for seed in (1, 2)],
        *[an_outcome(None, seed, diverged=True, activation="c") for seed in range(2)],
        an_outcome(3.0, 2, activation="c"),
    ]
    (table,) = tabulate(outcomes, "eps8", lambda job: job.activation)
    a, b, c = table.rows
    assert (a.mean, a.diverged, b.mean, b.diverged) == (1.0, 0, 2.0, 1)
    assert (c.cells, c.mean, c.rank, c.diverged) == ((None,), None, 3, 2)


def test_a_network_beside_models_is_the_median_of_its_seeds():
    scored = {"male": 0.1, "cube_root_rmse": 0.2}
    outcomes = [
        replace(an_outcome(error, seed, hidden=hidden), seconds=error / 10, **scored)
        for hidden, errors in {(4, 3): (1.0, 2.0, 9.0), (8,): (5.0, 4.0, 3.0)}.items()
        for seed, error in enumerate(errors)
    ]
    first, second = compare_networks(outcomes)
    assert (first.name, first.subset, first.numbers) == ("network 4-3", "vs-is", 28 + 15 + 12)
    assert (first.scores.eps8, first.fit_seconds) == (2.0, 0.2)
    assert (second.name, second.scores.eps8) == ("network 8", 4.0)
    assert first.million_seconds > 0
    lost = [replace(outcome, diverged=True, eps8=None) for outcome in outcomes[:2]]
    (first,) = compare_networks([*lost, outcomes[2]])
    assert first.scores.eps8 == np.inf


def test_what_diverged_is_the_worst_in_decibels_too():
    outcomes = [
        *[an_outcome(20.0 + seed, seed) for seed in range(3)],
        *[an_outcome(None, seed, diverged=True) for seed in (3, 4)],
    ]
    for metric, cell in {"eps8": 22.0, "sphere_psnr_db": 20.0}.items():
        (table,) = tabulate(outcomes, metric, lambda job: job.activation)
        assert table.rows[0].cells == (cell,)


def test_what_diverged_at_once_is_not_the_quickest():
    outcomes = [
        *[replace(an_outcome(1.0, seed, activation="a"), seconds=0.5) for seed in range(3)],
        *[
            replace(an_outcome(None, seed, diverged=True, activation="b"), seconds=1e-5)
            for seed in range(3)
        ],
    ]
    (table,) = tabulate(outcomes, "seconds", lambda job: job.activation)
    assert ranking(table) == ["a", "b"]
    assert table.rows[1].cells == (None,)


def test_a_perfect_picture_is_the_best_and_has_not_diverged():
    perfect = replace(an_outcome(0.1, activation="a"), sphere_psnr_db=None)
    (table,) = tabulate(
        [an_outcome(20.0, activation="b"), perfect], "sphere_psnr_db", lambda job: job.activation
    )
    best = table.rows[1]
    assert (best.name, best.cells, best.rank, best.percent_from_best) == ("a", (np.inf,), 1, 0.0)
    assert table.rows[0].percent_from_best is None


MIDDLES = {
    "diverged and perfect": ([None, np.inf], None),
    "diverged and one more": ([None, 20.0], None),
    "perfect and one more": ([np.inf, 20.0], 20.0),
    "perfect in most": ([np.inf, np.inf, np.inf, 20.0], np.inf),
    "both finite": ([None, 10.0, 20.0, np.inf], 15.0),
    "all perfect but half diverged": ([None, None, np.inf, np.inf], None),
    "most diverged": ([None, None, None, 20.0], None),
}


@pytest.mark.parametrize(("decibels", "cell"), MIDDLES.values(), ids=MIDDLES)
def test_of_two_in_the_middle_that_have_no_mean_the_worse_counts(decibels, cell):
    outcomes = [
        replace(
            an_outcome(None if value is None else 1.0, seed, diverged=value is None),
            sphere_psnr_db=value if value and np.isfinite(value) else None,
        )
        for seed, value in enumerate(decibels)
    ]
    (table,) = tabulate(outcomes, "sphere_psnr_db", lambda job: job.activation)
    assert table.rows[0].cells == (cell,)
    (table,) = tabulate(outcomes, "eps8", lambda job: job.activation)
    assert table.rows[0].cells == (None if cell is None else 1.0,)


def test_kendall_tau():
    assert kendall_tau([1, 2, 3], [1, 2, 3]) == 1
    assert kendall_tau([1, 2, 3], [3, 2, 1]) == -1
    assert kendall_tau([1], [1]) is None


def test_a_setting_is_ranked_whole_and_by_halves_of_its_seeds():
    errors = {"a": [1.0, 5.0, 1.0], "b": [2.0, 4.0, 2.0], "c": [3.0, 3.0, 3.0]}
    outcomes = [
        an_outcome(error, seed, activation=name)
        for name, values in errors.items()
        for seed, error in enumerate(values)
    ]
    ranked = rank_setting(outcomes, lambda job: job.activation)
    assert ranking(ranked.errors) == ["a", "b", "c"]
    assert [row.mean for row in ranked.times.rows] == [0.5] * 3
    assert [ranking(half) for half in ranked.halves] == [["a", "b", "c"], ["c", "b", "a"]]
    assert agreement(ranked.errors, ranked.halves[0]) == 1.0
    assert agreement(*ranked.halves) == -1.0
    assert mean_ranks([ranked.errors, ranked.halves[0], ranked.halves[1]]) == {
        "a": pytest.approx(5 / 3), "b": 2.0, "c": pytest.approx(7 / 3)
    }  # fmt: skip
    alone = [outcome for outcome in outcomes if outcome.job.seed == 0]
    assert rank_setting(alone, lambda job: job.activation).halves is None


def test_designs_are_as_large_as_they_say():
    paper = designs.Extent({"va-ia": 6561, "vs-ia": 1134, "va-is": 1134, "vs-is": 196})
    jobs = designs.combinations(a_truth(), paper, activations=list(ACTIVATIONS))
    assert len(jobs) == len({job.key for job in jobs}) == 800
    steps = {job.subset: job.steps for job in jobs}
    assert steps == {"va-ia": 103_000, "vs-ia": 18_000, "va-is": 18_000, "vs-is": 3500}
    settings = designs.targets(a_truth(), paper, ["relu"])
    assert {job.steps for job in settings["equal steps"]} == {103_000}
    assert {job.top for job in settings["targets to 255"]} == {255.0}
    assert {job.white_scale for job in settings["white x 2"]} == {2.0}


def test_what_is_refused_elsewhere_is_not_laid_to_the_results(tmp_path):
    with pytest.raises(OSError, match="another file") as refused, appending(tmp_path):
        raise OSError("another file")
    assert not isinstance(refused.value, StorageError)


def test_a_folder_that_cannot_be_locked_is_no_other_study(tmp_path, monkeypatch):
    def refuse(file, how):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("nnbrdf.studies.store.fcntl.flock", refuse)
    with (
        pytest.raises(
            StorageError, match=r"results\.jsonl: cannot be written \(No locks available"
        ),
        appending(tmp_path),
    ):
        pass


def append_all(folder, outcomes):
    with appending(folder) as append:
        for outcome in outcomes:
            append(outcome)


def test_what_a_full_disk_cut_is_trained_again(tmp_path):
    outcomes = [an_outcome(1.0, seed) for seed in range(20)]
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2048, limits[1]))
    try:
        with pytest.raises(StorageError, match=r"results\.jsonl: cannot be written \(File too"):
            append_all(tmp_path, outcomes)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    kept = read_results(tmp_path)
    assert 0 < len(kept) < len(outcomes)
    append_all(tmp_path, outcomes[-1:])
    assert read_results(tmp_path).keys() == {*kept, outcomes[-1].job.key}


def test_two_studies_do_not_write_into_one_file(tmp_path):
    with (
        appending(tmp_path),
        pytest.raises(BadInputError, match="another study writes its results here"),
        appending(tmp_path),
    ):
        pass
