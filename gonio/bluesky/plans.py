"""Plans of Bluesky that measure a session of gonio."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gonio.errors import MissingExtraError
from gonio.rig import AXES
from gonio.timemodel import WHITE_POSE_DEG

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence

    from gonio.bluesky.bench import Bench
    from gonio.capture.wanted import Wanted
    from gonio.plan import LampSetting

    Messages = Generator[Any, Any, Any]


def scan(bench: Bench, md: Mapping[str, Any] | None = None) -> Messages:
    """Take every frame that a session lacks: dark, white reference, then shot after shot.

    Three streams: `dark`, `white` and `primary`, one event a frame. A pause goes back to the last
    checkpoint, before the arms moved to a shot; what is safe is not taken again. Whatever ends it,
    lamps are left dark and axes disabled.

    Parameters
    ----------
    bench
        See `gonio.bluesky.bench`.
    md
        Metadata for the run's start document, beside the hashes of plan and rig.

    Raises
    ------
    gonio.errors.MissingExtraError
        When Bluesky is not installed.
    """
    try:
        import bluesky.preprocessors as bpp
    except ImportError:
        raise MissingExtraError("bluesky", "bluesky") from None

    about = {
        "plan_name": "gonio_scan",
        "session": str(bench.session.root),
        "plan_sha256": bench.chain.last.sha256,
        "rig_sha256": bench.session.rig().sha256,
        **(md or {}),
    }
    devices = [bench.arm, bench.lamps, bench.camera]

    def measure() -> Messages:
        yield from _calibrations(bench)
        yield from _shots(bench)

    return (yield from bpp.stage_wrapper(bpp.run_wrapper(measure(), md=about), devices))


def _calibrations(bench: Bench) -> Messages:
    import bluesky.plan_stubs as bps

    if not (bench.missing.dark() or bench.missing.white()):
        return
    yield from bps.mv(bench.holder, "reference")
    lit = {lamp.n: lamp for shot in reversed(bench.chain.shots) for lamp in shot.lamps}
    white = tuple(lit[n] for n in sorted(lit))
    yield from _take(bench, WHITE_POSE_DEG, (), bench.missing.dark())
    yield from _take(bench, WHITE_POSE_DEG, white, bench.missing.white())


def _shots(bench: Bench) -> Messages:
    import bluesky.plan_stubs as bps

    if not any(bench.missing.of_shot(shot) for shot in bench.chain.shots):
        return
    yield from bps.mv(bench.holder, "sample")
    for shot in bench.chain.shots:
        pose = {name: shot.axis_deg(name) for name in AXES}
        yield from _take(bench, pose, shot.lamps, bench.missing.of_shot(shot))


def _take(
    bench: Bench,
    pose: Mapping[str, float],
    lamps: tuple[LampSetting, ...],
    frames: Sequence[Wanted],
) -> Messages:
    import bluesky.plan_stubs as bps

    if not frames:
        return
    # a pause goes back to here, where arms and lamps are put into place again
    yield from bps.checkpoint()
    yield from bps.mv(bench.arm, dict(pose))
    yield from bps.mv(bench.lamps, lamps)
    for wanted in frames:
        yield from bps.prepare(bench.camera, wanted, wait=True)
        stream = "primary" if wanted.role == "shot" else wanted.role
        yield from bps.trigger_and_read([bench.camera, bench.arm, bench.lamps], name=stream)
