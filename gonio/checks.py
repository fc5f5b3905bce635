"""What the reduction thought of a session: its checks, and the shots to take again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal

from pydantic import Field

from gonio.files import write_json
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA: Final = "gonio.checks/1"
_REMEDY = "make it again with: gonio reduce"


class Check(Document):
    """One question to a session, and its answer.

    Attributes
    ----------
    name
        What is checked, such as `reciprocity`.
    ok
        Whether all is within the limit.
    found
        What was found, in words.
    limit
        What would have been well, in words.
    remedy
        What to do where it is not; empty where it is.
    shots
        Indices of the shots that fail.
    retake
        Whether to take these again may help: what all shots suffer from is no chance.
    asked
        Whether the session has what the question is about; where not, it is neither well nor wrong.
    """

    name: str
    ok: bool
    found: str
    limit: str
    remedy: str = ""
    shots: tuple[int, ...] = ()
    retake: bool = False
    asked: bool = True

    @property
    def verdict(self) -> str:
        """The answer in a word: ok, flag, or - where there was nothing to ask."""
        if not self.asked:
            return "-"
        return "ok" if self.ok else "flag"

    @property
    def line(self) -> str:
        """What was found and what to do, in one line."""
        return f"{self.found}; {self.remedy}" if self.remedy else self.found


class Suspect(Document):
    """A shot to take again: its index, the files that it was taken as, and why."""

    shot: int = Field(ge=0)
    files: tuple[str, ...]
    problem: str


class Checks(Document):
    """All checks of a session.

    Attributes
    ----------
    frames
        SHA-256 of the frames that they were made on, as in the provenance of the samples.
    checks
        In the order of telling.
    suspects
        The shots that are offered for a retake, in the order of the plans.
    """

    schema_: Literal["gonio.checks/1"] = Field(default=SCHEMA, alias="schema")
    frames: str
    checks: tuple[Check, ...]
    suspects: tuple[Suspect, ...] = ()

    def save(self, path: Path) -> None:
        """Write them as JSON, whole or not at all."""
        write_json(path, self.model_dump(mode="json", by_alias=True))

    @classmethod
    def load(cls, path: Path) -> Checks:
        """Read and check what `save` wrote.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, malformed or of another schema.
        """
        return check(cls, parse_json(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY)
