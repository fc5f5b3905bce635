"""`gonio study` as a user runs it."""

import csv
import json
import os
import signal
import statistics
import subprocess
import sys

import pytest

QUICK = ("--subsets", "vs-is", "--seeds", "2", "--steps", "20")


def lines(path):
    return list(csv.DictReader(path.read_text().splitlines()))


def test_activations(gonio, tmp_path):
    ran = gonio("study", "activations", "satin", "matte-paint", *QUICK,
                "--activations", "softsign,gelu", "--networks", "3-6-4")  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "satin: eps8" in ran.stdout
    assert "matte-paint: eps8" in ran.stdout
    assert "All materials: mean rank over 2 materials" in ran.stdout
    trainings = lines(tmp_path / "study" / "results.csv")
    assert len(trainings) == 2 * 2 * 2
    table = lines(tmp_path / "study" / "eps8.csv")
    assert [row["name"] for row in table] == ["softsign", "gelu"] * 2
    assert {row["rank"] for row in table} == {"1", "2"}
    page = (tmp_path / "study" / "activations.html").read_text()
    assert page.count("<svg") == 4
    assert "http" not in page.replace("http://www.w3.org", "")


def test_names_may_be_written_in_capitals(gonio, tmp_path):
    ran = gonio("study", "activations", "satin", "--subsets", "VS-IS", "--seeds", "1", "--steps",
                "5", "--activations", "SoftSign", "--networks", "3-6-4")  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    (training,) = lines(tmp_path / "study" / "results.csv")
    assert (training["subset"], training["activation"]) == ("vs-is", "softsign")


@pytest.mark.parametrize("name", ["encodings", "topology", "targets"])
def test_the_other_studies(gonio, tmp_path, name):
    few = {"encodings": ("--networks", "4"), "topology": (), "targets": ("--activations", "relu")}
    ran = gonio("study", name, "satin", *QUICK, *few[name], "-o", "out")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert (tmp_path / "out" / f"{name}.html").is_file()
    assert len(lines(tmp_path / "out" / "results.csv")) >= 4 * 2


def test_targets_of_two_materials_are_summed_up(gonio, tmp_path):
    ran = gonio("study", "targets", "satin", "velvet", "--subsets", "vs-is", "--seeds", "2",
                "--steps", "10", "--activations", "softsign,relu")  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "All materials: mean rank over 2 materials" in ran.stdout
    page = (tmp_path / "study" / "targets.html").read_text()
    assert page.count("<svg") == 2
    assert "http" not in page.replace("http://www.w3.org", "")


def test_analytic(gonio, tmp_path):
    ran = gonio("study", "analytic", "satin", *QUICK, "--models", "lambert,ggx")
    assert (ran.returncode, ran.stderr) == (0, "")
    table = lines(tmp_path / "study" / "analytic.csv")
    names = ["lambert", "ggx", "network 15-30-20", "network 3-6-4"]
    assert [row["name"] for row in table] == names
    assert float(table[1]["male"]) < float(table[0]["male"])
    assert (tmp_path / "study" / "analytic.html").read_text().count("<svg") == 2
    trainings = lines(tmp_path / "study" / "results.csv")
    assert len(trainings) == 2 * 2
    errors = [float(row["eps8"]) for row in trainings if row["hidden"] == "3-6-4"]
    assert float(table[3]["eps8"]) == pytest.approx(statistics.median(errors))


def test_analytic_takes_the_networks_that_another_study_trained(gonio, tmp_path):
    assert (
        gonio("study", "activations", "satin", *QUICK, "--activations", "softsign").returncode == 0
    )
    before = (tmp_path / "study" / "results.jsonl").read_bytes()
    assert gonio("study", "analytic", "satin", *QUICK, "--models", "lambert").returncode == 0
    assert (tmp_path / "study" / "results.jsonl").read_bytes() == before


def test_what_is_killed_goes_on(gonio, tmp_path):
    command = ("study", "activations", "satin", "--subsets", "vs-is", "--seeds", "3", "--epochs",
               "300", "--activations", "softsign,tanh,gelu,mish,swish,softmax,rrelu")  # fmt: skip
    results = tmp_path / "study" / "results.jsonl"
    process = subprocess.Popen(
        [sys.executable, "-m", "gonio", *command],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    while process.poll() is None and not (results.exists() and results.stat().st_size):
        os.sched_yield()
    process.send_signal(signal.SIGKILL)
    process.wait()
    kept = [json.loads(line) for line in results.read_text().split("\n")[:-1]]
    assert 0 < len(kept) < 42
    assert gonio(*command).returncode == 0
    after = [json.loads(line) for line in results.read_text().splitlines()]
    assert after[: len(kept)] == kept
    assert len(after) == 42


BAD = {
    "activation": (("activations", "satin", "--activations", "silu"), "use linear, sigmoid"),
    "model": (("analytic", "satin", "--models", "disney"), "use lambert, minnaert"),
    "encoding": (("encodings", "satin", "--encodings", "abc"), "use "),
    "subset": (("activations", "satin", "--subsets", "abc"), "use va-ia, vs-ia, va-is, vs-is"),
    "network": (("topology", "satin", "--networks", "4-x"), "like 15-30-20,3-6-4"),
    "too deep": (("topology", "satin", "--networks", "1-2-3-4-5-6-7-8"), "up to 7 hidden layers"),
    "no units": (("topology", "satin", "--networks", "4-0"), "like 15-30-20,3-6-4"),
    "material": (("activations", "steel"), "material 'steel' is not known"),
    "file": (("activations", "none.npz"), "none.npz"),
    "twice": (("activations", "satin", "satin"), "two materials are called satin"),
    "folder": (("activations", "satin", "-o", "taken"), "taken is a file"),
    "study": (("weather", "satin"), "No such command"),
}


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line(gonio, tmp_path, arguments, message):
    (tmp_path / "taken").write_text("")
    ran = gonio("study", *arguments)
    assert ran.returncode == 2
    assert message in ran.stderr
    assert "Traceback" not in ran.stderr
    assert not (tmp_path / "study").exists()
