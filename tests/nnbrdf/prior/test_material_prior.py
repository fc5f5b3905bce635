import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gonio.cli import main
from gonio.directions import from_degrees
from gonio.errors import BadFileError
from gonio.files import sha256_file
from gonio.report.provenance import hashes
from gonio.samples import Samples
from nnbrdf.load import load_model
from nnbrdf.posterior_model import PriorEstimator
from nnbrdf.prior import MaterialPrior, Pairs
from nnbrdf.prior.family import grid_pairs
from nnbrdf.prior.generated import GeneratedMaterials
from nnbrdf.teaching import TaughtEstimator

PRIOR = MaterialPrior.generate(examples=150)


def directions(seed, count):
    rng = np.random.default_rng(seed)
    return from_degrees(rng.uniform(0, 75, count), rng.uniform(0, 360, count))


def siblings(count):
    """Return materials that differ a little from each other and much from most."""
    drawn = GeneratedMaterials.draw(2000, 3, isotropic=True)
    one = drawn.select(np.flatnonzero((drawn.sheen > 0.1) & (drawn.retro > 0.1))[:1])
    rng = np.random.default_rng(0)
    for _ in range(count):
        yield replace(
            one,
            sheen=one.sheen * rng.lognormal(0, 0.3),
            retro=3 * one.retro * rng.lognormal(0, 0.3),
            retro_power=np.array([90.0]),
            body=one.body * rng.lognormal(0, 0.3),
        )


def samples_of(material, count, seed):
    light, view = directions(seed, count), directions(seed + 1, count)
    value = np.repeat(material.evaluate(Pairs.of(light, view)), 3, axis=1)
    return Samples.from_values(light, view, value, sigma=0.001 * value)


@pytest.fixture(scope="module")
def family():
    *measured, last = siblings(6)
    estimator = TaughtEstimator(prior=PRIOR, steps=20_000, size="1268")
    models = [estimator.fit(samples_of(each, 150, 10 * i)) for i, each in enumerate(measured)]
    return models, last


def test_measured_relatives_make_few_shots_better(family):
    models, last = family
    sharper = PRIOR.learn([model.as_example() for model in models])
    grid = grid_pairs().part(slice(0, None, 11))
    true = last.evaluate(grid)
    floor = 0.04 * np.median(true)

    def error(prior):
        told = PriorEstimator(prior=prior).fit(samples_of(last, 16, 99))
        value = told.evaluate(grid.light, grid.view)[:, :1]
        return np.abs(np.log((value + floor) / (true + floor))).mean()

    assert error(sharper) < 0.8 * error(PRIOR)


def test_an_example_is_the_material_up_to_scale(family):
    models, _ = family
    grid = grid_pairs().part(slice(0, None, 37))
    told = models[0].evaluate(grid.light, grid.view).mean(axis=1)
    other = models[0].evaluate(grid.view, grid.light).mean(axis=1)
    ratio = models[0].as_example().evaluate(grid) / np.sqrt(told * other)
    assert ratio == pytest.approx(np.median(ratio), rel=0.02)


def test_ten_count_as_much_as_all_generated_ones(family):
    example = family[0][0].as_example()
    weights = PRIOR.learn([example] * 10).families[0].weights
    assert weights.sum() == pytest.approx(1)
    assert weights[:150].sum() == pytest.approx(0.5)
    assert PRIOR.families[0].weights == pytest.approx(1 / 150)


def test_a_grained_material_is_no_isotropic_example(family):
    example = replace(family[0][0].as_example(), encoding="anisotropic")
    isotropic, other = PRIOR.learn([example]).families
    assert len(isotropic.learned) == 0
    assert len(other.learned) == 1


def test_it_loads_as_it_was_saved(family, tmp_path):
    prior = PRIOR.learn([model.as_example() for model in family[0]])
    prior.save(tmp_path / "prior.npz")
    again = MaterialPrior.load(tmp_path / "prior.npz")
    pairs = grid_pairs().part(slice(0, None, 101))
    for mine, told in zip(prior.families, again.families, strict=True):
        assert len(told.learned) == 5
        assert (mine.traits(pairs).examples == told.traits(pairs).examples).all()


BROKEN = {
    "missing": None,
    "empty": b"",
    "no npz": b"PK nothing of the kind",
    "other arrays": "other",
    "not finite": "nan",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_one_line(name, tmp_path):
    path, content = tmp_path / "prior.npz", BROKEN[name]
    if content == "other":
        np.savez(path, schema=np.array("gonio.prior/1"), body=np.ones(3))
    elif content == "nan":
        PRIOR.save(path)
        arrays = dict(np.load(path))
        arrays["isotropic.body"][3] = np.nan
        np.savez(path, **arrays)
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(BadFileError, match=r"prior\.npz"):
        MaterialPrior.load(path)


def run(monkeypatch, *words):
    monkeypatch.setattr("sys.argv", ["gonio", *map(str, words)])
    try:
        main()
    except SystemExit as stop:
        return stop.code
    return 0


def test_build_reads_what_is_below_the_folders(family, tmp_path, monkeypatch, capsys):
    for index, model in enumerate(family[0][:2]):
        model.save(tmp_path / "archive" / f"session{index}" / "model")
    broken = tmp_path / "archive" / "broken" / "model"
    family[0][0].save(broken)
    (broken / "weights.safetensors").write_bytes(b"x")
    PriorEstimator(prior=PRIOR).fit(samples_of(family[1], 20, 5)).save(tmp_path / "archive" / "p")
    out = tmp_path / "ours.npz"
    assert run(monkeypatch, "prior", "build", tmp_path / "archive", "-o", out) == 0
    said = capsys.readouterr()
    assert "isotropic: 2000 generated, 2 measured" in said.out
    assert "is broken" in said.err
    assert "is of estimator prior, not nn" in said.err
    assert len(MaterialPrior.load(out).families[0].learned) == 2


@pytest.mark.parametrize("folder", ["empty", "missing"])
def test_build_says_where_it_found_nothing(folder, tmp_path, monkeypatch, capsys):
    (tmp_path / "empty").mkdir()
    code = run(monkeypatch, "prior", "build", tmp_path / folder, "-o", tmp_path / "p.npz")
    assert code == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "p.npz").exists()


def test_a_file_of_something_else_is_not_to_be_loaded_unsafely(tmp_path):
    (tmp_path / "junk.npz").write_text("junk")
    with pytest.raises(BadFileError) as refused:
        MaterialPrior.load(tmp_path / "junk.npz")
    assert "no npz of arrays" in str(refused.value)
    assert "pickle" not in str(refused.value)


def test_what_is_expected_is_what_the_examples_are_like():
    light, view = directions(5, 40), directions(6, 40)
    mean, deviation = PRIOR.expected(light, view)
    drawn = []
    for family in PRIOR.families:
        values = family.examples.evaluate(Pairs.of(light, view))
        drawn.append(np.log(values + 0.01 * family.white))
    # four fifths are isotropic
    assert mean == pytest.approx(0.8 * drawn[0].mean(1) + 0.2 * drawn[1].mean(1), abs=1e-9)
    both = np.concatenate([*[drawn[0]] * 4, drawn[1]], axis=1)
    # scales count as independent of shapes, which is less sure in highlights
    assert np.median(deviation / both.std(1)) == pytest.approx(1.0, abs=0.15)
    assert (deviation > 0.9 * both.std(1)).all()


def test_the_interval_of_what_is_expected_holds_materials_of_another_draw():
    light, view = directions(7, 60), directions(8, 60)
    mean, deviation = PRIOR.expected(light, view)
    other = GeneratedMaterials.draw(300, 99, isotropic=True)
    log = np.log(other.evaluate(Pairs.of(light, view)).clip(1e-9))
    within = np.abs(log - mean[:, None]) < 1.645 * deviation[:, None]
    assert 0.85 < within.mean() < 0.98


def test_the_hash_is_of_what_a_prior_says_not_of_its_file(family, tmp_path):
    learned = PRIOR.learn([family[0][0].as_example()])
    learned.save(tmp_path / "one.npz")
    np.savez(tmp_path / "other.npz", **np.load(tmp_path / "one.npz"))
    assert (tmp_path / "one.npz").read_bytes() != (tmp_path / "other.npz").read_bytes()
    again = [MaterialPrior.load(tmp_path / name).sha256 for name in ("one.npz", "other.npz")]
    assert again == [learned.sha256] * 2
    others = [PRIOR, MaterialPrior.generate(examples=150, seed=1), learned]
    assert len({prior.sha256 for prior in others}) == 3


@pytest.mark.parametrize("estimator", [PriorEstimator, TaughtEstimator])
def test_a_model_names_its_prior_and_says_what_that_holds(family, tmp_path, estimator):
    learned = PRIOR.learn([family[0][0].as_example()])
    steps = {"steps": 300} if estimator is TaughtEstimator else {}
    model = estimator(prior=learned, **steps).fit(samples_of(family[1], 20, 5))
    model.save(tmp_path)
    told = load_model(tmp_path).card
    assert told.prior.model_dump() == {
        "sha256": learned.sha256, "generated": 300, "measured": 1,
    }  # fmt: skip
    assert "under 300 generated and 1 measured materials" in " ".join(told.sentences())
    assert (f"prior ({told.prior})", learned.sha256) in hashes(
        tmp_path, samples_of(family[1], 8, 5), None
    )


def test_a_posterior_beside_another_prior_is_refused(family, tmp_path):
    PriorEstimator(prior=PRIOR).fit(samples_of(family[1], 20, 5)).save(tmp_path)
    MaterialPrior.generate(examples=150, seed=1).save(tmp_path / "prior.npz")
    with pytest.raises(BadFileError, match=r"prior\.npz: is another prior"):
        load_model(tmp_path)


def test_a_model_counts_once_by_whatever_name(family, tmp_path, monkeypatch, capsys):
    for index, model in enumerate(family[0][:2]):
        model.save(tmp_path / "archive" / f"session{index}" / "model")
    shutil.copytree(tmp_path / "archive/session0", tmp_path / "archive/copy")
    (tmp_path / "link").symlink_to(tmp_path / "archive/session1")
    monkeypatch.chdir(tmp_path / "archive")
    folders = (tmp_path / "archive", ".", "session1", "../link")
    assert run(monkeypatch, "prior", "build", *folders, "-o", tmp_path / "ours.npz") == 0
    said = capsys.readouterr()
    assert "isotropic: 2000 generated, 2 measured" in said.out
    skipped = [line for line in said.err.splitlines() if " is the same as " in line]
    assert len(skipped) == 5
    assert "skipped: copy/model is the same as" in said.err
    learned = MaterialPrior.load(tmp_path / "ours.npz").learned
    assert {each.sha256 for each in learned} == {
        sha256_file(Path(each.source) / "weights.safetensors") for each in learned
    }
    assert len({each.sha256 for each in learned}) == 2


def scaled(name, factor):
    return lambda arrays: arrays.update({name: arrays[name] * factor})


def put(name, value):
    return lambda arrays: arrays.update({name: np.array(value)})


def stacked_twice(arrays):
    for name in [name for name in arrays if ".layer." in name]:
        arrays[name] = np.concatenate([arrays[name]] * 2)


def a_single_example(arrays):
    for name in [name for name in arrays if name.startswith("isotropic.")]:
        arrays[name] = arrays[name][:1]


def last_layer_blown_up(arrays):
    last = max(name for name in arrays if name.startswith("learned.0.layer."))
    arrays[last] = arrays[last] * np.float32(1e36)


def without_layers(arrays):
    for name in [name for name in arrays if name.startswith("learned.0.layer.")]:
        del arrays[name]


ABSURD = {
    "tint not a number": (put("learned.0.tint", [1.0, np.nan, 1.0]), "tint"),
    "tint below zero": (put("learned.0.tint", [1.0, -1.0, 1.0]), "tint"),
    "tint of zero": (put("learned.0.tint", [1.0, 0.0, 1.0]), "tint"),
    "tint of another shape": (put("learned.0.tint", [[1.0, 1.0]]), "tint"),
    "tint of text": (put("learned.0.tint", ["red", "green", "blue"]), "tint"),
    "activation": (put("learned.0.activation", "foo"), "activation 'foo'"),
    "encoding": (put("learned.0.encoding", "foo"), "learned.0.encoding"),
    "complex numbers": (scaled("isotropic.f0", 1j), "isotropic.f0"),
    "whole numbers": (put("isotropic.f0", [[1, 2, 3]] * 150), "isotropic.f0"),
    "text": (put("isotropic.body", ["a"] * 150), "isotropic.body"),
    "complex layers": (scaled("learned.0.layer.0", 1j), "learned.0.layer.0"),
    "bright beyond all": (scaled("isotropic.f0", 1e300), "isotropic.f0"),
    "dark at the rim": (put("anisotropic.limb", [500.0] * 150), "anisotropic.limb is 500"),
    "a network of no material": (last_layer_blown_up, "learned.0 is no material"),
    "two networks": (stacked_twice, "not one network"),
    "no network": (without_layers, "not one network"),
    "a flat layer": (put("learned.0.layer.0", [1.0, 2.0]), "not one network"),
    "one example": (a_single_example, "fewer than 10 isotropic examples"),
    "another schema": (put("schema", "gonio.prior/9"), "gonio.prior/9"),
    "an array missing": (lambda arrays: arrays.pop("anisotropic.sheen"), "lacks anisotropic.sheen"),
}


@pytest.mark.parametrize("name", ABSURD)
def test_an_absurd_prior_is_refused_by_name_of_file_and_array(name, family, tmp_path):
    spoil, says = ABSURD[name]
    path = tmp_path / "prior.npz"
    PRIOR.learn([family[0][0].as_example()]).save(path)
    arrays = dict(np.load(path))
    spoil(arrays)
    np.savez(path, **arrays)
    with pytest.raises(BadFileError, match=r"prior\.npz: is no prior") as refusal:
        MaterialPrior.load(path)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)
