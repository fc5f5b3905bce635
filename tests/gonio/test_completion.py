"""`gonio completion`, and what the shell is then told."""

import subprocess

import pytest

SHELLS = {
    # what to type, the variable by which a shell asks, where its script says so
    "bash": "_GONIO_COMPLETE=bash_complete",
    "zsh": "#compdef gonio",
    "fish": "complete --no-files --command gonio",
}


@pytest.mark.parametrize("shell", SHELLS)
def test_a_script_for_each_shell(gonio, shell):
    ran = gonio("completion", shell)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert SHELLS[shell] in ran.stdout


def test_another_shell_is_refused(gonio):
    ran = gonio("completion", "tcsh")
    assert ran.returncode == 2
    assert "'tcsh' is not one of 'bash', 'zsh', 'fish'" in ran.stderr


def test_bash_takes_the_script(gonio, tmp_path):
    (tmp_path / "script").write_text(gonio("completion", "bash").stdout)
    checked = subprocess.run(["bash", "-n", tmp_path / "script"], check=False, capture_output=True)
    assert (checked.returncode, checked.stderr) == (0, b"")


ASKED = {
    "gonio ca": ["calibrate", "capture"],
    "gonio study e": ["encodings"],
    "gonio plan --crit": ["--criterion"],
    "gonio reconstruct --estimator a": ["analytic"],
}


@pytest.mark.parametrize("typed", ASKED)
def test_what_is_typed_is_completed(all_forks, tmp_path, typed):
    last = str(len(typed.split()) - 1)
    asking = {"COMP_WORDS": typed, "COMP_CWORD": last, "_GONIO_COMPLETE": "bash_complete"}
    with (tmp_path / "out").open("w+") as out, (tmp_path / "err").open("w+") as err:
        with all_forks.start(tmp_path, stdout=out, stderr=err, env=asking) as running:
            code = running.wait(60)
        out.seek(0)
        told = [line.partition(",")[2] for line in out.read().splitlines()]
    assert (code, told) == (0, ASKED[typed])
