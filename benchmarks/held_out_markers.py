"""Markers of measured recordings that were not learnt: how far a calibrated arm or person has them.

    python -m benchmarks.held_out_markers DATA

DATA is the folder with the recordings. Each half of `racing_full` and of `sprintbasket` is learnt and the other
judged, the sprint's left arm from the scapula, and from the thorax, C7 its only marker, with the scapula's markers
and without: first the frames that show base and limb, each by itself, as `fitter kinematics --evaluate` has them,
then all of them, tracked. A person is learnt from OpenCap's subject 4 standing and either half of the squats, and
judged by the other and by a drop jump.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arm.body.limbs import Girdle
from arm.kinematics import axis_frames
from arm.model import Arm, Body, Floats
from benchmarks.limb_intervals import halves
from fitter.body.calibration import calibrate_body
from fitter.body.written_body import calibrated_body
from fitter.functional.marker_set import MarkerSet, load_marker_set
from fitter.limb.limb_calibration import calibrate
from fitter.limb.tracking import track_limb
from fitter.limb.written_arm import calibrated_arm
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

_LINKS = {
    "upper_arm_left": (*(f"ArmL:Marker{k}" for k in range(1, 5)), "LateralEpicondyleL"),
    "forearm_left": tuple(f"ForearmL:Marker{k}" for k in range(1, 5)),
    "hand_left": ("HandL",),
}
_SCAPULA = {"scapula_left": ("AcromionL", "ScapularSpineL", "ScapulaL")}
_ACROMION, _C7 = {"acromion_left": "AcromionL"}, {"c7": "C7"}
_LANDMARKS = {"lateral_epicondyle_left": "LateralEpicondyleL"}
_SPRINT = MarkerSet("sprint", {**_SCAPULA, **_LINKS}, {**_ACROMION, **_LANDMARKS})
_C7_AND_SCAPULA = MarkerSet(
    "sprint-c7", {"thorax": ("C7",), **_SCAPULA, **_LINKS}, {**_ACROMION, **_C7, **_LANDMARKS}
)
_C7_ALONE = MarkerSet("sprint-c7-alone", {"thorax": ("C7",), **_LINKS}, {**_C7, **_LANDMARKS})


@dataclass(frozen=True)
class Case:
    """A recording in halves, and what of it is learnt."""

    name: str
    file: str
    marker_set: str | MarkerSet
    preset: str
    girdle: Girdle


CASES = (
    Case("racing_full", "racing_full.c3d", "kineticstoolkit", "human-arm-right", "scapula"),
    Case("sprint", "sprintbasket.c3d", _SPRINT, "human-arm-left", "scapula"),
    Case("sprint, C7 and scapula", "sprintbasket.c3d", _C7_AND_SCAPULA, "human-arm-left", "thorax"),
    Case("sprint, C7 alone", "sprintbasket.c3d", _C7_ALONE, "human-arm-left", "thorax"),
)


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def judged(arm: Arm, recording: MarkerRecording) -> str:
    """Return the markers' distances from a tracked arm's."""
    (tracked,) = track_limb(arm, [recording])
    return said(tracked.distance_m)


def said(distance_m: Floats) -> str:
    """Return rms and median of distances [mm]."""
    far = 1e3 * distance_m
    return f"{np.sqrt(np.nanmean(far**2)):.1f} mm rms, {np.nanmedian(far):.1f} median"


def between_axes_deg(arm: Arm, elbow: int) -> float:
    """Return the angle between the axes of a joint, from 0, and of the next."""
    z = axis_frames(arm, np.zeros(arm.n_joint))[0][elbow : elbow + 2, :3, 2]
    return float(np.degrees(np.arccos(np.clip(z[0] @ z[1], -1.0, 1.0))))


def main(argv: Sequence[str] | None = None) -> int:
    """Say it of every recording."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    data = parser.parse_args(argv).data
    for case in CASES:
        (looked,) = read_markers([data / "kineticstoolkit" / case.file])
        marker_set = load_marker_set(case.marker_set) if isinstance(case.marker_set, str) else case.marker_set
        both = halves(looked.recording)
        for k, learnt in enumerate(both):
            fit = calibrate([learnt], marker_set, case.preset, case.girdle)
            arm = calibrated_arm(fit, None)
            between = between_axes_deg(arm, fit.where.centres["elbow"])
            which = ("first", "second")[k]
            evaluated = said(fit.marker_errors([both[1 - k]], 0).distance_m)
            _say(f"{case.name}, {which} half learnt: {evaluated}; elbow to forearm {between:.0f}°")
            _say(f"all frames, tracked: {judged(arm, both[1 - k])}")
    folder = data / "opencap_subject4" / "MarkerData"
    names = [folder / f"{name}.trc" for name in ("static1", "squats1", "DJ1")]
    static, squats, jump = (one.recording for one in read_markers(names))
    person, both = Body("human-body", 60.05, 1.7, "f"), halves(squats)
    for k, learnt in enumerate(both):
        arm = calibrated_body(calibrate_body([static, learnt], load_marker_set("opencap"), person), person)
        which = ("first", "second")[k]
        _say(f"person, standing and {which} half of the squats learnt, the other half: {judged(arm, both[1 - k])}")
        _say(f"drop jump: {judged(arm, jump)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
