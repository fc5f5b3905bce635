"""The estimate of whoever watches goes on, whatever one of them comes to."""

from gonio.errors import BadInputError
from gonio.watch import fit as fit_module
from gonio.watch.fit import RunningFit


def test_what_fails_is_told_and_tried_again_with_more(monkeypatch):
    fit, notes = RunningFit(None), []
    outcomes = iter([ValueError("singular"), BadInputError("dark"), 5])
    monkeypatch.setattr(fit_module, "_LOOK_S", 0.0)

    def estimate(ready):
        notes.append(fit.note)
        outcome = next(outcomes)
        if isinstance(outcome, Exception):
            fit.offer([*ready, *ready])
            raise outcome
        fit.stop()
        return outcome

    monkeypatch.setattr(fit, "_fit", estimate)
    fit.offer(range(100))
    fit._run()
    assert notes == [
        "The first estimate, of 100 shots, is being made.",
        "the estimate failed (ValueError: singular)",
        "dark",
    ]
    assert (fit.last, fit.note) == (5, "")
