"""What fuzzing begins with is what importers read, or it would never get beyond a header."""

import pytest

from tests.fuzz.fuzz_importers import look_at, readable
from tests.fuzz.seeds import sow


@pytest.mark.parametrize("format_", readable(), ids=lambda each: each.name)
def test_every_importer_reads_its_seeds(format_, tmp_path):
    sow(format_, tmp_path)
    seeds = list(tmp_path.iterdir())
    assert seeds
    for path in seeds:
        look_at(format_, path)
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        look_at(format_, path)
