"""--json: what commands find, for programs."""

import json

import click
import pytest

from gonio.cli import _json
from gonio.cli._main import cli
from gonio.rig import default_rig_text

# they find nothing, serve until Ctrl-C, or print a script
WITHOUT = {
    "gonio watch", "gonio sim serve", "gonio sim place", "gonio sim door", "gonio sim power",
    "gonio completion",
}  # fmt: skip


def commands(command, context):
    if not isinstance(command, click.Group):
        yield context.command_path, command
        return
    for name in command.list_commands(context):
        below = command.get_command(context, name)
        yield from commands(below, click.Context(below, context, info_name=name))


def test_every_command_that_finds_something_has_it():
    every = dict(commands(cli, click.Context(cli, info_name="gonio")))
    assert len(every) > 25
    has = {name for name, command in every.items() if "as_json" in {p.name for p in command.params}}
    assert set(every) - has == WITHOUT


ASKED = {
    # command, keys of its answer, words that a person sees
    "plan": (("--density", 3, "--criterion", "random"), ("estimates", "shots"), "estimated time"),
    "materials": ((), ("materials",), "anisotropy"),
    "export": (("satin", "--to", "csv"), ("eps8", "file_bytes"), "read back"),
    "rig check": (("--sim",), ("findings",), "all is well"),
    "study activations": (
        (
            "satin",
            "--subsets",
            "vs-is",
            "--seeds",
            1,
            "--steps",
            5,
            "--networks",
            "3-6-4",
            "--activations",
            "softsign",
        ),
        ("tables", "trainings"),
        "1 trainings",
    ),
}


@pytest.mark.parametrize("command", ASKED)
def test_one_object_is_all_there_is_on_standard_output(gonio, command):
    options, keys, words = ASKED[command]
    ran = gonio(*command.split(), *options, "--json")
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    assert (found["schema"], found["command"]) == (_json.SCHEMA, f"gonio {command}")
    assert set(keys) <= set(found)
    assert words in ran.stderr


def test_what_is_found_wrong_is_told_before_it_ends_in_an_error(gonio, tmp_path):
    (tmp_path / "rig.toml").write_text(default_rig_text())  # of which no device is here
    ran = gonio("rig", "check", "--rig", "rig.toml", "--json")
    assert (ran.returncode, ran.stderr.splitlines()[-1]) == (3, "gonio: 6 things to see to")
    findings = json.loads(ran.stdout)["findings"]
    assert [each["is_well"] for each in findings] == [False] * 6


def test_what_fails_finds_nothing(gonio):
    ran = gonio("reduce", "nowhere", "--json")
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr.startswith("gonio: nowhere: no such folder")


def test_numbers_that_json_does_not_have_are_null(capsys):
    @click.command()
    @_json.answers
    def command():
        click.echo("for people")
        _json.answer({"share": float("nan"), "best_db": float("inf"), "rows": ((1, 2.5), [None])})

    command.main(["--json"], prog_name="gonio try", standalone_mode=False)
    told = capsys.readouterr()
    found = json.loads(told.out)
    assert (found["share"], found["best_db"], found["rows"]) == (None, None, [[1, 2.5], [None]])
    assert told.err == "for people\n"
