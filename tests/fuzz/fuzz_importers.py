"""Throws mutated files at every importer: python -m tests.fuzz.fuzz_importers [RUNS] [FORMAT...].

Coverage-guided by Atheris (libFuzzer), each format in a process of its own with 2 GB of memory. An
importer may refuse a file by `gonio.errors.BadFileError` in one line, and nothing else: any other
exception, a refusal of several lines, a NaN, or an input that takes more than ten seconds ends the
run, and the file that did it is left as `fuzz/FORMAT/crash-...`.
"""

import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

from gonio.directions import paper_directions
from gonio.errors import BadFileError
from gonio.exchange import FORMATS, Source, format_named
from gonio.exchange.format import Format

RUNS = 20_000
MEMORY = 2 << 30
SLOWEST_S = 10
LONGEST = 1 << 16


class Dim:
    """A small anisotropic material, so that seeds are short."""

    def evaluate(self, light, view):
        shape = np.broadcast_shapes(light.shape, view.shape)
        return np.broadcast_to(0.1 + 0.05 * light[..., :1] * view[..., :1] + 0.01, shape)


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


def seed(format_: Format, folder: Path) -> None:
    """Give the fuzzer a good file to begin with, cut where it is long, and its first bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    whole = folder / f"whole{format_.suffix}"
    if format_.write is not None:
        format_.write(Source(Dim(), "dim"), whole, None)
        content = whole.read_bytes()
        (folder / "head").write_bytes(content[: LONGEST // 16])
        if len(content) > LONGEST:
            whole.unlink()


def fuzz(format_: Format, runs: int, home: Path) -> None:
    import atheris

    folder, trial = home / format_.name, home / f"{format_.name}-trial{format_.suffix}"
    atheris.instrument_all()

    def once(data: bytes) -> None:
        trial.write_bytes(data)
        look_at(format_, trial)

    options = [f"-runs={runs}", f"-timeout={SLOWEST_S}", f"-max_len={LONGEST}", "-seed=1"]
    told = [f"-artifact_prefix={folder}/", "-print_final_stats=1", "-rss_limit_mb=0"]
    atheris.Setup([sys.argv[0], *options, *told, str(folder)], once)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    atheris.Fuzz()


def main() -> int:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS
    names = sys.argv[2:] or [each.name for each in readable()]
    home = Path("fuzz")
    if len(names) == 1:
        seed(format_named(names[0]), home / names[0])
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
