"""Stated 95 % intervals of a person's lengths and centres, judged by disjoint recordings.

    python -m benchmarks.limb_intervals DATA [--simulated N]

Each measured recording is cut into two halves, or there is a second one, and each is fitted by itself. A length's
interval by one holds if the other's length lies in it; a centre's if the other has it within 1.96 of its stated
standard deviations, once the markers of its segment lie upon each other. Simulated persons are judged by the
truth.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.simulated_people.person import person
from fitter.functional.marker_set import MarkerSet, load_marker_set
from fitter.functional.rigid_fit import fit_poses
from fitter.limb.json_document import document
from fitter.limb.limb_calibration import calibrate
from fitter.limb.marker_errors import scores_of
from protocol.markers.marker_files import read_markers
from protocol.markers.recording import MarkerRecording

#: Standard deviations on either side of a 95 % interval of many degrees of freedom.
_NORMAL = 1.96
#: Clusters of FunctionalLHip.c3d, which Plug-in Gait does not name.
_BTK = MarkerSet(
    "btk-clusters",
    {
        "pelvis": ("LASI", "RASI", "LPSI", "RPSI"),
        "thigh_left": ("LTHI", "LKNE", *(f"LF0{k}" for k in range(1, 6))),
        "shank_left": ("LTIB", "LANK", *(f"LT0{k}" for k in range(1, 6))),
        "foot_left": ("LHEE", "LTOE"),
    },
    {
        "asis_left": "LASI", "asis_right": "RASI", "psis_left": "LPSI", "psis_right": "RPSI",
        "lateral_femoral_epicondyle_left": "LKNE", "lateral_malleolus_left": "LANK",
    },
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A recording, its marker set, the limb, and a second recording of it where there is one."""

    file: str
    marker_set: str | MarkerSet
    preset: str
    second: str | None = None


_HIPS = "biobuddy/lower_limb_calibration/Test_func_{}hip.c3d"
CASES = (
    Case("kineticstoolkit/racing_full.c3d", "kineticstoolkit", "human-arm-right"),
    Case("kineticstoolkit/racing_full.c3d", "kineticstoolkit", "human-arm-left"),
    Case("btk/FunctionalLHip.c3d", _BTK, "human-leg-left"),
    Case("opencap_subject4/MarkerData/squats1.trc", "opencap", "human-leg-right"),
    Case("opencap_subject4/MarkerData/squats1.trc", "opencap", "human-leg-left"),
    Case("biobuddy/right_knee.c3d", "biobuddy", "human-leg-right"),
    # in the other leg's trial a hip turns under the trunk that sways
    Case(_HIPS.format("l"), "biobuddy-lower-limb", "human-leg-left", _HIPS.format("r")),
    Case(_HIPS.format("r"), "biobuddy-lower-limb", "human-leg-right", _HIPS.format("l")),
)


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")


def estimated(
    recording: MarkerRecording, marker_set: MarkerSet, preset: str
) -> dict[str, dict[str, dict[str, object]]]:
    """Return lengths and centres as the command's JSON has them."""
    fit = calibrate([recording], marker_set, preset)
    return document(fit, scores_of(fit, [recording], [], 0))  # type: ignore[return-value]


def halves(recording: MarkerRecording) -> tuple[MarkerRecording, MarkerRecording]:
    """Return both halves of a recording in time."""
    middle = len(recording.positions) // 2
    first, second = recording.positions[:middle], recording.positions[middle:]
    return replace(recording, positions=first), replace(recording, positions=second)


def apart_mm(one: dict[str, object], other: dict[str, object]) -> float:
    """Return how far two answers have a centre apart, in the first one's markers [mm]; NaN of fewer than three."""
    mine, theirs = dict(one["markers_m"]), dict(other["markers_m"])  # type: ignore[call-overload]
    names = [name for name in mine if name in theirs]
    if len(names) < 3:  # noqa: PLR2004 - of a pose
        return np.nan
    pose = fit_poses(np.array([theirs[n] for n in names]), np.array([[mine[n] for n in names]]))
    moved = pose.R[0] @ np.array(other["position_m"]) + pose.p[0]
    return float(1e3 * np.linalg.norm(moved - np.array(one["position_m"])))


def judged(one: dict, other: dict, what: str) -> list[tuple[str, bool]]:  # type: ignore[type-arg]
    """Return which of one answer's intervals hold the other's values, and say them."""
    found = []
    for name, length in one["lengths_m"].items():
        low, high = length["ci95"]
        value = other["lengths_m"][name]["value"]
        found.append(("length", bool(low <= value <= high)))
        _say(
            f"{what}, {name}: {1e3 * length['value']:.0f} [{1e3 * low:.0f}, {1e3 * high:.0f}], "
            f"other {1e3 * value:.0f} mm"
        )
    for name, centre in one["centres"].items():
        apart = apart_mm(centre, other["centres"][name])
        if np.isfinite(apart):
            found.append(("centre", bool(apart <= _NORMAL * centre["std_mm"])))
            _say(f"{what}, {name}: sd {centre['std_mm']:.1f}, apart {apart:.1f} mm")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Say of all cases how many intervals hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--simulated", type=int, default=4, help="persons (4)")
    given = parser.parse_args(arguments)
    found: dict[str, list[tuple[str, bool]]] = {"measured": [], "simulated": []}
    for case in CASES:
        marker_set = load_marker_set(case.marker_set) if isinstance(case.marker_set, str) else case.marker_set
        files = [case.file] if case.second is None else [case.file, case.second]
        recordings = [looked.recording for looked in read_markers([given.data / file for file in files])]
        disjoint = halves(*recordings) if case.second is None else recordings
        both = [estimated(one, marker_set, case.preset) for one in disjoint]
        for mine, theirs in (both, both[::-1]):
            found["measured"] += judged(mine, theirs, f"{Path(case.file).stem} {case.preset}")
    for seed in range(given.simulated):
        preset = ("human-arm-right", "human-leg-right")[seed % 2]
        truth = person(preset, seed=100 + seed, noise_m=3e-3)
        mine = estimated(truth.recordings[0], truth.marker_set, preset)
        upper, joints = next(iter(mine["lengths_m"])), truth.arm.joints
        lower = [name for name in mine["lengths_m"] if name != upper][0]
        true = {upper: abs(joints[2].d_m), lower: joints[3].a_m if "leg" in preset else abs(joints[4].d_m)}
        for name, value in true.items():
            low, high = mine["lengths_m"][name]["ci95"]  # type: ignore[misc]
            found["simulated"].append(("length", bool(low <= value <= high)))  # type: ignore[operator]
    for kind, all_of_them in found.items():
        for what in ("length", "centre"):
            held = [ok for one, ok in all_of_them if one == what]
            if held:
                _say(f"{kind}: {sum(held)} of {len(held)} intervals of a {what} hold")
    return 0


if __name__ == "__main__":
    sys.exit(main())
