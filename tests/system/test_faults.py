"""A capture of 196 shots in which all goes wrong that can, against one in which nothing does."""

import re
from pathlib import Path

import numpy as np
import pytest

from gonio.faultlog import faults_of
from gonio.samples import Samples
from gonio.session import Session

FAULTS = Path(__file__).parents[2] / "docs/examples/faults.toml"


def ok(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


def samples_of(gonio, folder):
    ok(gonio("reduce", folder.name))
    return Samples.load(folder / "samples.nc")


@pytest.mark.slow
def test_every_fault_at_once_leaves_the_same_samples(gonio, tmp_path):
    ok(gonio("plan", "--density", "sixth", "--criterion", "farthest", "--no-page"))
    ok(gonio("capture", "--sim", "-o", "clean"))
    stopped = gonio("capture", "--sim", "-o", "hit", "--faults", FAULTS)
    assert stopped.returncode == 3
    assert "the disk is full" in stopped.stderr
    assert "go on with: gonio capture --sim --resume -o hit" in stopped.stderr
    told = ok(gonio("capture", "--sim", "-o", "hit", "--resume", "--faults", FAULTS))
    assert "faults met: " in told
    with Session(tmp_path / "hit").journal() as journal:
        assert len(faults_of(journal)) > 40
        keys = [record.key for record in journal.frames() if record.role == "shot"]
    assert len(keys) == len({*keys}) == 196 * 4
    clean, hit = samples_of(gonio, tmp_path / "clean"), samples_of(gonio, tmp_path / "hit")
    assert sorted(hit.shot_index) == sorted(clean.shot_index) == list(range(196))
    order = np.argsort(clean.shot_index)[hit.shot_index]
    off = (clean.value[order] - hit.value) / np.hypot(clean.sigma[order], hit.sigma)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(1.0, abs=0.25)
    assert np.abs(off).max() < 5.0
    ok(gonio("reconstruct", "hit", "--estimator", "paper", "--epochs", "2"))
    page = (tmp_path / "hit/report.html").read_text()
    assert "faults met" in page
    assert re.search(r"\d+ x lamps", page)


BAD = {
    "no.toml": (None, "no such file"),
    "text.toml": ("[[fault]", "is not TOML"),
    "empty.toml": ("", "fault"),
    "kind.toml": (
        '[[fault]]\nkind = "flood"\nrate = 1',
        "'flood' is no kind of fault; use bus time",
    ),
    "when.toml": ('[[fault]]\nkind = "stall"', "say when: a rate above 0, at, or at_s"),
    "rate.toml": ('[[fault]]\nkind = "stall"\nrate = 2', "2 is out of range, 0 to 1"),
    "key.toml": ('[[fault]]\nkind = "stall"\nrate = 1\nhow = "hard"', "how"),
    "axis.toml": ('[[fault]]\nkind = "interlock"\nrate = 1\naxis = "view_phi"', "strikes no axis"),
    "lamp.toml": ('[[fault]]\nkind = "stall"\nrate = 1\nlamp = 2', "strikes no lamp"),
    "lasts.toml": ('[[fault]]\nkind = "frame missing"\nrate = 1\nlasts_s = 2', "over at once"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_of_faults_is_refused_before_anything_is_made(gonio, tmp_path, name):
    text, says = BAD[name]
    if text is not None:
        (tmp_path / name).write_text(text)
    refused = gonio("capture", "--sim", "--faults", name)
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1
    assert name in refused.stderr
    assert says in refused.stderr
    assert not (tmp_path / "session").exists()


def test_faults_are_for_the_twin_only(gonio):
    refused = gonio("capture", "--faults", FAULTS)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
