"""Where segments, joints' centres and bony landmarks are on the chain of a person's arm or leg, about.

Places of landmarks are starting values for a calibration and nothing more: half the breadth of joints and hand as
grown-ups have it, assumed, in proportion to stature. A calibration replaces them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from arm.body.limbs import FORWARD, LEFT, MEAN_PERSON, UP
from arm.kinematics import axis_frames
from arm.model import Arm, Floats


@dataclass(frozen=True)
class Part:
    """A segment of the chain: the link that it is (from 0), and the centres that it reaches from and to."""

    link: int
    begins: str
    ends: str


@dataclass(frozen=True)
class LimbMap:
    """Which links of a preset are which segments, and where its joints' centres are.

    Attributes
    ----------
    side : str
        ``right`` or ``left``.
    base : str
        The segment that carries the base.
    parts : mapping of str to Part
        By segment.
    centres : mapping of str to int
        By joint: the link, from 0, whose joint-axis frame begins there in the pose in which all joints are zero.
    balls : tuple of int
        First joints, from 0, of those of three whose axes meet in one point.
    axes : mapping of str to int
        Joints, from 0, whose axis anatomy names, such as that of the elbow.
    """

    side: str
    base: str
    parts: Mapping[str, Part]
    centres: Mapping[str, int]
    balls: tuple[int, ...]
    axes: Mapping[str, int]

    @property
    def outward(self) -> Floats:
        """Away from the middle of the body, in the base frame of the preset."""
        return -LEFT if self.side == "right" else LEFT


def limb_map(preset: str, n_joint: int) -> LimbMap:
    """Return the map of a preset by its joints.

    Nine of an arm begin at the thorax, seven at the scapula. Of a leg's seven one turns the shank, of six none.
    """
    side = preset.rpartition("-")[2]
    if "arm" in preset:
        k = n_joint - 7
        base = "thorax" if k else f"scapula_{side}"
        parts = {
            f"upper_arm_{side}": Part(k + 2, "shoulder", "elbow"),
            f"forearm_{side}": Part(k + 4, "elbow", "wrist"),
            f"hand_{side}": Part(k + 6, "wrist", "fingers"),
        }
        if k:
            parts = {f"scapula_{side}": Part(1, "girdle", "shoulder"), **parts}
        centres = {**({"girdle": 0} if k else {}), "shoulder": k, "elbow": k + 3, "wrist": k + 5}
        axes = {"elbow": k + 3, "forearm": k + 4, "wrist": k + 5}
        return LimbMap(side, base, parts, centres, (k,), axes)
    shank = n_joint - 3
    parts = {
        f"thigh_{side}": Part(2, "hip", "knee"),
        f"shank_{side}": Part(shank, "knee", "ankle"),
        f"foot_{side}": Part(shank + 2, "ankle", "toes"),
    }
    turning = {"shank": shank} if shank > 3 else {}
    axes = {"knee": 3, **turning, "ankle": shank + 1, "subtalar": shank + 2}
    return LimbMap(side, "pelvis", parts, {"hip": 0, "knee": 3, "ankle": shank + 1}, (0,), axes)


#: Landmark, the centre that it is near, and how far from it: forward, outward, up [m], of a person of 1.741 m.
_NEAR: dict[str, tuple[str, float, float, float]] = {
    "acromion": ("shoulder", 0.0, 0.0, 0.045),
    "lateral_epicondyle": ("elbow", 0.0, 0.033, 0.0),
    "medial_epicondyle": ("elbow", 0.0, -0.033, 0.0),
    "radial_styloid": ("wrist", 0.028, 0.0, 0.0),
    "ulnar_styloid": ("wrist", -0.028, 0.0, 0.0),
    "second_metacarpal": ("wrist", 0.03, 0.0, -0.08),
    "fifth_metacarpal": ("wrist", -0.03, 0.0, -0.07),
    "greater_trochanter": ("hip", 0.0, 0.085, 0.0),
    "lateral_femoral_epicondyle": ("knee", 0.0, 0.05, 0.0),
    "medial_femoral_epicondyle": ("knee", 0.0, -0.05, 0.0),
    "lateral_malleolus": ("ankle", 0.0, 0.036, 0.0),
    "medial_malleolus": ("ankle", 0.0, -0.036, 0.0),
    "calcaneus": ("ankle", -0.06, 0.0, -0.03),
    "first_metatarsal": ("ankle", 0.13, -0.035, -0.05),
    "second_metatarsal": ("ankle", 0.15, 0.0, -0.04),
    "fifth_metatarsal": ("ankle", 0.10, 0.05, -0.05),
}
#: How far those are off, rms [m].
LANDMARK_STD_M = 0.015


def centre_points(arm: Arm, where: LimbMap) -> dict[str, Floats]:
    """Return the joints' centres with all joints at zero, in frame 0, (3,) [m] each; the far end comes last."""
    frames = axis_frames(arm, np.zeros(arm.n_joint))[0]
    points = {name: np.array(frames[k, :3, 3]) for name, k in where.centres.items()}
    end = frames[-1, :3, 3] + arm.joints[-1].a_m * frames[-1, :3, 0]
    return points | {"fingers" if "wrist" in points else "toes": end}


def landmark_places(arm: Arm, where: LimbMap, height_m: float) -> dict[str, tuple[int, Floats]]:
    """Return link (from 0, -1 for the base) and place in its joint-axis frame [m] of every landmark, about."""
    frames = axis_frames(arm, np.zeros(arm.n_joint))[0]
    centres = centre_points(arm, where)
    scale = height_m / MEAN_PERSON.height_m
    places: dict[str, tuple[int, Floats]] = {}
    for name, (centre, forward, outward, up) in _NEAR.items():
        if centre not in centres:
            continue
        at = centres[centre] + scale * (forward * FORWARD + outward * where.outward + up * UP)
        link = next((p.link for s, p in where.parts.items() if s.startswith(_segment_of(name))), -1)
        T = np.eye(4) if link < 0 else frames[link]
        places[f"{name}_{where.side}"] = (link, T[:3, :3].T @ (at - T[:3, 3]))
    return places


def _segment_of(landmark: str) -> str:
    groups = {
        "scapula": ("acromion",),
        "upper_arm": ("lateral_epicondyle", "medial_epicondyle"),
        "forearm": ("radial_styloid", "ulnar_styloid"),
        "hand": ("second_metacarpal", "fifth_metacarpal"),
        "thigh": ("greater_trochanter", "lateral_femoral_epicondyle", "medial_femoral_epicondyle"),
        "shank": ("lateral_malleolus", "medial_malleolus"),
        "foot": ("calcaneus", "first_metatarsal", "second_metatarsal", "fifth_metatarsal"),
    }
    return next(segment for segment, landmarks in groups.items() if landmark in landmarks)


def middle_of(arm: Arm, where: LimbMap, segment: str) -> Floats:
    """Return the middle of a segment in its link's joint-axis frame, (3,) [m]."""
    frames = axis_frames(arm, np.zeros(arm.n_joint))[0]
    part, centres = where.parts[segment], centre_points(arm, where)
    middle = 0.5 * (centres[part.begins] + centres[part.ends])
    T = frames[part.link]
    return np.asarray(T[:3, :3].T @ (middle - T[:3, 3]))
