"""The virtual arm beside a real one, on the same clock."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from playback.common_clock import begins_after, spans_of
from playback.file_source import file_source
from playback.motion_trials import Signals, read_trials
from playback.recording_source import recording_source
from playback.simulated_source import even_step, simulated
from playback.source import Source
from playback.trajectory import Trajectory
from protocol.tables.columns import DRIVE_ROLES
from protocol.tables.files import TABLES


def with_twin(
    source: Source, twin: str, targets: Path | None, say: Callable[[str], None], columns: str | None = None
) -> Source:
    """Return a source with a virtual arm beside it, trial by trial, on one clock where the two have one.

    Trials that have names in both are paired by them, others by their numbers.

    Parameters
    ----------
    source : Source
        The real arm's motion.
    twin : str
        A file of joint motion or a recording, to be shown as it is; or an arm, which is then simulated: under its
        law after the targets ``ref1…``, or under the torque ``tau1…`` where its law is "measured", with the drives
        ``on1… kp1… kv1…`` where the file has them, from the state of the real arm when these begin, or in which it
        begins after them.
    targets : Path or None
        The file with the targets or the torque.
    say : callable
        Takes a sentence about what is done otherwise than it might seem.
    columns : str, optional
        Mapping of foreign columns.

    Raises
    ------
    ConfigError
        If there is nothing to drive the twin by, or it has another number of joints.
    DataError
        If a file cannot be used, or the two have no trial in common.
    """
    path = Path(twin)
    if path.suffix.lower() == ".mcap":
        other = _stored_twin(source, recording_source(path, None), twin)
    elif path.suffix.lower() in TABLES:
        other = _stored_twin(source, file_source(path, source.arm, columns, names=source.names), twin)
    else:
        arm = load_arm(twin)
        _require_alike(source, arm, twin)
        other = _simulated_twin(source, arm, targets, columns)
    common = [trial for trial in source.trials if trial in other.durations_s]
    if not common:
        raise DataError(f"--twin {twin}: none of the trials of {source.name} is in it")
    if left_out := [trial for trial in source.trials if trial not in common]:
        say(f"--twin {twin}: it has no trial {', '.join(map(str, left_out))}; left out")
    notes = tuple(dict.fromkeys((*source.notes, *other.notes)))
    durations = {trial: source.durations_s[trial] for trial in common}
    return replace(source, durations_s=durations, twin=other, notes=notes)


def _require_alike(source: Source, arm: Arm, twin: str) -> None:
    if arm.n_joint != source.arm.n_joint:
        raise ConfigError(
            f"--twin {twin}: it has {arm.n_joint} joint(s), but what moves in {source.name} has "
            f"{source.arm.n_joint}"
        )


def _stored_twin(source: Source, other: Source, twin: str) -> Source:
    _require_alike(source, other.arm, twin)
    later, notes = begins_after(source, spans_of(other.begins_s, other.durations_s), f"--twin {twin}")

    def trajectory(number: int) -> Trajectory:
        return replace(other.trajectory(number), begin_s=later.get(number, 0.0))

    return replace(other, trajectory=trajectory, notes=(*other.notes, *notes))


def _simulated_twin(source: Source, arm: Arm, targets: Path | None, columns: str | None) -> Source:
    name = "tau" if arm.control.law == "measured" else "ref"
    if targets is None or targets.suffix.lower() not in TABLES:
        what = "torque" if name == "tau" else "targets"
        raise ConfigError(
            f"--twin {arm.name}: {source.name} has no {what}; expected --reference FILE with {name}1…, or "
            "joint motion as the twin"
        )
    found = read_trials(targets, arm, needed=(name,), optional=DRIVE_ROLES, columns=columns, names=source.names)
    trials = found.signals
    durations = {number: float(signals["t"][-1]) for number, signals in trials.items()}
    later, notes = begins_after(source, spans_of(found.stamps_s, durations), str(targets))

    def trajectory(number: int) -> Trajectory:
        signals, begin_s, left_out_s = _from(trials[number], later.get(number, 0.0))
        q, dq, _ = source.load(number).at(np.array([max(begin_s, 0.0)]))
        step = even_step(signals["t"], f"{targets}: trial {number}")
        t0_s = found.begins_s[number] + left_out_s
        motion = simulated(arm, {**signals, "q": q, "dq": dq}, step, t0_s, found.identities[number])
        return replace(motion, begin_s=begin_s)

    name = f"simulation of {arm.name}"
    return Source(name, arm, durations, trajectory, notes=(*found.notes, *notes), begins_s=found.stamps_s)


def _from(signals: Signals, begin_s: float) -> tuple[Signals, float, float]:
    """Return signals without what is before 0 on the real arm's clock, when they begin, and how long that was."""
    t = signals["t"]
    k = min(int(np.searchsorted(t, -begin_s)), len(t) - 2)  # two samples stay
    later = {**{name: values[k:] for name, values in signals.items()}, "t": t[k:] - t[k]}
    return later, begin_s + float(t[k]), float(t[k])
