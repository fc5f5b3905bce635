"""Which frames a session needs, which it already has, and which are left to take."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gonio.intact import verified_frames
from gonio.timemodel import DARK_FRAMES, WHITE_FRAMES

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from gonio.intact import FrameKey
    from gonio.journal import FrameRecord, Role
    from gonio.plan import Shot
    from gonio.planchain import PlanChain
    from gonio.session import Session


@dataclass(frozen=True)
class Wanted:
    """A frame to take (fields as in `gonio.journal.FrameRecord`)."""

    role: Role
    shot_index: int
    repeat: int
    exposure_s: float
    attempt: int
    name: str

    @property
    def key(self) -> FrameKey:
        """The same key as the record of this frame will have."""
        return (self.role, self.shot_index, self.repeat, self.exposure_s)


class Missing:
    """The frames still to be taken, in the order of taking.

    Parameters
    ----------
    session, chain
        What is measured.
    records
        The journal's frames so far; those that verify are not taken again.
    rejected
        Files of frames that the reduction had no use for.
    """

    def __init__(
        self,
        session: Session,
        chain: PlanChain,
        records: Sequence[FrameRecord],
        rejected: Collection[str] = (),
    ) -> None:
        self._have = verified_frames(session, records, rejected)
        self._tries = Counter(record.key for record in records)
        self._exposures = chain.exposures_s

    def took(self, record: FrameRecord) -> None:
        """Count a frame that was taken since."""
        self._have[record.key] = record
        self._tries[record.key] += 1

    def dark(self) -> list[Wanted]:
        """Return the dark frames to take."""
        return self._calibration("dark", DARK_FRAMES)

    def white(self) -> list[Wanted]:
        """Return the frames of the white reference to take."""
        return self._calibration("white", WHITE_FRAMES)

    def of_shot(self, shot: Shot) -> list[Wanted]:
        """Return the frames of a shot to take."""
        return self._missing("shot", shot.index, 1, shot.exposures_s)

    def count(self, shots: Iterable[Shot]) -> int:
        """Return how many frames are to be taken: of these shots, and to calibrate them."""
        of_shots = sum(len(self.of_shot(shot)) for shot in shots)
        return len(self.dark()) + len(self.white()) + of_shots

    def _calibration(self, role: Role, repeats: int) -> list[Wanted]:
        return self._missing(role, 0, repeats, self._exposures)

    def _missing(
        self, role: Role, index: int, repeats: int, exposures: Sequence[float]
    ) -> list[Wanted]:
        frames = []
        for number, exposure in enumerate(exposures):
            for repeat in range(repeats):
                key = (role, index, repeat, exposure)
                if key not in self._have:
                    attempt = self._tries[key] + 1
                    name = f"{role}_{index:06d}_e{number}_r{repeat}_a{attempt}.dng"
                    frames.append(Wanted(role, index, repeat, exposure, attempt, name))
        return frames
