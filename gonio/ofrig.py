"""What was found of a rig, as a file that says which rig, and whose hash says that it is whole."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from gonio.errors import BadFileError
from gonio.files import canonical_json, sha256_bytes, write_json
from gonio.validation import Document, check, parse_json, read_text

if TYPE_CHECKING:
    from gonio.rig import Rig


class OfRig(Document):
    """Base of such files.

    Attributes
    ----------
    rig_sha256
        The rig that it is of.
    remedy
        How to get another one, for messages.
    """

    remedy: ClassVar[str]

    rig_sha256: str

    @property
    def sha256(self) -> str:
        """SHA-256 of the canonical JSON of everything else."""
        return sha256_bytes(canonical_json(self._content()))

    def save(self, path: Path) -> None:
        """Write it with its hash, whole or not at all."""
        write_json(path, self._content() | {"sha256": self.sha256})

    @classmethod
    def load(cls, path: Path | str, rig: Rig) -> Self:
        """Read the file of a rig and check every field and its hash.

        Raises
        ------
        gonio.errors.BadFileError
            When it is missing, broken, changed, or of another rig.
        """
        path = Path(path)
        data = parse_json(read_text(path, cls.remedy), path, cls.remedy)
        stated = data.pop("sha256", None) if isinstance(data, dict) else None
        found = check(cls, data, path, cls.remedy)
        if found.sha256 != stated:
            raise BadFileError(path, "has changed since it was written", cls.remedy)
        if found.rig_sha256 != rig.sha256:
            problem = f"is of rig {found.rig_sha256[:12]}, not {rig.sha256[:12]}"
            raise BadFileError(path, problem, cls.remedy)
        return found

    def _content(self) -> dict[str, Any]:
        return self.model_dump(mode="json", by_alias=True)
