"""Names on the command line: in any case, and of unknown ones the known are told."""

from importlib import import_module

import pytest

ANY_CASE = [
    # command, option, as typed, as taken
    ("reconstruct", "--estimator", "Paper", "paper"),
    ("reconstruct", "--activation", "SoftSign", "softsign"),
    ("reconstruct", "--encoding", "XYZ", "xyz"),
    ("reconstruct", "--trainer", "Fused", "fused"),
    ("plan", "--criterion", "Farthest", "farthest"),
    ("plan", "--density", "VA-IS", "va-is"),
    ("plan", "--views", "ALL", "all"),
    ("plan", "--lights", "Sixth", "sixth"),
    ("capture", "--material", "Wood-Veneer", "wood-veneer"),
    ("capture", "--material", "Felt.npz", "Felt.npz"),
]


@pytest.mark.parametrize(
    ("name", "option", "typed", "taken"), ANY_CASE, ids=[f"{c[0]} {c[1]} {c[2]}" for c in ANY_CASE]
)
def test_a_name_in_any_case(name, option, typed, taken):
    command = import_module(f"gonio.cli.{name}").command
    context = command.make_context(name, [option, typed])
    assert context.params[option.removeprefix("--")] == taken


def test_the_paper_s_own_spelling_trains(gonio, tmp_path):
    rows = [f"{10 * i},0,{5 * i},40,0.{i + 1},0.2,0.3" for i in range(8)]
    header = "light_theta_deg,light_phi_deg,view_theta_deg,view_phi_deg,r,g,b"
    (tmp_path / "table.csv").write_text("\n".join([header, *rows]))
    names = ("--estimator", "Paper", "--activation", "SoftSign", "--encoding", "XYZ")
    result = gonio("reconstruct", "table.csv", *names, "--steps", "1", "--weights", "88")
    assert result.returncode == 0, result.stderr
