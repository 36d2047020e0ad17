"""What bounds a whole person's held-out markers: segments that bend, or joints that the tree does not have.

    python -m benchmarks.missing_joints DATA

DATA is the folder with the recordings. A person is learnt from OpenCap's subject 4 standing and the first half of
the squats. Judged are the other half and a drop jump: feet and thorax as clusters of their own, whose shape is
the learnt one (what no rigid segment can help); the person as learnt; and the same with joints that the tree has
not, put in only now, while all that was learnt stays as it was: a shank that turns about its long axis under the
knee, and a trunk that flexes a second time where thoracic and lumbar spine meet.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from arm.body.whole_body import SIDES, THORAX_LINK, body_map
from arm.marker_kinematics import MarkerChain, moved_by, ways
from arm.model import Body, Floats
from fitter.body.calibration import calibrate_body
from fitter.body.written_body import calibrated_body
from fitter.functional.marker_set import load_marker_set
from fitter.functional.rigid_fit import fit_poses
from fitter.functional.segment_motion import segment_motion
from fitter.limb.inverse_kinematics import link_poses, predicted
from fitter.limb.marker_observations import AnglePrior
from fitter.limb.motion_smoother import smooth
from fitter.limb.solved_motion import JERK_OF_A_BODY, SolvedMotion, solve_motion
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

_CLUSTERS = {
    "foot_right": ("r_calc", "r_toe", "r_5meta"),
    "foot_left": ("L_calc", "L_toe", "L_5meta"),
    "thorax": ("C7", "L_Sternum", "R_Sternum"),
}
_SAID = ("C7", "L_Sternum", "r_toe", "L_toe", "r_5meta", "L_5meta")
#: Prior of a joint that is put in, about zero, assumed.
_STD_RAD = np.radians(15.0)
#: Where the lumbar spine ends on the way from its lower end to C7: 18 of 46 cm (Gray 1918).
_LUMBAR_SHARE = 18.0 / 46.0


def with_joint(chain: MarkerChain, on: int, axis: Floats, at_m: Floats) -> MarkerChain:
    """Return a chain with one more joint, numbered ``on + 1``, between a link and all that rides or hangs on it.

    Parameters
    ----------
    chain : MarkerChain
        For tracking: the new joint has no numbers of eq. (1).
    on : int
        The link, from 0.
    axis, at_m : (3,)
        The joint's axis and a point on it, in the link's frame.
    """
    n, new = len(chain.parent), on + 1
    R = np.linalg.svd(axis[None])[2][[1, 2, 0]].T  # any two directions across, and the axis
    R[:, 2] = axis / np.linalg.norm(axis)
    R[:, 1] *= np.sign(np.linalg.det(R))
    moved = np.arange(n) + (np.arange(n) >= new)
    parent = np.empty(n + 1, dtype=np.int64)
    parent[moved] = np.where(chain.parent == on, new, np.where(chain.parent < 0, -1, moved[chain.parent]))
    parent[new] = on
    zero_R, zero_p, hung, place = (x.copy() for x in (chain.zero_R, chain.zero_p, chain.hung, chain.place))
    hangs, rides = chain.parent == on, chain.link == on
    zero_R[hangs], zero_p[hangs] = R.T @ zero_R[hangs], zero_p[hangs] @ R
    hung[hangs], place[rides] = (hung[hangs] - at_m) @ R, (place[rides] - at_m) @ R
    moves = moved_by(parent)
    return chain._replace(
        revolute=np.insert(chain.revolute, new, True),
        geometry=np.insert(chain.geometry, new, 0.0, axis=0),
        link=np.where(rides, new, moved[chain.link]),
        place=place,
        parent=parent,
        hang=np.insert(chain.hang, new, 0.0, axis=0),
        moves=moves,
        depth=ways(moves)[0],
        way=ways(moves)[1],
        zero_R=np.insert(zero_R, new, R, axis=0),
        zero_p=np.insert(zero_p, new, 0.0, axis=0),
        hung=np.insert(hung, new, at_m, axis=0),
    )


def candidates(solved: SolvedMotion) -> dict[str, list[tuple[int, Floats, Floats]]]:
    """Return the joints to put in: link, axis and a point on it, in the link's frame; those further on first."""
    where, chain = body_map(), solved.chain
    frames = solved.frames.rows(np.arange(1))
    R, _ = link_poses(chain, frames, np.zeros((1, len(chain.parent))))
    left = R[0, THORAX_LINK].T @ R[0, where.joints.index("lumbar_flexion"), :, 2]
    c7 = chain.place[solved.marked.names.index("C7")]
    knees = sorted((where.joints.index(f"knee_{side}") for side in SIDES), reverse=True)
    along = np.array([1.0, 0.0, 0.0])  # a link of eq. (1) reaches along its x axis
    shanks = [(knee, along, np.zeros(3)) for knee in knees]
    trunk = [(THORAX_LINK, left, _LUMBAR_SHARE * (c7 - (c7 @ left) * left))]
    return {"shank that turns": shanks, "trunk that flexes twice": trunk, "both": [*shanks, *trunk]}


def distances_mm(solved: SolvedMotion, rate_hz: float, joints: Sequence[tuple[int, Floats, Floats]]) -> Floats:
    """Return how far markers are from where a tree with more joints has them, (n_frame, m)."""
    chain, q, prior = solved.chain, solved.smoothed.q, solved.marked.angles
    for on, axis, at in joints:
        chain, q = with_joint(chain, on, axis, at), np.insert(q, on + 1, 0.0, axis=1)
        prior = AnglePrior(np.insert(prior.mean, on + 1, 0.0), np.insert(prior.information, on + 1, _STD_RAD**-2))
    if joints:
        std = solved.marked.everything.std
        q = smooth(chain, solved.frames, std, prior, 1.0 / rate_hz, q, JERK_OF_A_BODY).q
    return np.asarray(1e3 * np.linalg.norm(solved.frames.y - predicted(chain, solved.frames, q), axis=2))


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


def main(argv: Sequence[str] | None = None) -> int:
    """Say it of both recordings."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    folder = parser.parse_args(argv).data / "opencap_subject4" / "MarkerData"
    files = [folder / f"{name}.trc" for name in ("static1", "squats1", "DJ1")]
    static, squats, jump = (looked.recording for looked in read_markers(files))
    half = len(squats.positions) // 2
    learn = [static, replace(squats, positions=squats.positions[:half])]
    judge = {"squats": replace(squats, positions=squats.positions[half:]), "drop jump": jump}
    _clusters(learn, judge)
    person = Body("human-body", 60.05, 1.7, "f")
    arm = calibrated_body(calibrate_body(learn, load_marker_set("opencap"), person), person)
    for name, recording in judge.items():
        solved = solve_motion(arm, recording, 1)
        for what, joints in {"as learnt": [], **candidates(solved)}.items():
            far = distances_mm(solved, recording.rate_hz, joints)
            each = ", ".join(f"{m} {rms(far[:, solved.marked.names.index(m)]):.0f}" for m in _SAID)
            _say(f"{name}, {what}: {rms(far):.1f} mm rms, {np.nanmedian(far):.1f} median; {each}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
