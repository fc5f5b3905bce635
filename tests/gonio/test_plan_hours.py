import pytest

from gonio.plan import Plan


def test_hours_are_kept_and_used(gonio, tmp_path):
    plans = {}
    for hours in ("0.1", "0.2"):
        gonio("plan", "--hours", hours, "-o", f"{hours}.json", "--no-page")
        plans[hours] = Plan.load(tmp_path / f"{hours}.json")
        total_s = plans[hours].estimates.total_s
        # a shot more would not fit: each takes some five seconds
        assert 3600 * float(hours) - 8 < total_s <= 3600 * float(hours)
    few, more = plans["0.1"], plans["0.2"]
    assert len(few.shots) < len(more.shots)
    assert few.selection.variance_left > more.selection.variance_left


@pytest.mark.slow
def test_hours_buy_more_than_shots_of_no_price(gonio, tmp_path):
    gonio("plan", "--hours", "0.15", "-o", "hours.json", "--no-page")
    hours = Plan.load(tmp_path / "hours.json")
    gonio("plan", "--shots", str(len(hours.shots)), "-o", "shots.json", "--no-page")
    assert hours.estimates.total_s < Plan.load(tmp_path / "shots.json").estimates.total_s


BAD = [
    (("--hours", "0.001"), "takes more than 0.001 h"),
    (("--hours", "0"), "--hours"),
    (("--hours", "nan"), "nan is no number"),
    (("--hours", "-1"), "--hours"),
    (("--hours", "1e9"), "--hours"),
    (("--hours", "1", "--shots", "8"), "leave out --shots"),
    (("--hours", "1", "--density", "8"), "leave out --density"),
    (("--hours", "1", "--pareto"), "--pareto"),
    (("--hours", "1", "--criterion", "farthest"), "i-optimal or d-optimal"),
]


@pytest.mark.parametrize(("options", "says"), BAD, ids=[" ".join(b[0]) for b in BAD])
def test_hours_that_are_none(gonio, options, says):
    result = gonio("plan", *options)
    assert result.returncode == 2
    assert says in result.stderr
    assert "Traceback" not in result.stderr
