"""The virtual arm beside a real one, on the same clock."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from arm.arm_file import load_arm
from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from playback.file_source import file_source
from playback.motion_trials import Signals, read_trials
from playback.recording_source import recording_source
from playback.simulated_source import even_step, simulated
from playback.source import Source
from playback.trajectory import Trajectory
from protocol.tables.files import TABLES


def with_twin(
    source: Source, twin: str, targets: Path | None, say: Callable[[str], None], columns: str | None = None
) -> Source:
    """Return a source with a virtual arm beside it.

    Parameters
    ----------
    source : Source
        The real arm's motion.
    twin : str
        A file of joint motion or a recording, to be shown as it is; or an arm, which is then simulated: under its
        law after the targets ``ref1…``, or under the torque ``tau1…`` where its law is "measured", from the state
        that the real arm begins in.
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
        other = recording_source(path, None, say)
    elif path.suffix.lower() in TABLES:
        other = file_source(path, source.arm, columns)
    else:
        arm = load_arm(twin)
        _require_alike(source, arm, twin)
        other = _simulated_twin(source, arm, targets, columns)
    _require_alike(source, other.arm, twin)
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


def _simulated_twin(source: Source, arm: Arm, targets: Path | None, columns: str | None) -> Source:
    name = "tau" if arm.control.law == "measured" else "ref"
    if targets is None or targets.suffix.lower() not in TABLES:
        what = "torque" if name == "tau" else "targets"
        raise ConfigError(
            f"--twin {arm.name}: {source.name} has no {what}; expected --reference FILE with {name}1…, or "
            "joint motion as the twin"
        )
    found = read_trials(targets, arm, needed=(name,), columns=columns)
    trials = found.signals

    def trajectory(number: int) -> Trajectory:
        q, dq, _ = source.load(number).at(trials[number]["t"][:1])
        signals: Signals = {**trials[number], "q": q, "dq": dq}
        step = even_step(signals["t"], f"{targets}: trial {number}")
        return simulated(arm, signals, step)

    durations = {number: float(signals["t"][-1]) for number, signals in trials.items()}
    return Source(f"simulation of {arm.name}", arm, durations, trajectory, notes=found.notes)
