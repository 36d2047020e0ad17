"""Bony points that a pointer touched, in another motion: where clusters carry them, and where a limb has them.

    python -m benchmarks.bony_points DATA

DATA is the folder with the recordings. A static recording and four probings of a right arm, then wheelchair
propulsion. It says how far each point is from where the recordings' own makers had it; how much of that no cluster
can help, since bones keep their length and joints hold together; how far skin takes the cluster of the upper arm
from the bone, by the marker that is on the lateral epicondyle, from one recording to the next; and how far limbs
have each point from its cluster, and the medial epicondyle from the lateral one's marker.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from arm.model import Floats
from fitter.functional.functional_centre import functional_centre
from fitter.functional.marker_set import load_marker_set
from fitter.functional.segment_motion import SegmentMotion, segment_motion
from fitter.limb.inverse_kinematics import link_poses
from fitter.limb.limb_calibration import calibrate
from fitter.limb.probing import with_probed
from fitter.limb.solved_motion import solve_motion
from fitter.limb.written_arm import calibrated_arm
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

_POINTS = ("acromion", "medial_epicondyle", "radial_styloid", "ulnar_styloid")
_LATERAL = "LateralEpicondyleR"
_ARM, _FOREARM = ("ArmR1", "ArmR2", "ArmR3"), ("ForearmR1", "ForearmR2", "ForearmR3")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")


def _median_mm(off: Floats) -> str:
    """Return the median length of vectors (n, 3) [m], and the largest [mm]."""
    far = 1e3 * np.linalg.norm(off, axis=1)
    return f"{np.nanmedian(far):.1f} mm, at the most {np.nanmax(far):.1f}"


def elbow_gap_mm(recordings: Sequence[MarkerRecording]) -> list[float]:
    """Return how far two clusters have the elbow apart, rms, in each recording; all but the last are learnt."""
    segments = [segment_motion(str(m[0]), m, [r.of(m) for r in recordings]) for m in (_ARM, _FOREARM)]
    learnt = [SegmentMotion(s.name, s.template, s.trials[:-1]) for s in segments]
    centre = functional_centre("elbow_right", *learnt)
    found = []
    for upper, fore in zip(*(s.trials for s in segments), strict=True):
        gap = upper.R @ centre.in_parent_m + upper.p - fore.R @ centre.in_child_m - fore.p
        found.append(1e3 * float(np.sqrt(np.nanmean(np.sum(gap**2, axis=1)))))
    return found


def slid_mm(recordings: Sequence[MarkerRecording], since: int) -> list[float]:
    """Return how far the lateral epicondyle is, in the upper arm's cluster, from where it was in one recording."""
    poses = segment_motion("upper_arm_right", _ARM, [one.of(_ARM) for one in recordings]).trials
    there = [
        np.einsum("nji,nj->ni", pose.R, one.of([_LATERAL])[:, 0] - pose.p)
        for pose, one in zip(poses, recordings, strict=True)
    ]
    begin = np.nanmedian(there[since], axis=0)
    return [1e3 * float(np.nanmedian(np.linalg.norm(x - begin, axis=1))) for x in there]


def main(argv: Sequence[str] | None = None) -> int:
    """Say it of every point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    folder = parser.parse_args(argv).data / "kineticstoolkit"
    files = ["sample_static", *(f"sample_probing_{p}_R" for p in _POINTS), "sample_propulsion", "racing_full"]
    *bare, stored = (one.recording for one in read_markers([folder / f"{name}.c3d" for name in files]))
    static, *probings, propulsion = bare
    marker_set = load_marker_set("kineticstoolkit")
    probed = with_probed(bare, {f"{p}_right": r for p, r in zip(_POINTS, probings, strict=True)}, marker_set)
    moving = probed.recordings[-1]
    names = {p: probed.marker_set.landmarks[f"{p}_right"] for p in _POINTS}
    for name in names.values():
        off = moving.of([name])[:, 0] - stored.of([name])[:, 0]
        _say(f"{name} by its cluster, from where the makers have it: {_median_mm(off)}")
    ends = [_LATERAL, names["medial_epicondyle"]]
    wide = [
        1e3 * np.linalg.norm(np.diff(r.of(ends), axis=1)[:, 0], axis=1) for r in (probed.recordings[2], moving)
    ]
    low, high = np.nanmin(wide[1]), np.nanmax(wide[1])
    _say(f"between the epicondyles: {np.nanmedian(wide[0]):.0f} mm probed, {low:.0f} to {high:.0f} in propulsion")
    slid = slid_mm(bare, 1 + _POINTS.index("medial_epicondyle"))
    said = ", ".join(
        f"{name} {far:.0f}" for name, far in zip(("static", *_POINTS, "propulsion"), slid, strict=True)
    )
    _say(
        f"lateral epicondyle in the upper arm's cluster, from where it was as the medial one was probed: {said} mm"
    )
    *still, moved = elbow_gap_mm(bare)
    _say(f"elbow by either cluster, apart: {max(still):.1f} mm where it is learnt, {moved:.1f} in propulsion")
    for what, learn in (
        ("static and probings", probed.recordings[:-1]),
        ("these and propulsion", probed.recordings),
    ):
        arm = calibrated_arm(calibrate(learn, probed.marker_set, "human-arm-right"), None)
        solved = solve_motion(arm, propulsion, 1)
        R, o = link_poses(solved.chain, solved.frames, solved.smoothed.q)
        for marker in arm.markers:
            if marker.name in list(names.values())[1:]:
                i = solved.marked.markers.sway + marker.joint - 1
                there = R[:, i] @ np.array(marker.position_m) + o[:, i]
                off = there - moving.of([marker.name])[:, 0]
                _say(f"{marker.name} by a limb learnt on {what}, from its cluster's: {_median_mm(off)}")
            if marker.name == names["medial_epicondyle"]:
                far = 1e3 * np.linalg.norm(there - moving.of([_LATERAL])[:, 0], axis=1)
                low, high = np.nanmin(far), np.nanmax(far)
                _say(f"and from the lateral epicondyle's marker: {low:.0f} to {high:.0f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main())
