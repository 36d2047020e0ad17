"""What a whole person's held-out markers owe to two joints: a shank that turns, and a trunk that flexes twice.

    python -m benchmarks.person_joints DATA

DATA is the folder with the recordings. A person is learnt from OpenCap's subject 4 standing and half of the
squats, either half. Judged are the other half and a drop jump: feet and thorax as clusters of their own, whose
shape is the learnt one (what no rigid segment can help); the person as learnt; and the same learnt and tracked
with joints held at zero. Last comes how much the answer owes to what is said of the shank's range beforehand: the
same with a prior of a quarter of its width, and with none.
"""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from arm.body.whole_body import SIDES, body_map
from arm.model import Arm, Body, Floats
from fitter.body.body_fit import BodyFit
from fitter.body.calibration import calibrate_body
from fitter.body.written_body import calibrated_body
from fitter.functional.marker_set import load_marker_set
from fitter.functional.rigid_fit import fit_poses
from fitter.functional.segment_motion import segment_motion
from fitter.limb.bundle import fit_bundle
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import AnglePrior
from fitter.limb.motion_smoother import smooth
from fitter.limb.solved_motion import JERK_OF_A_BODY, solve_motion
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

_CLUSTERS = {
    "foot_right": ("r_calc", "r_toe", "r_5meta"),
    "foot_left": ("L_calc", "L_toe", "L_5meta"),
    "thorax": ("C7", "L_Sternum", "R_Sternum"),
}
_SAID = ("C7", "L_Sternum", "r_toe", "L_toe", "r_5meta", "L_5meta")
SHANKS = tuple(f"shank_{side}" for side in SIDES)
_HELD = {
    "as learnt": (),
    "shanks held": SHANKS,
    "second flexion held": ("thoracic_flexion",),
    "both held": (*SHANKS, "thoracic_flexion"),
}
#: A joint that is held has this standard deviation [rad]; one without a prior this.
_HELD_RAD, _FREE_RAD = np.radians(0.5), 2.0


def with_std(
    prior: AnglePrior, joints: Sequence[str], std_rad: float, mean_rad: float | None = None
) -> AnglePrior:
    """Return a prior in which some joints of a whole person have another standard deviation, and mean."""
    chosen = np.isin(body_map().joints, list(joints))
    mean = prior.mean if mean_rad is None else np.where(chosen, mean_rad, prior.mean)
    return AnglePrior(mean, np.where(chosen, std_rad**-2, prior.information))


def learnt_under(fit: BodyFit, prior: AnglePrior) -> BodyFit:
    """Return the same fit under another prior of the angles."""
    bundle = fit.bundle
    task = replace(fit.task, angles=prior)
    return replace(fit, task=task, bundle=fit_bundle(task, bundle.geometry, bundle.markers, bundle.q))


def tracked(
    arm: Arm, recording: MarkerRecording, change: Callable[[AnglePrior], AnglePrior]
) -> tuple[Floats, Floats]:
    """Return the angles under another prior, and how far markers are from there, (n_frame, m) [mm]."""
    solved = solve_motion(arm, recording, 1)
    prior, std, q = change(solved.marked.angles), solved.marked.everything.std, solved.smoothed.q
    q = smooth(solved.chain, solved.frames, std, prior, 1.0 / recording.rate_hz, q, JERK_OF_A_BODY).q
    return q, np.asarray(1e3 * np.linalg.norm(solved.frames.y - predicted(solved.chain, solved.frames, q), axis=2))


def rms(x: Floats) -> float:
    """Return the root of the mean square of what is known."""
    return float(np.sqrt(np.nanmean(x**2)))


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")


def _clusters(learn: Sequence[MarkerRecording], judge: Mapping[str, MarkerRecording]) -> None:
    for segment, markers in _CLUSTERS.items():
        shape = segment_motion(segment, markers, [one.of(markers) for one in learn]).template.points_m
        for name, recording in judge.items():
            off = 1e3 * fit_poses(shape, recording.of(markers)).marker_rms_m
            each = ", ".join(f"{m} {x:.1f}" for m, x in zip(markers, off, strict=True))
            _say(f"{name}, {segment} by itself: {each} mm")


def _judged(fit: BodyFit, person: Body, judge: Mapping[str, MarkerRecording]) -> None:
    def held(prior: AnglePrior, joints: Sequence[str]) -> AnglePrior:
        return with_std(prior, joints, _HELD_RAD, 0.0)

    for what, joints in _HELD.items():
        arm = calibrated_body(learnt_under(fit, held(fit.task.angles, joints)) if joints else fit, person)
        names = [marker.name for marker in arm.markers]
        for name, recording in judge.items():
            _, far = tracked(arm, recording, partial(held, joints=joints))
            each = ", ".join(f"{m} {rms(far[:, names.index(m)]):.0f}" for m in _SAID)
            _say(f"{name}, {what}: {rms(far):.1f} mm rms, {np.nanmedian(far):.1f} median; {each}")
    at = [body_map().joints.index(joint) for joint in SHANKS]
    of_range = fit.task.angles.information[at[0]] ** -0.5
    for what, std in {"a quarter of the range's prior": 0.25 * of_range, "no prior": _FREE_RAD}.items():
        change = partial(with_std, joints=SHANKS, std_rad=std)
        arm = calibrated_body(learnt_under(fit, change(fit.task.angles)), person)
        for name, recording in judge.items():
            q, far = tracked(arm, recording, change)
            spans = np.degrees(np.ptp(q[:, at], axis=0))
            _say(
                f"{name}, shanks with {what}: {rms(far):.1f} mm rms; they turn by {spans[0]:.0f}, {spans[1]:.0f}°"
            )


def main(argv: Sequence[str] | None = None) -> int:
    """Say it of both halves."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    folder = parser.parse_args(argv).data / "opencap_subject4" / "MarkerData"
    files = [folder / f"{name}.trc" for name in ("static1", "squats1", "DJ1")]
    static, squats, jump = (looked.recording for looked in read_markers(files))
    half = len(squats.positions) // 2
    first, second = (replace(squats, positions=squats.positions[at]) for at in (np.s_[:half], np.s_[half:]))
    _clusters([static, first], {"squats": second, "drop jump": jump})
    person = Body("human-body", 60.05, 1.7, "f")
    for learnt, other, which in ((first, second, "first"), (second, first, "second")):
        _say(f"learnt from standing and the {which} half of the squats:")
        fit = calibrate_body([static, learnt], load_marker_set("opencap"), person)
        _judged(fit, person, {"squats, other half": other, "drop jump": jump})
    return 0


if __name__ == "__main__":
    sys.exit(main())
