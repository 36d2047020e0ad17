"""Markers as they were measured, beside the motion that was tracked from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arm.base_pose import frame_0_poses
from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note, of_source
from playback.motion_trials import read_trials
from playback.trajectory import Floats
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording
from protocol.tables.columns import BASE_ROLES


@dataclass(frozen=True)
class MeasuredMarkers:
    """The markers of an arm during one trial.

    Attributes
    ----------
    t : (n_sample,) [s]
        From the trial's first sample.
    places : (n_sample, n_marker, 3) [m]
        In frame 0, in the order of the arm's markers; NaN where one was not seen.
    """

    t: Floats
    places: Floats

    def at(self, position_s: float) -> Floats:
        """Return where the markers were, (n_marker, 3) [m]; between two samples on the line between them."""
        at = float(np.interp(position_s, self.t, np.arange(len(self.t))))
        before = min(int(at), len(self.t) - 2)
        part = at - before
        if part in (0.0, 1.0):
            return np.asarray(self.places[before + int(part)])
        return np.asarray((1.0 - part) * self.places[before] + part * self.places[before + 1])


def read_measured_markers(
    motion: Path, recordings: Sequence[Path], arm: Arm, columns: str | None = None
) -> tuple[dict[int, MeasuredMarkers], tuple[Note, ...]]:
    """Read recordings of markers, one for each trial of a motion in its order, and what is to be said of them.

    Parameters
    ----------
    motion : Path
        Joint motion as `fitter track` writes it: on the recordings' clock, with the base's columns where a segment
        carries the arm.
    recordings : sequence of Path
        C3D or TRC.
    arm : Arm
        With the markers.
    columns : str, optional
        See `playback.motion_trials.read_trials`.

    Raises
    ------
    ConfigError
        If the arm has no markers, or there are more or fewer recordings than trials.
    DataError
        If a recording has none of the arm's markers, or no frame during its trial.
    """
    names = [marker.name for marker in arm.markers]
    if not names:
        raise ConfigError(f"arm {arm.name!r} has no [[marker]], expected those of `fitter kinematics --body`")
    trials = read_trials(motion, arm, needed=("q",), vectors={"base": BASE_ROLES}, columns=columns)
    if len(recordings) != len(trials.signals):
        n = len(trials.signals)
        raise ConfigError(
            f"--markers names {len(recordings)} recording{'s' * (len(recordings) != 1)}, expected one for each of "
            f"the {n} trial{'s' * (n != 1)} of {motion}"
        )
    looked = read_markers(list(recordings))
    found: dict[int, MeasuredMarkers] = {}
    for (number, signals), one in zip(trials.signals.items(), looked, strict=True):
        t, own = signals["t"], one.recording
        if not set(names) & set(own.names):
            expected = f"expected some of {', '.join(names)}"
            raise DataError(f"{own.path}: it has no marker of arm {arm.name!r}, {expected}")
        places = _at(own, names, t + trials.begins_s[number])
        if np.isnan(places).all():
            raise DataError(
                f"{own.path}: its frames are from {own.t[0]:.6g} to {own.t[-1]:.6g} s, but trial {number} of "
                f"{motion} begins at {trials.begins_s[number]:.6g} s; expected the recording it was tracked from"
            )
        R, p = frame_0_poses(arm, signals.get("base"))
        found[number] = MeasuredMarkers(t, (places - p[:, None]) @ R)
    notes = [note for one in looked for note in of_source(one.notes, Path(one.recording.path).name)]
    return found, tuple(notes)


def _at(recording: MarkerRecording, names: Sequence[str], t: Floats) -> Floats:
    """Return markers at some times, (n, n_marker, 3) [m]; NaN outside, and beside a frame without one."""
    own = recording.of(names).reshape(len(recording.t), -1)
    columns = [np.interp(t, recording.t, column, left=np.nan, right=np.nan) for column in own.T]
    return np.stack(columns, axis=1).reshape(len(t), len(names), 3)
