import json
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import click
import pytest

import gonio
from gonio.cli import _main
from gonio.cli.study import STUDIES
from gonio.errors import (
    BadInputError,
    DeviceFaultError,
    ResumeRefusedError,
    StorageError,
    TransportTimeoutError,
)

HEAVY = {"numpy", "scipy", "torch", "pydantic", "xarray", "cv2", "matplotlib", "rawpy", "rich"}


def modules_after(program):
    """Return the packages that are loaded after a program has run in a process of its own."""
    report = "import json, sys; print(json.dumps(sorted({m.split('.')[0] for m in sys.modules})))"
    result = subprocess.run(
        [sys.executable, "-c", f"{program}\n{report}"], capture_output=True, text=True, check=True
    )
    return set(json.loads(result.stdout.splitlines()[-1]))


HELP = """
import sys
from gonio.cli import main
sys.argv = ["gonio", "--help"]
try:
    main()
except SystemExit:
    pass
"""


@pytest.mark.parametrize("program", ["import gonio", HELP], ids=["import gonio", "gonio --help"])
def test_what_is_light_stays_light(program):
    assert not modules_after(program) & HEAVY


def test_every_public_name_resolves():
    assert dir(gonio) == sorted(gonio.__all__)
    for name in gonio.__all__:
        assert getattr(gonio, name) is not None
    stub = Path(gonio.__file__).with_suffix(".pyi").read_text()
    assert set(re.findall(r" as (\w+)$", stub, re.MULTILINE)) == {*gonio.__all__} - {"__version__"}
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = gonio.nonsense


def test_help_lists_the_commands_in_the_order_of_use(gonio):
    result = gonio("--help")
    assert result.returncode == 0
    places = [result.stdout.index(f"\n  {name}") for name in _main.COMMANDS]
    assert places == sorted(places)


def test_the_version(gonio):
    assert gonio("--version").stdout.split()[-1] == import_module("gonio").__version__


@pytest.mark.parametrize("name", list(_main.COMMANDS))
def test_every_command_teaches_with_an_example(name):
    command = _main.cli.get_command(click.Context(_main.cli), name)
    text = command.get_help(click.Context(command, info_name=f"gonio {name}"))
    assert "Examples:" in text
    assert f"    gonio {name}" in text
    # each example stands on a line of its own
    assert all(line.count("gonio ") == 1 for line in text.splitlines() if "    gonio " in line)


MISTAKES = [
    (("fly",), f"'fly' is no command of gonio; use {', '.join(_main.COMMANDS)}"),
    (("stdy",), "'stdy' is no command of gonio (did you mean study?); use plan, "),
    (("Plan",), "(did you mean plan?)"),
    (("study", "foo"), f"'foo' is no command of gonio study; use {', '.join(STUDIES)}"),
    (("prior", "biuld"), "(did you mean build?); use build"),
    (("plan", "--densty", "4"), "No such option"),
    (("plan", "extra"), "unexpected extra argument"),
]


@pytest.mark.parametrize(("arguments", "says"), MISTAKES, ids=[" ".join(m[0]) for m in MISTAKES])
def test_mistyped_commands_exit_2(gonio, arguments, says):
    result = gonio(*arguments)
    assert result.returncode == 2
    assert says in result.stderr
    assert result.stderr.count("\n") == 1


def noted(error):
    error.add_note("go on with: gonio capture --resume")
    return error


ENDINGS = [
    # what a command raises, exit code, what is printed
    (BadInputError("a\nb"), 2, "gonio: a b\n"),
    (DeviceFaultError("axis 1 stuck"), 3, "gonio: axis 1 stuck\n"),
    (StorageError("disk"), 3, "gonio: disk\n"),
    (
        noted(TransportTimeoutError("no answer")),
        3,
        "gonio: no answer; go on with: gonio capture --resume\n",
    ),
    (ResumeRefusedError("other plan"), 4, "gonio: other plan\n"),
    (KeyboardInterrupt(), 130, "\ngonio: stopped; what was finished is kept\n"),
    (
        PermissionError(13, "Permission denied", "x.json"),
        3,
        "gonio: x.json: Permission denied; check the folder, its permissions and space\n",
    ),
    (BrokenPipeError(32, "Broken pipe"), 141, ""),
]


@pytest.mark.parametrize(
    ("error", "code", "printed"), ENDINGS, ids=[type(e[0]).__name__ for e in ENDINGS]
)
def test_errors_end_in_one_line_and_a_code(monkeypatch, capsys, error, code, printed):
    @click.command()
    def command():
        raise error

    monkeypatch.setattr(_main, "cli", command)
    monkeypatch.setattr(sys, "argv", ["gonio"])
    with pytest.raises(SystemExit) as caught:
        _main.main()
    assert caught.value.code == code
    assert capsys.readouterr().err == printed


UNREAD = {
    "the help, which click prints": (("--help",), 141),
    "a table, which rich prints": (("materials",), 141),
    "the help of a group": ((), 2),
    "a mistake": (("fly",), 2),
}


@pytest.mark.parametrize(("arguments", "code"), UNREAD.values(), ids=UNREAD)
def test_where_nobody_reads_on_it_ends_quietly(arguments, code):
    read, write = os.pipe()
    os.close(read)
    # mistakes are told to stderr, so that is what nobody reads then
    quiet = {"stdout": write, "stderr": subprocess.PIPE} if code == 141 else {"stderr": write}
    command = [sys.executable, "-m", "gonio", *arguments]
    ran = subprocess.run(command, check=False, text=True, **quiet)
    os.close(write)
    assert ran.returncode == code
    assert not ran.stderr
