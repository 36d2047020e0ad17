"""Centres and axes of measured joints, by either half of a recording: how far apart, and do the intervals hold.

    python -m benchmarks.functional_joints DATA

DATA is the folder with the recordings. One half's 95 % interval holds a coordinate of a centre if the other half's
answer lies in it. The last columns are the distances of published regressions from the answer of the whole.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arm.model import Floats
from fitter.functional.functional_axis import functional_axis
from fitter.functional.functional_centre import FunctionalCentre, functional_centre
from fitter.functional.marker_set import load_marker_set
from fitter.functional.regression_centre import regression_centres
from fitter.functional.segment_motion import SegmentMotion, segment_motion
from protocol.markers.marker_files import read_markers

_LOWER_LIMB = "biobuddy/lower_limb_calibration/Test_func_"
_PELVIS = ("LASI", "RASI", "LPSI", "RPSI")


@dataclass(frozen=True)
class Case:
    """A joint of a recording and the markers of its segments."""

    joint: str
    file: str
    parent: Sequence[str]
    child: Sequence[str]


CENTRES = (
    Case("hip_left", "btk/FunctionalLHip.c3d", _PELVIS, ("LTHI", "LKNE", "LF01", "LF02", "LF03", "LF04", "LF05")),
    Case("hip_left", f"{_LOWER_LIMB}lhip.c3d", _PELVIS, ("LTHI", "LTHIB", "LTHID")),
    Case("hip_right", f"{_LOWER_LIMB}rhip.c3d", _PELVIS, ("RTHI", "RTHIB", "RTHID")),
    *(
        Case(
            joint,
            "kineticstoolkit/racing_full.c3d",
            [f"{parent}{i}" for i in "123"],
            [f"{child}{i}" for i in "123"],
        )
        for joint, parent, child in (
            ("shoulder_right", "ScapulaR", "ArmR"),
            ("shoulder_left", "ScapulaL", "ArmL"),
            ("elbow_right", "ArmR", "ForearmR"),
            ("wrist_right", "ForearmR", "GloveR"),
        )
    ),
)
AXES = (
    Case(
        "knee_right",
        "biobuddy/right_knee.c3d",
        ("RTHI1", "RTHI2", "RTHI3", "RGT"),
        ("RLEG1", "RLEG2", "RLEG3", "RATT"),
    ),
    Case("knee_left", f"{_LOWER_LIMB}lknee.c3d", ("LTHI", "LTHIB", "LTHID"), ("LTIB", "LTIBF", "LTIBD")),
    Case("knee_right", f"{_LOWER_LIMB}rknee.c3d", ("RTHI", "RTHIB", "RTHID"), ("RTIB", "RTIBF", "RTIBD")),
)


@dataclass(frozen=True)
class Recording:
    """The markers of a file, in metres."""

    markers: tuple[str, ...]
    points_m: Floats

    def of(self, markers: Sequence[str]) -> Floats:
        """Return the positions of some markers, (n_frame, n_marker, 3)."""
        return self.points_m[:, [self.markers.index(marker) for marker in markers]]


def segments(case: Case, recording: Recording) -> list[tuple[SegmentMotion, SegmentMotion]]:
    """Return parent and child of the whole, of the first and of the second half, with the whole's templates."""
    whole = [
        segment_motion(name, markers, [recording.of(markers)])
        for name, markers in (("parent", case.parent), ("child", case.child))
    ]
    half = len(recording.points_m) // 2
    cut = [
        tuple(
            SegmentMotion(s.name, s.template, (s.template.poses(recording.of(s.template.markers)[frames]),))
            for s in whole
        )
        for frames in (slice(None), slice(0, half), slice(half, None))
    ]
    return [(parent, child) for parent, child in cut]


def held(one: FunctionalCentre, other: FunctionalCentre) -> int:
    """Return how many of six coordinates, three of each half, lie in the other half's interval."""
    away = np.abs(one.in_parent_m - other.in_parent_m)
    return int(np.count_nonzero(away <= one.half_width_m) + np.count_nonzero(away <= other.half_width_m))


def rivals(centre: FunctionalCentre, parent: SegmentMotion, recording: Recording) -> str:
    """Return how far the regressions of a joint are from a centre [mm]."""
    known = load_marker_set("plug-in-gait").landmarks.items()
    landmarks = {name: recording.of([m])[:, 0] for name, m in known if m in recording.markers}
    found = [
        (r.method, parent.place([r.position_m])) for r in regression_centres(landmarks) if r.joint == centre.joint
    ]
    return " ".join(f"{name} {1e3 * np.linalg.norm(at - centre.in_parent_m):.1f}" for name, at in found)


def main(argv: Sequence[str] | None = None) -> int:
    """Print a line for each joint."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    data = parser.parse_args(argv).data
    recordings = {}
    for file in dict.fromkeys(case.file for case in (*CENTRES, *AXES)):
        (looked,) = read_markers([data / file])
        recordings[file] = Recording(tuple(looked.recording.names), looked.recording.positions)
    say, total = sys.stdout.write, 0
    for case in CENTRES:
        (parent, child), *halves = segments(case, recordings[case.file])
        whole = functional_centre(case.joint, parent, child)
        first, second = (functional_centre(case.joint, *half) for half in halves)
        total += held(first, second)
        apart = 1e3 * np.linalg.norm(first.in_parent_m - second.in_parent_m)
        say(f"{case.joint} {case.file}: halves {apart:.1f} mm apart, held {held(first, second)} of 6, ")
        say(f"std {1e3 * whole.std_m:.1f} mm, {rivals(whole, parent, recordings[case.file])}\n")
    say(f"held {total} of {6 * len(CENTRES)}\n")
    for case in AXES:
        axes = [functional_axis(case.joint, *both) for both in segments(case, recordings[case.file])]
        apart = np.degrees(np.arccos(min(1.0, abs(axes[1].in_parent @ axes[2].in_parent))))
        say(f"{case.joint} {case.file}: halves {apart:.1f}° apart, std {np.degrees(axes[0].std_rad):.1f}°\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
