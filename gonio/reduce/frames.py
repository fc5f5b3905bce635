"""The frames of a session, each used only with the content that the journal vouches for."""

from __future__ import annotations

import contextlib
from collections import Counter, defaultdict
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Final

import numpy as np

from gonio.alignment import ALIGNED
from gonio.errors import BadFileError, BadInputError
from gonio.geometry import ArmPose
from gonio.reduce.poses import posed
from gonio.reduce.raw import Sensor, decode_raw, read_vouched

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from gonio.calibration import CameraIdentity
    from gonio.journal import FrameRecord, Role
    from gonio.photogrammetry.geometry_file import Geometry
    from gonio.plan import Shot
    from gonio.reduce.raw import RawFrame
    from gonio.rig import CameraSpec

_Place = tuple[str, int, float]
"""Role, shot and exposure asked for."""

_QUORUM: Final = 5
_FEW: Final = 0.1
_CALLED: Final = {
    "pattern": "filter pattern", "black": "black level", "white": "white level", "iso": "ISO",
    "color_matrix": "color matrix", "matrix_name": "color matrix",
}  # fmt: skip


@dataclass(frozen=True)
class Frame:
    """A raw frame and what the journal knows about it.

    Attributes
    ----------
    record
        The journal's.
    raw
        The file's content.
    view
        The camera's pose.
    """

    record: FrameRecord
    raw: RawFrame
    view: ArmPose

    @property
    def light(self) -> ArmPose:
        """The light's pose by the encoders."""
        return ArmPose.from_degrees(self.record.light_theta_deg, self.record.light_phi_deg)


class Frames:
    """Finds and reads frames; of several tries at one, the newest that is valid.

    Parameters
    ----------
    root
        The session's folder.
    spec
        The camera that took them.
    records
        The journal's frames, oldest first.
    remedy
        What to do about one that is of no use.
    geometry
        Camera and view arm as measured, where they were.
    sensor
        What took them, where it is known already.
    calibrated
        The camera of the session's calibration; frames of it are the right ones.

    Attributes
    ----------
    remedy
        As given.
    problems
        What was wrong with each calibration frame that was left out, by role.
    """

    def __init__(
        self,
        root: Path,
        spec: CameraSpec,
        records: Iterable[FrameRecord],
        remedy: str,
        geometry: Geometry | None = None,
        sensor: Sensor | None = None,
        calibrated: CameraIdentity | None = None,
    ) -> None:
        self._root, self._spec, self.remedy = root, spec, remedy
        self._geometry = geometry
        self._sensor, self._calibrated = sensor, calibrated
        self._tries: dict[_Place, dict[int, list[FrameRecord]]] = defaultdict(dict)
        self._records = list(records)
        for record in self._records:
            repeats = self._tries[record.role, record.shot_index, record.exposure_s]
            repeats.setdefault(record.repeat, []).append(record)
        self.problems: dict[Role, list[str]] = {"dark": [], "white": []}
        self._broken: dict[str, str] = {}
        self._unlike: dict[Role, dict[str, str]] = defaultdict(dict)

    @property
    def useless(self) -> dict[str, str]:
        """What is wrong with each frame that is as it was taken and yet of no use, by its file.

        One that is missing or changed may come back. Of frames that are unlike most, few of a role
        are; where there are many, whoever set the camera has to say which are wrong.
        """
        taken = Counter(record.role for record in self._records)
        few = {
            file: problem
            for role, files in self._unlike.items()
            if len(files) <= max(1.0, _FEW * taken[role])
            for file, problem in files.items()
        }
        return self._broken | few

    @property
    def sensor(self) -> Sensor:
        """What took the frames, by most of a few of them; known once one is read."""
        assert self._sensor is not None
        return self._sensor

    def look_over(self) -> None:
        """Read every dark and white frame, so that `useless` has all that are."""
        for role, _, exposure_s in list(self._tries):
            if role in self.problems:
                self.of_calibration(role, exposure_s)

    def of_shot(self, shot: Shot) -> list[Frame]:
        """Return the whole bracket of a shot.

        Raises
        ------
        gonio.errors.BadInputError
            When a frame of it is missing or damaged.
        """
        bracket = [
            self._newest(tries)
            for exposure_s in shot.exposures_s
            for tries in self._repeats("shot", shot.index, exposure_s).values()
        ]
        return posed(bracket, self._geometry, self._spec) if self._geometry else bracket

    def of_calibration(self, role: Role, exposure_s: float) -> list[Frame]:
        """Return the valid dark or white frames of one exposure; `problems` notes the others."""
        frames = []
        for tries in self._tries.get((role, 0, exposure_s), {}).values():
            try:
                frames.append(self._newest(tries))
            except BadInputError as error:
                self.problems[role].append(str(error))
        return frames

    def _repeats(self, role: Role, index: int, exposure_s: float) -> dict[int, list[FrameRecord]]:
        repeats = self._tries.get((role, index, exposure_s))
        if not repeats:
            raise BadInputError(f"shot {index}: no frame of {exposure_s:g} s; {self.remedy}")
        return repeats

    def _newest(self, tries: list[FrameRecord]) -> Frame:
        newest_problem: BadFileError | None = None
        for record in sorted(tries, key=lambda record: record.attempt, reverse=True):
            try:
                alignment = self._geometry.view if self._geometry else ALIGNED
                view = alignment.pose(record.view_theta_deg, record.view_phi_deg)
                return Frame(record, self._read(record), view)
            except BadFileError as error:
                newest_problem = newest_problem or error
        assert newest_problem is not None
        raise newest_problem

    def _read(self, record: FrameRecord) -> RawFrame:
        path = self._root / record.file
        data = read_vouched(path, record.sha256, self.remedy)
        try:
            raw = self._decode(data, record, path)
        except BadFileError as error:
            self._broken[record.file] = str(error)
            raise
        try:
            self._check_sensor(raw.sensor, path)
        except BadFileError as error:
            self._unlike[record.role][record.file] = str(error)
            raise
        # where most frames have another size, the rig file is wrong, and no frame
        self._check_size(raw.sensor, path)
        return raw

    def _decode(self, data: bytes, record: FrameRecord, path: Path) -> RawFrame:
        raw = decode_raw(data, path, self.remedy)
        # the tolerance that the rig's protocol grants the shutter
        if abs(raw.exposure_s - record.exposure_s) > 0.01 * record.exposure_s + 100e-6:
            problem = f"was open {raw.exposure_s:g} s, not the {record.exposure_s:g} s asked for"
            raise BadFileError(path, problem, self.remedy)
        return raw

    def _check_sensor(self, sensor: Sensor, path: Path) -> None:
        if self._sensor is None:
            self._sensor = self._usual_sensor() or sensor
        if sensor != self._sensor:
            problem = f"is unlike most frames: {_difference(sensor, self._sensor)}"
            raise BadFileError(path, problem, "take all frames with one camera at one setting")

    def _check_size(self, sensor: Sensor, path: Path) -> None:
        size, wanted = (sensor.width, sensor.height), (self._spec.width, self._spec.height)
        if size != wanted:
            problem = f"is {size[0]} x {size[1]} px, not {wanted[0]} x {wanted[1]} as in rig.toml"
            raise BadFileError(path, problem, "set [camera] width and height to the camera's")

    def _usual_sensor(self) -> Sensor | None:
        """Return the sensor of most of a few frames, since any single one may be the odd one.

        None where none of them can be read.
        """
        places = np.linspace(0, len(self._records) - 1, min(_QUORUM, len(self._records)))
        seen: Counter[Sensor] = Counter()
        for place in places.round().astype(int):
            record = self._records[place]
            path = self._root / record.file
            with contextlib.suppress(BadFileError):
                data = read_vouched(path, record.sha256, self.remedy)
                seen[self._decode(data, record, path).sensor] += 1
        right = [sensor for sensor in seen if sensor.identity == self._calibrated]
        return max(right or seen, key=lambda sensor: seen[sensor], default=None)


def _difference(sensor: Sensor, usual: Sensor) -> str:
    """Name the first thing in which two sensors differ, and both its values."""
    name = next(f.name for f in fields(Sensor) if getattr(sensor, f.name) != getattr(usual, f.name))
    here, there = (getattr(each, name) for each in (sensor, usual))
    return f"its {_CALLED.get(name, name)} is {here}, not {there}"
