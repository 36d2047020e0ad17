"""Which frames a fit takes, and how much each counts."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.marker_kinematics import Integers
from arm.model import Floats
from fitter.limb.marker_observations import Frames
from limbcal.errors import NotIdentifiable
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: How long skin keeps an error [s]: frames nearer in time than that count together as one. As long as a movement's
#: own acceleration lasts, which is what sets soft tissue going.
COHERENCE_S = 0.3
#: Markers of the chain that a frame must show.
_LEAST_MARKERS = 3


def usable_frames(
    y: Floats, R: Floats, p: Floats, recordings: Sequence[MarkerRecording]
) -> tuple[Frames, NDArray[np.bool_]]:
    """Return the frames in which the base has a pose and enough markers of the chain are seen."""
    times = [one.t for one in recordings]
    trial = np.concatenate([np.full(len(t), i, dtype=np.int64) for i, t in enumerate(times)])
    usable = np.isfinite(p).all(axis=1) & (np.isfinite(y[..., 0]).sum(axis=1) >= _LEAST_MARKERS)
    if not usable.any():
        where = ", ".join(one.path for one in recordings)
        raise NotIdentifiable(
            f"{where}: no frame shows the base and {_LEAST_MARKERS} markers of the limb together, expected some: "
            "check the marker set, or take another base"
        )
    parts = (y[usable], R[usable], p[usable], trial[usable], np.concatenate(times)[usable])
    return Frames(*(np.ascontiguousarray(part) for part in parts)), usable


def left_out(usable: NDArray[np.bool_], recordings: Sequence[MarkerRecording]) -> tuple[Note, ...]:
    """Say of which recordings no frame is usable, given which of all their frames are, (n_frame,)."""
    ends = np.cumsum([len(one.positions) for one in recordings])
    lost = [
        Path(one.path).name
        for one, own in zip(recordings, np.split(usable, ends[:-1]), strict=True)
        if not own.any()
    ]
    if not lost:
        return ()
    text = (
        f"{', '.join(lost)}: no frame shows the base and {_LEAST_MARKERS} markers of the limb together: "
        "nothing is learnt from it"
    )
    return (Note("left_out", text),)


def thinned(usable: NDArray[np.bool_], n: int) -> Integers:
    """Return a given number of the usable frames, evenly spread over them."""
    there = np.flatnonzero(usable)
    return there[np.linspace(0, len(there) - 1, min(n, len(there))).round().astype(np.int64)]


def shares(frames: Frames, coherence_s: float = COHERENCE_S) -> Floats:
    """Return how much each frame counts: those within the time that skin keeps an error count together as one."""
    share = np.empty(len(frames.t))
    for i in np.unique(frames.trial):
        own = frames.trial == i
        t = frames.t[own]
        lasts = (t[-1] - t[0]) / max(len(t) - 1, 1)
        share[own] = min(1.0, lasts / coherence_s) if len(t) > 1 else 1.0
    return share
