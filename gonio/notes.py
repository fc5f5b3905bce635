"""What is noted of a sample, for whoever reads a session years later."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal

from pydantic import Field

from gonio.files import write_json
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA: Final = "gonio.session/1"
_REMEDY = "give the folder of a session that gonio capture made"


class Notes(Document):
    """What a reader years later will ask about a sample.

    Attributes
    ----------
    rehearsal
        Whether the twin went through the motions alone: then no frame shows anything.
    """

    schema_: Literal["gonio.session/1"] = Field(default=SCHEMA, alias="schema")
    sample: str
    orientation: str
    mounting: str
    operator: str
    temperature_c: float | None = Field(default=None, ge=-273.15)
    rehearsal: bool = False

    def save(self, path: Path) -> None:
        """Write them as JSON, whole or not at all."""
        write_json(path, self.model_dump(mode="json", by_alias=True))

    @classmethod
    def load(cls, path: Path) -> Notes:
        """Read and check what `save` wrote.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, malformed or of another schema.
        """
        return check(cls, parse_json(read_text(path, _REMEDY), path, _REMEDY), path, _REMEDY)
