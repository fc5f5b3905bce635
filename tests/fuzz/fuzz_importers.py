"""Throws mutated files at every importer: python -m tests.fuzz.fuzz_importers [RUNS] [FORMAT...].

Coverage-guided by Atheris (libFuzzer), each format in a process of its own with 2 GB of memory. An
importer may refuse a file by `gonio.errors.BadFileError` in one line, and nothing else: any other
exception, a refusal of several lines, a NaN, or an input that takes more than ten seconds ends the
run, and the file that did it is left as `fuzz/FORMAT/crash-...`.
"""

import gc
import resource
import subprocess
import sys
from pathlib import Path
from types import FunctionType

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadFileError
from gonio.exchange import FORMATS, format_named
from gonio.exchange.format import Format
from tests.fuzz.seeds import sow

RUNS = 20_000
MEMORY = 2 << 30
SLOWEST_S = 10
SHORTEST_LIMIT = 1 << 16
"""Mutated files grow to this, or to twice the longest seed."""


def readable() -> list[Format]:
    return [each for each in map(format_named, FORMATS) if each.read is not None]


def look_at(format_: Format, path: Path) -> None:
    """Read a file as an import does; raise what no importer may."""
    try:
        material = format_.read(path)
        directions = paper_directions()[::16]
        values = material.evaluate(directions[:, None], directions)
    except BadFileError as error:
        if "\n" in str(error):
            raise AssertionError(str(error)) from error
        return
    assert np.isfinite(values).all(), "a value is not finite"


def instrument() -> None:
    """Have gonio's own functions tell of their coverage; all that is imported takes minutes."""
    import atheris

    for each in gc.get_objects():
        if isinstance(each, FunctionType) and (each.__module__ or "").startswith("gonio."):
            atheris.instrument_func(each)


def fuzz(format_: Format, runs: int, home: Path) -> None:
    import atheris

    folder, trial = home / format_.name, home / f"{format_.name}-trial{format_.suffix}"
    folder.mkdir(parents=True, exist_ok=True)
    sow(format_, folder)
    instrument()

    def once(data: bytes) -> None:
        trial.write_bytes(data)
        look_at(format_, trial)

    longest = max(SHORTEST_LIMIT, *(2 * seed.stat().st_size for seed in folder.iterdir()))
    options = [f"-runs={runs}", f"-timeout={SLOWEST_S}", f"-max_len={longest}", "-seed=1"]
    told = [f"-artifact_prefix={folder}/", "-print_final_stats=1", "-rss_limit_mb=0"]
    atheris.Setup([sys.argv[0], *options, *told, str(folder)], once)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    atheris.Fuzz()


def main() -> int:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS
    names = sys.argv[2:] or [each.name for each in readable()]
    home = Path("fuzz")
    if len(names) == 1:
        fuzz(format_named(names[0]), runs, home)
        return 0
    codes = [
        subprocess.run([sys.executable, "-m", __spec__.name, str(runs), name], check=False)
        for name in names
    ]
    failed = [name for name, code in zip(names, codes, strict=True) if code.returncode]
    print(f"{len(names)} importers, {runs} runs each; failed: {', '.join(failed) or 'none'}")  # noqa: T201
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
