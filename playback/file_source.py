"""A joint-motion file as something to play."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from arm.model import Arm
from limbcal.note import Note
from playback.motion_trials import Signals, read_trials
from playback.source import Source
from playback.trajectory import Floats, Trajectory
from protocol.tables.columns import DRIVE_ROLES
from protocol.tables.stamps import holes

#: Angles written modulo a turn [rad] lie in one, give or take their rounding.
_TURN = 2.0 * np.pi * (1.0 + 1e-6)


def file_source(
    path: Path,
    arm: Arm,
    columns: str | None = None,
    beside_twin: bool = False,
    names: Mapping[str, int] | None = None,
) -> Source:
    """Read a joint-motion file (a table with t, q1…, and where known dq1…, ddq1…, trial).

    A derivative that the file does not hold is taken by central differences, which shift nothing in time. Where
    rows are missing the motion is bridged, and its frames say so. A turning joint whose angles stay within a turn
    and jump by more than half a turn between two samples was written modulo a turn: it is made to go on, so that
    what lies between is the short way.

    Parameters
    ----------
    path : Path
    arm : Arm
    columns : str, optional
        Mapping of foreign columns.
    beside_twin : bool
        Whether the mapping is that of a simulated twin, too, which asks for drives.
    names : mapping of str to int, optional
        Numbers that named trials have in another file.

    Raises
    ------
    DataError
        If the file cannot be used.
    ConfigError
        If the mapping of columns is wrong.
    """
    optional = ("dq", "ddq", *DRIVE_ROLES) if beside_twin else ("dq", "ddq")
    found = read_trials(path, arm, needed=("q",), optional=optional, columns=columns, names=names)
    trials, notes = found.signals, list(found.notes)
    turns = np.array([joint.type == "revolute" for joint in arm.joints])
    for number, signals in trials.items():
        wrapped = turns & (np.ptp(signals["q"], axis=0) <= _TURN)
        unwrapped = np.where(wrapped, np.unwrap(signals["q"], axis=0), signals["q"])
        if not np.array_equal(unwrapped, signals["q"]):
            text = f"trial {number}: angles jump by a turn, so they are taken to go on"
            notes.append(Note("turn", text, source=str(path)))
            signals["q"] = unwrapped
    motions = {number: _trajectory(signals) for number, signals in trials.items()}
    durations = {number: motion.duration_s for number, motion in motions.items()}
    return Source(
        path.name,
        arm,
        durations,
        motions.__getitem__,
        notes=tuple(notes),
        begins_s=found.stamps_s,
        names=found.names,
    )


def _trajectory(signals: Signals) -> Trajectory:
    t, q = signals["t"], signals["q"]
    dq = signals["dq"] if "dq" in signals else _derivative(q, t)
    ddq = signals["ddq"] if "ddq" in signals else _derivative(dq, t)
    lost = np.zeros(len(t), dtype=np.bool_)
    lost[holes(t)] = True
    return Trajectory(t, q, dq, ddq, method="file", lost=lost)


def _derivative(x: Floats, t: Floats) -> Floats:
    return np.gradient(x, t, axis=0, edge_order=2 if len(t) > 2 else 1)
