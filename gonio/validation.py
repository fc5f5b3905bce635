"""Turn what a file holds into a checked model, or into one line that says what is wrong."""

from __future__ import annotations

import json
import tomllib
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from gonio.errors import BadFileError, BadInputError
from gonio.words import size

if TYPE_CHECKING:
    from collections.abc import Sequence


LONGEST_TEXT: Final = 1 << 26
"""In bytes; a plan of all 145 x 145 Klems pairs is a quarter of it."""


class Document(BaseModel):
    """Base of everything read from a file: frozen, unknown keys refused, no NaN."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


D = TypeVar("D", bound=Document)


def within(low: float, high: float, *, or_text: bool = False) -> BeforeValidator:
    """Make the annotation of a number from `low` to `high`, whose refusal names value and range.

    It comes before pydantic's own checks, so that it names NaN and infinities, too. With `or_text`
    a text may stand in its place.
    """

    def check_range(value: Any) -> Any:
        # pydantic would take true for 1 and "20" for 20
        if isinstance(value, bool) or (isinstance(value, str) and not or_text):
            raise ValueError(f"{value!r} is no number")
        if isinstance(value, int | float) and not low <= value <= high:
            raise ValueError(f"{value!r} is out of range, {low:g} to {high:g} is allowed")
        return value

    return BeforeValidator(check_range)


def read_text(path: Path, remedy: str, longest: int = LONGEST_TEXT) -> str:
    """Read a UTF-8 text file of at most so many bytes.

    Raises
    ------
    BadFileError
        When it is missing, a folder, unreadable, too long or not text.
    """
    try:
        with path.open("rb") as file:
            # a device may never end, and has no size
            content = file.read(longest + 1)
        if len(content) > longest:
            raise BadFileError(path, f"is longer than {size(longest)}", remedy)
        # some editors begin a file with a byte order mark
        text = content.decode("utf-8-sig")
        return text.replace("\r\n", "\n").replace("\r", "\n")
    except FileNotFoundError:
        raise BadFileError(path, "no such file", remedy) from None
    except UnicodeDecodeError as error:
        raise BadFileError(path, f"is not text (byte {error.start})", remedy) from None
    except OSError as error:
        raise BadFileError(path, f"cannot be read ({error.strerror})", remedy) from None


def parse_json(text: str, path: Path, remedy: str) -> Any:
    """Parse JSON text that came from `path`."""
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}: {error.msg}"
        raise BadFileError(path, f"is not JSON ({where})", remedy) from None
    except (ValueError, RecursionError) as error:  # endless digits, endless brackets
        raise BadFileError(path, f"is not JSON ({error})", remedy) from None


def parse_toml(text: str, path: Path, remedy: str) -> Any:
    """Parse TOML text that came from `path`."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadFileError(path, f"is not TOML ({error})", remedy) from None


def check(model: type[D], data: Any, path: Path, remedy: str) -> D:
    """Validate `data` as `model`.

    Raises
    ------
    BadFileError
        Naming the first field that is wrong, and how many more there are.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise BadFileError(path, describe(error), remedy) from None


def describe(error: ValidationError) -> str:
    """Say in one line which field a validation error is about and what it wants."""
    first, *others = error.errors(include_url=False)
    field = ".".join(str(part) for part in first["loc"]) or "the document"
    message = first["msg"].removeprefix("Value error, ")
    known = {
        "missing": "is missing",
        "extra_forbidden": "is not a known key",
        "union_tag_not_found": f"{first.get('ctx', {}).get('discriminator', '')} is missing",
    }
    text = f"{field}: {known.get(first['type'], message)}"
    return text + (f" (and {len(others)} more)" if others else "")


def plain_float(text: str) -> float:
    """Return the number that a cell of a table holds, in digits as other programs write them.

    Raises
    ------
    ValueError
        Where it is none; `1_0` is Python for ten, and elsewhere a slip.
    """
    if "_" in text:
        raise ValueError(f"could not convert string to float: {text!r}")
    return float(text)


def load_named(model: type[D], name: str, built_in: Sequence[str], what: str, remedy: str) -> D:
    """Return a model of data that comes with gonio by name, or of a file that ends in .toml.

    Raises
    ------
    BadInputError
        For an unknown name of a `what`.
    BadFileError
        When the file is missing, is not TOML, or a key is missing, unknown or wrong.
    """
    if name.endswith(".toml"):
        path = Path(name)
        return check(model, parse_toml(read_text(path, remedy), path, remedy), path, remedy)
    if name not in built_in:
        raise BadInputError(
            f"{what} {name!r} is not known; use {', '.join(built_in)}, or the path of a .toml file"
        )
    text = resources.files("gonio").joinpath(f"data/{name}.toml").read_text(encoding="utf-8")
    return model.model_validate(tomllib.loads(text))
