"""What the chain of the journal's rows costs a capture, and a session when it is opened."""

from time import process_time

from click.testing import CliRunner

from gonio.cli.capture import command as capture
from gonio.cli.plan import command as plan
from gonio.clock import VirtualClock
from gonio.journal import Journal
from gonio.rowchain import row_sha256

ROWS = 6561 * 4 + 32


class Timed:
    """Adds up the processor's time within functions."""

    def __init__(self):
        self.seconds = 0.0

    def of(self, function):
        def run(*arguments):
            began = process_time()
            result = function(*arguments)
            self.seconds += process_time() - began
            return result

        return run


def test_its_share_of_a_capture_of_81_shots(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = CliRunner().invoke
    assert run(plan, ["--density", "9", "--criterion", "farthest", "--no-page"]).exit_code == 0
    timed = Timed()
    monkeypatch.setattr("gonio.journal.row_sha256", timed.of(row_sha256))
    for name in ("_written", "_last_sha256"):
        monkeypatch.setattr(Journal, name, timed.of(getattr(Journal, name)))
    began = process_time()
    assert run(capture, ["--sim"]).exit_code == 0
    took_s = process_time() - began
    share = timed.seconds / took_s
    print(f"\nchain {timed.seconds:.3f} s of {took_s:.2f} s, {share:.2%}")  # noqa: T201
    assert share < 0.02


def test_checking_as_many_rows_as_6561_shots_make(tmp_path):
    clock = VirtualClock()
    with Journal(tmp_path / "j", writing=True) as journal:
        journal._connection.execute("PRAGMA synchronous = OFF")
        for number in range(ROWS):
            journal.append(clock, "frame", number=number, text="x" * 400)
    with Journal(tmp_path / "j") as journal:
        began = process_time()
        journal.check_chain()
        took_s = process_time() - began
    print(f"\n{ROWS} rows checked in {took_s:.2f} s")  # noqa: T201
