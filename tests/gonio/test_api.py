"""gonio from Python: the tutorial as it is printed, and the command line beside it."""

import ast
import contextlib
import inspect
import io
import json
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import gonio as api
from gonio import plan as core_plan
from gonio import session as core_session
from gonio.directions import from_degrees
from gonio.errors import BadInputError

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"
CELL = re.compile(r"^```python\n(.*?)^```\n(?:```text\n(.*?)^```\n)?", re.DOTALL | re.MULTILINE)


def run(cell, namespace):
    """Run a cell as a notebook does: what its last expression is, is printed."""
    *body, last = ast.parse(cell).body
    screen = io.StringIO()
    with contextlib.redirect_stdout(screen):
        if isinstance(last, ast.Expr):
            exec(compile(ast.Module(body, []), "cell", "exec"), namespace)
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), namespace)
            if value is not None:
                screen.write(f"{value!r}\n")
        else:
            exec(compile(cell, "cell", "exec"), namespace)
    return screen.getvalue()


def as_printed(expected):
    return re.escape(expected).replace(re.escape("..."), ".*?")


def answer(ran):
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


TWIN = ("--sim", "--material", "satin", "--seed", 1)


def test_the_tutorial_is_as_printed(gonio, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    here, cells = {}, CELL.findall(TUTORIAL.read_text())
    assert len(cells) >= 11
    for cell, expected in cells:
        assert re.fullmatch(as_printed(expected), run(cell, here)), cell
    told = answer(gonio("capture", *TWIN, "-o", "cli", "--json"))
    assert told["frames"] == len(list(Path("cli").rglob("*.dng")))
    for frame in Path("cli/raw").glob("*.dng"):
        assert frame.read_bytes() == (Path("night/raw") / frame.name).read_bytes()


@pytest.mark.slow
def test_the_command_line_comes_to_the_same_to_the_bit(gonio, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plan = api.Plan.make(shots=12)
    session = plan.capture("night", sim=True, material="satin", seed=1)
    samples = session.reduce()
    material = session.reconstruct(steps=2000)
    told = answer(gonio("plan", "--shots", 12, "--no-page", "--json"))
    assert plan.summary().items() <= told.items()
    assert api.Plan.load("plan.json") == plan
    answer(gonio("capture", *TWIN, "-o", "cli", "--json"))
    told = answer(gonio("reduce", "cli", "--json"))
    assert samples.summary().items() <= told.items()
    assert np.array_equal(api.Session.open("cli").samples.sigma, samples.sigma)
    told = answer(gonio("reconstruct", "cli", "--steps", 2000, "--json"))
    assert told["error"]["eps8"] == material.compare(material.truth).eps8
    assert same("model/weights.safetensors")
    session.extend(shots=4)
    told = answer(gonio("plan", "--continue", "cli", "--shots", 4, "--json"))
    answer(gonio("capture", "--sim", "--resume", "-o", "cli", "--json"))
    assert told["sha256"] == session.chain().last.sha256
    assert same("plans/001.json")
    assert same("raw")


def same(name):
    """Whether the two sessions hold the same bytes in a file, or in every file of a folder."""
    one, other = (
        {path.name: path.read_bytes() for path in ([at] if at.is_file() else sorted(at.iterdir()))}
        for at in (Path(root) / name for root in ("night", "cli"))
    )
    return one == other


@pytest.fixture(scope="module")
def plan():
    return api.Plan.make(3, criterion="Farthest")


def test_what_is_of_the_core_goes_wherever_that_does(plan, tmp_path):
    assert isinstance(plan, core_plan.Plan)
    plan.save(tmp_path / "plan.json")
    assert api.Plan.load(tmp_path / "plan.json") == plan
    assert core_plan.Plan.load(tmp_path / "plan.json").sha256 == plan.sha256
    assert issubclass(api.Session, core_session.Session)
    light, view = from_degrees([10, 20], [0, 0]), from_degrees([30, 40], [0, 90])
    samples = api.Samples.from_values(light, view, np.full((2, 3), 0.1), np.full((2, 3), 0.01))
    samples.save(tmp_path / "samples.nc")
    assert repr(api.Samples.load(tmp_path / "samples.nc")) == repr(samples)
    samples.to_csv(tmp_path / "samples.csv")
    read = api.Samples.load(tmp_path / "samples.csv").to_table()
    assert read.r.tolist() == samples.to_table().r.tolist() == [0.1, 0.1]


def test_things_tell_of_themselves_in_a_notebook(plan):
    for shown, words in (
        (plan._repr_html_(), ("estimated time", "9, 0.1% of the full set")),
        (api.Material.load("satin")._repr_html_(), ("<figcaption>satin", "data:image/png;base64,")),
    ):
        assert all(word in shown for word in words)


ALIKE = {
    # command, function, options of files that it draws or of what has a function of its own
    "plan": (
        api.Plan.make,
        {"continued", "output", "page", "pareto", "plot", "plot_demand"},
    ),
    "capture": (api.Session.capture, {"resume", "retake"}),
}
RENAMED = {"output": "folder"}


@pytest.mark.parametrize("name", ALIKE)
def test_arguments_are_named_as_options_and_have_their_defaults(name):
    function, without = ALIKE[name]
    arguments = dict(inspect.signature(function).parameters)
    options = import_module(f"gonio.cli.{name}").command.make_context(name, []).params
    of_both = {
        RENAMED.get(option, option.removesuffix("_path")): default
        for option, default in options.items()
        if option not in without | {"as_json"}
    }
    assert of_both.keys() == arguments.keys() - {"progress"}
    for argument, default in of_both.items():
        known = "sixth" if argument == "density" else arguments[argument].default
        # a flag that is not set is None where the command asks whether it was
        assert (default or None) == (known or None), argument


_UP = [0.0, 0.0, 1.0]


def evaluated(light, view):
    return api.Material.load("satin").evaluate(light, view)


REFUSED = {
    "a plan told twice how much": (lambda: api.Plan.make("all", hours=1), "--hours says how many"),
    "options of the twin without it": (lambda: api.Session.capture(seed=1), "add that, or leave"),
    "a rig that nobody named": (api.Session.capture, "which rig?"),
    "a setting that is none": (
        lambda: api.Samples.reconstruct(None, wieght=88),
        "there is no setting 'wieght'; use weights, general, steps",
    ),
    "a setting of another estimator": (
        lambda: api.Samples.reconstruct(None, estimator="prior", epochs=3),
        "--epochs is an option of estimator paper, not of prior",
    ),
    "a material that is none": (lambda: api.Material.load("nylon"), "no such file, folder or"),
    "sigma of what has none": (
        lambda: api.Material.load("satin").sigma(None, None),
        "satin: is no model, so its sigma is not known",
    ),
    "shots that are no number": (
        lambda: api.Plan.make(shots="abc"),
        "shots is 'abc'; give a whole",
    ),
    "shots that are a part": (
        lambda: api.Plan.make(shots=2.5),
        "shots is 2.5; give a whole number",
    ),
    "hours that are no number": (
        lambda: api.Plan.make(hours="two"),
        "hours is 'two'; give a number",
    ),
    "hours without end": (
        lambda: api.Plan.make(hours=np.inf),
        "hours is inf; give a number from 0",
    ),
    "a seed below none": (lambda: api.Plan.make(seed=-1), "seed is -1; give a whole number from 0"),
    "too many for both": (lambda: api.Plan.make(82), "--density '82' is no density; use all"),
    "too many lights": (lambda: api.Plan.make(lights=82), "--lights '82' is no density; use all"),
    "pictures of two pixels": (
        lambda: api.Material.load("satin").render(size_px=2),
        "size_px is 2; give a whole number from 16 to 2048",
    ),
    "three lights": (
        lambda: api.Material.load("satin").render(lights=3),
        "lights is 3; give a whole number from 16 to 8192",
    ),
    "too bright": (
        lambda: api.Material.load("satin").render(stops=11),
        "stops is 11; give a number",
    ),
    "nothing to compare with": (
        lambda: api.Material.load("satin").compare(None),
        "None is no material; give one, its name or its path",
    ),
    "a name to compare with": (
        lambda: api.Material.load("satin").compare("nylon"),
        "nylon: no such file, folder or material",
    ),
    "a light that is long": (
        lambda: evaluated([0, 0, 2], _UP),
        "light holds what is no unit vector",
    ),
    "a light of nothing": (
        lambda: evaluated([np.nan] * 3, _UP),
        "light holds what is no unit vector",
    ),
    "a light behind": (
        lambda: evaluated([0, 0, -1], _UP),
        "light holds directions below the sample",
    ),
    "a view of two": (lambda: evaluated(_UP, [0, 1]), "view is of shape (2,), not (..., 3)"),
    "a view of words": (lambda: evaluated(_UP, "up"), "view is no array of numbers"),
    "what does not fit": (lambda: evaluated([_UP] * 2, [_UP] * 3), "do not fit together"),
    "a renderer that is none": (
        lambda: api.Material.load("satin").render(renderer="luxury"),
        "'luxury' is not known; use auto, own, mitsuba",
    ),
    "a shape that is none": (lambda: api.Material.load("satin").render("cube"), "use sphere, "),
}


@pytest.mark.parametrize(("ask", "says"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_done_is_refused_in_words(tmp_path, monkeypatch, ask, says):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInputError, match=re.escape(says)):
        ask()
    assert not list(tmp_path.iterdir())


def test_a_material_is_asked_by_lists():
    satin = api.Material.load("satin")
    assert evaluated(_UP, [_UP] * 2).shape == (2, 3)
    assert evaluated(from_degrees(90.0, 10.0), _UP).shape == (3,)
    assert repr(satin.render(size_px=16, lights=16, renderer="own")).startswith(
        "<Rendered 16 x 16 px, times "
    )
