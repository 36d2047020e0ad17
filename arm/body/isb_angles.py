"""Joint angles as the International Society of Biomechanics recommends them, of a calibrated limb or body.

A joint's angles are those of a joint coordinate system (Grood and Suntay 1983; Wu et al. 2002, 2005): the distal
segment's anatomical frame in the proximal one's, as three turns about z, x and y, at the shoulder about y, x and
y. The left side is mirrored, so that a number means the same at either side.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from arm.body.isb_frames import isb_frame
from arm.body.landmarks import limb_map
from arm.body.limbs import LIMBS
from arm.body.whole_body import body_map, is_whole_body
from arm.kinematics import axis_frames
from arm.model import Arm, Floats

#: About which axes of the moving frame a joint turns, one after the other.
Turns = Literal["ZXY", "YXY"]


@dataclass(frozen=True)
class _Joint:
    """Proximal and distal segment, the turns, and name and sign of each angle."""

    proximal: str
    distal: str
    turns: Turns
    angles: tuple[tuple[str, float], ...]


_JOINTS = {
    "lumbar": _Joint("pelvis", "thorax", "ZXY", (("flexion", -1.0), ("bending", 1.0), ("rotation", 1.0))),
    "hip": _Joint("pelvis", "thigh", "ZXY", (("flexion", 1.0), ("adduction", 1.0), ("internal_rotation", 1.0))),
    "knee": _Joint("thigh", "shank", "ZXY", (("flexion", -1.0), ("adduction", 1.0), ("internal_rotation", 1.0))),
    "ankle": _Joint(
        "shank", "foot", "ZXY", (("dorsiflexion", 1.0), ("inversion", 1.0), ("internal_rotation", 1.0))
    ),
    "shoulder": _Joint(
        "thorax", "upper_arm", "YXY", (("plane", 1.0), ("elevation", 1.0), ("internal_rotation", 1.0))
    ),
    "elbow": _Joint("upper_arm", "forearm", "ZXY", (("flexion", 1.0), ("carrying", 1.0), ("pronation", 1.0))),
    "wrist": _Joint(
        "forearm", "hand", "ZXY", (("flexion", 1.0), ("ulnar_deviation", 1.0), ("internal_rotation", 1.0))
    ),
}
_MIRROR = np.diag([1.0, 1.0, -1.0])


@dataclass(frozen=True)
class IsbAngles:
    """Angles of a motion.

    Attributes
    ----------
    names : tuple of str
        Such as ``isb_knee_right_flexion``.
    values : (n_sample, n_angle) [rad]
        Without whole turns from one sample to the next.
    missing : mapping of str to str
        Joints whose segments the arm has but not their frames, and the landmark or centre that is lacking.
    """

    names: tuple[str, ...]
    values: Floats
    missing: Mapping[str, str]


def isb_angles(arm: Arm, q: Floats) -> IsbAngles:
    """Return the angles of all joints whose segments' landmarks are known.

    Parameters
    ----------
    arm : Arm
        A person's limb or body whose markers say which landmarks they are.
    q : (n_sample, n_joint) [rad or m]
    """
    links, frames_0 = _links(arm), axis_frames(arm, np.zeros((1, arm.n_joint)))[0]
    points = {m.landmark: _at(frames_0, m.joint - 1, m.position_m) for m in arm.markers if m.landmark}
    points |= _centres(arm, frames_0)
    frames = axis_frames(arm, q)[..., :3, :3]
    own: dict[str, Floats] = {}
    lacking: dict[str, str] = {}
    for segment, link in links.items():
        try:
            anatomical = isb_frame(segment, points)
        except KeyError as error:
            lacking[segment] = str(error.args[0])
            continue
        if link < 0:
            own[segment] = np.broadcast_to(anatomical, (len(q), 3, 3))
        else:
            own[segment] = frames[:, link] @ (frames_0[link, :3, :3].T @ anatomical)
    names, columns, missing = list[str](), list[Floats](), dict[str, str]()
    for joint, side in ((joint, side) for joint in _JOINTS for side in ("", "right", "left")):
        known = _JOINTS[joint]
        ends = [s if s in links else f"{s}_{side}" for s in (known.proximal, known.distal)]
        if not all(end in links for end in ends) or (side == "") != (joint == "lumbar"):
            continue
        label = f"{joint}_{side}".rstrip("_")
        if any(end in lacking for end in ends):
            missing[label] = next(lacking[end] for end in ends if end in lacking)
            continue
        R = np.einsum("nji,njk->nik", own[ends[0]], own[ends[1]])
        if side == "left":
            R = _MIRROR @ R @ _MIRROR
        values = _turns(R, known.turns)
        for k, (name, sign) in enumerate(known.angles):
            names.append(f"isb_{label}_{name}")
            columns.append(sign * values[:, k])
    table = np.column_stack(columns) if columns else np.empty((len(q), 0))
    return IsbAngles(tuple(names), table, missing)


def _turns(R: Floats, turns: Turns) -> Floats:
    """Return the three angles, (n_sample, 3) [rad], about moving axes, without jumps of whole turns.

    About y, x and y an elevation has either sign; it is negative as Wu et al. (2005) have it.
    """
    values = Rotation.from_matrix(R).as_euler(turns)
    if turns[0] == turns[2]:
        values = np.where(values[:, 1:2] > 0.0, values * [1.0, -1.0, 1.0] + [np.pi, 0.0, np.pi], values)
    values = np.unwrap(values, axis=0)
    return np.asarray(values - 2.0 * np.pi * np.round(np.median(values, axis=0) / (2.0 * np.pi)))


def _links(arm: Arm) -> dict[str, int]:
    """Return the link, from 0, of each segment; -1 for the one that carries the base."""
    if is_whole_body(arm):
        return {name: part.link for name, part in body_map().parts.items()}
    if arm.name not in LIMBS:
        return {}
    where = limb_map(arm.name, arm.n_joint)
    return {where.base: -1} | {name: part.link for name, part in where.parts.items()}


def _centres(arm: Arm, frames_0: NDArray[np.float64]) -> dict[str, Floats]:
    """Return joints' centres with all joints at zero, in frame 0, (3,) [m] each."""
    if is_whole_body(arm):
        return {name: frames_0[k, :3, 3] for name, k in body_map().centres.items()}
    if arm.name not in LIMBS:
        return {}
    where = limb_map(arm.name, arm.n_joint)
    return {f"{name}_{where.side}": frames_0[k, :3, 3] for name, k in where.centres.items()}


def _at(frames_0: Floats, link: int, place: tuple[float, float, float]) -> Floats:
    if link < 0:
        return np.array(place)
    return np.asarray(frames_0[link, :3, :3] @ np.array(place) + frames_0[link, :3, 3])
