"""`gonio study` as a user runs it."""

import csv
import json
import os
import re
import signal
import statistics
import subprocess
import sys

import numpy as np
import pytest

from gonio.cli import main
from gonio.cli._main import _Terminated

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
    trainings = lines(tmp_path / "study" / "activations-trainings.csv")
    assert len(trainings) == 2 * 2 * 2
    table = lines(tmp_path / "study" / "activations-eps8.csv")
    assert [row["name"] for row in table] == ["softsign", "gelu"] * 2
    assert {row["rank"] for row in table} == {"1", "2"}
    page = (tmp_path / "study" / "activations.html").read_text()
    assert page.count("<svg") == 4
    assert "http" not in page.replace("http://www.w3.org", "")


def test_names_may_be_written_in_capitals(gonio, tmp_path):
    ran = gonio("study", "activations", "satin", "--subsets", "VS-IS", "--seeds", "1", "--steps",
                "5", "--activations", "SoftSign", "--networks", "3-6-4")  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    (training,) = lines(tmp_path / "study" / "activations-trainings.csv")
    assert (training["subset"], training["activation"]) == ("vs-is", "softsign")


@pytest.mark.parametrize("name", ["encodings", "topology", "targets"])
def test_the_other_studies(gonio, tmp_path, name):
    few = {"encodings": ("--networks", "4"), "topology": (), "targets": ("--activations", "relu")}
    ran = gonio("study", name, "satin", *QUICK, *few[name], "-o", "out")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert (tmp_path / "out" / f"{name}.html").is_file()
    assert len(lines(tmp_path / "out" / f"{name}-trainings.csv")) >= 4 * 2


def test_studies_of_one_folder_leave_each_others_tables_alone(gonio, tmp_path):
    for study in ("activations", "topology"):
        few = ("--activations", "relu") if study == "activations" else ()
        assert gonio("study", study, "satin", *QUICK, *few, "--networks", "4").returncode == 0
    (row,) = lines(tmp_path / "study" / "activations-eps8.csv")
    assert row["name"] == "relu"
    (row,) = lines(tmp_path / "study" / "topology-sphere_psnr_db.csv")
    assert row["name"] == "4 (43)"
    assert "percent_below_best" in row


def test_the_page_says_how_it_was_made(gonio, tmp_path):
    arguments = (
        "study",
        "activations",
        "satin",
        *QUICK,
        "--activations",
        "relu",
        "--networks",
        "4",
    )
    assert gonio(*arguments).returncode == 0
    page = (tmp_path / "study" / "activations.html").read_text()
    notes = dict(re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", page))
    assert notes["command"] == " ".join(("gonio", *arguments))
    assert notes["networks for each case"] == "2"
    assert notes["length of training"] == "as --steps says (vs-is: 196 pairs, 20 steps)"
    assert notes["white (1/sr)"].startswith("satin 0.")
    assert {"trainer", "machine", "date", "eps8", "male"} < set(notes)


def test_what_is_wide_scrolls(gonio, tmp_path):
    few = ("--activations", "relu", "--networks", "4")
    assert gonio("study", "activations", "satin", *QUICK, *few).returncode == 0
    page = (tmp_path / "study" / "activations.html").read_text()
    for wide in ("<table>", "<svg "):
        assert page.count(wide) == len(re.findall(rf'<div class="scroll">\s*{wide}', page)) > 0


def test_equal_steps_of_a_single_subset_are_not_repeated(gonio, tmp_path):
    assert gonio("study", "targets", "satin", *QUICK, "--activations", "relu").returncode == 0
    page = (tmp_path / "study" / "targets.html").read_text()
    assert "targets to 255" in page
    assert "equal steps<" not in page


def test_names_given_twice_count_once(gonio, tmp_path):
    ran = gonio("study", "activations", "satin", *QUICK, "--activations", "relu,relu",
                "--networks", "4,4")  # fmt: skip
    assert "2 trainings" in ran.stdout


def test_a_long_training_stops_at_once(gonio, tmp_path):
    command = [sys.executable, "-m", "gonio", "study", "activations", "satin", "--subsets", "vs-is",
               "--steps", "1000000000", "--activations", "relu"]  # fmt: skip
    results = tmp_path / "study" / "results.jsonl"
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        while process.poll() is None and not results.exists():
            os.sched_yield()
        # not SIGINT, which a shell in the background has its children ignore
        process.terminate()
        try:
            _, said = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == 143
    assert "stopped" in said


def test_a_disk_that_is_full_is_one_line(tmp_path):
    command = (
        f"ulimit -f 2; {sys.executable} -m gonio study activations satin -o full --steps 50"
        " --seeds 2 --subsets vs-is --networks 3-6-4"
    )
    ran = subprocess.run(
        ["bash", "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 3
    (line,) = ran.stderr.splitlines()
    assert line.startswith("gonio: full/results.jsonl: cannot be written (File too large)")


def test_targets_of_two_materials_are_summed_up(gonio, tmp_path):
    ran = gonio("study", "targets", "satin", "velvet", "--subsets", "vs-is", "--seeds", "2",
                "--steps", "10", "--activations", "softsign,relu")  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "All materials: mean rank over 2 materials" in ran.stdout
    page = (tmp_path / "study" / "targets.html").read_text()
    assert page.count("<svg") == 2
    assert "http" not in page.replace("http://www.w3.org", "")


def test_targets_as_tables_say_what_the_page_says(gonio, tmp_path):
    ran = gonio("study", "targets", "satin", "velvet", "--subsets", "vs-is", "--seeds", "2",
                "--steps", "10", "--activations", "softsign,relu,gelu")  # fmt: skip
    assert "tables: study/targets-*.csv" in ran.stdout
    page = (tmp_path / "study" / "targets.html").read_text()
    shown = [re.findall(r">([^<]*)</t[hd]>", row) for row in re.findall(r"<tr.*?</tr>", page)]
    settings = ["as in the recipe", "targets to 255", "white x 0.5", "white x 2"]
    errors = lines(tmp_path / "study" / "targets-eps8.csv")
    assert list(errors[0]) == ["material", "name", *settings]
    assert [row["material"] for row in errors] == ["satin"] * 3 + ["velvet"] * 3
    for row in errors:
        assert [row["name"], *(f"{float(row[name]):.2f}" for name in settings)] in shown
    orders = lines(tmp_path / "study" / "targets-tau.csv")
    assert [row["setting"] for row in orders] == settings * 2
    for row in orders:
        taus = [f"{float(row[name]):.2f}" for name in ("tau_to_recipe", "tau_between_seeds")]
        assert [row["setting"], *taus, row["best"], row["second"], row["third"]] in [
            cells[:6] for cells in shown
        ]


def test_analytic(gonio, tmp_path):
    ran = gonio("study", "analytic", "satin", *QUICK, "--models", "lambert,ggx")
    assert (ran.returncode, ran.stderr) == (0, "")
    table = lines(tmp_path / "study" / "analytic.csv")
    names = ["lambert", "ggx", "network 15-30-20", "network 3-6-4"]
    assert [row["name"] for row in table] == names
    assert float(table[1]["male"]) < float(table[0]["male"])
    assert (tmp_path / "study" / "analytic.html").read_text().count("<svg") == 2
    trainings = lines(tmp_path / "study" / "analytic-trainings.csv")
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


def test_subsets_are_views_and_lights_as_they_are_called(tmp_path):
    from gonio.cli._study import read_setting

    setting = read_setting(["satin"], tmp_path, "va-is,vs-ia", seeds=1, epochs=1, steps=None)
    counts = {
        name: tuple(len(set(part.tolist())) for part in np.divmod(pairs, 81))
        for name, pairs in setting.subsets.items()
    }
    assert counts == {"va-is": (14, 81), "vs-ia": (81, 14)}  # lights, views


def test_another_white_is_another_material(tmp_path):
    from gonio.cli._study import read_setting

    def digest(white):
        np.savez(tmp_path / "one.npz", values=np.full((81, 81, 3), 0.2), white=white)
        names = [str(tmp_path / "one.npz")]
        setting = read_setting(names, tmp_path, "vs-is", seeds=1, epochs=1, steps=None)
        return setting.truths["one"].digest

    assert digest(0.8) == digest(0.8) != digest(0.9)


def test_stability_without_torch_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr("sys.argv", ["gonio", "study", "stability", "-o", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert "gonio[nn]" in capsys.readouterr().err


@pytest.mark.parametrize(("stop", "code"), [(KeyboardInterrupt, 130), (_Terminated, 143)])
def test_stability_that_is_stopped_says_that_nothing_is_kept(
    tmp_path, monkeypatch, capsys, stop, code
):
    def interrupt(*arguments):
        raise stop

    monkeypatch.setattr("gonio.cli.study_stability._section", interrupt)
    monkeypatch.setattr("sys.argv", ["gonio", "study", "stability", "-o", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == code
    said = capsys.readouterr().err.strip()
    assert said == "gonio: stopped; nothing is kept, and the same command begins anew"
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_dynamics(gonio, tmp_path):
    ran = gonio("study", "dynamics", "--methods", "Exponential,LSODA", "--cases", "locked,work",
                "--days", "0.05", "-o", "out")  # fmt: skip
    assert ran.returncode == 0
    bounds = lines(tmp_path / "out" / "dynamics-bounds.csv")
    assert {row[""] for row in bounds} == {"pass"}
    assert f"{len(bounds)} of {len(bounds)} bounds hold" in ran.stdout
    errors = {}
    for row in lines(tmp_path / "out" / "dynamics-race.csv"):
        method, _ = row["method and tolerance"].split()
        errors.setdefault(method, []).append(float(row["largest error (µrad)"]))
    assert {method: each[0] > 1e3 * each[-1] for method, each in errors.items()} == {
        "exponential": True,
        "LSODA": True,
    }
    page = (tmp_path / "out" / "dynamics.html").read_text()
    assert page.count("<svg") == 3
    assert "1e-04 s electrical, 0.1 s mechanical, 1000 s thermal" in page
    assert "gonio study dynamics --methods" in page


BAD = {
    "solver": (("dynamics", "--methods", "euler"), "use exponential, lsoda, radau, rk45"),
    "case": (("dynamics", "--cases", "flood"), "use swing, step, locked"),
    "dynamics folder": (("dynamics", "-o", "taken"), "taken is a file"),
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
    "steps beyond all": (("activations", "satin", "--steps", "9" * 25), "1000000000"),
    "epochs beyond all": (("activations", "satin", "--epochs", "9" * 25), "1000000"),
    "seeds beyond all": (("activations", "satin", "--seeds", "1000000000000"), "1000"),
    "black": (("activations", "black.npz"), "the largest value is 0"),
    "tiny": (("analytic", "tiny.npz"), "check that values are in 1/sr"),
    "huge": (("activations", "huge.npz"), "check that values are in 1/sr"),
    "folder": (("activations", "satin", "-o", "taken"), "taken is a file"),
    "study": (("weather", "satin"), "use activations, encodings"),
}


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line(gonio, tmp_path, arguments, message):
    (tmp_path / "taken").write_text("")
    for name, scale in {"black": 0.0, "tiny": 1e-310, "huge": 1e35}.items():
        np.savez(tmp_path / name, values=np.full((81, 81, 3), scale), white=1.0)
    ran = gonio("study", *arguments)
    assert ran.returncode == 2
    assert message in ran.stderr
    assert "Traceback" not in ran.stderr
    assert not (tmp_path / "study").exists()
