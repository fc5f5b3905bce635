"""What there is to see of a session, and two wishes."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from gonio.watch.fit import RunningFit
from gonio.watch.following import Following
from gonio.watch.pictures import frame_png
from gonio.watch.progress import Route, progress_of
from gonio.wishes import forget, wish, wished
from gonio.words import duration

if TYPE_CHECKING:
    from gonio.journal import FrameRecord
    from gonio.session import Session
    from gonio.watch.following import Told
    from gonio.watch.progress import Progress

_MOST_FAULTS = 50
WISHES = ("pause", "resume", "stop")
"""What a capture can be told."""


class Watched:
    """A session as whoever watches sees it; several threads may ask at a time.

    Parameters
    ----------
    session
        What is watched.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self._following, self._fit = Following(session), RunningFit(session)
        self._lock = threading.Lock()
        self._route: tuple[object, Route] | None = None
        self._decoding = threading.Lock()
        self._frame: tuple[FrameRecord, bytes] | None = None

    def start(self) -> None:
        """Begin to fit."""
        self._fit.start()

    def stop(self) -> None:
        """End the fit."""
        self._fit.stop()

    def state(self) -> dict[str, Any]:
        """Return all that changes on the page, as JSON has it (errors as for `Following.look`)."""
        with self._lock:
            told, route = self._following.look(), self._planned()
            progress = progress_of(route, told)
            marked = zip(progress.marks, route.chain.shots, strict=True)
            self._fit.offer([shot for mark, shot in marked if mark == "d"])
            return {
                "sample": self.session.notes().sample,
                "alive": self._is_captured(told),
                "wish": wished(self.session.root),
                **_course(progress, route),
                **_heard(told),
                **self._estimate(),
            }

    def route(self) -> list[list[float]]:
        """Return theta and phi of light and view of each shot, in deg, in route order."""
        names = ("light_theta", "light_phi", "view_theta", "view_phi")
        with self._lock:
            shots = self._planned().chain.shots
        return [[shot.axis_deg(name) for name in names] for shot in shots]

    def frame(self) -> bytes | None:
        """Return the last frame as PNG; None before the first (errors as `frame_png`, `state`)."""
        with self._lock:
            last = self._following.look().last_frame
        return self._picture(last[2]) if last else None

    def sphere(self) -> bytes | None:
        """Return the estimate as PNG; None before the first."""
        return self._fit.last.sphere if self._fit.last else None

    def want(self, what: str) -> str | None:
        """Leave one of `WISHES`; return why none was left, None where it was.

        Raises
        ------
        gonio.errors.GonioError
            When the wish cannot be written, or as for `Following.look`.
        """
        root = self.session.root
        with self._lock:
            told = self._following.look()
            if not self._is_captured(told):
                return "no capture works on this session"
            if told.by:
                return f"{told.by} measures this session, and heeds no wishes; act there"
            if what == "stop":
                wish(root, "stop")
            elif wished(root) == "stop":
                return "the capture has been asked to stop"
            elif what == "pause":
                wish(root, "pause")
            else:
                forget(root)
        return None

    def _picture(self, record: FrameRecord) -> bytes:
        # a raw frame is large: it is decoded once, however many ask
        with self._decoding:
            if self._frame is None or self._frame[0] != record:
                self._frame = record, frame_png(self.session.root, record)
            return self._frame[1]

    def _is_captured(self, told: Told) -> bool:
        # a reduction works on a session, too
        return not told.is_over and self.session.is_locked

    def _estimate(self) -> dict[str, Any]:
        fit = self._fit.last
        return {
            "fit": fit and {"sentence": fit.sentence, "shots": fit.of},
            "fit_note": self._fit.note,
        }

    def _planned(self) -> Route:
        """Return the route of all plans, read anew when there is another."""
        files = sorted(self.session.plans.glob("*.json"))
        stamp = [(file.name, file.stat().st_mtime_ns) for file in files]
        if self._route is None or self._route[0] != stamp:
            self._route = stamp, Route(self.session.chain(), self.session.rig())
        return self._route[1]


def _course(progress: Progress, route: Route) -> dict[str, Any]:
    return {
        "frames": [progress.frames, route.frames],
        "marks": progress.marks,
        "left": duration(progress.left_s),
        "plans": len(route.chain.plans),
    }


def _heard(told: Told) -> dict[str, Any]:
    last = told.last_frame
    return {
        "phase": told.phase,
        "over": told.is_over,
        "by": told.by,
        "reason": told.reason,
        "target": told.target,
        "last": last and {"id": last[0], "utc": last[1].isoformat(), **last[2].model_dump()},
        "faults": [
            {"utc": utc.isoformat(), "what": fault.what, "did": fault.did}
            for utc, fault in told.faults[: -_MOST_FAULTS - 1 : -1]
        ],
        "fault_count": len(told.faults),
    }
