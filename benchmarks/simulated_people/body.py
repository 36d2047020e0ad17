"""A whole person with a known truth: human-body bent a little, markers on it, a squat with arms that swing."""

import functools
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from arm.body.landmarks import landmark_places
from arm.body.limbs import BODY, MEAN_PERSON
from arm.body.tracked_segments import TRACKED_SEGMENTS
from arm.body.whole_body import BRANCHES, body_landmarks, body_map, human_body, limb_of_body
from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from fitter.body.body_fit import BodyFit
from fitter.body.calibration import calibrate_body
from fitter.functional.marker_set import MarkerSet
from protocol.markers.recording import MarkerRecording

RATE_HZ = 50.0
#: Laboratory's axes of forward, left and up of the person: Y is up, and the person faces neither X nor Z.
WORLD = Rotation.from_euler("y", 40.0, degrees=True).as_matrix() @ np.array(
    [[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]
)
WHERE = body_map()


@dataclass(frozen=True)
class Truth:
    """The truth, and what was recorded of it."""

    arm: Arm
    recording: MarkerRecording
    marker_set: MarkerSet
    q: Floats
    centres_m: dict[str, Floats]
    lengths_m: dict[str, float]


def joint(name: str) -> int:
    """Return which joint of the body has a name, from 0."""
    return WHERE.joints.index(name)


def squatting(n: int) -> Floats:
    """Return angles, (n, n_joint): upright for a second, then squats with arms that swing and trunk that turns."""
    t = np.arange(n) / RATE_HZ
    deep = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.maximum(t - 1.0, 0.0) / 2.0)
    sway = np.where(t > 1.0, 1.0, 0.0) * np.sin(2.0 * np.pi * np.maximum(t - 1.0, 0.0) / 3.0)
    q = np.zeros((n, len(WHERE.joints)))
    for name, most in {
        "hip_flexion": 1.5,
        "knee": 1.7,
        "ankle": 0.4,
        "shoulder_flexion": 1.2,
        "elbow": 0.9,
    }.items():
        for side in ("right", "left"):
            q[:, joint(f"{name}_{side}")] = most * deep
    for name, most in {
        "lumbar_flexion": 0.2, "thoracic_flexion": 0.1, "lumbar_rotation": 0.3, "lumbar_bending": 0.2,
        "pelvis_rotation": 0.2,
        "hip_abduction_right": 0.2, "hip_abduction_left": -0.2,
        "hip_rotation_right": 0.2, "hip_rotation_left": 0.2, "shank_right": 0.2, "shank_left": 0.1,
        "shoulder_abduction_right": 0.4, "shoulder_abduction_left": 0.4, "shoulder_rotation_left": 0.4,
        "shoulder_rotation_right": 0.4, "forearm_right": 0.5, "forearm_left": 0.5, "girdle_elevation_right": 0.15,
        "girdle_elevation_left": 0.15, "pelvis_forward": 0.1, "pelvis_left": 0.05,
    }.items():  # fmt: skip
        q[:, joint(name)] += most * sway
    q[:, joint("pelvis_tilt")] = 0.4 * deep
    q[:, joint("pelvis_up")] = 0.9 - 0.35 * deep
    return q


def _landmarks(arm: Arm) -> dict[str, tuple[int, Floats]]:
    """Return the preset's landmarks, those of the limbs at the ends of the lengths that these limbs have."""
    found = body_landmarks(arm)
    for name, branch in BRANCHES.items():
        if branch.where is not None:
            own = limb_of_body(arm.body, name)
            at = arm.joints[branch.first : branch.first + own.n_joint]
            own = own.with_joints(a_m=[j.a_m for j in at], d_m=[j.d_m for j in at])
            places = landmark_places(own, branch.where, arm.body.height_m)
            found |= {landmark: (branch.first + link, place) for landmark, (link, place) in places.items()}
    return found


def truth(n: int = 300, noise_m: float = 5e-4) -> Truth:
    """Simulate a person whose thigh, shank and upper arm are not the preset's."""
    arm = human_body(replace(MEAN_PERSON, preset=BODY))
    a, d = (np.array([getattr(j, name) for j in arm.joints]) for name in ("a_m", "d_m"))
    for side in ("right", "left"):
        d[joint(f"hip_rotation_{side}")] *= 1.06
        d[joint(f"shank_{side}")] *= 0.95
        d[joint(f"shoulder_rotation_{side}")] *= 1.05
    arm = arm.with_joints(a_m=a, d_m=d)
    rng = np.random.default_rng(1)
    names, links, places = list[str](), list[int](), list[Floats]()
    segments: dict[str, tuple[str, ...]] = {}
    for segment, part in WHERE.parts.items():
        if segment not in TRACKED_SEGMENTS:
            continue
        own = tuple(f"{segment}{k}" for k in range(2 if segment.startswith("scapula") else 3))
        segments[segment] = own
        for name in own:
            names.append(name)
            links.append(part.link)
            places.append(rng.normal(scale=0.07, size=3))
    landmarks = _landmarks(arm)
    for name, (link, place) in landmarks.items():
        names.append(name)
        links.append(link)
        places.append(place)
    q = squatting(n)
    frames = axis_frames(arm, q)
    at = np.stack(
        [frames[:, i, :3, :3] @ x + frames[:, i, :3, 3] for i, x in zip(links, places, strict=True)], axis=1
    )
    world = at @ WORLD.T + noise_m * rng.normal(size=at.shape)
    centres = {name: frames[:, k, :3, 3] @ WORLD.T for name, k in WHERE.centres.items()}
    lengths = {
        "thigh_right": abs(d[joint("hip_rotation_right")]), "shank_left": abs(d[joint("shank_left")]),
        "upper_arm_left": abs(d[joint("shoulder_rotation_left")]),
    }  # fmt: skip
    recording = MarkerRecording("squats.trc", RATE_HZ, tuple(names), world, "m", "+y")
    marker_set = MarkerSet("simulated", segments, {name: name for name in landmarks})
    return Truth(arm, recording, marker_set, q, centres, lengths)


@functools.cache
def fitted() -> tuple[Truth, BodyFit]:
    """Return a person and its fit, once for all tests of a process."""
    person = truth()
    return person, calibrate_body([person.recording], person.marker_set, fit_frames=60)
