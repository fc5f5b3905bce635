"""What a session's journal hears of a RunEngine's runs, for whoever watches or reads it later."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gonio.intact import new_inputs

if TYPE_CHECKING:
    from gonio.capture.wanted import Missing
    from gonio.clock import Clock
    from gonio.journal import Journal
    from gonio.planchain import PlanChain
    from gonio.session import Session


class Record:
    """Notes when a run begins, is home, pauses and ends, as `gonio capture` does.

    Parameters
    ----------
    session, chain, journal
        What is measured, its plans, and its journal to be written.
    missing
        The frames still to be taken.
    clock
        The rig's.
    """

    def __init__(
        self, session: Session, chain: PlanChain, journal: Journal, missing: Missing, clock: Clock
    ) -> None:
        self._session, self._chain, self._journal = session, chain, journal
        self._missing, self._clock = missing, clock
        self._has_ended = False

    @property
    def left(self) -> int:
        """How many frames are to be taken."""
        return self._missing.count(self._chain.shots)

    def begin(self) -> None:
        """Note that the session is begun or gone on with."""
        self._note(
            "begun", plan=self._chain.last.sha256, rig=self._session.rig().sha256,
            frames=self.left, inputs=new_inputs(self._session.root, self._journal), by="Bluesky",
        )  # fmt: skip

    def home(self) -> None:
        """Note that all axes are home, where there is something to take."""
        if self.left:
            self._has_ended = False
            self._note("homed")

    def pause(self) -> None:
        """Note that a run pauses."""
        self._note("paused")

    def resume(self) -> None:
        """Note that it goes on."""
        self._note("resumed")

    def fault(self, what: str, did: str) -> None:
        """Note what drivers met."""
        self._note("fault", what=what, did=did)

    def end(self) -> None:
        """Note, once, that a run is over, complete or not."""
        if self._has_ended:
            return
        self._has_ended = True
        if self.left:
            self._note("stopped", reason="Bluesky's run ended before all was taken")
        else:
            self._note("finished")

    def _note(self, kind: str, **data: object) -> None:
        self._journal.append(self._clock, kind, **data)
