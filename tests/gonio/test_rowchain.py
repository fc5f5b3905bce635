"""Any change to a chain of rows is found, at the first row that it touches."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gonio.rowchain import START, Row, break_in, followed, row_sha256

CONTENT = st.tuples(
    st.floats(allow_nan=False, allow_infinity=False), st.text(), st.text(), st.text()
)


def chained(contents):
    rows, previous = [], START
    for number, content in enumerate(contents, start=1):
        row = Row(number, *content)
        previous = row_sha256(previous, row)
        rows.append(row._replace(sha256=previous))
    return rows


CHAINS = st.lists(CONTENT, min_size=3, max_size=8).map(chained)


def places(rows):
    return st.integers(0, len(rows) - 1)


def numbered(rows):
    return [row._replace(number=number) for number, row in enumerate(rows, start=1)]


@given(CHAINS)
def test_a_chain_is_whole(rows):
    assert break_in(rows, len(rows)) is None
    assert [due for _, due in followed(rows)] == [row.sha256 for row in rows]


@given(st.data(), CHAINS, st.sampled_from(Row._fields[1:]))
def test_an_edited_row_is_named(data, rows, field):
    at = data.draw(places(rows))
    old = getattr(rows[at], field)
    rows[at] = rows[at]._replace(**{field: old + 1.0 if field == "at_s" else f"{old}x"})
    if getattr(rows[at], field) != old:  # a large number swallows the one
        assert break_in(rows, len(rows)) == f"record {at + 1} is not the one that was written there"


@given(st.data(), CHAINS)
def test_an_edited_row_with_a_hash_to_fit_is_found_at_the_next(data, rows):
    at = data.draw(st.integers(0, len(rows) - 2))
    edited = rows[at]._replace(kind=f"{rows[at].kind}x")
    due = row_sha256(rows[at - 1].sha256 if at else START, edited)
    rows[at] = edited._replace(sha256=due)
    assert break_in(rows, len(rows)) == f"record {at + 2} is not the one that was written there"


@given(st.data(), CHAINS, st.booleans())
def test_a_removed_row_is_named(data, rows, renumbered):
    at = data.draw(places(rows))
    left = [*rows[:at], *rows[at + 1 :]]
    if renumbered and at < len(left):
        assert break_in(numbered(left), len(left)) == (
            f"record {at + 1} is not the one that was written there"
        )
    else:
        assert break_in(left, len(rows)) == f"record {at + 1} is missing"


@given(st.data(), CHAINS)
def test_moved_rows_are_named(data, rows):
    one, other = sorted(data.draw(st.sets(places(rows), min_size=2, max_size=2)))
    rows[one], rows[other] = rows[other], rows[one]
    assert break_in(numbered(rows), len(rows)) == (
        f"record {one + 1} is not the one that was written there"
    )


@given(st.data(), CHAINS)
def test_rows_of_before_there_were_hashes_are_vouched_for_by_the_next_that_has_one(data, rows):
    old = data.draw(st.integers(0, len(rows)))
    rows[:old] = [row._replace(sha256=None) for row in rows[:old]]
    assert break_in(rows, len(rows)) is None
    if 0 < old < len(rows):
        rows[0] = rows[0]._replace(data=f"{rows[0].data}x")
        assert break_in(rows, len(rows)) == (
            f"record {old + 1} is not the one that was written there"
        )


@pytest.mark.parametrize("value", [b"bytes", math.inf, math.nan])
def test_what_no_journal_writes_fits_no_hash(value):
    (row,) = chained([(value, "", "", "")])
    assert row.sha256 == ""
    (good,) = chained([(0.0, "", "", "")])
    assert break_in([good._replace(at_s=value)], 1) is not None
